//! The plane that fits the samples around a position best by weighted least squares, along the frame's
//! normal.

use crate::algebra::{Matrix, Vector, dot, each, scale, sub, tangential};
use crate::eigen::{product, trace};
use crate::engine::{FrameSums, Regression};
use crate::lane::{Lane, Number};

/// Moments along some direction of the plane below this share of those along another, in units in the last
/// place, are rounding.
const FLAT: f64 = 45.0;

impl<L: Lane, const D: usize> Regression<L, D> {
    /// From sums that have the positions' moments.
    #[inline(always)]
    pub(crate) fn new(sums: &FrameSums<L, D>, normal: Vector<L, D>) -> Self {
        let inverse_weight = sums.weight.like(1.0) / sums.weight;
        let centre = scale(sums.first, inverse_weight);
        let moments: Matrix<L, D> =
            each(|i| each(|k| (-centre[i]).mul_add(sums.first[k], sums.second[i][k])));
        let turned = product(moments, normal);
        let along = dot(normal, turned);
        // T M T with T = I − n nᵀ.
        let plane: Matrix<L, D> = each(|i| {
            each(|k| {
                let both = normal[i] * turned[k] + turned[i] * normal[k];
                (normal[i] * normal[k]).mul_add(along, moments[i][k] - both)
            })
        });
        let whole = trace(plane);
        let unit = |i: usize, k: usize| whole.like(if i == k { 1.0 } else { 0.0 });
        let inverse: Matrix<L, D> = if D == 2 {
            each(|i| each(|k| (unit(i, k) - normal[i] * normal[k]) / whole))
        } else {
            let minor = |i: usize, j: usize| plane[i][i] * plane[j][j] - plane[i][j] * plane[i][j];
            let minors = minor(0, 1) + minor(0, D - 1) + minor(1, D - 1);
            let known = (whole * whole * whole.like(FLAT * L::Number::EPSILON)).less(minors);
            let minors = L::select(known, minors, whole.like(f64::NAN));
            each(|i| each(|k| ((unit(i, k) - normal[i] * normal[k]) * whole - plane[i][k]) / minors))
        };
        let across = sub(normal, product(inverse, tangential(turned, normal)));
        Self { centre, across, inverse, inverse_weight }
    }
}
