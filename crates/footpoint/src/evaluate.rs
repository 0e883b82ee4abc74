//! Evaluation: f, its gradient and what belongs to them, in columns.

use crate::algebra::scale;
use crate::columns::{Counts, Numbers, Statuses};
use crate::evaluator::{Depth, Local, Position};
use crate::field::NormalField;
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use std::ops::BitOr;

/// A set of columns of [`Evaluations`]: only these are computed and stored. Join them with `|`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Want(u32);

impl Want {
    /// f.
    pub const VALUE: Self = Self(1);
    /// a.
    pub const AVERAGE: Self = Self(1 << 1);
    /// n.
    pub const FRAME_NORMAL: Self = Self(1 << 2);
    /// ∇f.
    pub const GRADIENT: Self = Self(1 << 3);
    /// ∇f/|∇f|.
    pub const SURFACE_NORMAL: Self = Self(1 << 4);
    /// The gap of the frame.
    pub const GAP: Self = Self(1 << 5);
    /// Samples with positive weight.
    pub const NEIGHBOURS: Self = Self(1 << 6);
    /// (Σθ)²/Σθ².
    pub const EFFECTIVE_NEIGHBOURS: Self = Self(1 << 7);
    /// S = Σθ.
    pub const WEIGHT_SUM: Self = Self(1 << 8);
    /// Eigenvalues of the matrix that gives the frame.
    pub const EIGENVALUES: Self = Self(1 << 9);
    /// Σ|∂f/∂p_i|².
    pub const SQUARED_SENSITIVITY: Self = Self(1 << 10);
    /// h(x).
    pub const SUPPORT: Self = Self(1 << 11);
    /// Every column.
    pub const ALL: Self = Self((1 << 12) - 1);

    /// Whether all of `other` is in the set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Want {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Answers, one row a query, in the order of the queries. Columns not wanted are empty; a quantity that does not
/// exist at a point is NaN there, and the status says why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluations<const D: usize> {
    /// f, a length: the distance along n to the weighted average.
    pub value: Vec<f64>,
    /// a, the weighted average.
    pub average: Vec<[f64; D]>,
    /// n, a unit vector: the normal of the fitted frame, which is not the surface's.
    pub frame_normal: Vec<[f64; D]>,
    /// ∇f, exact.
    pub gradient: Vec<[f64; D]>,
    /// ∇f/|∇f|: the normal of the level set of f through the point.
    pub surface_normal: Vec<[f64; D]>,
    /// (λ1 − λ0)/λ_max, the two largest for averaged axes; |Nv|/S for averaged normals. 1 is best, 0 no frame.
    pub gap: Vec<f64>,
    /// Samples with positive weight.
    pub neighbours: Vec<u32>,
    /// (Σθ)²/Σθ²: how many equally weighted samples would average as much noise away.
    pub effective_neighbours: Vec<f64>,
    /// S = Σθ.
    pub weight_sum: Vec<f64>,
    /// Eigenvalues, ascending: of W, of Σθ e eᵀ (centred) or of Σθ n nᵀ (axes); NaN for averaged normals.
    pub eigenvalues: Vec<[f64; D]>,
    /// Σ|∂f/∂p_i|²: times the square of the samples' noise, the variance of f (first order).
    pub squared_sensitivity: Vec<f64>,
    /// h(x) = Σθh/S, a length.
    pub support: Vec<f64>,
    /// *ok*, *outside*, *degenerate*, *singular* (no gradient, hence no surface normal) or *invalid*.
    pub status: Vec<Status>,
}

