//! A block: nearby positions that share one list of candidate samples.

use crate::algebra::{Vector, add};
use crate::grid::{Grid, LARGEST_COORDINATE};
use crate::lane::Lane;
use std::ops::Range;

/// Most positions of a block: the lanes of the widest vector unit.
pub(crate) const BLOCK: usize = 8;

/// A location, in units of the grid: a fixed anchor and the way from it.
///
/// Two numbers per axis, because an iterate near a sample at survey coordinates must move in steps far below the
/// spacing of doubles there. A difference to a sample is `(p − anchor) − offset`: two roundings that depend on
/// nothing but the sample and the position, so results have the same bits wherever and however they are computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position<L, const D: usize> {
    pub(crate) anchor: Vector<L, D>,
    pub(crate) offset: Vector<L, D>,
}

impl<L: Lane, const D: usize> Position<L, D> {
    pub(crate) fn at(anchor: Vector<L, D>) -> Self {
        Self { anchor, offset: [L::splat(0.0); D] }
    }

    /// `p − x` for a sample p.
    #[inline(always)]
    pub(crate) fn to_sample(self, sample: [f64; D]) -> Vector<L, D> {
        std::array::from_fn(|k| (L::splat(sample[k]) - self.anchor[k]) - self.offset[k])
    }
}

impl<const D: usize> Position<f64, D> {
    /// The location as one vector, rounded.
    pub(crate) fn rounded(self) -> [f64; D] {
        add(self.anchor, self.offset)
    }

    /// Whether doubles tell locations here apart within a support. NaN is not representable.
    pub(crate) fn is_representable(self) -> bool {
        self.rounded().iter().chain(&self.offset).all(|c| c.abs() < LARGEST_COORDINATE)
    }
}

/// The samples whose supports meet a box, in canonical order. Optional columns are empty if the grid has none.
#[derive(Debug)]
pub(crate) struct Candidates<const D: usize> {
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) scales: Vec<f64>,
    pub(crate) uniform_scale: f64,
    pub(crate) factors: Vec<f64>,
    pub(crate) normals: Vec<[f64; D]>,
    low: [f64; D],
    high: [f64; D],
}

impl<const D: usize> Candidates<D> {
    /// An empty list that covers nothing.
    pub(crate) fn new() -> Self {
        Self {
            points: Vec::new(),
            scales: Vec::new(),
            uniform_scale: 1.0,
            factors: Vec::new(),
            normals: Vec::new(),
            low: [f64::INFINITY; D],
            high: [f64::NEG_INFINITY; D],
        }
    }

    /// Whether the list holds every sample whose support contains the position.
    pub(crate) fn covers(&self, position: &Position<f64, D>) -> bool {
        let x = position.rounded();
        (0..D).all(|k| self.low[k] <= x[k] && x[k] <= self.high[k])
    }

    /// Collects the candidates of all locations in the box around `positions`, widened by `margin`.
    pub(crate) fn gather(
        &mut self,
        grid: &Grid<D>,
        positions: &[Position<f64, D>],
        margin: f64,
        weight_reach: f64,
    ) {
        self.points.clear();
        self.scales.clear();
        self.factors.clear();
        self.normals.clear();
        self.uniform_scale = grid.uniform_scale;
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for position in positions {
            let x = position.rounded();
            for k in 0..D {
                low[k] = low[k].min(x[k] - margin);
                high[k] = high[k].max(x[k] + margin);
            }
        }
        (self.low, self.high) = (low, high);
        // Roundings of the box and of the distances below must not lose a sample at the very end of its support.
        let largest = low.iter().chain(&high).fold(0.0_f64, |m, c| m.max(c.abs()));
        let slack = 4.0 * f64::EPSILON * largest;
        grid.visit(low, high, |range: Range<usize>, reach| {
            for i in range {
                let radius = match grid.scales.get(i) {
                    Some(scale) => scale * weight_reach,
                    None => reach,
                };
                let radius = radius * (1.0 + 1e-9) + slack;
                let p = grid.points[i];
                let mut distance = 0.0;
                for k in 0..D {
                    let outside = (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
                    distance += outside * outside;
                }
                if distance <= radius * radius {
                    self.points.push(p);
                    if let Some(&scale) = grid.scales.get(i) {
                        self.scales.push(scale);
                    }
                    if let Some(&factor) = grid.factors.get(i) {
                        self.factors.push(factor);
                    }
                    if let Some(&normal) = grid.normals.get(i) {
                        self.normals.push(normal);
                    }
                }
            }
        });
    }
}
