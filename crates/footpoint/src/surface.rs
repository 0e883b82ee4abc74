//! The surface: samples, index and definition; and its evaluation at points.

use crate::algebra::{dot, length, scale};
use crate::cloud::Cloud;
use crate::columns::{Counts, Numbers, Statuses};
use crate::definition::{Definition, DefinitionError, Error};
use crate::engine::{BLOCK, Position};
use crate::evaluator::{Depth, Evaluator, Local};
use crate::field::NormalField;
use crate::grid::{Grid, LARGEST_COORDINATE, cell_side, group};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::support::{SupportSummary, choose};
use std::ops::{BitOr, Range};

/// Gradients shorter than this have no direction.
const SMALLEST_GRADIENT: f64 = 1e-12;

/// The surface that a cloud defines: the zero set of f(x) = n(x)·(x − a(x)) (eqs. 2 and 3).
///
/// Immutable, and shared freely between threads. Plain calls use all cores and cannot fail: every point gets a
/// [`Status`]. [`Surface::with`] gives the same calls with threads, progress and cancelling. Results have the
/// same bits for any number of threads, any batch and any order of the samples.
#[derive(Debug)]
pub struct Surface<const D: usize> {
    pub(crate) cloud: Cloud<D>,
    pub(crate) definition: Definition,
    pub(crate) grid: Grid<D>,
    support: SupportSummary,
}

/// How the sign of f and of the normals is decided (SPEC § 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Sign {
    /// By the samples' normals: distances are signed.
    Given,
    /// By a rule that only makes it unique at each point: distances are not signed.
    Arbitrary,
}

/// Where to ask.
#[derive(Clone, Copy, Debug)]
pub enum Queries<'a, const D: usize> {
    /// At these points, in the unit of the samples.
    Points(&'a [[f64; D]]),
    /// At the samples themselves, in their own order.
    Samples,
}

impl<'a, const D: usize> From<&'a [[f64; D]]> for Queries<'a, D> {
    fn from(points: &'a [[f64; D]]) -> Self {
        Self::Points(points)
    }
}

impl<'a, const D: usize> From<&'a Vec<[f64; D]>> for Queries<'a, D> {
    fn from(points: &'a Vec<[f64; D]>) -> Self {
        Self::Points(points)
    }
}

impl<'a, const D: usize, const N: usize> From<&'a [[f64; D]; N]> for Queries<'a, D> {
    fn from(points: &'a [[f64; D]; N]) -> Self {
        Self::Points(points)
    }
}

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

/// A surface together with how to run: the same calls, which end early when cancelled.
#[derive(Clone, Copy, Debug)]
pub struct Running<'r, const D: usize> {
    pub(crate) surface: &'r Surface<D>,
    pub(crate) run: &'r Run<'r>,
}

impl<const D: usize> Surface<D> {
    /// Chooses the support and indexes the samples.
    ///
    /// Fails where the definition makes no sense or needs normals that are absent, and where no sample is usable.
    pub fn new(cloud: Cloud<D>, definition: Definition) -> Result<Self, Error> {
        Self::build(cloud, definition, &Run::new())
    }

    /// [`Surface::new`] with threads and cancelling.
    pub fn build(cloud: Cloud<D>, definition: Definition, run: &Run<'_>) -> Result<Self, Error> {
        const { assert!(D == 2 || D == 3, "clouds have 2 or 3 dimensions") };
        definition.check()?;
        if u32::try_from(cloud.len()).is_err() {
            return Err(crate::cloud::CloudError::TooMany(cloud.len()).into());
        }
        if definition.field().needs_normals() && cloud.absent_normals() == cloud.len() && !cloud.is_empty() {
            return Err(DefinitionError::NormalsAbsent(definition.field()).into());
        }
        let radii = choose(&cloud, definition.support(), definition.weight(), run)?;
        let support = radii.summary(&cloud)?;
        let grid = Grid::new(&cloud, &radii, support.largest, definition.weight().reach(), run);
        if grid.points.is_empty() {
            return Err(crate::support::SupportError::NoSample(cloud.len()).into());
        }
        Ok(Self { cloud, definition, grid, support })
    }

