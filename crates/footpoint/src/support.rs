//! Support radii: uniform, per sample, and chosen from the spacing of the samples.

use crate::algebra::{compare, exponent};
use crate::cloud::Cloud;
use crate::run::{Cancelled, Run};
use crate::weight::Weight;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZero;

/// The rule that gives the support radii h (SPEC § 1), in the unit of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Support {
    /// One radius for all samples.
    Uniform(f64),
    /// The cloud's own column of supports.
    FromSamples,
    /// One radius: the median, over the samples, of the distance to the k-th distinct neighbour, with k such that an
    /// even sampling has this many effective neighbours (Σθ)²/Σθ². Above 50,000 distinct samples the median is taken
    /// over an even selection of 50,000 of them.
    Auto {
        /// Effective neighbours to aim at; 16 by default.
        effective_neighbours: f64,
    },
    /// One radius per sample: its own distance to the k-th distinct neighbour, k as for `Auto`.
    AutoPerSample {
        /// Effective neighbours to aim at.
        effective_neighbours: f64,
    },
}

impl Default for Support {
    fn default() -> Self {
        Self::Auto { effective_neighbours: 16.0 }
    }
}

/// Why no support can be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SupportError {
    /// A radius that is not a positive, finite number.
    #[error("support radius {0}: it must be positive and finite")]
    NotPositive(f64),
    /// A number of effective neighbours that cannot be aimed at.
    #[error("{0} effective neighbours: the number must be between 1 and 1e6")]
    EffectiveNeighbours(f64),
    /// `FromSamples` without a column of supports.
    #[error("the support is to come from the samples, but the cloud has no column of supports")]
    NoColumn,
    /// No sample takes part.
    #[error(
        "no usable sample among {0}: coordinates must be finite (and below 2^50 supports), factors positive"
    )]
    NoSample(usize),
    /// There is no second point to measure a distance to.
    #[error("all {0} usable samples coincide, so no support can be chosen: give a radius")]
    Coincident(usize),
    /// The radii differ by more than the arithmetic can hold.
    #[error("support radii from {smallest:e} to {largest:e}: the largest may be 1e60 times the smallest")]
    Range {
        /// Smallest radius.
        smallest: f64,
        /// Largest radius.
        largest: f64,
    },
    /// The choice was cancelled through its `Run`.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The radii that a rule gave, in the unit of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SupportSummary {
    /// Whether every sample has the same radius.
    pub uniform: bool,
    /// Smallest radius.
    pub smallest: f64,
    /// Median radius.
    pub median: f64,
    /// Largest radius.
    pub largest: f64,
}

/// Radii as the index needs them.
#[derive(Clone, Debug)]
pub(crate) enum Radii {
    Uniform(f64),
    /// One a sample; not positive where the sample is absent.
    PerSample(Vec<f64>),
}

/// Distinct samples whose neighbours are counted for a uniform support; the median of so many is within 1 % of the
/// median of all.
const SELECTION: usize = 50_000;

impl Radii {
    /// The radius of sample `i`, or `None` if that sample is absent.
    pub(crate) fn of<const D: usize>(&self, cloud: &Cloud<D>, i: usize) -> Option<f64> {
        let radius = match self {
            Self::Uniform(h) => *h,
            Self::PerSample(radii) => radii[i],
        };
        (radius > 0.0 && radius.is_finite() && cloud.is_present(i)).then_some(radius)
    }

    pub(crate) fn summary<const D: usize>(&self, cloud: &Cloud<D>) -> Result<SupportSummary, SupportError> {
        let mut radii: Vec<f64> = (0..cloud.len()).filter_map(|i| self.of(cloud, i)).collect();
        if radii.is_empty() {
            return Err(SupportError::NoSample(cloud.len()));
        }
        let middle = radii.len() / 2;
        let (below, median, above) = radii.select_nth_unstable_by(middle, f64::total_cmp);
        let smallest = below.iter().fold(*median, |a, &b| a.min(b));
        let largest = above.iter().fold(*median, |a, &b| a.max(b));
        if smallest < largest * 1e-60 {
            return Err(SupportError::Range { smallest, largest });
        }
        let uniform = matches!(self, Self::Uniform(_));
        Ok(SupportSummary { uniform, smallest, median: *median, largest })
    }
}

