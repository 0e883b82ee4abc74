//! The sums of surfaces of higher degree (SPEC § 12), in general mode: moments over the tangent plane, then those of the gradient.

use super::candidates::Columns;
use super::sums::{Frame, General, List, Place, cut, norm_by, to_sample};
use crate::algebra::{Vector, add_scaled, dot, each, scale, zero};
use crate::field::NormalField;
use crate::lane::Lane;
use crate::polynomial::{MONOMIALS, PRODUCTS, Plane, monomials, powers, slope, value};
use crate::weight::Kernel;

/// Sums over the samples of monomials in the plane's coordinates s times powers of the height z. Those that follow from the
/// frame's sums are not there: degrees below 3, 2 and 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeightSums<L> {
    /// Σ θ φ(s), up to twice the degree of the fit.
    pub(crate) plain: [L; PRODUCTS],
    /// Σ θ z φ(s), one degree less.
    pub(crate) heights: [L; PRODUCTS],
    /// Σ θ z² φ(s), below the degree of the fit.
    pub(crate) squares: [L; MONOMIALS],
}

impl<L: Copy> HeightSums<L> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> HeightSums<M> {
        HeightSums {
            plain: each(|i| f(self.plain[i])),
            heights: each(|i| f(self.heights[i])),
            squares: each(|i| f(self.squares[i])),
        }
    }
}

/// A fit of heights over the plane (SPEC § 12), and what its gradient needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heights<L, const D: usize> {
    pub(crate) plane: Plane<L, D>,
    /// c: the polynomial; NaN where there is none. f = −c₀.
    pub(crate) coefficients: [L; MONOMIALS],
    /// S y: the polynomial l whose value at a sample is S times the influence of its height on c₀, over its θ.
    pub(crate) influence: [L; MONOMIALS],
    /// u, and how the frame turns: A⁺v or S v⊥/|Nv| with v = −Q.
    pub(crate) frame: Frame<L, D>,
    /// The part of ∇f that is no sum: n Σθl + V Σk.
    pub(crate) closed: Vector<L, D>,
    /// The degree of the polynomial.
    pub(crate) degree: L,
}

impl<L: Copy, const D: usize> Heights<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> Heights<M, D> {
        Heights {
            plane: self.plane.map(f),
            coefficients: each(|i| f(self.coefficients[i])),
            influence: each(|i| f(self.influence[i])),
            frame: self.frame.map(f),
            closed: each(|k| f(self.closed[k])),
            degree: f(self.degree),
        }
    }

    /// Number by number with those of another fit.
    #[inline(always)]
    pub(crate) fn joined<M: Copy>(&self, other: &Heights<M, D>, f: impl Fn(L, M) -> L + Copy) -> Self {
        let vector = |a: &Vector<L, D>, b: &Vector<M, D>| each(|k| f(a[k], b[k]));
        Heights {
            plane: Plane {
                normal: vector(&self.plane.normal, &other.plane.normal),
                along: each(|axis| vector(&self.plane.along[axis], &other.plane.along[axis])),
            },
            coefficients: each(|i| f(self.coefficients[i], other.coefficients[i])),
            influence: each(|i| f(self.influence[i], other.influence[i])),
            frame: Frame {
                normal: vector(&self.frame.normal, &other.frame.normal),
                aside: vector(&self.frame.aside, &other.frame.aside),
                turn: vector(&self.frame.turn, &other.frame.turn),
            },
            closed: vector(&self.closed, &other.closed),
            degree: f(self.degree, other.degree),
        }
    }
}

/// θ and ψ of every sample from the closeness that the first pass kept: the only step that knows the weight.
#[inline(always)]
pub(crate) fn height_weights<L: Lane, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    list: List<'_, L::Number, D>,
    (kept, weights): (&[L::Slot], &mut [[L::Slot; 2]]),
) {
    let columns = list.columns;
    for ((&place, kept), [theta, psi]) in list.places.iter().zip(kept).zip(weights) {
        let j = place as usize;
        let closeness = L::load(token, kept);
        (kernel.theta(closeness) * L::broadcast(token, columns.factors[j])).store(theta);
        (kernel.psi(closeness) * L::broadcast(token, columns.slopes[j])).store(psi);
    }
}

