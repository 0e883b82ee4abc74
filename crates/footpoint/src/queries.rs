//! Where to ask, and how queries are put into blocks of near ones.

use crate::algebra::scale;
use crate::evaluator::{BLOCK, Evaluator, Position};
use crate::grid::{Group, group};
use crate::run::{Cancelled, Run};
use crate::surface::Surface;
use std::borrow::Cow;
use std::ops::Range;

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

/// Queries in units of the grid, grouped into blocks of near ones.
pub(crate) struct Grouped<'q, const D: usize> {
    points: Cow<'q, [[f64; D]]>,
    /// Row of each point in the output, where that is not its own place.
    rows: Option<&'q [u32]>,
    order: Vec<u32>,
    groups: Vec<Group>,
}

/// The valid queries of one block.
pub(crate) struct Block<const D: usize> {
    pub(crate) rows: [usize; BLOCK],
    positions: [Position<f64, D>; BLOCK],
    len: usize,
}

impl<'q, const D: usize> Grouped<'q, D> {
    pub(crate) fn new(surface: &'q Surface<D>, queries: Queries<'q, D>, run: &Run<'_>) -> Self {
        let grid = &surface.grid;
        match queries {
            // The grid knows the samples that take part; where some do not, they are asked about like any point.
            Queries::Samples if grid.points.len() == surface.cloud.len() => {
                let (order, groups) = grid.group_samples();
                Self { points: Cow::Borrowed(&grid.points), rows: Some(grid.original()), order, groups }
            }
            _ => {
                let points = queries.points(surface);
                let inverse = 1.0 / grid.unit;
                let points: Vec<[f64; D]> = points.iter().map(|p| scale(*p, inverse)).collect();
                let (order, groups) = group(&points, grid.typical_side(), run);
                Self { points: Cow::Owned(points), rows: None, order, groups }
            }
        }
    }

    /// Calls `work` for every block, in parallel over the groups, each thread with an evaluator of its own whose lists
    /// let positions move by `margin`.
    pub(crate) fn for_each_block(
        &self,
        surface: &Surface<D>,
        run: &Run<'_>,
        margin: f64,
        work: impl Fn(&mut Evaluator<'_, D>, &Block<D>) + Sync + Send,
    ) -> Result<(), Cancelled> {
        let state = || Evaluator::new(&surface.grid, &surface.definition, run.level());
        let points = |group: &Group| group.points.clone();
        run.for_each_group(&self.groups, points, state, |evaluator, group| {
            let places = self.order[group.points.clone()].iter();
            let positions = places.map(|&place| Position::at(self.points[place as usize]));
            evaluator.set_margin(margin);
            evaluator.enter(positions.filter(|position| position.is_representable()));
            for block in &group.blocks {
                work(evaluator, &self.block(block.clone()));
            }
        })
    }

    /// The block's queries without the invalid ones.
    fn block(&self, range: Range<usize>) -> Block<D> {
        let mut block = Block { rows: [0; BLOCK], positions: [Position::at([0.0; D]); BLOCK], len: 0 };
        for &place in &self.order[range] {
            let position = Position::at(self.points[place as usize]);
            if position.is_representable() {
                block.rows[block.len] = self.rows.map_or(place, |rows| rows[place as usize]) as usize;
                block.positions[block.len] = position;
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