    /// Evaluates f and what belongs to it (SPEC §§ 3 and 4). Relative accuracy 1e-11 where the gap exceeds 0.1.
    pub fn evaluate<'q>(&self, at: impl Into<Queries<'q, D>>, want: Want) -> Evaluations<D> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).evaluate(at, want).unwrap_or_default()
    }

    /// The same calls with threads, progress and cancelling.
    pub fn with<'r>(&'r self, run: &'r Run<'r>) -> Running<'r, D> {
        Running { surface: self, run }
    }

    /// The definition.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The cloud.
    pub fn cloud(&self) -> &Cloud<D> {
        &self.cloud
    }

    /// The radii that the definition's rule gave.
    pub fn support(&self) -> SupportSummary {
        self.support
    }

    /// Whether distances and normals have a sign that means something.
    pub fn sign(&self) -> Sign {
        let usable = self.cloud.absent_normals() < self.cloud.len();
        match self.definition.field() {
            NormalField::AveragedAxes => Sign::Arbitrary,
            _ if usable => Sign::Given,
            _ => Sign::Arbitrary,
        }
    }

    /// Samples that take part: those with finite coordinates, and a positive support and factor.
    pub fn samples_used(&self) -> usize {
        self.grid.points.len()
    }

    /// Side of the index's cells: a cloud moved by whole multiples of it along the axes keeps every bit of its
    /// answers (if the moved coordinates are exact). It belongs to the largest support.
    pub fn cell_side(&self) -> f64 {
        cell_side(self.support.largest * self.definition.weight().reach())
    }

    pub(crate) fn points<'a>(&'a self, queries: Queries<'a, D>) -> &'a [[f64; D]] {
        match queries {
            Queries::Points(points) => points,
            Queries::Samples => self.cloud.points(),
        }
    }
}

/// Queries in units of the grid, grouped into blocks of near ones.
pub(crate) struct Grouped<const D: usize> {
    points: Vec<[f64; D]>,
    order: Vec<u32>,
    pub(crate) blocks: Vec<Range<usize>>,
}

/// The valid queries of one block.
pub(crate) struct Block<const D: usize> {
    pub(crate) rows: [usize; BLOCK],
    positions: [Position<f64, D>; BLOCK],
    len: usize,
}

impl<const D: usize> Grouped<D> {
    pub(crate) fn new(surface: &Surface<D>, points: &[[f64; D]], run: &Run<'_>) -> Self {
        let inverse = 1.0 / surface.grid.unit;
        let points: Vec<[f64; D]> = points.iter().map(|p| p.map(|c| c * inverse)).collect();
        let (order, blocks) = group(&points, surface.grid.typical_side(), BLOCK, run);
        Self { points, order, blocks }
    }

    /// The block's queries without the invalid ones.
    pub(crate) fn block(&self, range: Range<usize>) -> Block<D> {
        let mut block = Block { rows: [0; BLOCK], positions: [Position::at([0.0; D]); BLOCK], len: 0 };
        for &row in &self.order[range] {
            let point = self.points[row as usize];
            if point.iter().all(|c| c.abs() < LARGEST_COORDINATE) {
                block.rows[block.len] = row as usize;
                block.positions[block.len] = Position::at(point);
                block.len += 1;
            }
        }
        block
    }
}

impl<const D: usize> Block<D> {
    pub(crate) fn positions(&self) -> &[Position<f64, D>] {
        &self.positions[..self.len]
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::evaluate`].
    pub fn evaluate<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
    ) -> Result<Evaluations<D>, Cancelled> {
        let surface = self.surface;
        let points = surface.points(at.into());
        let grouped = Grouped::new(surface, points, self.run);
        let columns = Columns::new(points.len(), want);
        let depth = if want.contains(Want::SQUARED_SENSITIVITY) {
            Depth::Sensitivity
        } else if want.contains(Want::GRADIENT) || want.contains(Want::SURFACE_NORMAL) {
            Depth::Gradient
        } else {
            Depth::Frame
        };
        let state = || (Evaluator::new(&surface.grid, &surface.definition, 0.0), [Local::NOWHERE; BLOCK]);
        self.run.for_each_block(&grouped.blocks, state, |(evaluator, locals), range| {
            let block = grouped.block(range);
            evaluator.evaluate(block.positions(), depth, locals);
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
            match unit_gradient(local) {
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

/// ∇f/|∇f|, where ∇f has a direction.
pub(crate) fn unit_gradient<const D: usize>(local: &Local<D>) -> Option<[f64; D]> {
    let length = length(local.gradient);
    if length < SMALLEST_GRADIENT || !length.is_finite() {
        return None;
    }
    let unit = scale(local.gradient, 1.0 / length);
    // Once more: the first division leaves the length a few roundings from one.
    Some(scale(unit, 1.0 / dot(unit, unit).sqrt()))
}
