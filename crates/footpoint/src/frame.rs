//! Frames: the normal n and how it turns, from the sums of the first pass (SPEC § 3, § 4).

use crate::algebra::{Matrix, Vector, add, add_scaled, dot, each, scale, tangential, zero};
use crate::eigen::{mirrored, pseudo_inverse, smallest, trace};
use crate::engine::{Frame, FrameSums, LevinSums};
use crate::field::NormalField;
use crate::lane::{Lane, Number};

/// A frame and its quality.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit<L, const D: usize> {
    pub(crate) frame: Frame<L, D>,
    /// (λ1 − λ0)/λ_max; |Nv|/S for averaged normals.
    pub(crate) gap: L,
    /// Eigenvalues in ascending order, of the matrix that is not normalised; zero for averaged normals.
    pub(crate) eigenvalues: Vector<L, D>,
}

impl<L: Copy, const D: usize> Fit<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> Fit<M, D> {
        Fit { frame: self.frame.map(f), gap: f(self.gap), eigenvalues: each(|k| f(self.eigenvalues[k])) }
    }
}

/// Eigenvalues of the centred matrix that differ by less than this share of the trace about x, in units of the last
/// place, are equal: rounding leaves a few such units of that trace.
const CANCELLED: f64 = 45.0;

/// Fits the frame. The sign of n is that of the samples' normals where they have one here, else the component of
/// largest magnitude is positive (SPEC § 3).
#[inline(always)]
pub(crate) fn fit<L: Lane, const D: usize>(field: NormalField, sums: &FrameSums<L, D>) -> Fit<L, D> {
    let inverse = sums.weight.like(1.0) / sums.weight;
    let u = scale(sums.first, inverse);
    if field == NormalField::AveragedNormals {
        let length = dot(sums.normals, sums.normals).sqrt();
        let normal = scale(sums.normals, length.like(1.0) / length);
        let turn = scale(tangential(u, normal), sums.weight / length);
        let frame = Frame { normal, aside: u, turn };
        return Fit { frame, gap: length * inverse, eigenvalues: zero(length.token()) };
    }
    let axes = field == NormalField::AveragedAxes;
    let sum = if axes { sums.axes } else { sums.second };
    let mut matrix: Matrix<L, D> = each(|i| scale(sum[i], inverse));
    let whole = trace(matrix);
    if field == NormalField::CentredCovariance {
        matrix = each(|i| each(|j| (-u[i]).mul_add(u[j], matrix[i][j])));
    }
    let pair = smallest(if axes { mirrored(matrix) } else { matrix });
    let values = if axes { each(|k| whole - pair.values[D - 1 - k]) } else { pair.values };
    let normal = signed(pair.vector, sums);
    let own = if axes { D - 1 } else { 0 };
    let turn = pseudo_inverse(matrix, values[own], normal, u);
    let difference = pair.values[1] - pair.values[0];
    // Where the samples nearly coincide the centred matrix cancels: what is left is rounding, not a frame.
    let known = (whole * whole.like(CANCELLED * L::Number::EPSILON)).less(difference);
    let gap = L::select(known, difference / values[D - 1], whole.like(0.0));
    Fit { frame: Frame { normal, aside: u, turn }, gap, eigenvalues: scale(values, sums.weight) }
}

/// The axis with the sign of SPEC § 3.
#[inline(always)]
fn signed<L: Lane, const D: usize>(axis: Vector<L, D>, sums: &FrameSums<L, D>) -> Vector<L, D> {
    let zero = axis[0].like(0.0);
    let mut largest = axis[0];
    for k in 1..D {
        largest = L::select(largest.abs().less(axis[k].abs()), axis[k], largest);
    }
    let along = dot(axis, sums.normals);
    // With no normal here, or exactly across, the component decides.
    let decisive = L::select(zero.less(along.abs()), along, largest);
    let sign = L::select(decisive.less(zero), zero.like(-1.0), zero.like(1.0));
    scale(axis, sign)
}

/// ∇f from the second pass (SPEC § 4; § 10 for the closed part).
#[inline(always)]
pub(crate) fn gradient<L: Lane, const D: usize>(
    field: NormalField,
    frame: &Frame<L, D>,
    weight: L,
    second: Vector<L, D>,
) -> Vector<L, D> {
    let Frame { normal: n, aside: u, turn: g } = *frame;
    let sum = scale(second, weight.like(1.0) / weight);
    match field {
        NormalField::Covariance => {
            let closed = add_scaled(scale(n, weight.like(1.0) - dot(g, u)), g, -dot(n, u));
            add(closed, sum)
        }
        _ => add(n, sum),
    }
}

/// Levin's surface at a frame (SPEC § 7).
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevinFit<L, const D: usize> {
    /// Its turn is q_L = P w.
    pub(crate) frame: Frame<L, D>,
    /// f_L.
    pub(crate) value: L,
    /// 1 + (3/2) Σψ(n·d)²/S: how steeply f_L rises along n with the heights alone.
    pub(crate) steepness: L,
}

impl<L: Copy, const D: usize> LevinFit<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> LevinFit<M, D> {
        LevinFit { frame: self.frame.map(f), value: f(self.value), steepness: f(self.steepness) }
    }
}

/// f_L and what its second pass needs, from the frame about x and the sums that follow it.
#[inline(always)]
pub(crate) fn fit_levin<L: Lane, const D: usize>(
    sums: &FrameSums<L, D>,
    fit: &Fit<L, D>,
    levin: &LevinSums<L, D>,
) -> LevinFit<L, D> {
    let inverse = sums.weight.like(1.0) / sums.weight;
    let number = |value: f64| inverse.like(value);
    let Frame { normal, aside, .. } = fit.frame;
    let cubes = scale(levin.cubes, inverse);
    // With A and w both over S, P w keeps its size.
    let matrix: Matrix<L, D> = each(|i| scale(sums.second[i], inverse));
    let w = add_scaled(aside, cubes, number(1.5));
    let turn = pseudo_inverse(matrix, fit.eigenvalues[0] * inverse, normal, w);
    LevinFit {
        frame: Frame { normal, aside, turn },
        value: -dot(normal, add_scaled(aside, cubes, number(0.5))),
        steepness: (levin.squares * inverse).mul_add(number(1.5), number(1.0)),
    }
}

/// ∇f_L from its second pass: SPEC § 7, with the part of Jᵀw that is no sum in closed form.
#[inline(always)]
pub(crate) fn levin_gradient<L: Lane, const D: usize>(
    levin: &LevinFit<L, D>,
    weight: L,
    second: Vector<L, D>,
) -> Vector<L, D> {
    let Frame { normal: n, aside: u, turn: q } = levin.frame;
    let sum = scale(second, weight.like(1.0) / weight);
    let closed = add_scaled(scale(n, levin.steepness - dot(q, u)), q, -dot(n, u));
    add(closed, sum)
}
