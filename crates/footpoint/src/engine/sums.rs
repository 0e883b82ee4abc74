//! The hot loops: two passes over a block's candidates, the frame sums first, then the gradient's.

use super::candidates::Columns;
use crate::algebra::{Matrix, Vector, add, add_outer_upper, add_scaled, dot, each, mirror, scale, sub, zero};
use crate::field::NormalField;
use crate::lane::Lane;
use crate::weight::Kernel;

/// A location, in units of the grid: a fixed anchor and the way from it.
///
/// Two numbers per axis, because an iterate near a sample at survey coordinates must move in steps far below the
/// spacing of doubles there. A difference to a sample is `(p − anchor) − offset`: two roundings that depend on
/// nothing but the sample and the position, so results have the same bits wherever and however they are computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<L, const D: usize> {
    pub(crate) anchor: Vector<L, D>,
    pub(crate) offset: Vector<L, D>,
}

/// One location.
pub(crate) type Position<const D: usize> = Place<f64, D>;

impl<const D: usize> Position<D> {
    pub(crate) fn at(anchor: [f64; D]) -> Self {
        Self { anchor, offset: [0.0; D] }
    }

    /// The location as one vector, rounded.
    pub(crate) fn rounded(&self) -> [f64; D] {
        add(self.anchor, self.offset)
    }
}

/// The candidates of a block: places in columns that blocks near each other share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct List<'a, N, const D: usize> {
    pub(crate) columns: &'a Columns<N, D>,
    pub(crate) places: &'a [u32],
}

/// How the hot loops take samples and positions: what is known to be equal or at rest saves a part of them.
pub(crate) trait Mode {
    /// Supports or factors differ.
    const VARIED: bool;
    /// Positions have an offset.
    const MOVED: bool;
}
/// One support, no factors, positions at their anchors.
pub(crate) struct Plain;
/// One support, no factors.
pub(crate) struct Moved;
/// Positions at their anchors.
pub(crate) struct Resting;
/// Whatever there is.
pub(crate) struct General;
impl Mode for Plain {
    const VARIED: bool = false;
    const MOVED: bool = false;
}
impl Mode for Moved {
    const VARIED: bool = false;
    const MOVED: bool = true;
}
impl Mode for Resting {
    const VARIED: bool = true;
    const MOVED: bool = false;
}
impl Mode for General {
    const VARIED: bool = true;
    const MOVED: bool = true;
}

/// Sums of the first pass (SPEC § 1), lengths in units of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameSums<L, const D: usize> {
    /// S = Σθ.
    pub(crate) weight: L,
    /// m = Σ θ d.
    pub(crate) first: Vector<L, D>,
    /// W = Σ θ d dᵀ; zero for the averaged fields, unless asked for.
    pub(crate) second: Matrix<L, D>,
    /// Nv = Σ θ n_i; zero without normals.
    pub(crate) normals: Vector<L, D>,
    /// Σ θ n_i n_iᵀ; zero but for averaged axes.
    pub(crate) axes: Matrix<L, D>,
    /// Σ θ h_i.
    pub(crate) scales: L,
}

impl<L: Copy, const D: usize> FrameSums<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> FrameSums<M, D> {
        FrameSums {
            weight: f(self.weight),
            first: each(|k| f(self.first[k])),
            second: each(|i| each(|k| f(self.second[i][k]))),
            normals: each(|k| f(self.normals[k])),
            axes: each(|i| each(|k| f(self.axes[i][k]))),
            scales: f(self.scales),
        }
    }
}

/// Sums that are rarely asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Statistics<L> {
    /// Σθ².
    pub(crate) squares: L,
    /// Samples with θ > 0.
    pub(crate) neighbours: L,
    /// Samples whose domain ball contains the position.
    pub(crate) inside: L,
}

impl<L> Statistics<L> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> Statistics<M> {
        Statistics { squares: f(self.squares), neighbours: f(self.neighbours), inside: f(self.inside) }
    }
}

