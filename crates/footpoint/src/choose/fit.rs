//! f, ∇f and what decides about them, from moments: the surface of degree 0 (SPEC § 4) and those of degree 1 to
//! 3 (§ 12).
//!
//! Lengths are in units of the level's radius, vectors along the axes of the moments.

use super::moments::{FrameMoments, Moments};
use crate::algebra::{Vector, dot, length, scale, sub, tangential};
use crate::definition::Definition;
use crate::eigen::{pseudo_inverse, smallest};
use crate::heights::factors;
use crate::polynomial::{MONOMIALS, PRODUCTS, Table, monomials, slope};

/// The surface at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted<const D: usize> {
    /// f.
    pub(super) value: f64,
    pub(super) gradient: [f64; D],
    /// n.
    pub(super) normal: [f64; D],
    pub(super) gap: f64,
    /// |a − x| across n.
    pub(super) across: f64,
    /// Mean curvature of the polynomial; NaN at degree 0 and 1.
    pub(super) bend: f64,
}

impl<const D: usize> Fitted<D> {
    /// The rule of SPEC § 8 with its usual limits.
    pub(super) fn is_accepted(&self, definition: &Definition) -> bool {
        let alignment = dot(self.normal, self.gradient);
        definition.verdict::<D>(self.gap, alignment, (self.across, 1.0)).is_ok() && self.value.is_finite()
    }

    /// How far along ∇f the zero lies, to first order.
    pub(super) fn way(&self) -> f64 {
        -self.value / length(self.gradient)
    }
}

/// The fit of this degree; None where the samples do not determine it.
pub(super) fn fit<const D: usize>(moments: &Moments, degree: u8) -> Option<Fitted<D>> {
    let frame = FrameMoments::<D>::of(moments);
    if frame.weight.is_nan() || frame.weight <= 0.0 {
        return None;
    }
    match degree {
        0 => Some(mean(&frame, moments)),
        1 => polynomial::<D, 1>(&frame, moments),
        2 => polynomial::<D, 2>(&frame, moments),
        _ => polynomial::<D, 3>(&frame, moments),
    }
}

/// Degree 0: the frame is fitted anew, for the moments may be those of a part of the samples.
fn mean<const D: usize>(frame: &FrameMoments<D>, moments: &Moments) -> Fitted<D> {
    let (u, centred) = (frame.aside(), frame.centred());
    let pair = smallest(centred);
    let n = pair.vector;
    let value = -dot(n, u);
    let turn = pseudo_inverse(centred, pair.values[0], n, u);
    // Σψ d (n·d + f)(1 + g·u − g·d), for d along each axis.
    let steady = 1.0 + dot(turn, u);
    let mut sum = [0.0; D];
    for i in 0..D {
        sum[i] += steady * value * slopes::<D>(moments, &[i]);
        for j in 0..D {
            sum[i] += (steady * n[j] - value * turn[j]) * slopes::<D>(moments, &[i, j]);
            for k in 0..D {
                sum[i] -= n[j] * turn[k] * slopes::<D>(moments, &[i, j, k]);
            }
        }
    }
    let gradient = std::array::from_fn(|k| n[k] + sum[k] / frame.weight);
    Fitted {
        value,
        gradient,
        normal: n,
        gap: (pair.values[1] - pair.values[0]) / pair.values[D - 1],
        across: length(tangential(u, n)),
        bend: f64::NAN,
    }
}

/// Σψ times these components of d.
fn slopes<const D: usize>(moments: &Moments, components: &[usize]) -> f64 {
    let count = |axis: usize| components.iter().filter(|&&c| c == axis).count();
    let height = count(D - 1);
    let place = if D == 2 {
        count(0)
    } else {
        let degree = components.len() - height;
        degree * (degree + 1) / 2 + count(1)
    };
    moments.slopes(height)[place]
}

