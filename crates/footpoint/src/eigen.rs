//! Eigenpairs of symmetric 2×2 and 3×3 matrices, for any lane scalar and any magnitude of the entries.

use crate::algebra::{Matrix, Vector};
use crate::lane::Lane;

/// Eigenvalues in ascending order, each with its unit eigenvector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eigen<L, const D: usize> {
    pub(crate) values: Vector<L, D>,
    /// `vectors[j]` belongs to `values[j]`.
    pub(crate) vectors: [Vector<L, D>; D],
}

/// Sweeps after which a 3×3 matrix is diagonal whatever it was; cubic convergence needs four or five.
const SWEEPS: usize = 10;
/// Off-diagonal entries below this share of the largest entry end the sweeps. Far below the rounding error, so
/// that the derivatives that dual numbers carry have converged too: they lag one sweep behind.
const NEGLIGIBLE: f64 = 1e-24;

/// Jacobi's method: rotate each off-diagonal entry away until none is left.
///
/// Slower than a closed form, but exact to the last digits for every matrix, and its rotations are smooth in the
/// entries wherever the eigenvalues are distinct. A zero or non-finite matrix gives zero or NaN eigenvalues.
#[inline]
pub(crate) fn eigen<L: Lane, const D: usize>(matrix: Matrix<L, D>) -> Eigen<L, D> {
    let zero = L::splat(0.0);
    let one = L::splat(1.0);
    let mut largest = zero;
    for i in 0..D {
        for j in i..D {
            largest = matrix[i][j].abs().max(largest);
        }
    }
    // Scaled to entries of size one: squares of tiny entries must not vanish.
    let size = L::select(zero.less(largest), largest, one);
    let mut a: Matrix<L, D> = matrix.map(|row| row.map(|entry| entry / size));
    let mut v: Matrix<L, D> =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { one } else { zero }));

    for _ in 0..SWEEPS {
        let mut off = zero;
        for p in 0..D {
            for q in p + 1..D {
                off = a[p][q].abs().max(off);
            }
        }
        if L::none(L::splat(NEGLIGIBLE).less(off)) {
            break;
        }
        for p in 0..D {
            for q in p + 1..D {
                rotate(&mut a, &mut v, p, q);
            }
        }
    }

    let mut pairs: [(L, Vector<L, D>); D] =
        std::array::from_fn(|j| (a[j][j] * size, std::array::from_fn(|i| v[i][j])));
    for last in (1..D).rev() {
        for j in 0..last {
            let (first, second) = (pairs[j], pairs[j + 1]);
            let swap = second.0.less(first.0);
            let choose = |yes: (L, Vector<L, D>), no: (L, Vector<L, D>)| {
                (L::select(swap, yes.0, no.0), std::array::from_fn(|i| L::select(swap, yes.1[i], no.1[i])))
            };
            pairs[j] = choose(second, first);
            pairs[j + 1] = choose(first, second);
        }
    }
    Eigen { values: pairs.map(|pair| pair.0), vectors: pairs.map(|pair| pair.1) }
}

/// The rotation in the plane (p, q) that makes `a[p][q]` zero; `v` collects the rotations in its columns.
#[inline(always)]
fn rotate<L: Lane, const D: usize>(a: &mut Matrix<L, D>, v: &mut Matrix<L, D>, p: usize, q: usize) {
    let zero = L::splat(0.0);
    let one = L::splat(1.0);
    // tan φ = w sign(δ)/(|δ| + √(δ² + w²)), the smaller root; no division by an entry that may be zero.
    let w = a[p][q] + a[p][q];
    let delta = a[q][q] - a[p][p];
    let denominator = delta.abs() + (delta * delta + w * w).sqrt();
    let signed = L::select(delta.less(zero), -w, w);
    let regular = zero.less(denominator);
    let tangent = L::select(regular, signed / L::select(regular, denominator, one), zero);
    let cosine = one / (one + tangent * tangent).sqrt();
    let sine = tangent * cosine;

    let shift = tangent * a[p][q];
    a[p][p] = a[p][p] - shift;
    a[q][q] = a[q][q] + shift;
    a[p][q] = zero;
    a[q][p] = zero;
    for k in 0..D {
        if k != p && k != q {
            let (kp, kq) = (a[k][p], a[k][q]);
            a[k][p] = cosine * kp - sine * kq;
            a[p][k] = a[k][p];
            a[k][q] = sine * kp + cosine * kq;
            a[q][k] = a[k][q];
        }
        let (kp, kq) = (v[k][p], v[k][q]);
        v[k][p] = cosine * kp - sine * kq;
        v[k][q] = sine * kp + cosine * kq;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::dot;
    use crate::lane::tests::Dual;
    use crate::samples::Random;

    fn check<const D: usize>(m: Matrix<f64, D>) {
        let e = eigen(m);
        let size = m.iter().flatten().fold(0.0_f64, |s, x| s.max(x.abs()));
        for j in 0..D {
            for i in 0..D {
                let product: f64 = (0..D).map(|k| m[i][k] * e.vectors[j][k]).sum();
                assert!((product - e.values[j] * e.vectors[j][i]).abs() <= 2e-15 * size, "{m:?} {e:?}");
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((dot(e.vectors[i], e.vectors[j]) - expected).abs() < 1e-14);
            }
            assert!(j == 0 || e.values[j - 1] <= e.values[j]);
        }
    }

    #[test]
    fn eigenpairs_are_right_at_every_magnitude() {
        let mut random = Random::new(1);
        for magnitude in [1e-150, 1e-8, 1.0, 1e8, 1e150] {
            for _ in 0..2000 {
                let r: [f64; 6] = std::array::from_fn(|_| magnitude * (random.uniform() - 0.5));
                check([[r[0], r[1]], [r[1], r[2]]]);
                check([[r[0], r[1], r[2]], [r[1], r[3], r[4]], [r[2], r[4], r[5]]]);
            }
        }
    }

    #[test]
    fn multiple_and_zero_eigenvalues_are_right() {
        check([[0.0; 3]; 3]);
        check([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]);
        check([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
        check([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1e-300]]);
        check([[1.0, 1e-9, 0.0], [1e-9, 1.0, 1e-9], [0.0, 1e-9, 1.0]]);
        check([[0.0; 2]; 2]);
        check([[1.0, 1.0], [1.0, 1.0]]);
    }

    #[test]
    fn nan_stays_nan() {
        assert!(eigen([[f64::NAN, 0.0], [0.0, 1.0]]).values.iter().any(|v| v.is_nan()));
    }

    #[test]
    fn dual_numbers_give_the_derivative_of_the_eigenvector() {
        let at = |t: f64| [[1.0 + t, 0.3, 0.1 - t], [0.3, 2.0, 0.2], [0.1 - t, 0.2, 3.5 + 2.0 * t]];
        let slope = [[1.0, 0.0, -1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 2.0]];
        let dual = eigen::<Dual, 3>(std::array::from_fn(|i| {
            std::array::from_fn(|j| Dual { value: at(0.0)[i][j], slope: slope[i][j] })
        }));
        let step = 1e-5;
        let (ahead, behind) = (eigen(at(step)), eigen(at(-step)));
        for k in 0..3 {
            let difference = (ahead.vectors[0][k] - behind.vectors[0][k]) / (2.0 * step);
            assert!((dual.vectors[0][k].slope - difference).abs() < 1e-8);
        }
    }
}