/// Applies the rule to a cloud.
pub(crate) fn choose<const D: usize>(
    cloud: &Cloud<D>,
    support: Support,
    weight: Weight,
    run: &Run<'_>,
) -> Result<Radii, SupportError> {
    match support {
        Support::Uniform(h) if h > 0.0 && h.is_finite() => Ok(Radii::Uniform(h)),
        Support::Uniform(h) => Err(SupportError::NotPositive(h)),
        Support::FromSamples => {
            let radii = cloud.supports().ok_or(SupportError::NoColumn)?;
            Ok(Radii::PerSample(radii.to_vec()))
        }
        Support::Auto { effective_neighbours } => {
            let spacing = Neighbours::of(cloud, neighbour_count::<D>(weight, effective_neighbours)?)?;
            let mut distances = spacing.distances(spacing.distinct.len().div_ceil(SELECTION), run)?;
            let middle = distances.len() / 2;
            Ok(Radii::Uniform(*distances.select_nth_unstable_by(middle, f64::total_cmp).1))
        }
        Support::AutoPerSample { effective_neighbours } => {
            let spacing = Neighbours::of(cloud, neighbour_count::<D>(weight, effective_neighbours)?)?;
            let distances = spacing.distances(1, run)?;
            let mut radii = vec![f64::NAN; cloud.len()];
            for (samples, distance) in spacing.groups().zip(distances) {
                for &i in samples {
                    radii[i as usize] = distance;
                }
            }
            Ok(Radii::PerSample(radii))
        }
    }
}

/// k = ⌈n_eff · count/n_eff of the weight⌉ (SPEC § 1).
fn neighbour_count<const D: usize>(weight: Weight, effective: f64) -> Result<usize, SupportError> {
    if !(1.0..=1e6).contains(&effective) {
        return Err(SupportError::EffectiveNeighbours(effective));
    }
    Ok((effective / weight.effective_share(D)).ceil() as usize)
}