/// The pass between the first and the second, for fits of degree M.
#[inline(always)]
pub(crate) fn height_sums<L: Lane, const D: usize, const M: usize>(
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    plane: &Plane<L, D>,
    weights: &[[L::Slot; 2]],
) -> HeightSums<L> {
    let token = x.anchor[0].token();
    let nought = L::splat(token, 0.0);
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let mut sums =
        HeightSums { plain: [nought; PRODUCTS], heights: [nought; PRODUCTS], squares: [nought; MONOMIALS] };
    for (&place, [theta, _]) in list.places.iter().zip(weights) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let theta = L::load(token, theta);
        let (along, height) = plane.coordinates(d);
        let powers = powers::<L, D, PRODUCTS>(theta, along, 2 * M);
        for i in monomials::<D>(2)..monomials::<D>(2 * M) {
            sums.plain[i] = sums.plain[i] + powers[i];
        }
        for i in monomials::<D>(1)..monomials::<D>(2 * M - 1) {
            sums.heights[i] = powers[i].mul_add(height, sums.heights[i]);
        }
        let square = height * height;
        for i in monomials::<D>(0)..monomials::<D>(M - 1) {
            sums.squares[i] = powers[i].mul_add(square, sums.squares[i]);
        }
    }
    sums
}

/// What a sample is to the fit.
#[derive(Clone, Copy)]
struct Influence<L> {
    /// Monomials at the sample.
    powers: [L; MONOMIALS],
    /// S times its influence l on c₀.
    influence: L,
    /// ρ: its height over the polynomial.
    residual: L,
    /// What stands before ψ d in −S G.
    along: L,
}

#[inline(always)]
fn influence<L: Lane, const D: usize, const M: usize, const AVERAGED: bool>(
    fit: &Heights<L, D>,
    (d, normal): (Vector<L, D>, Vector<L, D>),
) -> Influence<L> {
    let (along, height) = fit.plane.coordinates(d);
    let powers = powers::<L, D, MONOMIALS>(height.like(1.0), along, M);
    let influence = value::<L, D>(&fit.influence, &powers, M);
    let residual = height - value::<L, D>(&fit.coefficients, &powers, M);
    let part = influence * residual;
    let along = if AVERAGED {
        part + dot(fit.frame.turn, normal)
    } else {
        let [turned, risen] = about_average(&fit.frame, (d, height));
        (-turned).mul_add(risen, part)
    };
    Influence { powers, influence, residual, along }
}

/// g·e and n·e, e = d − u.
#[inline(always)]
fn about_average<L: Lane, const D: usize>(frame: &Frame<L, D>, (d, height): (Vector<L, D>, L)) -> [L; 2] {
    [dot(frame.turn, d) - dot(frame.turn, frame.aside), height - dot(frame.normal, frame.aside)]
}

/// Pass two: Σ ψ c d, with `c = S l ρ − (g·e)(n·e)` about a(x), and `S l ρ + e·n_i` for averaged normals (g, e: the frame's turn).
#[inline(always)]
pub(crate) fn heights_second_pass<L: Lane, const D: usize, const M: usize>(
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    (field, fit): (NormalField, &Heights<L, D>),
    weights: &[[L::Slot; 2]],
) -> Vector<L, D> {
    if field == NormalField::AveragedNormals {
        contract::<L, D, M, true>(list, x, fit, weights)
    } else {
        contract::<L, D, M, false>(list, x, fit, weights)
    }
}

