//! One thread's evaluator: its scratch, and all quantities at the positions of a block.

use crate::algebra::{add, dot, length, scale};
use crate::definition::Definition;
pub(crate) use crate::engine::{BLOCK, Position};
use crate::engine::{Candidates, Needs, first_pass, second_pass};
use crate::field::{NormalField, fit, gradient};
use crate::grid::Grid;
use crate::status::Status;
use crate::weight::{Kernel, with_kernel};

/// Gaps below this do not determine a frame in double precision (SPEC § 3).
const DEGENERATE_GAP: f64 = 1e-12;

/// Gradients shorter than this have no direction.
const SMALLEST_GRADIENT: f64 = 1e-12;

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
        if length < SMALLEST_GRADIENT || !length.is_finite() {
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
}

impl<'s, const D: usize> Evaluator<'s, D> {
    pub(crate) fn new(grid: &'s Grid<D>, definition: &'s Definition) -> Self {
        Self { grid, definition, list: Candidates::new(), margin: 0.0 }
    }

    /// The support of every position, in units of the grid, if all samples have the same.
    pub(crate) fn uniform_support(&self) -> Option<f64> {
        self.grid.scales.is_empty().then_some(self.grid.uniform_scale)
    }

    /// Makes later lists wide enough for positions to move this far, in units of the grid.
    pub(crate) fn set_margin(&mut self, margin: f64) {
        self.margin = margin;
    }

    /// Evaluates at most [`BLOCK`] positions; finite ones, in the range of the grid.
    pub(crate) fn evaluate(
        &mut self,
        positions: &[Position<f64, D>],
        depth: Depth,
        out: &mut [Local<D>; BLOCK],
    ) {
        if !positions.iter().all(|position| self.list.covers(position)) {
            let reach = self.definition.weight().reach();
            self.list.gather(self.grid, positions, self.margin, reach);
        }
        let field = self.definition.field();
        let needs = Needs {
            second: matches!(field, NormalField::Covariance | NormalField::CentredCovariance),
            axes: field == NormalField::AveragedAxes,
            sensitivity: depth == Depth::Sensitivity,
            domain: self.definition.domain_ratio().powi(2),
        };
        with_kernel!(self.definition.weight(), kernel => {
            for (position, out) in positions.iter().zip(out) {
                *out = local(kernel, &self.list, *position, field, needs, depth);
            }
        });
    }
}

#[inline]
fn local<K: Kernel, const D: usize>(
    kernel: K,
    list: &Candidates<D>,
    position: Position<f64, D>,
    field: NormalField,
    needs: Needs,
    depth: Depth,
) -> Local<D> {
    let sums = first_pass(kernel, list, position, needs);
    if sums.inside == 0.0 {
        return Local { neighbours: sums.neighbours as u32, ..Local::NOWHERE };
    }
    let fit = fit(field, &sums);
    let mut local = Local {
        status: Status::Degenerate,
        neighbours: sums.neighbours as u32,
        weight_sum: sums.weight,
        effective_neighbours: sums.weight * sums.weight / sums.squares,
        support: sums.scales / sums.weight,
        aside: fit.frame.aside,
        gap: if fit.gap.is_nan() { 0.0 } else { fit.gap },
        eigenvalues: if field == NormalField::AveragedNormals { [f64::NAN; D] } else { fit.eigenvalues },
        ..Local::NOWHERE
    };
    if local.gap < DEGENERATE_GAP {
        return local;
    }
    local.status = Status::Ok;
    local.normal = fit.frame.normal;
    local.value = -dot(local.normal, local.aside);
    local.signed = dot(local.normal, sums.normals) > 0.0;
    if depth != Depth::Frame {
        let second = second_pass(kernel, list, position, &fit.frame, needs);
        local.gradient = gradient(&fit.frame, sums.weight, second.gradient);
        if needs.sensitivity {
            local.sensitivity = second.sensitivity / (sums.weight * sums.weight);
        }
    }
    local
}
