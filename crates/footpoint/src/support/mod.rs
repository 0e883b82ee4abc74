//! Support radii: uniform, per sample, and chosen from spacing, noise and curvature of the samples.

mod least_error;
mod local_fit;
pub(crate) mod neighbours;

use crate::cloud::Cloud;
use crate::run::{Cancelled, Run};
use crate::weight::Weight;
use least_error::{Spread, least_error};
use neighbours::Distinct;

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
    /// One radius: that at which the estimated distance of the surface from the one that was sampled is least (root mean
    /// square over the samples). Noise and bias are estimated at 2000 of them, for 2 to 1000 effective neighbours; see
    /// [`SupportChoice`] and `docs/accuracy.md`. It costs some tenths of a second more than `Auto`.
    LeastError,
    /// One radius per sample, as for `AutoPerSample`, with the effective neighbours of the least error.
    LeastErrorPerSample,
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

/// Why [`Support::LeastError`] chose what it did. Lengths are in the unit of the coordinates, and NaN where no surface was
/// found to estimate them by (then the support is that of `Auto`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SupportChoice {
    /// Effective neighbours of an even sampling with this support: for `Auto` and `AutoPerSample` to repeat the choice.
    pub effective_neighbours: f64,
    /// Standard deviation of the samples across the surface: what a local quadratic leaves (median).
    pub noise: f64,
    /// What is left of the noise in the surface, root mean square.
    pub error_from_noise: f64,
    /// How far the surface is drawn aside by curvature, root mean square; 0 where no more is seen than noise explains.
    pub error_from_bias: f64,
}

impl SupportChoice {
    /// The expected distance from the surface that was sampled, root mean square.
    pub fn error(&self) -> f64 {
        self.error_from_noise.hypot(self.error_from_bias)
    }
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
/// The median of so many is within 2 % of that of all.
const SMALL_SELECTION: usize = 5_000;

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
) -> Result<(Radii, Option<SupportChoice>), SupportError> {
    let radii = match support {
        Support::Uniform(h) if h > 0.0 && h.is_finite() => Radii::Uniform(h),
        Support::Uniform(h) => return Err(SupportError::NotPositive(h)),
        Support::FromSamples => {
            let radii = cloud.supports().ok_or(SupportError::NoColumn)?;
            Radii::PerSample(radii.to_vec())
        }
        Support::Auto { effective_neighbours } => {
            let count = neighbour_count::<D>(weight, effective_neighbours)?;
            let distinct = Distinct::of(cloud)?;
            Radii::Uniform(median(distinct.distances(count, distinct.len().div_ceil(SELECTION), run)?))
        }
        Support::AutoPerSample { effective_neighbours } => {
            let count = neighbour_count::<D>(weight, effective_neighbours)?;
            per_sample(cloud, &Distinct::of(cloud)?, count, run)?
        }
        Support::LeastError => {
            let found = least_error((cloud, &Distinct::of(cloud)?), weight, Spread::Uniform, run)?;
            return Ok((Radii::Uniform(found.radius), Some(found.choice)));
        }
        Support::LeastErrorPerSample => {
            let distinct = Distinct::of(cloud)?;
            let found = least_error((cloud, &distinct), weight, Spread::PerSample, run)?;
            return Ok((per_sample(cloud, &distinct, found.count, run)?, Some(found.choice)));
        }
    };
    Ok((radii, None))
}

/// The radii for so many effective neighbours each, as for [`Support::Auto`] but over fewer samples.
pub(crate) fn radii_of<const D: usize>(
    cloud: &Cloud<D>,
    weight: Weight,
    effective_neighbours: &[f64],
    run: &Run<'_>,
) -> Result<Vec<f64>, SupportError> {
    let counts: Result<Vec<usize>, SupportError> =
        effective_neighbours.iter().map(|&n| neighbour_count::<D>(weight, n)).collect();
    let counts = counts?;
    let distinct = Distinct::of(cloud)?;
    let stride = distinct.len().div_ceil(SMALL_SELECTION);
    counts.into_iter().map(|count| Ok(median(distinct.distances(count, stride, run)?))).collect()
}

/// Every sample's distance to the k-th distinct neighbour.
fn per_sample<const D: usize>(
    cloud: &Cloud<D>,
    distinct: &Distinct<D>,
    count: usize,
    run: &Run<'_>,
) -> Result<Radii, Cancelled> {
    let distances = distinct.distances(count, 1, run)?;
    let mut radii = vec![f64::NAN; cloud.len()];
    for (samples, distance) in distinct.groups().zip(distances) {
        for &i in samples {
            radii[i as usize] = distance;
        }
    }
    Ok(Radii::PerSample(radii))
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
    let distinct = Distinct::of(cloud).ok()?;
    Some(median(distinct.distances(1, distinct.len().div_ceil(SELECTION), run).ok()?))
}

/// NaN for no value.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { f64::NAN } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn uniform<const D: usize>(cloud: &Cloud<D>, n: f64) -> f64 {
        let auto = Support::Auto { effective_neighbours: n };
        match choose(cloud, auto, Weight::Poly3, &Run::new()).unwrap().0 {
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
