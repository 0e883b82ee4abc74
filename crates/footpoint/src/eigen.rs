//! Eigenpairs of symmetric 2×2 and 3×3 matrices, for any lane scalar and any magnitude of the entries.

use crate::algebra::{Matrix, Vector, dot, each, tangential};
use crate::lane::Lane;

/// One eigenpair of a positive semidefinite matrix, and all eigenvalues.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eigenpair<L, const D: usize> {
    /// Ascending.
    pub(crate) values: Vector<L, D>,
    /// Unit vector of the smallest eigenvalue.
    pub(crate) vector: Vector<L, D>,
}

/// Eigenvalues in ascending order, each with its unit eigenvector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eigen<L, const D: usize> {
    pub(crate) values: Vector<L, D>,
    /// `vectors[j]` belongs to `values[j]`.
    pub(crate) vectors: [Vector<L, D>; D],
}

/// The smallest eigenvalue's pair of a positive semidefinite matrix, for entries of any magnitude.
///
/// In 3-D three steps of Laguerre's iteration from below give the eigenvalue nearly; the largest column
/// of the adjugate the vector; its Rayleigh quotient a better value and the column again, three times. Lanes whose
/// gap is small go to Jacobi's method instead, lane by lane, so that a neighbour lane changes nothing.
#[inline(always)]
pub(crate) fn smallest<L: Lane, const D: usize>(matrix: Matrix<L, D>) -> Eigenpair<L, D> {
    let trace = trace(matrix);
    // A matrix of zeros stays one, with eigenvalues of zero.
    let inverse = L::select(trace.like(0.0).less(trace), trace.like(1.0) / trace, trace.like(0.0));
    let a = each(|i| each(|j| matrix[i][j] * inverse));
    let pair = if D == 2 { smallest_of_two(a) } else { smallest_of_three(a) };
    Eigenpair { values: each(|k| pair.values[k] * trace), ..pair }
}

/// tr(A) I − A: its smallest pair is the largest of A.
#[inline(always)]
pub(crate) fn mirrored<L: Lane, const D: usize>(matrix: Matrix<L, D>) -> Matrix<L, D> {
    let trace = trace(matrix);
    each(|i| each(|j| if i == j { trace - matrix[i][i] } else { -matrix[i][j] }))
}

#[inline(always)]
pub(crate) fn trace<L: Lane, const D: usize>(matrix: Matrix<L, D>) -> L {
    let mut sum = matrix[0][0];
    for k in 1..D {
        sum = sum + matrix[k][k];
    }
    sum
}

/// Closed form for unit trace; exact for every gap.
#[inline(always)]
fn smallest_of_two<L: Lane, const D: usize>(a: Matrix<L, D>) -> Eigenpair<L, D> {
    let zero = a[0][0].like(0.0);
    let mean = (a[0][0] + a[1][1]) * zero.like(0.5);
    let half = (a[0][0] - a[1][1]) * zero.like(0.5);
    let b = a[0][1];
    let radius = (half * half + b * b).sqrt();
    let negative = half.less(zero);
    let first = L::select(negative, half - radius, b);
    let second = L::select(negative, b, -(half + radius));
    let length = (first * first + second * second).sqrt();
    let values = [mean - radius, mean + radius];
    let vector = [first / length, second / length];
    Eigenpair { values: each(|k| values[k.min(1)]), vector: each(|k| vector[k.min(1)]) }
}

/// Gaps below this share of the trace go to Jacobi's method: near a double root Laguerre's iteration is slow, and the
/// steps below do not suffice. With a quarter of it the worst of 30,000 random matrices is off by 1e-12, not 1e-14.
const SMALL_GAP: f64 = 2e-2;