/// The frame and what the second pass needs of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<L, const D: usize> {
    pub(crate) normal: Vector<L, D>,
    /// u = a(x) − x.
    pub(crate) aside: Vector<L, D>,
    /// g = A⁺u, or e = S u⊥/|Nv| for averaged normals.
    pub(crate) turn: Vector<L, D>,
}

impl<L: Copy, const D: usize> Frame<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> Frame<M, D> {
        Frame {
            normal: each(|k| f(self.normal[k])),
            aside: each(|k| f(self.aside[k])),
            turn: each(|k| f(self.turn[k])),
        }
    }
}

/// `p − x` for the sample at place j.
#[inline(always)]
pub(super) fn to_sample<L: Lane, M: Mode, const D: usize>(
    points: &[&[L::Number]; D],
    j: usize,
    x: &Place<L, D>,
) -> Vector<L, D> {
    each(|k| {
        let p = L::broadcast(x.anchor[k].token(), points[k][j]);
        let d = p - x.anchor[k];
        if M::MOVED { d - x.offset[k] } else { d }
    })
}

/// The closeness of a sample, times a constant in plain mode.
#[inline(always)]
fn closeness<L: Lane, K: Kernel, M: Mode, const D: usize>(
    kernel: K,
    columns: &Columns<L::Number, D>,
    j: usize,
    d: Vector<L, D>,
    [square, inverse]: [L; 2],
) -> L {
    if M::VARIED {
        kernel.closeness(dot(d, d) * L::broadcast(square.token(), columns.inverse[j]))
    } else {
        kernel.uniform_closeness(d, square, inverse)
    }
}

/// Columns cut to one length, so that one comparison proves that a place is in all of them.
#[inline(always)]
pub(super) fn cut<T, const D: usize>(columns: &[Vec<T>; D], length: usize) -> [&[T]; D] {
    each(|k| &columns[k][..length])
}

/// Whose second moments the first pass takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moments {
    /// Those that the field needs.
    OfTheField,
    /// Those of the positions whatever the field.
    OfPositions,
}

/// Pass one over all candidates; their closeness is kept for the second.
#[inline(always)]
pub(crate) fn first_pass<L: Lane, K: Kernel, M: Mode, const D: usize>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    (field, moments): (NormalField, Moments),
    kept: &mut [L::Slot],
) -> FrameSums<L, D> {
    let axes = field == NormalField::AveragedAxes;
    if field.needs_normals() && moments == Moments::OfTheField {
        sum::<L, K, M, D, false>(kernel, list, x, axes, kept)
    } else {
        sum::<L, K, M, D, true>(kernel, list, x, axes, kept)
    }
}

/// With second moments of positions and, if asked for, of normals.
#[inline(always)]
fn sum<L: Lane, K: Kernel, M: Mode, const D: usize, const MOMENTS: bool>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    axes: bool,
    kept: &mut [L::Slot],
) -> FrameSums<L, D> {
    let token = x.anchor[0].token();
    let nought = L::splat(token, 0.0);
    let columns = list.columns;
    let h = columns.uniform_scale;
    let constants = [L::splat(token, h * h), L::splat(token, 1.0 / (h * h))];
    let points = cut(&columns.points, columns.len);
    let has_normals = columns.has_normals();
    let mut sums = FrameSums {
        weight: nought,
        first: zero(token),
        second: [zero(token); D],
        normals: zero(token),
        axes: [zero(token); D],
        scales: nought,
    };
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, M, D>(&points, j, x);
        let closeness = closeness::<L, K, M, D>(kernel, columns, j, d, constants);
        closeness.store(kept);
        let mut theta = kernel.theta(closeness);
        if M::VARIED {
            theta = theta * L::broadcast(token, columns.factors[j]);
            sums.scales = theta.mul_add(L::broadcast(token, columns.scales[j]), sums.scales);
        }
        sums.weight = sums.weight + theta;
        for i in 0..D {
            let part = d[i] * theta;
            sums.first[i] = sums.first[i] + part;
            if MOMENTS {
                for k in i..D {
                    sums.second[i][k] = part.mul_add(d[k], sums.second[i][k]);
                }
            }
        }
        if has_normals {
            let normal = each(|k| L::broadcast(token, columns.normals[k][j]));
            sums.normals = add_scaled(sums.normals, normal, theta);
            if axes {
                add_outer_upper(&mut sums.axes, normal, theta);
            }
        }
    }
    if !M::VARIED {
        let factor = L::splat(token, kernel.uniform_constants(h)[1]);
        sums.weight = sums.weight * factor;
        sums.first = scale(sums.first, factor);
        sums.second = each(|i| scale(sums.second[i], factor));
        sums.normals = scale(sums.normals, factor);
        sums.axes = each(|i| scale(sums.axes[i], factor));
        sums.scales = sums.weight * L::splat(token, h);
    }
    sums.second = mirror(sums.second);
    sums.axes = mirror(sums.axes);
    sums
}

