//! Normal fields: the frame normal n and how it turns, from the sums of the first pass (SPEC § 3, § 4).

use crate::algebra::{Matrix, Vector, add_scaled, dot, scale, tangential, zero};
use crate::eigen::{Eigen, eigen};
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
pub(crate) fn fit<L: Lane, const D: usize>(field: NormalField, sums: &FrameSums<L, D>) -> Fit<L, D> {
    let u = scale(sums.first, L::splat(1.0) / sums.weight);
    match field {
        NormalField::Covariance => {
            let pairs = eigen(normalised(sums.second, sums.weight));
            let (normal, g, gap) = smallest(&pairs, u, sums);
            fitted(normal, u, Contraction::AboutX { g }, gap, scale(pairs.values, sums.weight))
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
            let pairs = eigen(matrix);
            let (normal, g, gap) = smallest(&pairs, u, sums);
            // Where the samples nearly coincide the difference above cancels: what is left is rounding, not a frame.
            let known = (trace * L::splat(CANCELLED)).less(pairs.values[1] - pairs.values[0]);
            let gap = L::select(known, gap, L::splat(0.0));
            fitted(normal, u, Contraction::Centred { g }, gap, scale(pairs.values, sums.weight))
        }
        NormalField::AveragedNormals => {
            let length = dot(sums.normals, sums.normals).sqrt();
            let normal = scale(sums.normals, L::splat(1.0) / length);
            let e = scale(tangential(u, normal), sums.weight / length);
            fitted(normal, u, Contraction::Normals { e }, length / sums.weight, zero())
        }
        NormalField::AveragedAxes => {
            let pairs = eigen(normalised(sums.axes, sums.weight));
            let normal = signed(pairs.vectors[D - 1], sums);
            let g = pseudo_inverse(&pairs, D - 1, u);
            let gap = (pairs.values[D - 1] - pairs.values[D - 2]) / pairs.values[D - 1];
            fitted(normal, u, Contraction::Axes { g }, gap, scale(pairs.values, sums.weight))
        }
    }
}

fn fitted<L: Lane, const D: usize>(
    normal: Vector<L, D>,
    aside: Vector<L, D>,
    contraction: Contraction<L, D>,
    gap: L,
    eigenvalues: Vector<L, D>,
) -> Fit<L, D> {
    Fit { frame: Frame { normal, aside, contraction }, gap, eigenvalues }
}

/// v0 with its sign, g = S P u, and the gap.
fn smallest<L: Lane, const D: usize>(
    pairs: &Eigen<L, D>,
    u: Vector<L, D>,
    sums: &FrameSums<L, D>,
) -> (Vector<L, D>, Vector<L, D>, L) {
    let normal = signed(pairs.vectors[0], sums);
    let gap = (pairs.values[1] - pairs.values[0]) / pairs.values[D - 1];
    (normal, pseudo_inverse(pairs, 0, u), gap)
}

fn normalised<L: Lane, const D: usize>(matrix: Matrix<L, D>, weight: L) -> Matrix<L, D> {
    matrix.map(|row| row.map(|entry| entry / weight))
}

/// `Σ_{j≠own} v_j (v_j·u)/(λ_j − λ_own)`: eq. 14 with the pseudo-inverse on the complement of v_own, where the
/// matrix printed there is singular. Eigenvalues of the normalised matrix make it S P u.
fn pseudo_inverse<L: Lane, const D: usize>(pairs: &Eigen<L, D>, own: usize, u: Vector<L, D>) -> Vector<L, D> {
    let mut sum = zero();
    for j in (0..D).filter(|&j| j != own) {
        let v = pairs.vectors[j];
        sum = add_scaled(sum, v, dot(v, u) / (pairs.values[j] - pairs.values[own]));
    }
    sum
}

/// The axis with the sign of SPEC § 3.
fn signed<L: Lane, const D: usize>(axis: Vector<L, D>, sums: &FrameSums<L, D>) -> Vector<L, D> {
    let zero = L::splat(0.0);
    let mut largest = axis[0];
    for k in 1..D {
        largest = L::select(largest.abs().less(axis[k].abs()), axis[k], largest);
    }
    let along = dot(axis, sums.normals);
    // With no normal here, or exactly across, the component decides.
    let decisive = L::select(zero.less(along.abs()), along, largest);
    let sign = L::select(decisive.less(zero), L::splat(-1.0), L::splat(1.0));
    scale(axis, sign)
}

/// ∇f from the second pass (SPEC § 4; § 10 for the closed part).
pub(crate) fn gradient<L: Lane, const D: usize>(
    frame: &Frame<L, D>,
    weight: L,
    second: Vector<L, D>,
) -> Vector<L, D> {
    let n = frame.normal;
    let u = frame.aside;
    let sum = scale(second, L::splat(1.0) / weight);
    match frame.contraction {
        Contraction::AboutX { g } => {
            let f = -dot(n, u);
            let closed = add_scaled(scale(n, L::splat(1.0) - dot(g, u)), g, f);
            add_scaled(closed, sum, L::splat(1.0))
        }
        Contraction::Centred { .. } | Contraction::Normals { .. } | Contraction::Axes { .. } => {
            add_scaled(n, sum, L::splat(1.0))
        }
    }
}