/// Degree M over the plane of the moments, whose normal is the last axis.
fn polynomial<const D: usize, const M: usize>(
    frame: &FrameMoments<D>,
    moments: &Moments,
) -> Option<Fitted<D>> {
    let inverse = 1.0 / frame.weight;
    let plain: [f64; PRODUCTS] = std::array::from_fn(|i| moments.plain()[i] * inverse);
    let heights: [f64; 21] = std::array::from_fn(|i| moments.heights()[i] * inverse);
    let squares: [f64; 6] = std::array::from_fn(|i| moments.squares()[i] * inverse);
    let factors = factors::<f64, D, M>(&plain, M);
    if factors.degree < M as f64 {
        return None;
    }
    let c = factors.solve::<D, M>(&heights);
    let y = factors.first_column::<D, M>();
    let table = const { &Table::new::<D>() };
    let mut both = [0.0; PRODUCTS];
    for i in 0..monomials::<D>(M) {
        for j in 0..monomials::<D>(M) {
            both[table.product[i][j]] += y[i] * c[j];
        }
    }
    // Q of SPEC § 12 along the plane, and how the frame turns with it.
    let mut back = [0.0; D];
    for axis in 0..D - 1 {
        back[axis] =
            slope::<f64, D>(&both, &heights, (axis, 2 * M)) - slope::<f64, D>(&y, &squares, (axis, M));
    }
    let (u, centred) = (frame.aside(), frame.centred());
    let mut n = [0.0; D];
    n[D - 1] = 1.0;
    let turn = pseudo_inverse(centred, centred[D - 1][D - 1], n, back);
    let mut gradient = n;
    for axis in 0..D - 1 {
        gradient[axis] = -c[1 + axis];
    }
    let sum = sub(residual_slopes::<D, M>(moments, &y, &both), turned_slopes(moments, (turn, u)));
    for k in 0..D {
        gradient[k] += sum[k] * inverse;
    }
    let pair = smallest(centred);
    Some(Fitted {
        value: -c[0],
        gradient,
        normal: n,
        gap: (pair.values[1] - pair.values[0]) / pair.values[D - 1],
        across: length(tangential(u, n)),
        bend: if M < 2 { f64::NAN } else { bend::<D>(&c) },
    })
}

/// Σψ l ρ d with l = y·φ and ρ = z − c·φ; `both` is the product of the two polynomials.
fn residual_slopes<const D: usize, const M: usize>(
    moments: &Moments,
    y: &[f64; MONOMIALS],
    both: &[f64; PRODUCTS],
) -> Vector<f64, D> {
    let mut sum = [0.0; D];
    let last = D - 1;
    for i in 0..monomials::<D>(M) {
        for axis in 0..last {
            sum[axis] += y[i] * moments.slopes(1)[beside::<D>(i, axis)];
        }
        sum[last] += y[i] * moments.slopes(2)[i];
    }
    for i in 0..monomials::<D>(2 * M) {
        for axis in 0..last {
            sum[axis] -= both[i] * moments.slopes(0)[beside::<D>(i, axis)];
        }
        sum[last] -= both[i] * moments.slopes(1)[i];
    }
    sum
}

/// Where a monomial times one coordinate stands.
fn beside<const D: usize>(place: usize, axis: usize) -> usize {
    if D == 2 {
        return place + 1;
    }
    let mut degree = 0;
    while monomials::<D>(degree) <= place {
        degree += 1;
    }
    place + degree + 1 + axis
}

/// Σψ (g·e)(n·e) d with e = d − u and n the last axis.
fn turned_slopes<const D: usize>(
    moments: &Moments,
    (turn, u): (Vector<f64, D>, Vector<f64, D>),
) -> Vector<f64, D> {
    let last = D - 1;
    let about = dot(turn, u);
    std::array::from_fn(|i| {
        let mut sum = about * u[last] * slopes::<D>(moments, &[i]) - about * slopes::<D>(moments, &[i, last]);
        for j in 0..D {
            sum += turn[j] * (slopes::<D>(moments, &[i, j, last]) - u[last] * slopes::<D>(moments, &[i, j]));
        }
        sum
    })
}

/// Mean curvature of the graph z = c·φ at its middle, positive where it bends away from the normal (SPEC § 4).
fn bend<const D: usize>(c: &[f64; MONOMIALS]) -> f64 {
    if D == 2 {
        return -2.0 * c[2] / (1.0 + c[1] * c[1]).powf(1.5);
    }
    let (p, q) = (c[1], c[2]);
    let sum = (1.0 + q * q) * 2.0 * c[3] - 2.0 * p * q * c[4] + (1.0 + p * p) * 2.0 * c[5];
    -sum / (2.0 * (1.0 + p * p + q * q).powf(1.5))
}

/// A vector along axes as one of space.
pub(super) fn in_space<const D: usize>(along: [f64; D], axes: &[[f64; D]; D]) -> [f64; D] {
    let mut sum = [0.0; D];
    for (part, axis) in along.iter().zip(axes) {
        let part = scale(*axis, *part);
        (0..D).for_each(|k| sum[k] += part[k]);
    }
    sum
}