impl<const D: usize> Surface<D> {
    /// Evaluates f and what belongs to it (SPEC §§ 3 and 4). Relative accuracy 1e-11 where the gap exceeds 0.1.
    pub fn evaluate<'q>(&self, at: impl Into<Queries<'q, D>>, want: Want) -> Evaluations<D> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).evaluate(at, want).unwrap_or_default()
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::evaluate`] into columns that are there already: their memory is used again.
    pub fn evaluate_into<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
        columns: &mut Evaluations<D>,
    ) -> Result<(), Cancelled> {
        *columns = self.evaluate(at, want)?;
        Ok(())
    }

    /// [`Surface::evaluate`].
    pub fn evaluate<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
    ) -> Result<Evaluations<D>, Cancelled> {
        let surface = self.surface;
        let queries = at.into();
        let columns = Columns::new(queries.points(surface).len(), want);
        let grouped = Grouped::new(surface, queries, self.run);
        let depth = if want.contains(Want::SQUARED_SENSITIVITY) {
            Depth::Sensitivity
        } else if want.contains(Want::GRADIENT) || want.contains(Want::SURFACE_NORMAL) {
            Depth::Gradient
        } else {
            Depth::Frame
        };
        grouped.for_each_block(surface, self.run, 0.0, |evaluator, block| {
            let locals = evaluator.evaluate(block.positions(), depth);
            for (j, position) in block.positions().iter().enumerate() {
                columns.put(surface, block.rows[j], position, &locals[j], depth);
            }
        })?;
        Ok(columns.finish())
    }
}

/// The columns while threads fill them.
struct Columns<const D: usize> {
    value: Numbers<1>,
    average: Numbers<D>,
    frame_normal: Numbers<D>,
    gradient: Numbers<D>,
    surface_normal: Numbers<D>,
    gap: Numbers<1>,
    neighbours: Counts,
    effective_neighbours: Numbers<1>,
    weight_sum: Numbers<1>,
    eigenvalues: Numbers<D>,
    squared_sensitivity: Numbers<1>,
    support: Numbers<1>,
    status: Statuses,
}

impl<const D: usize> Columns<D> {
    fn new(rows: usize, want: Want) -> Self {
        Self {
            value: Numbers::new(rows, want.contains(Want::VALUE)),
            average: Numbers::new(rows, want.contains(Want::AVERAGE)),
            frame_normal: Numbers::new(rows, want.contains(Want::FRAME_NORMAL)),
            gradient: Numbers::new(rows, want.contains(Want::GRADIENT)),
            surface_normal: Numbers::new(rows, want.contains(Want::SURFACE_NORMAL)),
            gap: Numbers::new(rows, want.contains(Want::GAP)),
            neighbours: Counts::new(rows, want.contains(Want::NEIGHBOURS)),
            effective_neighbours: Numbers::new(rows, want.contains(Want::EFFECTIVE_NEIGHBOURS)),
            weight_sum: Numbers::new(rows, want.contains(Want::WEIGHT_SUM)),
            eigenvalues: Numbers::new(rows, want.contains(Want::EIGENVALUES)),
            squared_sensitivity: Numbers::new(rows, want.contains(Want::SQUARED_SENSITIVITY)),
            support: Numbers::new(rows, want.contains(Want::SUPPORT)),
            status: Statuses::new(rows),
        }
    }

    fn put(
        &self,
        surface: &Surface<D>,
        row: usize,
        position: &Position<f64, D>,
        local: &Local<D>,
        depth: Depth,
    ) {
        let unit = surface.grid.unit;
        // Moments of positions carry a square of the unit, moments of normals none.
        let moment = if surface.definition.field() == NormalField::AveragedAxes { 1.0 } else { unit * unit };
        self.value.put(row, [local.value * unit]);
        let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
        self.average.put(row, scale(average, unit));
        self.frame_normal.put(row, local.normal);
        self.gradient.put(row, local.gradient);
        self.gap.put(row, [local.gap]);
        self.neighbours.put(row, local.neighbours);
        self.effective_neighbours.put(row, [local.effective_neighbours]);
        self.weight_sum.put(row, [local.weight_sum]);
        self.eigenvalues.put(row, scale(local.eigenvalues, moment));
        self.squared_sensitivity.put(row, [local.sensitivity]);
        self.support.put(row, [local.support * unit]);
        let mut status = local.status;
        if depth != Depth::Frame && status.is_ok() {
            match local.surface_normal() {
                Some(normal) => self.surface_normal.put(row, normal),
                None => status = Status::Singular,
            }
        }
        self.status.put(row, status);
    }

    fn finish(self) -> Evaluations<D> {
        Evaluations {
            value: self.value.values(),
            average: self.average.rows(),
            frame_normal: self.frame_normal.rows(),
            gradient: self.gradient.rows(),
            surface_normal: self.surface_normal.rows(),
            gap: self.gap.values(),
            neighbours: self.neighbours.values(),
            effective_neighbours: self.effective_neighbours.values(),
            weight_sum: self.weight_sum.values(),
            eigenvalues: self.eigenvalues.rows(),
            squared_sensitivity: self.squared_sensitivity.values(),
            support: self.support.values(),
            status: self.status.values(),
        }
    }
}
