//! Where to ask, and how queries are put into blocks of near ones.

use crate::evaluator::{BLOCK, Position};
use crate::grid::group;
use crate::run::Run;
use crate::surface::Surface;
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
            let position = Position::at(self.points[row as usize]);
            if position.is_representable() {
                block.rows[block.len] = row as usize;
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
