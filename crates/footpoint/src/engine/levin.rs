//! The sums of Levin's surface (SPEC § 7), in general mode: those of f_L once n is known, then those of its gradient.

use super::candidates::Columns;
use super::sums::{Frame, General, List, Place, cut, norm_by, to_sample, turned};
use crate::algebra::{Vector, add_scaled, dot, scale, zero};
use crate::lane::Lane;
use crate::weight::Kernel;

/// What f_L takes beside the sums of the frame, lengths in units of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevinSums<L, const D: usize> {
    /// Σ ψ (n·d)².
    pub(crate) squares: L,
    /// Σ ψ (n·d)² d.
    pub(crate) cubes: Vector<L, D>,
}

/// The pass between the first and the second.
#[inline(always)]
pub(crate) fn levin_sums<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    normal: Vector<L, D>,
    kept: &[L::Slot],
) -> LevinSums<L, D> {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let mut sums = LevinSums { squares: L::splat(token, 0.0), cubes: zero(token) };
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let psi = kernel.psi(L::load(token, kept)) * L::broadcast(token, columns.slopes[j]);
        let height = dot(normal, d);
        let part = psi * (height * height);
        sums.squares = sums.squares + part;
        sums.cubes = add_scaled(sums.cubes, d, part);
    }
    sums
}

/// ψ [(n·d)(1 − q·d) + f] + ½ χ (n·d)³: what stands before d in −S G_i (SPEC § 10).
#[inline(always)]
fn along_sample<L: Lane, const D: usize>(
    (frame, value): (&Frame<L, D>, L),
    d: Vector<L, D>,
    [psi, chi]: [L; 2],
) -> L {
    let height = dot(frame.normal, d);
    let turned = height.mul_add(height.like(1.0) - dot(frame.turn, d), value);
    let cube = height * height * (height * height.like(0.5));
    psi.mul_add(turned, chi * cube)
}

/// −S G_i (SPEC § 10) for weights θ, ψ, χ; q is the frame's turn and f = f_L.
#[inline(always)]
pub(crate) fn levin_share<L: Lane, const D: usize>(
    levin: (&Frame<L, D>, L),
    d: Vector<L, D>,
    [theta, psi, chi]: [L; 3],
) -> Vector<L, D> {
    let normal = levin.0.normal;
    let height = dot(normal, d);
    let along = scale(d, along_sample(levin, d, [psi, chi]));
    let upright = psi * (height * height) * height.like(1.5);
    add_scaled(add_scaled(along, turned(levin.0, d), theta), normal, upright)
}

/// ψ and χ of the sample at place j.
#[inline(always)]
fn slopes<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    columns: &Columns<L::Number, D>,
    j: usize,
    closeness: L,
) -> [L; 2] {
    let number = |column: &[L::Number]| L::broadcast(closeness.token(), column[j]);
    let slope = number(&columns.slopes);
    [kernel.psi(closeness) * slope, kernel.chi(closeness) * (slope * number(&columns.inverse))]
}

/// Pass two: Σ {ψ [(n·d)(1 − q·d) + f] + ½ χ (n·d)³} d, with q the frame's turn and f = f_L.
#[inline(always)]
pub(crate) fn levin_second_pass<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    levin: (&Frame<L, D>, L),
    kept: &[L::Slot],
) -> Vector<L, D> {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let mut sum = zero(token);
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let weights = slopes(kernel, columns, j, L::load(token, kept));
        sum = add_scaled(sum, d, along_sample(levin, d, weights));
    }
    sum
}

/// S² Σ |G_i|² and the same in the norm of the samples' own noise (SPEC § 10).
#[inline(always)]
pub(crate) fn levin_sensitivity<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    levin: (&Frame<L, D>, L),
    kept: &[L::Slot],
) -> [L; 2] {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let (mut sum, mut noisy) = (L::splat(token, 0.0), L::splat(token, 0.0));
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let closeness = L::load(token, kept);
        let theta = kernel.theta(closeness) * L::broadcast(token, columns.factors[j]);
        let [psi, chi] = slopes(kernel, columns, j, closeness);
        let whole = levin_share(levin, d, [theta, psi, chi]);
        sum = sum + dot(whole, whole);
        noisy = noisy + norm_by(&columns.noise, j, whole);
    }
    [sum, noisy]
}
