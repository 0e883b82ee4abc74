//! Where to ask, and how queries are put into blocks of near ones.

use crate::evaluator::{Evaluator, Position, Wanted};
use crate::grid::{Groups, group};
use crate::run::{Cancelled, Run};
use crate::surface::Surface;
use std::borrow::Cow;

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

impl<'a, const D: usize> Queries<'a, D> {
    /// The points to ask about.
    pub(crate) fn points(self, surface: &'a Surface<D>) -> &'a [[f64; D]] {
        match self {
            Self::Points(points) => points,
            Self::Samples => surface.cloud.points(),
        }
    }
}

/// Queries in units of the grid, in groups of near ones.
pub(crate) struct Grouped<'q, const D: usize> {
    surface: &'q Surface<D>,
    points: &'q [[f64; D]],
    groups: Cow<'q, Groups>,
    /// Which query stands at each place of the order, where that is not its own number.
    rows: Option<&'q [u32]>,
    /// The queries are not the samples.
    foreign: bool,
}

/// The queries of one group.
#[derive(Debug)]
pub(crate) struct Group<const D: usize> {
    /// Row of each query in the output.
    pub(crate) rows: Vec<u32>,
    pub(crate) positions: Vec<Position<D>>,
    /// Rows of queries that the grid does not hold.
    pub(crate) invalid: Vec<u32>,
}

impl<'q, const D: usize> Grouped<'q, D> {
    pub(crate) fn new(surface: &'q Surface<D>, queries: Queries<'q, D>, run: &Run<'_>) -> Self {
        let grid = &surface.grid;
        let points = queries.points(surface);
        let foreign = matches!(queries, Queries::Points(_));
        match queries {
            // The grid knows the samples that take part; where some do not, they are asked about like any point.
            Queries::Samples if grid.len() == points.len() => Self {
                surface,
                points,
                groups: Cow::Borrowed(grid.groups()),
                rows: Some(grid.original()),
                foreign,
            },
            _ => {
                let groups = group(points, grid, run);
                Self { surface, points, groups: Cow::Owned(groups), rows: None, foreign }
            }
        }
    }

    /// Where in the grid each query stands that is a sample; empty for foreign ones.
    pub(crate) fn own_places(&self) -> Vec<Option<u32>> {
        if self.foreign { Vec::new() } else { self.surface.grid.places(self.points.len()) }
    }

    /// Calls `work` for every group, in parallel, each thread with an evaluator of its own.
    pub(crate) fn for_each_group(
        &self,
        run: &Run<'_>,
        wanted: Wanted,
        work: impl Fn(&mut Evaluator<'_, D>, &Group<D>) + Sync + Send,
    ) -> Result<(), Cancelled> {
        let Surface { grid, definition, .. } = self.surface;
        let state = || {
            let group = Group { rows: Vec::new(), positions: Vec::new(), invalid: Vec::new() };
            let evaluator = Evaluator::new(grid, definition, run.level(), wanted);
            (evaluator.with_run(*run), group)
        };
        let size = |i: usize| self.groups.range(i).len();
        run.for_each_group(self.groups.count(), size, state, |(evaluator, group), i| {
            self.fill(group, i);
            work(evaluator, group);
        })
    }

    fn fill(&self, group: &mut Group<D>, i: usize) {
        let grid = &self.surface.grid;
        let inverse = 1.0 / grid.unit;
        group.rows.clear();
        group.positions.clear();
        group.invalid.clear();
        for &place in &self.groups.order[self.groups.range(i)] {
            let place = place as usize;
            let row = self.rows.map_or(place as u32, |rows| rows[place]);
            let sample = if self.rows.is_some() { grid.sample(place) } else { None };
            let point = sample.unwrap_or_else(|| self.points[row as usize].map(|c| c * inverse));
            if grid.holds(point) {
                group.rows.push(row);
                group.positions.push(Position::at(point));
            } else {
                group.invalid.push(row);
            }
        }
    }
}
