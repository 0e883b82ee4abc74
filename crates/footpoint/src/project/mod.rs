//! Projection onto the surface: the operators of SPEC § 6, Levin's own, and their statuses.

mod levin;
mod moving;

use crate::algebra::{add, dot, scale};
use crate::columns::{Counts, Numbers, Statuses};
use crate::evaluator::{Evaluator, Position, Wanted};
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use moving::Moving;

/// Which point of the surface a point is taken to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Operator {
    /// To the weighted average first, then along n from iterate to iterate (§ 4.1). Not idempotent, and it pulls
    /// rims inwards: a second application moves points by some 0.07 h.
    Basic,
    /// Along the frame normal at the result: x − y ∥ n(y) (§ 4.2).
    AlmostOrthogonal,
    /// Along the surface normal at the result, x − y ∥ ∇f(y): the foot point (§ 4.3).
    #[default]
    Orthogonal,
    /// Levin's own projection, to compare with: to q = x + t n, the local minimum of Σ(n·(p − q))²θ(|p − q|) in n and t with
    /// the smallest |t| (eq. 16, step one), then to the value at q of the polynomial that fits the samples over that plane
    /// (step two). It takes the definition's weight and supports, whatever its kind.
    ///
    /// Step one repeated lands on the surface of [`Kind::Levin`](crate::Kind::Levin): |t| falls by some 1e3 each time. It is
    /// not orthogonal to it: from 0.05 to 0.2 h away, with 30 neighbours on a torus, x − q stands 0.6° off ∇f(q) (median;
    /// 2° at worst of twenty) without noise, 1.4° (4.7°) with noise of half a spacing, and q lies 1 or 2.4 % of the way
    /// beside the foot point.
    Levin {
        /// Of the polynomial, 0 to 4 as a rule; *degenerate* where the samples do not determine it. `None` is step one alone.
        degree: Option<u8>,
    },
}

/// How to project: operator, tolerance, most evaluations.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Project {
    operator: Operator,
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    tolerance: f64,
    most_evaluations: u32,
}

impl Default for Project {
    fn default() -> Self {
        Self { operator: Operator::default(), tolerance: 1e-6, most_evaluations: 1000 }
    }
}

impl Project {
    /// The orthogonal projection to 1e-6 h.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes this operator.
    pub fn with_operator(mut self, operator: Operator) -> Self {
        self.operator = operator;
        self
    }

    /// Stops where the operator's next step and |f| are at most this many local supports. Reaches 1e-12; NaN counts as 0.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = if tolerance.is_nan() { 0.0 } else { tolerance };
        self
    }

    /// Gives up after this many evaluations of f (1000 by default; few points need more than 40).
    pub fn with_most_evaluations(mut self, most: u32) -> Self {
        self.most_evaluations = most;
        self
    }

    /// The operator.
    pub fn operator(&self) -> Operator {
        self.operator
    }

    /// The tolerance, in units of the local support.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

/// Projected points, one row a query, in the order of the queries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Projections<const D: usize> {
    /// The point on the surface; the query itself where the status is not *ok*.
    pub point: Vec<[f64; D]>,
    /// ∇f/|∇f| at the result; the polynomial's normal for Levin's operator, NaN below degree 1, where it has none. NaN where
    /// the status is not *ok*, like all that follows but the residual.
    pub surface_normal: Vec<[f64; D]>,
    /// n at the result.
    pub frame_normal: Vec<[f64; D]>,
    /// |x − y|; negative behind the surface if the surface's sign is given.
    pub distance: Vec<f64>,
    /// The larger of |f| and the operator's next step at the result, a length: what the tolerance is compared with;
    /// where the status is not *ok*, at the last iterate at which f exists. NaN if there is none. For Levin's operator the
    /// larger of the last change of t and |G/S| (SPEC § 7).
    pub residual: Vec<f64>,
    /// Evaluations of f spent; of the energy and its derivatives for Levin's operator.
    pub evaluations: Vec<u32>,
    /// What became of the point. A sample of the surface's own cloud whose foot point lies farther off than the
    /// sample's support reaches is *outside*: it does not belong to the surface there.
    pub status: Vec<Status>,
}

/// Where a point has come to, lengths in units of the grid; NaN where there is nothing.
struct Landing<const D: usize> {
    point: [f64; D],
    surface_normal: [f64; D],
    frame_normal: [f64; D],
    distance: f64,
    residual: f64,
    evaluations: u32,
}

impl<const D: usize> Landing<D> {
    const NOWHERE: Self = Self {
        point: [f64::NAN; D],
        surface_normal: [f64::NAN; D],
        frame_normal: [f64::NAN; D],
        distance: f64::NAN,
        residual: f64::NAN,
        evaluations: 0,
    };
}

/// The plain iterates of one projection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace<const D: usize> {
    /// Every point at which f was evaluated; the first is the query. For Levin's operator every q that was tried.
    pub iterates: Vec<[f64; D]>,
    /// f at each of them, with the sign carried from one to the next; for Levin's operator −G/S there.
    pub values: Vec<f64>,
    /// What became of the point.
    pub status: Status,
}

