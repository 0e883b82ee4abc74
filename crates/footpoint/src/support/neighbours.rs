//! The distinct points among the samples, and their neighbours.

use super::SupportError;
use crate::algebra::{compare, exponent, sub};
use crate::cloud::Cloud;
use crate::run::{Cancelled, Run};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZero;

/// The distinct points of the usable samples, in an order that depends on nothing else, with a tree over them.
pub(crate) struct Distinct<const D: usize> {
    /// Usable samples ordered by their coordinates, so that repeats stand together.
    order: Vec<u32>,
    /// Where each distinct point begins in `order`.
    begins: Vec<usize>,
    /// The distinct points, in `unit`s.
    points: Vec<[f64; D]>,
    /// A power of two that brings the extent near one: squares of tiny or huge distances stay in range, and the
    /// distances keep their bits.
    pub(crate) unit: f64,
    tree: ImmutableKdTree<f64, D>,
}

impl<const D: usize> Distinct<D> {
    pub(crate) fn of(cloud: &Cloud<D>) -> Result<Self, SupportError> {
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
        let begins: Vec<usize> = (0..order.len())
            .filter(|&j| j == 0 || points[order[j] as usize] != points[order[j - 1] as usize])
            .collect();
        if begins.len() < 2 {
            return Err(SupportError::Coincident(order.len()));
        }
        let position = |&j: &usize| points[order[j] as usize];
        let extent = (0..D)
            .map(|k| {
                let axis = begins.iter().map(|j| position(j)[k]);
                let (low, high) = axis.fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(c), h.max(c)));
                high / 2.0 - low / 2.0
            })
            .fold(0.0, f64::max);
        let unit = 2.0_f64.powi(exponent(extent).clamp(-1000, 1000));
        let points: Vec<[f64; D]> = begins.iter().map(|j| position(j).map(|c| c / unit)).collect();
        let Ok(tree) = ImmutableKdTree::<f64, D>::new_from_slice(&points) else {
            return Err(SupportError::Coincident(order.len()));
        };
        Ok(Self { order, begins, points, unit, tree })
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// A distinct point, in `unit`s.
    pub(crate) fn point(&self, j: usize) -> [f64; D] {
        self.points[j]
    }

    /// The samples at each distinct point.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.begins.iter().skip(1).copied().chain([self.order.len()]);
        self.begins.iter().zip(ends).map(|(&begin, end)| &self.order[begin..end])
    }

    /// Sum of the factors of the samples at each distinct point.
    pub(crate) fn factors(&self, cloud: &Cloud<D>) -> Vec<f64> {
        let sum = |samples: &[u32]| {
            let mut each: Vec<f64> =
                samples.iter().map(|&i| cloud.factors().map_or(1.0, |factors| factors[i as usize])).collect();
            // The sum must not depend on the order of the input.
            each.sort_unstable_by(f64::total_cmp);
            each.iter().sum()
        };
        self.groups().map(sum).collect()
    }

    /// Distance to the k-th distinct neighbour, for every `stride`-th distinct point, in the unit of the coordinates.
    pub(crate) fn distances(&self, k: usize, stride: usize, run: &Run<'_>) -> Result<Vec<f64>, Cancelled> {
        run.map(self.len().div_ceil(stride), |j| self.distance(self.points[j * stride], k) * self.unit)
    }

    /// Distance from a location to the k-th distinct point beyond the nearest, or to the last there is, in `unit`s.
    pub(crate) fn distance(&self, at: [f64; D], k: usize) -> f64 {
        let wanted = NonZero::new(k.min(self.len() - 1)).unwrap_or(NonZero::<usize>::MIN).saturating_add(1);
        let found = self.tree.query(&at).nearest_n::<SquaredEuclidean<f64>>(wanted).execute();
        found.last().map_or(f64::NAN, |item| item.distance.sqrt())
    }

    /// Calls `visit` with the number of every distinct point nearer than `radius` and its way from `at`, in `unit`s.
    pub(crate) fn within(&self, at: [f64; D], radius: f64, mut visit: impl FnMut(usize, [f64; D])) {
        let query = self.tree.query(&at).within::<SquaredEuclidean<f64>>(radius * radius);
        query.unsorted().visit(|found| {
            let j = found.item as usize;
            visit(j, sub(self.points[j], at));
        });
    }
}