#[inline(always)]
fn smallest_of_three<L: Lane, const D: usize>(a: Matrix<L, D>) -> Eigenpair<L, D> {
    let zero = a[0][0].like(0.0);
    let number = |value: f64| zero.like(value);
    let minor = |i: usize, j: usize| a[i][i] * a[j][j] - a[i][j] * a[i][j];
    let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
    let determinant = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[1][2])
        - a[0][1] * (a[0][1] * a[2][2] - a[1][2] * a[0][2])
        + a[0][2] * (a[0][1] * a[1][2] - a[1][1] * a[0][2]);
    let value_and_slope = |x: L| {
        let value = ((x - number(1.0)).mul_add(x, minors)).mul_add(x, -determinant);
        let slope = (x * number(3.0) - number(2.0)).mul_add(x, minors);
        (value, slope)
    };
    let mut x = zero;
    for _ in 0..3 {
        let (p, slope) = value_and_slope(x);
        let bend = x * number(6.0) - number(2.0);
        let inside = (slope * slope * number(4.0) - p * bend * number(6.0)).max(zero);
        let denominator = slope + inside.sqrt();
        let step = p * number(3.0) / denominator;
        x = L::select(zero.less(denominator), x - step, x);
    }
    // Rayleigh's quotient of a column of the adjugate: cubic convergence, and no digit lost.
    let mut column = column_of_adjugate(a, x);
    for _ in 0..3 {
        let refined = dot(column, product(a, column)) / dot(column, column);
        // Where every column vanishes there is no vector; the gap is small there.
        x = L::select(refined.abs().less(number(2.0)), refined, x);
        column = column_of_adjugate(a, x);
    }
    let inverse = number(1.0) / dot(column, column).sqrt();
    let vector = each(|k| column[k] * inverse);
    let [middle, largest] = values_across(a, vector);
    // NaN, where there is no vector, is no good gap either.
    let good = number(SMALL_GAP).less(middle - x);
    let values = [x, middle, largest];
    let pair = Eigenpair { values: each(|k| values[k]), vector };
    if L::none(zero.less(L::select(good, zero, number(1.0)))) {
        return pair;
    }
    let exact = eigen(a);
    Eigenpair {
        values: each(|k| L::select(good, pair.values[k], exact.values[k])),
        vector: each(|k| L::select(good, pair.vector[k], exact.vectors[0][k])),
    }
}

#[inline(always)]
pub(crate) fn product<L: Lane, const D: usize>(a: Matrix<L, D>, v: Vector<L, D>) -> Vector<L, D> {
    each(|i| dot(a[i], v))
}

/// The two eigenvalues on the plane across the unit vector n, ascending: those of the 2×2 matrix there. Differences of
/// the characteristic polynomial's coefficients would lose half the digits where the two are near each other.
#[inline(always)]
fn values_across<L: Lane, const D: usize>(a: Matrix<L, D>, n: Vector<L, D>) -> [L; 2] {
    let zero = a[0][0].like(0.0);
    let number = |value: f64| zero.like(value);
    // A basis without a division by zero (Duff et al. 2017), for n with either sign of its last component.
    let sign = L::select(n[2 % D].less(zero), number(-1.0), number(1.0));
    let p = number(-1.0) / (sign + n[2 % D]);
    let q = n[0] * n[1] * p;
    let first = [number(1.0) + sign * n[0] * n[0] * p, sign * q, -(sign * n[0])];
    let second = [q, sign + n[1] * n[1] * p, -n[1]];
    let along = |v: [L; 3]| -> Vector<L, D> { each(|k| v[k]) };
    let (first, second) = (along(first), along(second));
    let (turned, other) = (product(a, first), product(a, second));
    let (aa, ab, bb) = (dot(first, turned), dot(second, turned), dot(second, other));
    let mean = (aa + bb) * number(0.5);
    let half = (aa - bb) * number(0.5);
    let radius = (half * half + ab * ab).sqrt();
    [mean - radius, mean + radius]
}