#[inline(always)]
fn contract<L: Lane, const D: usize, const M: usize, const AVERAGED: bool>(
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    fit: &Heights<L, D>,
    weights: &[[L::Slot; 2]],
) -> Vector<L, D> {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let mut sum = zero(token);
    for (&place, [_, psi]) in list.places.iter().zip(weights) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let psi = L::load(token, psi);
        let found = influence::<L, D, M, AVERAGED>(fit, (d, normal_at::<L, D, AVERAGED>(token, columns, j)));
        sum = add_scaled(sum, d, psi * found.along);
    }
    sum
}

#[inline(always)]
fn normal_at<L: Lane, const D: usize, const AVERAGED: bool>(
    token: L::Token,
    columns: &Columns<L::Number, D>,
    j: usize,
) -> Vector<L, D> {
    if AVERAGED { each(|k| L::broadcast(token, columns.normals[k][j])) } else { zero(token) }
}

/// −S G of a sample (SPEC § 12): `ψ c d + θ (S l n − g (n·e) − n (g·e)) + V k`, k = θ (ρ ∂l − l ∂φᵀc) S/h; without g for
/// averaged normals.
#[inline(always)]
fn share<L: Lane, const D: usize, const M: usize, const AVERAGED: bool>(
    fit: &Heights<L, D>,
    sample: (Vector<L, D>, Vector<L, D>),
    [theta, psi]: [L; 2],
) -> Vector<L, D> {
    let found = influence::<L, D, M, AVERAGED>(fit, sample);
    let Frame { normal, turn, .. } = fit.frame;
    let mut shift = scale(normal, found.influence);
    for axis in 0..D - 1 {
        let bend = slope::<L, D>(&fit.coefficients, &found.powers, (axis, M));
        let change = slope::<L, D>(&fit.influence, &found.powers, (axis, M));
        let along = (-found.influence).mul_add(bend, found.residual * change);
        shift = add_scaled(shift, fit.plane.along[axis], along);
    }
    if !AVERAGED {
        let [turned, risen] = about_average(&fit.frame, (sample.0, dot(normal, sample.0)));
        shift = add_scaled(add_scaled(shift, turn, -risen), normal, -turned);
    }
    add_scaled(scale(sample.0, psi * found.along), shift, theta)
}

/// S² Σ |G_i|² and the same in the norm of the samples' own noise (SPEC § 10).
#[inline(always)]
pub(crate) fn heights_sensitivity<L: Lane, const D: usize, const M: usize>(
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    (field, fit): (NormalField, &Heights<L, D>),
    weights: &[[L::Slot; 2]],
) -> [L; 2] {
    if field == NormalField::AveragedNormals {
        squares::<L, D, M, true>(list, x, fit, weights)
    } else {
        squares::<L, D, M, false>(list, x, fit, weights)
    }
}

#[inline(always)]
fn squares<L: Lane, const D: usize, const M: usize, const AVERAGED: bool>(
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    fit: &Heights<L, D>,
    weights: &[[L::Slot; 2]],
) -> [L; 2] {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let (mut sum, mut noisy) = (L::splat(token, 0.0), L::splat(token, 0.0));
    for (&place, weights) in list.places.iter().zip(weights) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, General, D>(&points, j, x);
        let weights = [L::load(token, &weights[0]), L::load(token, &weights[1])];
        let sample = (d, normal_at::<L, D, AVERAGED>(token, columns, j));
        let whole = share::<L, D, M, AVERAGED>(fit, sample, weights);
        sum = sum + dot(whole, whole);
        noisy = noisy + norm_by(&columns.noise, j, whole);
    }
    [sum, noisy]
}

/// −S G of one sample at one position.
pub(crate) fn heights_share<const D: usize>(
    (field, fit): (NormalField, &Heights<f64, D>),
    sample: (Vector<f64, D>, Vector<f64, D>),
    weights: [f64; 2],
) -> Vector<f64, D> {
    if field == NormalField::AveragedNormals {
        share::<f64, D, 3, true>(fit, sample, weights)
    } else {
        share::<f64, D, 3, false>(fit, sample, weights)
    }
}