/// Median distance from a sample to its nearest distinct neighbour, in the unit of the coordinates.
///
/// Taken over at most 50,000 samples, evenly selected. `None` where fewer than two distinct samples exist.
pub fn spacing<const D: usize>(cloud: &Cloud<D>, run: &Run<'_>) -> Option<f64> {
    let neighbours = Neighbours::of(cloud, 1).ok()?;
    let mut distances = neighbours.distances(neighbours.distinct.len().div_ceil(SELECTION), run).ok()?;
    let middle = distances.len() / 2;
    Some(*distances.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The k-th distinct neighbours of the usable samples.
struct Neighbours<'c, const D: usize> {
    cloud: &'c Cloud<D>,
    k: NonZero<usize>,
    /// Usable samples ordered by their coordinates, so that repeats stand together.
    order: Vec<u32>,
    /// Where each distinct point begins in `order`.
    distinct: Vec<usize>,
}

impl<'c, const D: usize> Neighbours<'c, D> {
    fn of(cloud: &'c Cloud<D>, k: usize) -> Result<Self, SupportError> {
        let points = cloud.points();
        let mut order: Vec<u32> =
            (0..cloud.len()).filter(|&i| cloud.is_present(i)).map(|i| i as u32).collect();
        if order.is_empty() {
            return Err(SupportError::NoSample(cloud.len()));
        }
        order.sort_unstable_by(|&a, &b| {
            let (a, b) = (points[a as usize], points[b as usize]);
            compare(a, b)
        });
        let distinct: Vec<usize> = (0..order.len())
            .filter(|&j| j == 0 || points[order[j] as usize] != points[order[j - 1] as usize])
            .collect();
        if distinct.len() < 2 {
            return Err(SupportError::Coincident(order.len()));
        }
        let k = NonZero::new(k.min(distinct.len() - 1)).unwrap_or(NonZero::<usize>::MIN);
        Ok(Self { cloud, k, order, distinct })
    }

    /// The samples at each distinct point.
    fn groups(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.distinct.iter().skip(1).copied().chain([self.order.len()]);
        self.distinct.iter().zip(ends).map(|(&begin, end)| &self.order[begin..end])
    }

    /// Distance to the k-th distinct neighbour, for every `stride`-th distinct point.
    fn distances(&self, stride: usize, run: &Run<'_>) -> Result<Vec<f64>, SupportError> {
        let position = |j: usize| self.cloud.points()[self.order[self.distinct[j]] as usize];
        // A power of two brings the extent near one: squares of tiny or huge distances stay in range, and the
        // distances keep their bits.
        let extent = (0..D)
            .map(|k| {
                let axis = (0..self.distinct.len()).map(|j| position(j)[k]);
                let (low, high) = axis.fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(c), h.max(c)));
                high / 2.0 - low / 2.0
            })
            .fold(0.0, f64::max);
        let unit = 2.0_f64.powi(exponent(extent).clamp(-1000, 1000));
        let points: Vec<[f64; D]> = (0..self.distinct.len()).map(|j| position(j).map(|c| c / unit)).collect();
        let Ok(tree) = ImmutableKdTree::<f64, D>::new_from_slice(&points) else {
            return Err(SupportError::Coincident(self.order.len()));
        };
        let wanted = self.k.saturating_add(1);
        Ok(run.map(points.len().div_ceil(stride), |j| {
            let query = &points[j * stride];
            let found = tree.query(query).nearest_n::<SquaredEuclidean<f64>>(wanted).execute();
            found.last().map_or(f64::NAN, |item| item.distance.sqrt() * unit)
        })?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn uniform<const D: usize>(cloud: &Cloud<D>, n: f64) -> f64 {
        let auto = Support::Auto { effective_neighbours: n };
        match choose(cloud, auto, Weight::Poly3, &Run::new()).unwrap() {
            Radii::Uniform(h) => h,
            Radii::PerSample(_) => unreachable!(),
        }
    }

    #[test]
    fn the_count_is_that_of_the_specification() {
        assert_eq!(neighbour_count::<3>(Weight::Poly3, 16.0), Ok(37));
        assert_eq!(neighbour_count::<2>(Weight::Poly2, 7.0), Ok(10));
    }

    #[test]
    fn auto_is_the_median_of_the_brute_force_distances() {
        let cloud = Cloud::new(samples::torus(1.0, 0.4, 800, 3).points);
        let mut kth: Vec<f64> = cloud
            .points()
            .iter()
            .map(|p| {
                let mut all: Vec<f64> = cloud
                    .points()
                    .iter()
                    .map(|q| crate::algebra::length(crate::algebra::sub(*p, *q)))
                    .collect();
                all.sort_unstable_by(f64::total_cmp);
                all[37]
            })
            .collect();
        kth.sort_unstable_by(f64::total_cmp);
        assert!((uniform(&cloud, 16.0) - kth[400]).abs() < 1e-12);
    }

    #[test]
    fn repeats_do_not_count_as_neighbours() {
        let once = samples::torus(1.0, 0.4, 500, 3).points;
        let twice: Vec<_> = once.iter().chain(&once).copied().collect();
        assert_eq!(uniform(&Cloud::new(once), 10.0), uniform(&Cloud::new(twice), 10.0));
    }

    #[test]
    fn the_choice_scales_with_the_cloud_at_any_magnitude() {
        let points = samples::circle(1.0, 100, 5).points;
        let h = uniform(&Cloud::new(points.clone()), 8.0);
        for factor in [2.0_f64.powi(-600), 2.0_f64.powi(600)] {
            let scaled: Vec<_> = points.iter().map(|p| p.map(|c| c * factor)).collect();
            assert_eq!(uniform(&Cloud::new(scaled), 8.0), h * factor);
        }
    }

    #[test]
    fn clouds_without_a_spacing_are_refused() {
        let run = Run::new();
        let auto = Support::default();
        let refuse = |cloud: Cloud<3>| choose(&cloud, auto, Weight::Poly3, &run).unwrap_err();
        assert_eq!(refuse(Cloud::new([[1.0; 3]; 4])), SupportError::Coincident(4));
        assert_eq!(refuse(Cloud::new([[f64::NAN; 3]; 2])), SupportError::NoSample(2));
        assert_eq!(refuse(Cloud::default()), SupportError::NoSample(0));
        let none = Support::Auto { effective_neighbours: f64::NAN };
        assert!(choose(&Cloud::new([[0.0; 3], [1.0; 3]]), none, Weight::Poly3, &run).is_err());
    }
}
