//! One thread's evaluator: its scratch, and all quantities at the positions of a group.

mod answers;
mod batch;
mod heights;
#[cfg(test)]
mod kinds_tests;
mod levin;
#[cfg(test)]
mod levin_tests;
mod own;
#[cfg(test)]
mod tests;

use crate::definition::{Definition, Kind};
pub(crate) use crate::engine::Position;
use crate::engine::{Culled, Extent};
use crate::grid::{Grid, Store};
use crate::heights::Degrees;
use crate::run::Run;
pub(crate) use answers::{Answers, Extra, Local};
pub(crate) use batch::Pass;
use batch::{Announce, Batch, Task, taken_at};
use fearless_simd::Level;
pub(crate) use own::own_sensitivity;

/// What to compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wanted {
    /// Positions have moved from where they began.
    pub(crate) moving: bool,
    pub(crate) gradient: bool,
    /// Σ|G_i|²; needs the gradient.
    pub(crate) sensitivity: bool,
    /// Neighbours and effective neighbours.
    pub(crate) statistics: bool,
    pub(crate) eigenvalues: bool,
    /// ∇²f.
    pub(crate) hessian: bool,
    /// How the samples scatter about their plane.
    pub(crate) scatter: bool,
}

/// How far positions may move before a group's candidates are gathered anew, and the longest side of the box that they are
/// gathered for, in sides of the grid's cells. A group fits with its margin.
const MARGIN: f64 = 0.3;
const LONGEST_SIDE: f64 = 5.0;

/// Evaluates positions near each other; keeps their candidates as long as these cover them.
pub(crate) struct Evaluator<'s, const D: usize> {
    grid: &'s Grid<D>,
    task: Task,
    work: Work<D>,
    run: Run<'s>,
}

/// The scratch of one precision.
enum Work<const D: usize> {
    Double(Box<Batch<f64, D>>),
    Single(Box<Batch<f32, D>>),
}

impl<'s, const D: usize> Evaluator<'s, D> {
    pub(crate) fn new(grid: &'s Grid<D>, definition: &Definition, level: Level, wanted: Wanted) -> Self {
        let degrees =
            Degrees { asked: usize::from(definition.degree()), fallback: definition.degree_fallback() };
        // Sums of Levin's surface and of higher degrees run in general mode.
        let general = definition.kind() == Kind::Levin || degrees.asked > 0;
        let varied = general || !grid.scales.is_empty() || !grid.factors.is_empty();
        let task = Task {
            level,
            weight: definition.weight(),
            kind: definition.kind(),
            field: definition.field(),
            degrees,
            domain_ratio: definition.domain_ratio(),
            varied,
            moved: wanted.moving,
            gradient: wanted.gradient || wanted.sensitivity,
            sensitivity: wanted.sensitivity,
            statistics: wanted.statistics,
            eigenvalues: wanted.eigenvalues,
            hessian: wanted.hessian,
            scatter: wanted.scatter,
        };
        let work = match grid.store {
            Store::Double(_) => Work::Double(Box::new(Batch::new())),
            Store::Single(_) => Work::Single(Box::new(Batch::new())),
        };
        Self { grid, task, work, run: Run::new() }
    }

    /// The same, which answers *nowhere* once the run is cancelled: a block alone may take long where supports are wide.
    pub(crate) fn with_run(self, run: Run<'s>) -> Self {
        Self { run, ..self }
    }

    /// Evaluates positions, which the grid holds; `take` gets the place of each and its answers, and `announce` their places
    /// some time before.
    pub(crate) fn evaluate(
        &mut self,
        positions: &[Position<D>],
        announce: Announce<'_>,
        mut take: impl FnMut(usize, &Answers<D>, usize),
    ) {
        let Self { grid, task, work, run } = self;
        let how = (&**grid, &*task, announce, &*run);
        match work {
            Work::Double(batch) => evaluate(how, batch, (0, positions), &mut take),
            Work::Single(batch) => evaluate(how, batch, (0, positions), &mut take),
        }
    }
}

/// Gathers candidates for the positions unless that has been done; positions too far apart for that are halved first.
fn evaluate<N: Culled, const D: usize>(
    how: (&Grid<D>, &Task, Announce<'_>, &Run<'_>),
    batch: &mut Batch<N, D>,
    (first, positions): (usize, &[Position<D>]),
    take: &mut impl FnMut(usize, &Answers<D>, usize),
) {
    let (grid, task, announce, run) = how;
    let extent = Extent::around(positions.iter().map(|position| taken_at::<N, D>(position).0));
    if !batch.candidates.covers(&extent) {
        let side = grid.typical_side();
        if extent.longest_side() > (LONGEST_SIDE - 2.0 * MARGIN) * side && positions.len() > 1 {
            let (left, right) = positions.split_at(positions.len() / 2);
            evaluate(how, batch, (first, left), take);
            evaluate(how, batch, (first + left.len(), right), take);
            return;
        }
        let margin = if task.moved { MARGIN * side } else { 0.0 };
        batch.candidates.gather(
            grid,
            extent.widened(margin),
            task.weight.reach(),
            task.needs_general_columns(),
            task.level,
        );
    }
    let mut taken = 0;
    while taken < positions.len() {
        if run.is_cancelled() {
            return (taken..positions.len()).for_each(|place| take(first + place, &Answers::NOWHERE, 0));
        }
        let first = first + taken;
        taken += batch.run(task, grid, &positions[taken..], &|places, pass| {
            announce(first + places.start..first + places.end, pass);
        });
        for (places, answers) in batch.answers() {
            for (lane, place) in places.enumerate() {
                take(first + place, answers, lane);
            }
        }
    }
}
