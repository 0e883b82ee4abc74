//! Evaluation: f, its gradient and what belongs to them, in columns.

use crate::algebra::scale;
use crate::columns::{Answer, Statuses, Table};
use crate::evaluator::{Local, Position, Wanted};
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
    /// [`Surface::evaluate`].
    pub fn evaluate<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
    ) -> Result<Evaluations<D>, Cancelled> {
        let mut found = Evaluations::default();
        self.evaluate_into(at, want, &mut found)?;
        Ok(found)
    }

    /// [`Surface::evaluate`] into columns that are there already: their memory is used again, which saves up to a
    /// quarter of the time. What they hold after an error is not specified.
    pub fn evaluate_into<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
        columns: &mut Evaluations<D>,
    ) -> Result<(), Cancelled> {
        let surface = self.surface;
        let queries = at.into();
        let rows = queries.points(surface).len();
        let grouped = Grouped::new(surface, queries, self.run);
        let wanted = Wanted {
            moving: false,
            gradient: want.contains(Want::GRADIENT) || want.contains(Want::SURFACE_NORMAL),
            sensitivity: want.contains(Want::SQUARED_SENSITIVITY),
            statistics: want.contains(Want::NEIGHBOURS) || want.contains(Want::EFFECTIVE_NEIGHBOURS),
            eigenvalues: want.contains(Want::EIGENVALUES),
        };
        let has_gradient = wanted.gradient || wanted.sensitivity;
        let status = Statuses::new(rows);
        let table = table(columns, &status, want);
        grouped.for_each_group(
            self.run,
            wanted,
            || table.writer(),
            |evaluator, group, writer| {
                evaluator.evaluate(&group.positions, |i, answers, lane| {
                    let local = answers.local(lane);
                    let level = has_gradient && local.status.is_ok() && !local.has_surface_normal();
                    let status = if level { Status::Singular } else { local.status };
                    writer.put(group.rows[i], status, |answer| {
                        fill(answer, want, surface, &group.positions[i], &local);
                    });
                });
                for &row in &group.invalid {
                    let nowhere = Position::at([f64::NAN; D]);
                    writer.put(row, Status::Invalid, |answer| {
                        fill(answer, want, surface, &nowhere, &Local::NOWHERE);
                    });
                }
            },
        )?;
        drop(table);
        status.finish(&mut columns.status);
        Ok(())
    }
}

/// The wanted columns, to be filled in the order of [`fill`].
fn table<'c, const D: usize>(to: &'c mut Evaluations<D>, status: &'c Statuses, want: Want) -> Table<'c> {
    let mut table = Table::new(status);
    table.add_values(&mut to.value, want.contains(Want::VALUE));
    table.add_vectors(&mut to.average, want.contains(Want::AVERAGE));
    table.add_vectors(&mut to.frame_normal, want.contains(Want::FRAME_NORMAL));
    table.add_vectors(&mut to.gradient, want.contains(Want::GRADIENT));
    table.add_vectors(&mut to.surface_normal, want.contains(Want::SURFACE_NORMAL));
    table.add_values(&mut to.gap, want.contains(Want::GAP));
    table.add_counts(&mut to.neighbours, want.contains(Want::NEIGHBOURS));
    table.add_values(&mut to.effective_neighbours, want.contains(Want::EFFECTIVE_NEIGHBOURS));
    table.add_values(&mut to.weight_sum, want.contains(Want::WEIGHT_SUM));
    table.add_vectors(&mut to.eigenvalues, want.contains(Want::EIGENVALUES));
    table.add_values(&mut to.squared_sensitivity, want.contains(Want::SQUARED_SENSITIVITY));
    table.add_values(&mut to.support, want.contains(Want::SUPPORT));
    table
}

/// One row of the wanted columns, in the order of [`table`].
#[inline(always)]
fn fill<const D: usize>(
    answer: &mut Answer<'_>,
    want: Want,
    surface: &Surface<D>,
    position: &Position<D>,
    local: &Local<D>,
) {
    let unit = surface.grid.unit;
    if want.contains(Want::VALUE) {
        answer.numbers([local.value * unit]);
    }
    if want.contains(Want::AVERAGE) {
        let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
        answer.numbers(scale(average, unit));
    }
    if want.contains(Want::FRAME_NORMAL) {
        answer.numbers(local.normal);
    }
    if want.contains(Want::GRADIENT) {
        answer.numbers(local.gradient);
    }
    if want.contains(Want::SURFACE_NORMAL) {
        answer.numbers(local.surface_normal);
    }
    if want.contains(Want::GAP) {
        answer.numbers([local.gap]);
    }
    if want.contains(Want::NEIGHBOURS) {
        answer.count(local.neighbours);
    }
    if want.contains(Want::EFFECTIVE_NEIGHBOURS) {
        answer.numbers([local.effective_neighbours]);
    }
    if want.contains(Want::WEIGHT_SUM) {
        answer.numbers([local.weight_sum]);
    }
    if want.contains(Want::EIGENVALUES) {
        // Moments of positions carry a square of the unit, moments of normals none.
        let axes = surface.definition.field() == NormalField::AveragedAxes;
        answer.numbers(scale(local.eigenvalues, if axes { 1.0 } else { unit * unit }));
    }
    if want.contains(Want::SQUARED_SENSITIVITY) {
        answer.numbers([local.sensitivity]);
    }
    if want.contains(Want::SUPPORT) {
        answer.numbers([local.support * unit]);
    }
}
