//! Normal fields: the frame normal n and how it turns, from the sums of the first pass (SPEC § 3, § 4).

use crate::algebra::{Matrix, Vector, add, add_scaled, dot, scale, tangential, zero};
use crate::eigen::{largest, pseudo_inverse, smallest};
use crate::engine::{Contraction, Frame, FrameSums};
use crate::lane::Lane;

/// The normal field n(x) (SPEC § 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum NormalField {
    /// Direction of smallest weighted covariance about x (eqs. 5 and 6). Unsigned. Beyond a third of the support
    /// from the surface it turns sideways and is no normal field any more.
    Covariance,
    /// The same about the weighted average a(x). Unsigned; stays right farther out.
    #[default]
    CentredCovariance,
    /// Weighted average of the samples' normals (eq. 7). Signed; needs normals of consistent sign.
    AveragedNormals,
    /// Main axis of the samples' normals, for normals of unknown sign. Unsigned.
    AveragedAxes,
}

impl NormalField {
    /// Whether the samples must carry normals.
    pub fn needs_normals(self) -> bool {
        matches!(self, Self::AveragedNormals | Self::AveragedAxes)
    }
}

impl std::fmt::Display for NormalField {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Covariance => "covariance",
            Self::CentredCovariance => "centred covariance",
            Self::AveragedNormals => "averaged normals",
            Self::AveragedAxes => "averaged axes",
        })
    }
}

/// A frame and its quality.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit<L, const D: usize> {
    pub(crate) frame: Frame<L, D>,
    /// (λ1 − λ0)/λ_max; |Nv|/S for averaged normals.
    pub(crate) gap: L,
    /// Eigenvalues in ascending order, of the matrix that is not normalised; zero for averaged normals.
    pub(crate) eigenvalues: Vector<L, D>,
}

/// Eigenvalues of the centred matrix that differ by less than this share of the trace about x are equal: rounding
/// leaves a few units in the last place of that trace.
const CANCELLED: f64 = 1e-14;

/// Fits the frame. The sign of n is that of the samples' normals where they have one here, else the component of
/// largest magnitude is positive (SPEC § 3).
#[inline(always)]
pub(crate) fn fit<L: Lane, const D: usize>(field: NormalField, sums: &FrameSums<L, D>) -> Fit<L, D> {
    let u = scale(sums.first, sums.weight.like(1.0) / sums.weight);
    match field {
        NormalField::Covariance => {
            let matrix = normalised(sums.second, sums.weight);
            let pair = smallest(matrix);
            let normal = signed(pair.vector, sums);
            let g = pseudo_inverse(matrix, pair.values[0], normal, u);
            let gap = (pair.values[1] - pair.values[0]) / pair.values[D - 1];
            fitted(normal, u, Contraction::AboutX { g }, gap, scale(pair.values, sums.weight))
        }
        NormalField::CentredCovariance => {
            let mut matrix = normalised(sums.second, sums.weight);
            let mut trace = matrix[0][0];
            for k in 1..D {
                trace = trace + matrix[k][k];
            }
            for i in 0..D {
                for j in 0..D {
                    matrix[i][j] = matrix[i][j] - u[i] * u[j];
                }
            }
            let pair = smallest(matrix);
            let normal = signed(pair.vector, sums);
            let g = pseudo_inverse(matrix, pair.values[0], normal, u);
            // Where the samples nearly coincide the difference above cancels: what is left is rounding, not a frame.
            let difference = pair.values[1] - pair.values[0];
            let known = (trace * trace.like(CANCELLED)).less(difference);
            let gap = L::select(known, difference / pair.values[D - 1], trace.like(0.0));
            fitted(normal, u, Contraction::Centred { g }, gap, scale(pair.values, sums.weight))
        }
        NormalField::AveragedNormals => {
            let length = dot(sums.normals, sums.normals).sqrt();
            let normal = scale(sums.normals, length.like(1.0) / length);
            let e = scale(tangential(u, normal), sums.weight / length);
            fitted(normal, u, Contraction::Normals { e }, length / sums.weight, zero(length.token()))
        }
        NormalField::AveragedAxes => {
            let matrix = normalised(sums.axes, sums.weight);
            let pair = largest(matrix);
            let normal = signed(pair.vector, sums);
            let g = pseudo_inverse(matrix, pair.values[D - 1], normal, u);
            let gap = (pair.values[D - 1] - pair.values[D - 2]) / pair.values[D - 1];
            fitted(normal, u, Contraction::Axes { g }, gap, scale(pair.values, sums.weight))
        }
    }
}

#[inline(always)]
fn fitted<L: Lane, const D: usize>(
    normal: Vector<L, D>,
    aside: Vector<L, D>,
    contraction: Contraction<L, D>,
    gap: L,
    eigenvalues: Vector<L, D>,
) -> Fit<L, D> {
    Fit { frame: Frame { normal, aside, contraction }, gap, eigenvalues }
}

#[inline(always)]
fn normalised<L: Lane, const D: usize>(matrix: Matrix<L, D>, weight: L) -> Matrix<L, D> {
    let inverse = weight.like(1.0) / weight;
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] * inverse))
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
    frame: &Frame<L, D>,
    weight: L,
    second: Vector<L, D>,
) -> Vector<L, D> {
    let n = frame.normal;
    let u = frame.aside;
    let sum = scale(second, weight.like(1.0) / weight);
    match frame.contraction {
        Contraction::AboutX { g } => {
            let f = -dot(n, u);
            let closed = add_scaled(scale(n, weight.like(1.0) - dot(g, u)), g, f);
            add(closed, sum)
        }
        Contraction::Centred { .. } | Contraction::Normals { .. } | Contraction::Axes { .. } => add(n, sum),
    }
}
