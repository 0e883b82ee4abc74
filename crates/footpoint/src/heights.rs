//! Surfaces of higher degree: the polynomial that fits the samples' heights over the frame's plane (SPEC § 12).

use crate::algebra::{Matrix, Vector, add_scaled, dot, each, scale, tangential};
use crate::eigen::{product as times, pseudo_inverse};
use crate::engine::{Frame, FrameSums, HeightSums, Heights};
use crate::field::NormalField;
use crate::frame::Fit;
use crate::lane::{Lane, Number};
use crate::polynomial::{MONOMIALS, PRODUCTS, Plane, Table, monomials, slope};

/// Which polynomials a fit may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Degrees {
    pub(crate) asked: usize,
    /// A lower degree answers where the one asked for is not determined.
    pub(crate) fallback: bool,
}

/// The condition of A above which it does not determine a polynomial: 1e7 in double precision (SPEC § 12), 2e4 in single, where
/// this leaves three digits of the height.
///
/// It is that of A with its diagonal scaled to ones, which decides about rounding and does not depend on the unit of the
/// coordinates; taken for it is tr A · tr A⁻¹ of that matrix: at least the condition number, and not much more, because one
/// eigenvalue at the lower end outweighs the others.
fn limit<N: Number>() -> f64 {
    if N::EPSILON < 1e-10 { 1e7 } else { 2e4 }
}

/// The inverse of A as Σ r rᵀ/d over rows r of the inverse of its lower triangular factor: A = L D Lᵀ.
pub(crate) struct Factors<L> {
    /// L⁻¹, a row for each unknown.
    rows: [[L; MONOMIALS]; MONOMIALS],
    /// 1/d; zero for unknowns of a degree that is not determined.
    inverse: [L; MONOMIALS],
    /// The highest degree that is determined.
    pub(crate) degree: L,
}

/// Factors A of the moments, degree by degree: that of a lower degree is a part of it.
#[inline(always)]
pub(crate) fn factors<L: Lane, const D: usize, const M: usize>(
    plain: &[L; PRODUCTS],
    asked: usize,
) -> Factors<L> {
    let table = const { &Table::new::<D>() };
    let (zero, one) = (plain[0].like(0.0), plain[0].like(1.0));
    let mut lower = [[zero; MONOMIALS]; MONOMIALS];
    let mut rows = [[zero; MONOMIALS]; MONOMIALS];
    let mut inverse = [zero; MONOMIALS];
    let (mut trace_of_inverse, mut degree) = (zero, zero);
    for level in 0..=M {
        let begin = if level == 0 { 0 } else { monomials::<D>(level - 1) };
        for k in begin..monomials::<D>(level) {
            let mut pivot = plain[table.product[k][k]];
            for i in 0..k {
                let mut entry = plain[table.product[k][i]];
                for j in 0..i {
                    // Row k holds D times the factor until its own place is reached.
                    entry = (-lower[i][j]).mul_add(rows[k][j], entry);
                }
                rows[k][i] = entry;
                lower[k][i] = entry * inverse[i];
                pivot = (-entry).mul_add(lower[k][i], pivot);
            }
            inverse[k] = one / pivot;
            for j in 0..k {
                let mut entry = zero;
                for i in j..k {
                    let own = if i == j { one } else { rows[i][j] };
                    entry = (-lower[k][i]).mul_add(own, entry);
                }
                rows[k][j] = entry;
            }
            rows[k][k] = one;
            let mut squares = zero;
            for j in 0..=k {
                squares = (rows[k][j] * rows[k][j]).mul_add(plain[table.product[j][j]], squares);
            }
            trace_of_inverse = squares.mul_add(inverse[k].abs(), trace_of_inverse);
        }
        let bound = if level <= asked { limit::<L::Number>() / monomials::<D>(level) as f64 } else { 0.0 };
        let known = trace_of_inverse.less(zero.like(bound));
        for k in begin..monomials::<D>(level) {
            inverse[k] = L::select(known, inverse[k], zero);
            rows[k] = each(|j| L::select(known, rows[k][j], zero));
        }
        if level > 0 {
            degree = L::select(known, zero.like(level as f64), degree);
        }
    }
    Factors { rows, inverse, degree }
}

impl<L: Lane> Factors<L> {
    /// A⁻¹ b.
    #[inline(always)]
    pub(crate) fn solve<const D: usize, const M: usize>(&self, b: &[L]) -> [L; MONOMIALS] {
        let mut solution = [self.degree.like(0.0); MONOMIALS];
        for k in 0..monomials::<D>(M) {
            let mut part = b[0] * self.rows[k][0];
            for i in 1..=k {
                part = b[i].mul_add(self.rows[k][i], part);
            }
            let part = part * self.inverse[k];
            for i in 0..=k {
                solution[i] = self.rows[k][i].mul_add(part, solution[i]);
            }
        }
        solution
    }

