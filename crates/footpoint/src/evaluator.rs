//! One thread's evaluator: its scratch, and all quantities at the positions of a block.

use crate::algebra::{add, dot, length, scale};
use crate::definition::Definition;
pub(crate) use crate::engine::{BLOCK, Position};
use crate::engine::{Candidates, Needs, first_pass, second_pass};
use crate::field::{NormalField, fit, gradient};
use crate::grid::Grid;
use crate::lane::{Lane, Lanes};
use crate::status::Status;
use crate::weight::{Kernel, Weight, with_kernel};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use std::any::Any;

/// Gaps below this do not determine a frame in double precision (SPEC § 3).
const DEGENERATE_GAP: f64 = 1e-12;

/// Gradients shorter than this over the gap have no direction: the rounding error of ∇f grows as one over the gap.
const SMALLEST_GRADIENT: f64 = 1e-13;

/// How far to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Frame and value.
    Frame,
    /// The gradient too.
    Gradient,
    /// The gradient and Σ|G_i|².
    Sensitivity,
}

/// Everything at one position, lengths in units of the grid. Quantities that do not exist are NaN.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local<const D: usize> {
    /// *ok*, *outside* or *degenerate*.
    pub(crate) status: Status,
    pub(crate) neighbours: u32,
    /// S.
    pub(crate) weight_sum: f64,
    pub(crate) effective_neighbours: f64,
    /// h(x).
    pub(crate) support: f64,
    /// u = a(x) − x.
    pub(crate) aside: [f64; D],
    pub(crate) gap: f64,
    pub(crate) eigenvalues: [f64; D],
    pub(crate) normal: [f64; D],
    pub(crate) value: f64,
    pub(crate) gradient: [f64; D],
    pub(crate) sensitivity: f64,
    /// Whether normals of the samples decided the sign.
    pub(crate) signed: bool,
}

impl<const D: usize> Local<D> {
    /// Nothing exists here.
    pub(crate) const NOWHERE: Self = Self {
        status: Status::Outside,
        neighbours: 0,
        weight_sum: f64::NAN,
        effective_neighbours: f64::NAN,
        support: f64::NAN,
        aside: [f64::NAN; D],
        gap: f64::NAN,
        eigenvalues: [f64::NAN; D],
        normal: [f64::NAN; D],
        value: f64::NAN,
        gradient: [f64::NAN; D],
        sensitivity: f64::NAN,
        signed: false,
    };

    /// n·∇f.
    pub(crate) fn alignment(&self) -> f64 {
        dot(self.normal, self.gradient)
    }

    /// ∇f/|∇f|, where ∇f has a direction.
    pub(crate) fn surface_normal(&self) -> Option<[f64; D]> {
        let length = length(self.gradient);
        if length * self.gap < SMALLEST_GRADIENT || !length.is_finite() {
            return None;
        }
        let unit = scale(self.gradient, 1.0 / length);
        // Once more: the first division leaves the length a few roundings from one.
        Some(scale(unit, 1.0 / dot(unit, unit).sqrt()))
    }

    /// The rule of SPEC § 8, for a position where f vanishes.
    pub(crate) fn acceptance(&self, definition: &Definition) -> Status {
        let rule = definition.acceptance();
        // The part of a − x along n is f; only the part across it tells of a rim.
        let across = add(self.aside, scale(self.normal, self.value));
        let across = dot(across, across).sqrt();
        if !self.status.is_ok() {
            self.status
        } else if self.gap < rule.gap {
            Status::Degenerate
        } else if self.alignment() < rule.alignment || self.alignment().is_nan() {
            Status::Singular
        } else if across > definition.boundary_limit::<D>() * self.support {
            Status::Boundary
        } else {
            Status::Ok
        }
    }
}

/// Evaluates blocks of positions; keeps the list of candidates as long as it covers them.
pub(crate) struct Evaluator<'s, const D: usize> {
    grid: &'s Grid<D>,
    definition: &'s Definition,
    list: Candidates<D>,
    margin: f64,
    level: Level,
    locals: [Local<D>; BLOCK],
}

impl<'s, const D: usize> Evaluator<'s, D> {
    pub(crate) fn new(grid: &'s Grid<D>, definition: &'s Definition, level: Level) -> Self {
        let (list, locals) = (Candidates::new(), [Local::NOWHERE; BLOCK]);
        Self { grid, definition, list, margin: 0.0, level, locals }
    }

    /// The support of every position, in units of the grid, if all samples have the same.
    pub(crate) fn uniform_support(&self) -> Option<f64> {
        self.grid.scales.is_empty().then_some(self.grid.uniform_scale)
    }

    /// Makes later lists wide enough for positions to move this far, in units of the grid.
    pub(crate) fn set_margin(&mut self, margin: f64) {
        self.margin = margin;
    }

    /// Prepares for the blocks of a group: what they share is gathered once.
    pub(crate) fn enter(&mut self, positions: impl Iterator<Item = Position<f64, D>>) {
        self.list.enter(self.grid, positions, self.margin, self.definition.weight().reach());
    }

