//! Near samples: pairs within each other's reach, found for a few samples at a time and never stored.

use crate::cloud::Cloud;
use crate::grid::{Grid, snapped};
use crate::run::{Cancelled, Run};

/// Samples whose neighbours are gathered together: they lie close to each other.
const TOGETHER: usize = 16;

/// The relation *near* between samples, named by their places in the canonical order: no further apart than the smaller of
/// their reaches, each a share of the sample's support.
pub(crate) struct Neighbours<'s, const D: usize> {
    cloud: &'s Cloud<D>,
    grid: &'s Grid<D>,
    share: f64,
}

/// A sample as its neighbours see it, in units of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour<const D: usize> {
    pub(crate) place: usize,
    pub(crate) point: [f64; D],
    pub(crate) reach: f64,
}

impl<const D: usize> Neighbour<D> {
    /// The way to a near sample in units of the smaller reach, at most 1 long; `None` if the other is not near. The way back
    /// is its negative, bit for bit.
    #[inline]
    pub(crate) fn way_to(&self, other: &Self) -> Option<[f32; D]> {
        let reach = self.reach.min(other.reach);
        let mut squared = 0.0;
        for k in 0..D {
            let along = other.point[k] - self.point[k];
            squared += along * along;
        }
        if squared > reach * reach {
            return None;
        }
        let inverse = 1.0 / reach;
        Some(std::array::from_fn(|k| ((other.point[k] - self.point[k]) * inverse) as f32))
    }
}

impl<'s, const D: usize> Neighbours<'s, D> {
    /// `share` of the supports is at most the weight's reach.
    pub(crate) fn new(cloud: &'s Cloud<D>, grid: &'s Grid<D>, share: f64) -> Self {
        Self { cloud, grid, share }
    }

    /// The sample at a place.
    #[inline]
    pub(crate) fn at(&self, place: usize) -> Neighbour<D> {
        let point = self.grid.sample(place).unwrap_or_else(|| {
            // Single precision: the lattice point that the index holds.
            let given = self.cloud.points()[self.grid.original()[place] as usize];
            let inverse = 1.0 / self.grid.unit;
            snapped(given.map(|c| c * inverse))
        });
        let scale = self.grid.scales.get(place).copied().unwrap_or(self.grid.uniform_scale);
        Neighbour { place, point, reach: self.share * scale }
    }

    /// Puts the samples whose reach meets the box between `low` and `high` into `found`, in canonical order.
    pub(crate) fn gather(&self, low: [f64; D], high: [f64; D], found: &mut Vec<Neighbour<D>>) {
        found.clear();
        self.grid.visit(low, high, |stretch| {
            for place in stretch.samples() {
                let sample = self.at(place);
                // Differences are rounded alike here and in `way_to`; the rest is for its squares.
                let reach = sample.reach * (1.0 + 1e-12);
                let meets =
                    |k: usize| low[k] - sample.point[k] <= reach && sample.point[k] - high[k] <= reach;
                if (0..D).all(meets) {
                    found.push(sample);
                }
            }
        });
    }

    /// Calls `work` for every sample that is `wanted`, in parallel, with all samples that may be near it (and others).
    pub(crate) fn for_each(
        &self,
        run: &Run<'_>,
        wanted: impl Fn(usize) -> bool + Sync + Send,
        work: impl Fn(&Neighbour<D>, &[Neighbour<D>]) + Sync + Send,
    ) -> Result<(), Cancelled> {
        let groups = self.grid.groups();
        let size = |i: usize| groups.range(i).len();
        let state = || (Vec::new(), Vec::new());
        run.for_each_group(groups.count(), size, state, |(members, found), group| {
            for places in groups.order[groups.range(group)].chunks(TOGETHER) {
                members.clear();
                members.extend(places.iter().filter(|&&i| wanted(i as usize)).map(|&i| self.at(i as usize)));
                let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
                for Neighbour { point, .. } in members.iter() {
                    for k in 0..D {
                        low[k] = low[k].min(point[k]);
                        high[k] = high[k].max(point[k]);
                    }
                }
                if members.is_empty() {
                    continue;
                }
                self.gather(low, high, found);
                for member in members.iter() {
                    work(member, found);
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::Precision;
    use crate::samples;
    use crate::support::Radii;
    use std::sync::Mutex;

    /// Every pair within the smaller reach is found from both sides, whatever the precision.
    fn check(radii: &Radii, precision: Precision) {
        let cloud = Cloud::new(samples::torus(1.0, 0.4, 700, 3).points);
        let run = Run::new();
        let grid = Grid::new(&cloud, radii, 0.5, 1.0, precision, &run);
        let near = Neighbours::new(&cloud, &grid, 0.8);
        let found = Mutex::new(Vec::new());
        let collect = |a: &Neighbour<3>, others: &[Neighbour<3>]| {
            for b in others {
                if let (Some(way), Some(back)) = (a.way_to(b), b.way_to(a)) {
                    assert_eq!(way, back.map(|c| -c));
                    found.lock().unwrap().push((a.place, b.place));
                }
            }
        };
        near.for_each(&run, |_| true, collect).unwrap();
        let mut found = found.into_inner().unwrap();
        found.sort_unstable();
        let all: Vec<_> = (0..grid.len()).map(|i| near.at(i)).collect();
        let mut expected = Vec::new();
        for a in &all {
            expected.extend(all.iter().filter(|b| a.way_to(b).is_some()).map(|b| (a.place, b.place)));
        }
        assert!(found.len() > 5 * all.len() && found == expected, "{} pairs", found.len());
    }

    #[test]
    fn pairs_are_found_from_both_sides() {
        let own: Vec<f64> = (0..700).map(|i| 0.5 - 0.0004 * f64::from(i)).collect();
        for precision in [Precision::Double, Precision::Single] {
            check(&Radii::Uniform(0.5), precision);
            check(&Radii::PerSample(own.clone()), precision);
        }
    }
}
