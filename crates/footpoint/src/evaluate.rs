//! Evaluation: f, its gradient and what belongs to them, in columns.

use crate::algebra::scale;
use crate::columns::{Counts, Numbers, Statuses};
use crate::evaluator::{Extra, Local, Pass, Position, Wanted};
use crate::field::NormalField;
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use std::ops::{BitOr, Range};

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
        let status = Statuses::new(rows);
        let has_gradient = wanted.gradient || wanted.sensitivity;
        let filling = Columns::new(columns, rows, want, &status, has_gradient);
        grouped.for_each_group(self.run, wanted, |evaluator, group| {
            let announce = |places: Range<usize>, pass: Pass| {
                group.rows[places].iter().for_each(|&row| filling.expect(row as usize, pass));
            };
            evaluator.evaluate(&group.positions, &announce, |i, answers, lane| {
                let row = group.rows[i] as usize;
                filling.put(surface, row, &group.positions[i], (&answers.local(lane), &answers.extra(lane)));
            });
            for &row in &group.invalid {
                filling.put(
                    surface,
                    row as usize,
                    &Position::at([f64::NAN; D]),
                    (&Local::NOWHERE, &Extra::NOWHERE),
                );
                status.put(row as usize, Status::Invalid);
            }
        })?;
        status.finish(&mut columns.status);
        Ok(())
    }
}

/// The columns while threads fill them.
struct Columns<'c, const D: usize> {
    value: Numbers<'c, 1>,
    average: Numbers<'c, D>,
    frame_normal: Numbers<'c, D>,
    gradient: Numbers<'c, D>,
    surface_normal: Numbers<'c, D>,
    gap: Numbers<'c, 1>,
    neighbours: Counts<'c>,
    effective_neighbours: Numbers<'c, 1>,
    weight_sum: Numbers<'c, 1>,
    eigenvalues: Numbers<'c, D>,
    squared_sensitivity: Numbers<'c, 1>,
    support: Numbers<'c, 1>,
    status: &'c Statuses,
    has_gradient: bool,
}

impl<'c, const D: usize> Columns<'c, D> {
    fn new(
        to: &'c mut Evaluations<D>,
        rows: usize,
        want: Want,
        status: &'c Statuses,
        has_gradient: bool,
    ) -> Self {
        Self {
            value: Numbers::values(&mut to.value, rows, want.contains(Want::VALUE)),
            average: Numbers::rows(&mut to.average, rows, want.contains(Want::AVERAGE)),
            frame_normal: Numbers::rows(&mut to.frame_normal, rows, want.contains(Want::FRAME_NORMAL)),
            gradient: Numbers::rows(&mut to.gradient, rows, want.contains(Want::GRADIENT)),
            surface_normal: Numbers::rows(&mut to.surface_normal, rows, want.contains(Want::SURFACE_NORMAL)),
            gap: Numbers::values(&mut to.gap, rows, want.contains(Want::GAP)),
            neighbours: Counts::values(&mut to.neighbours, rows, want.contains(Want::NEIGHBOURS)),
            effective_neighbours: Numbers::values(
                &mut to.effective_neighbours,
                rows,
                want.contains(Want::EFFECTIVE_NEIGHBOURS),
            ),
            weight_sum: Numbers::values(&mut to.weight_sum, rows, want.contains(Want::WEIGHT_SUM)),
            eigenvalues: Numbers::rows(&mut to.eigenvalues, rows, want.contains(Want::EIGENVALUES)),
            squared_sensitivity: Numbers::values(
                &mut to.squared_sensitivity,
                rows,
                want.contains(Want::SQUARED_SENSITIVITY),
            ),
            support: Numbers::values(&mut to.support, rows, want.contains(Want::SUPPORT)),
            status,
            has_gradient,
        }
    }

    /// Calls for the memory of a row, which is far from the last one where queries are in random order; half of it before
    /// each pass, because the processor waits for few lines at a time.
    #[inline(always)]
    fn expect(&self, row: usize, pass: Pass) {
        if pass == Pass::First {
            self.value.expect(row);
            self.average.expect(row);
            self.frame_normal.expect(row);
            self.gap.expect(row);
            self.neighbours.expect(row);
            self.effective_neighbours.expect(row);
        } else {
            self.gradient.expect(row);
            self.surface_normal.expect(row);
            self.weight_sum.expect(row);
            self.eigenvalues.expect(row);
            self.squared_sensitivity.expect(row);
            self.support.expect(row);
            self.status.expect(row);
        }
    }

    #[inline(always)]
    fn put(
        &self,
        surface: &Surface<D>,
        row: usize,
        position: &Position<D>,
        (local, extra): (&Local<D>, &Extra<D>),
    ) {
        let unit = surface.grid.unit;
        // Moments of positions carry a square of the unit, moments of normals none.
        let moment = if surface.definition.field() == NormalField::AveragedAxes { 1.0 } else { unit * unit };
        self.value.put(row, [local.value * unit]);
        let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
        self.average.put(row, scale(average, unit));
        self.frame_normal.put(row, local.normal);
        self.gradient.put(row, local.gradient);
        self.surface_normal.put(row, local.surface_normal);
        self.gap.put(row, [local.gap]);
        self.neighbours.put(row, extra.neighbours);
        self.effective_neighbours.put(row, [extra.effective_neighbours]);
        self.weight_sum.put(row, [extra.weight_sum]);
        self.eigenvalues.put(row, scale(extra.eigenvalues, moment));
        self.squared_sensitivity.put(row, [extra.sensitivity]);
        self.support.put(row, [local.support * unit]);
        let level = self.has_gradient && local.status.is_ok() && !local.has_surface_normal();
        self.status.put(row, if level { Status::Singular } else { local.status });
    }
}
