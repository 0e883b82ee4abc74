//! The samples around a position against their weighted plane: what they leave, and what each decides by
//! itself.

use super::sums::{General, List, Place, cut, to_sample};
use crate::algebra::{Matrix, Vector, dot, sub};
use crate::eigen::product;
use crate::lane::Lane;
use crate::weight::Kernel;

/// Heights along n over a plane: residual and leverage of a sample at d with weight w are m·(d − u) and w
/// (1/S + (d − u)ᵀ P (d − u)).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Regression<L, const D: usize> {
    /// u, the weighted average.
    pub(crate) centre: Vector<L, D>,
    /// m = n − P M n: n itself where it is an eigenvector of the moments M about the average.
    pub(crate) across: Vector<L, D>,
    /// P, the inverse of M on the plane across n; NaN where the samples do not span that.
    pub(crate) inverse: Matrix<L, D>,
    /// 1/S.
    pub(crate) inverse_weight: L,
}

/// Sums over the samples with weight w, residual e from the plane and leverage H, how much of its own height
/// at the plane a sample decides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scatter<L> {
    /// Σ w e².
    pub(crate) residuals: L,
    /// Σ w (1 − H).
    pub(crate) freedom: L,
    /// Σ w² (1 − H)².
    pub(crate) squares: L,
}

impl<L> Scatter<L> {
    #[inline(always)]
    pub(crate) fn map<M>(self, f: impl Fn(L) -> M) -> Scatter<M> {
        Scatter { residuals: f(self.residuals), freedom: f(self.freedom), squares: f(self.squares) }
    }
}

/// One more pass, from what the first kept.
#[inline(always)]
pub(crate) fn scatter<L: Lane, K: Kernel, const D: usize>(
    varied: bool,
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    plane: &Regression<L, D>,
    kept: &[L::Slot],
) -> Scatter<L> {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let factor = L::splat(token, kernel.uniform_constants(columns.uniform_scale)[1]);
    let nought = L::splat(token, 0.0);
    let one = L::splat(token, 1.0);
    let mut sums = Scatter { residuals: nought, freedom: nought, squares: nought };
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let aside = sub(to_sample::<L, General, D>(&points, j, x), plane.centre);
        let own = if varied { L::broadcast(token, columns.factors[j]) } else { factor };
        let weight = own * kernel.theta(L::load(token, kept));
        let residual = dot(plane.across, aside);
        let leverage = weight * (plane.inverse_weight + dot(aside, product(plane.inverse, aside)));
        let free = weight * (one - leverage);
        sums.residuals = (weight * residual).mul_add(residual, sums.residuals);
        sums.freedom = sums.freedom + free;
        sums.squares = free.mul_add(free, sums.squares);
    }
    sums
}