    /// Evaluates at most [`BLOCK`] positions; finite ones, in the range of the grid.
    pub(crate) fn evaluate(&mut self, positions: &[Position<f64, D>], depth: Depth) -> &[Local<D>] {
        let reach = self.definition.weight().reach();
        self.list.cover(self.grid, positions, self.margin, reach, self.level);
        let field = self.definition.field();
        let needs = Needs {
            second: matches!(field, NormalField::Covariance | NormalField::CentredCovariance),
            axes: field == NormalField::AveragedAxes,
            sensitivity: depth == Depth::Sensitivity,
            domain: self.definition.domain_ratio().powi(2),
        };
        let what = What { level: self.level, weight: self.definition.weight(), field, needs, depth };
        // Lanes without a position of their own repeat the last.
        let last = positions.len().saturating_sub(1);
        if let Some(&padding) = positions.last() {
            let padded: [Position<f64, D>; BLOCK] =
                std::array::from_fn(|i| positions.get(i.min(last)).copied().unwrap_or(padding));
            evaluate_block(what, &self.list, &padded, &mut self.locals);
        }
        &self.locals[..positions.len()]
    }
}

/// What to compute, apart from where.
#[derive(Clone, Copy)]
struct What {
    level: Level,
    weight: Weight,
    field: NormalField,
    needs: Needs,
    depth: Depth,
}

/// Leads to the block evaluation of two or of three dimensions.
///
/// The dimension is found again at run time, so that the kernels are compiled once, with the library, and not
/// again in every crate that uses it.
fn evaluate_block(what: What, list: &dyn Any, positions: &dyn Any, out: &mut dyn Any) {
    fn sized<const D: usize>(what: What, list: &dyn Any, positions: &dyn Any, out: &mut dyn Any) {
        let list = list.downcast_ref::<Candidates<D>>();
        let positions = positions.downcast_ref::<[Position<f64, D>; BLOCK]>();
        let out = out.downcast_mut::<[Local<D>; BLOCK]>();
        if let (Some(list), Some(positions), Some(out)) = (list, positions, out) {
            with_kernel!(what.weight, kernel => {
                dispatch!(what.level, simd => block(simd, kernel, list, positions, what, out));
            });
        }
    }
    sized::<2>(what, list, positions, out);
    sized::<3>(what, list, positions, out);
}

/// A block, as many positions at a time as the processor has lanes.
#[inline(always)]
fn block<S: Simd, K: Kernel, const D: usize>(
    simd: S,
    kernel: K,
    list: &Candidates<D>,
    positions: &[Position<f64, D>; BLOCK],
    what: What,
    out: &mut [Local<D>; BLOCK],
) {
    let width = Lanes::<S>::WIDTH;
    for (positions, out) in positions.chunks(width).zip(out.chunks_mut(width)) {
        let position = Position {
            anchor: std::array::from_fn(|k| Lanes::from_fn(simd, |i| positions[i].anchor[k])),
            offset: std::array::from_fn(|k| Lanes::from_fn(simd, |i| positions[i].offset[k])),
        };
        local::<Lanes<S>, K, D>(kernel, list, position, what, out);
    }
}

#[inline(always)]
fn local<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: &Candidates<D>,
    position: Position<L, D>,
    what: What,
    out: &mut [Local<D>],
) {
    let What { field, needs, depth, .. } = what;
    let sums = first_pass(kernel, list, position, needs);
    let fit = fit(field, &sums);
    let normal = fit.frame.normal;
    let value = -dot(normal, fit.frame.aside);
    let along = dot(normal, sums.normals);
    let effective = sums.weight * sums.weight / sums.squares;
    let support = sums.scales / sums.weight;
    let (gradient, sensitivity) = if depth == Depth::Frame {
        (normal, value)
    } else {
        let second = second_pass(kernel, list, position, &fit.frame, needs);
        let gradient = gradient(&fit.frame, sums.weight, second.gradient);
        (gradient, second.sensitivity / (sums.weight * sums.weight))
    };
    for (i, out) in out.iter_mut().enumerate() {
        let vector = |v: [L; D]| -> [f64; D] { std::array::from_fn(|k| v[k].get(i)) };
        *out = Local { neighbours: sums.neighbours.get(i) as u32, ..Local::NOWHERE };
        if sums.inside.get(i) == 0.0 {
            continue;
        }
        let gap = fit.gap.get(i);
        out.status = Status::Degenerate;
        out.weight_sum = sums.weight.get(i);
        out.effective_neighbours = effective.get(i);
        out.support = support.get(i);
        out.aside = vector(fit.frame.aside);
        out.gap = if gap.is_nan() { 0.0 } else { gap };
        if field != NormalField::AveragedNormals {
            out.eigenvalues = vector(fit.eigenvalues);
        }
        if out.gap < DEGENERATE_GAP {
            continue;
        }
        out.status = Status::Ok;
        out.normal = vector(normal);
        out.value = value.get(i);
        out.signed = along.get(i) > 0.0;
        if depth != Depth::Frame {
            out.gradient = vector(gradient);
        }
        if needs.sensitivity {
            out.sensitivity = sensitivity.get(i);
        }
    }
}