/// The sums that only some columns of the answer need, from what the first pass kept.
#[inline(always)]
pub(crate) fn statistics<L: Lane, K: Kernel, const D: usize>(
    (token, varied): (L::Token, bool),
    kernel: K,
    list: List<'_, L::Number, D>,
    kept: &[L::Slot],
    domain_ratio: f64,
) -> Statistics<L> {
    let nought = L::splat(token, 0.0);
    let one = L::splat(token, 1.0);
    let [_, theta_factor, _] = kernel.uniform_constants(list.columns.uniform_scale);
    let theta_factor = L::splat(token, if varied { 1.0 } else { theta_factor });
    let limit = domain_limit::<L, K, D>((token, varied), kernel, list.columns, domain_ratio);
    let mut sums = Statistics { squares: nought, neighbours: nought, inside: nought };
    for (&place, kept) in list.places.iter().zip(kept) {
        let closeness = L::load(token, kept);
        let mut theta = kernel.theta(closeness) * theta_factor;
        if varied {
            theta = theta * L::broadcast(token, list.columns.factors[place as usize]);
        }
        sums.squares = theta.mul_add(theta, sums.squares);
        sums.neighbours = sums.neighbours + L::select(nought.less(closeness), one, nought);
        sums.inside = sums.inside + L::select(limit.less(closeness), one, nought);
    }
    sums
}

/// Closeness on the rim of the domain's balls (eq. 1).
#[inline(always)]
fn domain_limit<L: Lane, K: Kernel, const D: usize>(
    (token, varied): (L::Token, bool),
    kernel: K,
    columns: &Columns<L::Number, D>,
    domain_ratio: f64,
) -> L {
    let limit = kernel.closeness(kernel.end() * domain_ratio * domain_ratio);
    let [factor, ..] = kernel.uniform_constants(columns.uniform_scale);
    L::splat(token, if varied { limit } else { limit / factor })
}

/// Pass two: Σ ψ c d, from which ∇f comes. Sample i enters ∇f with −G_i, `G_i = −(1/S) [ψ_i c_i d_i + θ_i t_i]` (SPEC § 10);
/// the scalar c is the definition's, g and e as in [`Frame`]:
///
/// - frames about a(x): `c = (n·d + f)(1 + g·u − g·d)`
/// - frames about x: `c = (n·d)(1 − g·d) + f`
/// - averaged normals: `c = n·d + f + e·n_i`
/// - averaged axes: `c = n·d + f − (g·n_i)(n·n_i)`
#[inline(always)]
pub(crate) fn second_pass<L: Lane, K: Kernel, M: Mode, const D: usize>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    (field, frame): (NormalField, &Frame<L, D>),
    kept: &[L::Slot],
) -> Vector<L, D> {
    match field {
        NormalField::Covariance => contract::<L, K, M, D, 0>(kernel, list, x, frame, kept),
        NormalField::CentredCovariance => contract::<L, K, M, D, 1>(kernel, list, x, frame, kept),
        NormalField::AveragedNormals => contract::<L, K, M, D, 2>(kernel, list, x, frame, kept),
        NormalField::AveragedAxes => contract::<L, K, M, D, 3>(kernel, list, x, frame, kept),
    }
}