/// The longest cross product of two rows of A − x I.
#[inline(always)]
fn column_of_adjugate<L: Lane, const D: usize>(a: Matrix<L, D>, x: L) -> Vector<L, D> {
    let row = |i: usize| -> [L; 3] { each(|j| if i == j { a[i][i] - x } else { a[i][j] }) };
    let cross = |a: [L; 3], b: [L; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let mut best = cross(row(0), row(1));
    let mut size = dot(best, best);
    for other in [cross(row(0), row(2)), cross(row(1), row(2))] {
        let other_size = dot(other, other);
        let longer = size.less(other_size);
        best = each(|k| L::select(longer, other[k], best[k]));
        size = L::select(longer, other_size, size);
    }
    each(|k| best[k])
}

/// `Σ_{j≠own} v_j (v_j·u)/(λ_j − λ_own)` without the other pairs (SPEC § 10): with B = A − λ_own I on the complement of
/// its eigenvector n, the inverse is (tr B − B)/m in 3-D, m the sum of the principal minors, and 1/tr B in 2-D.
#[inline(always)]
pub(crate) fn pseudo_inverse<L: Lane, const D: usize>(
    a: Matrix<L, D>,
    value: L,
    n: Vector<L, D>,
    u: Vector<L, D>,
) -> Vector<L, D> {
    let mut b = a;
    for k in 0..D {
        b[k][k] = b[k][k] - value;
    }
    let across = tangential(u, n);
    let trace = trace(b);
    if D == 2 {
        return each(|k| across[k] / trace);
    }
    let minor = |i: usize, j: usize| b[i][i] * b[j][j] - b[i][j] * b[i][j];
    let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
    let turned = product(b, across);
    let inverse = trace.like(1.0) / minors;
    // Once more across n: the product leaves a rounding along it.
    tangential(each(|k| (trace * across[k] - turned[k]) * inverse), n)
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
#[inline(never)]
pub(crate) fn eigen<L: Lane, const D: usize>(matrix: Matrix<L, D>) -> Eigen<L, D> {
    let zero = matrix[0][0].like(0.0);
    let one = zero.like(1.0);
    let mut largest = zero;
    for i in 0..D {
        for j in i..D {
            largest = matrix[i][j].abs().max(largest);
        }
    }
    // Scaled to entries of size one: squares of tiny entries must not vanish.
    let size = L::select(zero.less(largest), largest, one);
    let mut a: Matrix<L, D> = each(|i| each(|j| matrix[i][j] / size));
    let mut v: Matrix<L, D> = each(|i| each(|j| if i == j { one } else { zero }));

    for _ in 0..SWEEPS {
        let mut off = zero;
        for p in 0..D {
            for q in p + 1..D {
                off = a[p][q].abs().max(off);
            }
        }
        // A lane that has converged stands still, whatever its neighbours need.
        let moving = zero.like(NEGLIGIBLE).less(off);
        if L::none(moving) {
            break;
        }
        let (mut next, mut turned) = (a, v);
        for p in 0..D {
            for q in p + 1..D {
                rotate(&mut next, &mut turned, p, q);
            }
        }
        for i in 0..D {
            for j in 0..D {
                a[i][j] = L::select(moving, next[i][j], a[i][j]);
                v[i][j] = L::select(moving, turned[i][j], v[i][j]);
            }
        }
    }

    let mut pairs: [(L, Vector<L, D>); D] = each(|j| (a[j][j] * size, each(|i| v[i][j])));
    for last in (1..D).rev() {
        for j in 0..last {
            let (first, second) = (pairs[j], pairs[j + 1]);
            let swap = second.0.less(first.0);
            let choose = |yes: (L, Vector<L, D>), no: (L, Vector<L, D>)| {
                (L::select(swap, yes.0, no.0), each(|i| L::select(swap, yes.1[i], no.1[i])))
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
    let zero = a[p][q].like(0.0);
    let one = zero.like(1.0);
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
    use crate::dual::Dual;
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

    /// The closed forms against Jacobi's method, for A = Σ r rᵀ with the last axis shrunk: gaps of every size.
    fn closed_forms_agree<const D: usize>() {
        let mut random = Random::new(2);
        for magnitude in [1e-100, 1e-8, 1.0, 1e8, 1e100] {
            for flat in [0.0, 1e-12, 1e-6, 1e-3, 0.3, 1.0] {
                for _ in 0..500 {
                    let mut a = [[0.0; D]; D];
                    for _ in 0..4 {
                        let mut r: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
                        r[D - 1] = flat * r[D - 1] + 0.1 * r[0];
                        crate::algebra::add_outer_upper(&mut a, r, magnitude);
                    }
                    let a = crate::algebra::mirror(a);
                    let exact = eigen(a);
                    let size = exact.values[D - 1];
                    let mut across = smallest(mirrored(a));
                    across.values = std::array::from_fn(|k| trace(a) - across.values[D - 1 - k]);
                    for (pair, own) in [(smallest(a), 0), (across, D - 1)] {
                        for k in 0..D {
                            let error = (pair.values[k] - exact.values[k]).abs() / size;
                            assert!(error <= 1e-14, "value {k} of {own}: {error:e} in {a:?}");
                        }
                        let beside = if own == 0 { exact.values[1] } else { exact.values[D - 2] };
                        let gap = (exact.values[own] - beside).abs() / size;
                        let along = dot(pair.vector, exact.vectors[own]).abs();
                        let aside = (1.0 - along * along).abs().sqrt();
                        assert!(gap < 1e-6 || aside < 1e-7, "{aside:e} at gap {gap:e}: {a:?}");
                        if gap > 1e-3 {
                            let u: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
                            let found = pseudo_inverse(a, exact.values[own], exact.vectors[own], u);
                            for (k, found) in found.into_iter().enumerate() {
                                let expected: f64 = (0..D)
                                    .filter(|&j| j != own)
                                    .map(|j| {
                                        let v = exact.vectors[j];
                                        v[k] * dot(v, u) / (exact.values[j] - exact.values[own])
                                    })
                                    .sum();
                                let bound = 1e-13 / (gap * gap * size);
                                assert!((found - expected).abs() <= bound, "{found} {expected} {gap}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn closed_forms_agree_with_jacobi_at_every_magnitude_and_gap() {
        closed_forms_agree::<2>();
        closed_forms_agree::<3>();
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
        let dual = eigen::<Dual<f64>, 3>(std::array::from_fn(|i| {
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