    /// A⁻¹ e₀.
    #[inline(always)]
    pub(crate) fn first_column<const D: usize, const M: usize>(&self) -> [L; MONOMIALS] {
        let mut column = [self.degree.like(0.0); MONOMIALS];
        for k in 0..monomials::<D>(M) {
            let part = self.rows[k][0] * self.inverse[k];
            for i in 0..=k {
                column[i] = self.rows[k][i].mul_add(part, column[i]);
            }
        }
        column
    }
}

/// Moments over the sum of weights: those that follow from the frame's sums, and the others.
#[inline(always)]
fn whole<L: Lane, const D: usize, const M: usize>(
    (u, second): (Vector<L, D>, Matrix<L, D>),
    plane: &Plane<L, D>,
    inverse: L,
    sums: &HeightSums<L>,
) -> HeightSums<L> {
    let mut whole = HeightSums {
        plain: each(|i| sums.plain[i] * inverse),
        heights: each(|i| sums.heights[i] * inverse),
        squares: each(|i| sums.squares[i] * inverse),
    };
    let table = const { &Table::new::<D>() };
    let risen = times(second, plane.normal);
    whole.plain[0] = inverse.like(1.0);
    whole.heights[0] = dot(plane.normal, u);
    whole.squares[0] = dot(plane.normal, risen);
    for a in 0..D - 1 {
        whole.plain[1 + a] = dot(plane.along[a], u);
        whole.heights[1 + a] = dot(plane.along[a], risen);
        let turned = times(second, plane.along[a]);
        for b in a..D - 1 {
            whole.plain[table.product[1 + a][1 + b]] = dot(plane.along[b], turned);
        }
    }
    whole
}

/// Fits the polynomial of degree M or less, from the frame and the sums that follow it.
#[inline(always)]
pub(crate) fn fit_heights<L: Lane, const D: usize, const M: usize>(
    (field, degrees): (NormalField, Degrees),
    sums: &FrameSums<L, D>,
    fit: &Fit<L, D>,
    more: &HeightSums<L>,
) -> Heights<L, D> {
    let inverse = sums.weight.like(1.0) / sums.weight;
    let zero = inverse.like(0.0);
    let Frame { normal, aside: u, .. } = fit.frame;
    let plane = Plane::new(normal, sums.scales * inverse);
    let second: Matrix<L, D> = each(|i| scale(sums.second[i], inverse));
    let moments = whole::<L, D, M>((u, second), &plane, inverse, more);
    let factors = factors::<L, D, M>(&moments.plain, degrees.asked);
    let mut coefficients = factors.solve::<D, M>(&moments.heights);
    let influence = factors.first_column::<D, M>();
    if !degrees.fallback {
        let lower = factors.degree.less(zero.like(degrees.asked as f64));
        coefficients[0] = L::select(lower, zero.like(f64::NAN), coefficients[0]);
    }
    let mut closed = normal;
    for a in 0..D - 1 {
        closed = add_scaled(closed, plane.along[a], -coefficients[1 + a]);
    }
    // V Σ k z = V (Σ θ z² ∂l − Σ θ z ∂(l φᵀc))/h; the rest of Q is along n, and u at degree 0.
    let table = const { &Table::new::<D>() };
    let mut both = [zero; PRODUCTS];
    for i in 0..monomials::<D>(M) {
        for j in 0..monomials::<D>(M) {
            let at = table.product[i][j];
            both[at] = influence[i].mul_add(coefficients[j], both[at]);
        }
    }
    let flat = factors.degree.less(zero.like(0.5));
    let mut back = each(|k| L::select(flat, u[k], zero));
    for a in 0..D - 1 {
        let bent = slope::<L, D>(&influence, &moments.squares, (a, M));
        let risen = slope::<L, D>(&both, &moments.heights, (a, 2 * M));
        back = add_scaled(back, plane.along[a], risen - bent);
    }
    let turn = if field == NormalField::AveragedNormals {
        scale(tangential(back, normal), zero.like(1.0) / fit.gap)
    } else {
        let centred: Matrix<L, D> = each(|i| each(|j| (-u[i]).mul_add(u[j], second[i][j])));
        pseudo_inverse(centred, fit.eigenvalues[0] * inverse, normal, back)
    };
    let frame = Frame { normal, aside: u, turn };
    Heights { plane, coefficients, influence, frame, closed, degree: factors.degree }
}

/// ∇f from its closed part and the second pass.
#[inline(always)]
pub(crate) fn heights_gradient<L: Lane, const D: usize>(
    closed: Vector<L, D>,
    weight: L,
    second: Vector<L, D>,
) -> Vector<L, D> {
    add_scaled(closed, second, weight.like(1.0) / weight)
}