/// Row of the table above, by field.
#[inline(always)]
fn sensitivity_scalar<L: Lane, const D: usize, const FIELD: u8>(
    frame: &Frame<L, D>,
    [f, gu]: [L; 2],
    d: Vector<L, D>,
    normal: Vector<L, D>,
) -> L {
    let n = frame.normal;
    let along =
        |start: L, a: Vector<L, D>, b: Vector<L, D>| (0..D).fold(start, |sum, k| a[k].mul_add(b[k], sum));
    let back = |start: L, a: Vector<L, D>| (0..D).fold(start, |sum, k| (-a[k]).mul_add(d[k], sum));
    match FIELD {
        0 => dot(n, d).mul_add(back(f.like(1.0), frame.turn), f),
        1 => along(f, n, d) * back(gu, frame.turn),
        2 => along(along(f, n, d), frame.turn, normal),
        _ => (-dot(frame.turn, normal)).mul_add(dot(n, normal), along(f, n, d)),
    }
}

/// f and 1 + g·u.
#[inline(always)]
fn frame_constants<L: Lane, const D: usize>(frame: &Frame<L, D>) -> [L; 2] {
    let f = -dot(frame.normal, frame.aside);
    [f, f.like(1.0) + dot(frame.turn, frame.aside)]
}

#[inline(always)]
fn contract<L: Lane, K: Kernel, M: Mode, const D: usize, const FIELD: u8>(
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    frame: &Frame<L, D>,
    kept: &[L::Slot],
) -> Vector<L, D> {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let constants = frame_constants(frame);
    let mut gradient = zero(token);
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        if j >= columns.len {
            continue;
        }
        let d = to_sample::<L, M, D>(&points, j, x);
        let mut psi = kernel.psi(L::load(token, kept));
        if M::VARIED {
            psi = psi * L::broadcast(token, columns.slopes[j]);
        }
        let normal =
            if FIELD > 1 { each(|k| L::broadcast(token, columns.normals[k][j])) } else { zero(token) };
        let c = sensitivity_scalar::<L, D, FIELD>(frame, constants, d, normal);
        gradient = add_scaled(gradient, d, psi * c);
    }
    if M::VARIED { gradient } else { scale(gradient, psi_factor(token, kernel, columns)) }
}

/// What plain mode leaves out of ψ.
#[inline(always)]
fn psi_factor<L: Lane, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    columns: &Columns<L::Number, D>,
) -> L {
    let h = columns.uniform_scale;
    L::splat(token, kernel.uniform_constants(h)[2] / (h * h))
}

/// Σ |ψ c d + θ t|² and, where samples have variances or covariances C of their own, the same in the norm of C (SPEC § 10), with t = n − g (n·e) − n (g·e), e = d − u for frames about a(x) and e = d about x, and t = n for
/// the averaged fields.
#[inline(always)]
pub(crate) fn sensitivity<L: Lane, K: Kernel, const D: usize>(
    varied: bool,
    kernel: K,
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    (field, frame): (NormalField, &Frame<L, D>),
    kept: &[L::Slot],
) -> [L; 2] {
    match field {
        NormalField::Covariance => squares::<L, K, D, 0>((varied, kernel), list, x, frame, kept),
        NormalField::CentredCovariance => squares::<L, K, D, 1>((varied, kernel), list, x, frame, kept),
        NormalField::AveragedNormals => squares::<L, K, D, 2>((varied, kernel), list, x, frame, kept),
        NormalField::AveragedAxes => squares::<L, K, D, 3>((varied, kernel), list, x, frame, kept),
    }
}