impl<const D: usize> Surface<D> {
    /// Projects points onto the surface (SPEC § 6). One bad point never fails the batch.
    pub fn project<'q>(&self, points: impl Into<Queries<'q, D>>, how: &Project) -> Projections<D> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).project(points, how).unwrap_or_default()
    }

    /// The plain iterates from one point: for teaching, figures and doubt.
    pub fn trace(&self, point: [f64; D], how: &Project) -> Trace<D> {
        let mut trace = Trace { status: Status::Invalid, ..Trace::default() };
        let start = Position::at(scale(point, 1.0 / self.grid.unit));
        if !self.grid.holds(start.anchor) {
            return trace;
        }
        if let Operator::Levin { degree } = how.operator {
            let observe = |way: [f64; D], value: f64| {
                trace.iterates.push(scale(add(start.anchor, way), self.grid.unit));
                trace.values.push(value * self.grid.unit);
            };
            trace.status = levin::project(self, start.anchor, (how, degree, &Run::new()), observe).0;
            return trace;
        }
        let wanted = Wanted { moving: true, gradient: true, ..Wanted::default() };
        let mut evaluator = Evaluator::new(&self.grid, &self.definition, Run::new().level(), wanted);
        let mut last = [f64::NAN; D];
        trace.status = moving::trace((self, &mut evaluator), start, how, |position, local| {
            trace.iterates.push(scale(position.rounded(), self.grid.unit));
            let sign = if dot(local.normal, last) < 0.0 { -1.0 } else { 1.0 };
            last = scale(local.normal, sign);
            trace.values.push(sign * local.value * self.grid.unit);
        });
        trace
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::project`].
    pub fn project<'q>(
        &self,
        points: impl Into<Queries<'q, D>>,
        how: &Project,
    ) -> Result<Projections<D>, Cancelled> {
        let surface = self.surface;
        let queries = points.into();
        let points = queries.points(surface);
        let grouped = Grouped::new(surface, queries, self.run);
        let rows = points.len();
        let mut found = Projections::default();
        let status = Statuses::new(rows);
        let wanted = Wanted { moving: true, gradient: true, ..Wanted::default() };
        // What a sample finds farther off than its own support is a part of the surface that is not its own.
        let are_samples = matches!(queries, Queries::Samples);
        let varied = are_samples && !surface.grid.scales.is_empty();
        let own = if varied { grouped.own_places() } else { Vec::new() };
        let widest = if are_samples { surface.support().largest / surface.grid.unit } else { f64::INFINITY };
        let farthest = |row: usize| {
            let place = own.get(row).copied().flatten();
            place.map_or(widest, |place| surface.grid.scales[place as usize])
                * surface.definition.weight().reach()
        };
        {
            let point = Numbers::rows(&mut found.point, rows, true);
            let surface_normal = Numbers::rows(&mut found.surface_normal, rows, true);
            let frame_normal = Numbers::rows(&mut found.frame_normal, rows, true);
            let distance = Numbers::values(&mut found.distance, rows, true);
            let residual = Numbers::values(&mut found.residual, rows, true);
            let evaluations = Counts::values(&mut found.evaluations, rows, true);
            let put = |row: usize, (verdict, landing): (Status, Landing<D>)| {
                let strays = landing.distance.abs() > farthest(row);
                let verdict = if verdict.is_ok() && strays { Status::Outside } else { verdict };
                status.put(row, verdict);
                evaluations.put(row, landing.evaluations);
                residual.put(row, [landing.residual * surface.grid.unit]);
                if verdict.is_ok() {
                    point.put(row, scale(landing.point, surface.grid.unit));
                    surface_normal.put(row, landing.surface_normal);
                    frame_normal.put(row, landing.frame_normal);
                    distance.put(row, [landing.distance * surface.grid.unit]);
                } else {
                    point.put(row, points[row]);
                    surface_normal.put(row, [f64::NAN; D]);
                    frame_normal.put(row, [f64::NAN; D]);
                    distance.put(row, [f64::NAN]);
                }
            };
            grouped.for_each_group(self.run, wanted, |evaluator, group| {
                if let Operator::Levin { degree } = how.operator {
                    for (&row, at) in group.rows.iter().zip(&group.positions) {
                        if self.run.is_cancelled() {
                            break;
                        }
                        let how = (how, degree, self.run);
                        put(row as usize, levin::project(surface, at.anchor, how, |_, _| {}));
                    }
                } else {
                    let mut moving: Vec<Moving<D>> =
                        group.positions.iter().map(|&at| Moving::new(at, how)).collect();
                    moving::project((surface, evaluator), &mut moving, how);
                    for (&row, moving) in group.rows.iter().zip(&moving) {
                        put(row as usize, (moving.verdict(surface), moving.landing(surface)));
                    }
                }
                for &row in &group.invalid {
                    put(row as usize, (Status::Invalid, Landing::NOWHERE));
                }
            })?;
        }
        status.finish(&mut found.status);
        Ok(found)
    }
}