#[inline(always)]
fn squares<L: Lane, K: Kernel, const D: usize, const FIELD: u8>(
    (varied, kernel): (bool, K),
    list: List<'_, L::Number, D>,
    x: &Place<L, D>,
    frame: &Frame<L, D>,
    kept: &[L::Slot],
) -> [L; 2] {
    let token = x.anchor[0].token();
    let columns = list.columns;
    let points = cut(&columns.points, columns.len);
    let constants = frame_constants(frame);
    let uniform_theta = L::splat(token, kernel.uniform_constants(columns.uniform_scale)[1]);
    let uniform_psi = psi_factor::<L, K, D>(token, kernel, columns);
    let (mut sum, mut noisy) = (L::splat(token, 0.0), L::splat(token, 0.0));
    for (&place, kept) in list.places.iter().zip(kept) {
        let j = place as usize;
        let d = to_sample::<L, General, D>(&points, j, x);
        let closeness = L::load(token, kept);
        let number = |column: &[L::Number]| L::broadcast(token, column[j]);
        let (theta, psi) = if varied {
            (number(&columns.factors), number(&columns.slopes))
        } else {
            (uniform_theta, uniform_psi)
        };
        let (theta, psi) = (theta * kernel.theta(closeness), psi * kernel.psi(closeness));
        let normal = if FIELD > 1 { each(|k| number(&columns.normals[k])) } else { zero(token) };
        let c = sensitivity_scalar::<L, D, FIELD>(frame, constants, d, normal);
        let whole = add_scaled(scale(d, psi * c), shift::<L, D, FIELD>(frame, d), theta);
        sum = sum + dot(whole, whole);
        noisy = noisy + norm_by(&columns.noise, j, whole);
    }
    [sum, noisy]
}

/// vᵀ C v for the sample at place j: nothing, a variance or the upper triangle of a covariance.
#[inline(always)]
pub(super) fn norm_by<L: Lane, const D: usize>(noise: &[Vec<L::Number>], j: usize, v: Vector<L, D>) -> L {
    let token = v[0].token();
    let entry = |column: usize| L::broadcast(token, noise[column][j]);
    match noise.len() {
        0 => L::splat(token, 0.0),
        1 => entry(0) * dot(v, v),
        _ => {
            let mut sum = L::splat(token, 0.0);
            let mut column = 0;
            for i in 0..D {
                sum = (v[i] * v[i]).mul_add(entry(column), sum);
                for k in i + 1..D {
                    sum = (v[i] * v[k]).mul_add(entry(column + k - i) * L::splat(token, 2.0), sum);
                }
                column += D - i;
            }
            sum
        }
    }
}

/// t: what θ multiplies.
#[inline(always)]
fn shift<L: Lane, const D: usize, const FIELD: u8>(frame: &Frame<L, D>, d: Vector<L, D>) -> Vector<L, D> {
    match FIELD {
        0 => turned(frame, d),
        1 => turned(frame, sub(d, frame.aside)),
        _ => frame.normal,
    }
}

/// What a sample and its weight are at one position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weighted<const D: usize> {
    pub(crate) d: Vector<f64, D>,
    pub(crate) theta: f64,
    pub(crate) psi: f64,
    pub(crate) normal: Vector<f64, D>,
}

/// G of one sample, −(ψ c d + θ t)/S, at one position.
pub(crate) fn sensitivity_to<const D: usize>(
    field: NormalField,
    frame: &Frame<f64, D>,
    weight: f64,
    sample: &Weighted<D>,
) -> Vector<f64, D> {
    fn whole<const D: usize, const FIELD: u8>(frame: &Frame<f64, D>, sample: &Weighted<D>) -> Vector<f64, D> {
        let Weighted { d, theta, psi, normal } = *sample;
        let c = sensitivity_scalar::<f64, D, FIELD>(frame, frame_constants(frame), d, normal);
        add_scaled(scale(d, psi * c), shift::<f64, D, FIELD>(frame, d), theta)
    }
    let whole = match field {
        NormalField::Covariance => whole::<D, 0>(frame, sample),
        NormalField::CentredCovariance => whole::<D, 1>(frame, sample),
        NormalField::AveragedNormals => whole::<D, 2>(frame, sample),
        NormalField::AveragedAxes => whole::<D, 3>(frame, sample),
    };
    scale(whole, -1.0 / weight)
}

/// n − g (n·e) − n (g·e).
#[inline(always)]
pub(super) fn turned<L: Lane, const D: usize>(frame: &Frame<L, D>, e: Vector<L, D>) -> Vector<L, D> {
    let (n, g) = (frame.normal, frame.turn);
    add_scaled(sub(n, scale(g, dot(n, e))), n, -dot(g, e))
}
