//! A block: nearby positions that share one list of candidate samples.

use crate::algebra::{Vector, add};
use crate::grid::{Grid, LARGEST_COORDINATE};
use crate::lane::Lane;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use std::ops::Range;

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
    #[inline(always)]
    pub(crate) fn at(anchor: Vector<L, D>) -> Self {
        Self { anchor, offset: [anchor[0].like(0.0); D] }
    }

    /// `p − x` for a sample p.
    #[inline(always)]
    pub(crate) fn to_sample(self, sample: [f64; D]) -> Vector<L, D> {
        std::array::from_fn(|k| (self.anchor[k].like(sample[k]) - self.anchor[k]) - self.offset[k])
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

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug)]
struct Extent<const D: usize> {
    low: [f64; D],
    high: [f64; D],
}

impl<const D: usize> Extent<D> {
    const NOTHING: Self = Self { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };

    fn around(positions: impl Iterator<Item = Position<f64, D>>, margin: f64) -> Self {
        let mut extent = Self::NOTHING;
        for position in positions {
            let x = position.rounded();
            for k in 0..D {
                extent.low[k] = if x[k] < extent.low[k] { x[k] } else { extent.low[k] };
                extent.high[k] = if x[k] > extent.high[k] { x[k] } else { extent.high[k] };
            }
        }
        for k in 0..D {
            extent.low[k] -= margin;
            extent.high[k] += margin;
        }
        extent
    }

    fn contains(&self, other: &Self) -> bool {
        (0..D).all(|k| self.low[k] <= other.low[k] && other.high[k] <= self.high[k])
    }

    fn contains_point(&self, x: [f64; D]) -> bool {
        (0..D).all(|k| self.low[k] <= x[k] && x[k] <= self.high[k])
    }

    /// More than any rounding of the corners.
    fn slack(&self) -> f64 {
        4.0 * f64::EPSILON * self.low.iter().chain(&self.high).fold(0.0_f64, |m, c| m.max(c.abs()))
    }
}

/// Candidates in two stages, both in canonical order: the samples around a group of blocks, copied together, and of
/// these the ones whose supports meet the box of one block. Optional columns are empty if the grid has none.
#[derive(Debug)]
pub(crate) struct Candidates<const D: usize> {
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) scales: Vec<f64>,
    pub(crate) uniform_scale: f64,
    pub(crate) factors: Vec<f64>,
    pub(crate) normals: Vec<[f64; D]>,
    /// Places in the columns above that the block needs.
    indices: Vec<u32>,
    len: usize,
    /// Points relative to `centre` and radii, in single precision: for culling alone, and rounded to the safe side.
    /// Padded to whole vectors with infinity, which is in no box.
    local: [Vec<f32>; D],
    reaches: Vec<f32>,
    centre: [f64; D],
    /// What single precision may be off by.
    blur: f32,
    group: Extent<D>,
    block: Extent<D>,
}

/// Lanes of single precision in the widest vector: the padding.
const WIDEST: usize = 16;

impl<const D: usize> Candidates<D> {
    /// An empty list that covers nothing.
    pub(crate) fn new() -> Self {
        Self {
            points: Vec::new(),
            scales: Vec::new(),
            uniform_scale: 1.0,
            factors: Vec::new(),
            normals: Vec::new(),
            indices: Vec::new(),
            len: 0,
            local: std::array::from_fn(|_| Vec::new()),
            reaches: Vec::new(),
            centre: [0.0; D],
            blur: 0.0,
            group: Extent::NOTHING,
            block: Extent::NOTHING,
        }
    }

    /// The block's candidates, as places in the columns.
    #[inline(always)]
    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices[..self.len]
    }

    /// Collects what the blocks of a group may need: all samples whose supports meet the box around its positions.
    pub(crate) fn enter(
        &mut self,
        grid: &Grid<D>,
        positions: impl Iterator<Item = Position<f64, D>>,
        margin: f64,
        reach: f64,
    ) {
        self.gather(grid, Extent::around(positions, margin), reach);
    }

    /// Makes the list cover these positions, widened by `margin`, unless it does already.
    pub(crate) fn cover(
        &mut self,
        grid: &Grid<D>,
        positions: &[Position<f64, D>],
        margin: f64,
        reach: f64,
        level: Level,
    ) {
        if positions.iter().all(|position| self.block.contains_point(position.rounded())) {
            return;
        }
        let block = Extent::around(positions.iter().copied(), margin);
        if !self.group.contains(&block) {
            self.gather(grid, block, reach);
        }
        self.block = block;
        let relative =
            |corner: [f64; D]| -> [f32; D] { std::array::from_fn(|k| (corner[k] - self.centre[k]) as f32) };
        let (low, high) = (relative(block.low), relative(block.high));
        let reach = (grid.uniform_scale * reach * (1.0 + 1e-6)) as f32 + self.blur;
        if self.indices.len() < self.local[0].len() {
            self.indices.resize(self.local[0].len(), 0);
        }
        let local = self.local.each_ref().map(Vec::as_slice);
        let sieve = Sieve { local: &local, reaches: &self.reaches, reach, low: &low, high: &high };
        self.len = sieve.sift(level, &mut self.indices);
    }

    fn gather(&mut self, grid: &Grid<D>, extent: Extent<D>, weight_reach: f64) {
        self.group = extent;
        self.block = Extent::NOTHING;
        self.points.clear();
        self.scales.clear();
        self.factors.clear();
        self.normals.clear();
        self.uniform_scale = grid.uniform_scale;
        let column = |to: &mut Vec<f64>, from: &[f64], range: Range<usize>| {
            if let Some(values) = from.get(range) {
                to.extend_from_slice(values);
            }
        };
        grid.visit(extent.low, extent.high, |range, _| {
            self.points.extend_from_slice(&grid.points[range.clone()]);
            column(&mut self.scales, &grid.scales, range.clone());
            column(&mut self.factors, &grid.factors, range.clone());
            if let Some(normals) = grid.normals.get(range) {
                self.normals.extend_from_slice(normals);
            }
        });
        self.centre = std::array::from_fn(|k| 0.5 * extent.low[k] + 0.5 * extent.high[k]);
        let padded = self.points.len().next_multiple_of(WIDEST);
        let mut span = 0.0_f32;
        for k in 0..D {
            let local = &mut self.local[k];
            local.clear();
            local.extend(self.points.iter().map(|p| (p[k] - self.centre[k]) as f32));
            span = local.iter().fold(span, |m, c| m.max(c.abs()));
            local.resize(padded, f32::INFINITY);
        }
        self.blur = span * 1e-6 + extent.slack() as f32;
        self.reaches.clear();
        if !self.scales.is_empty() {
            let blur = self.blur;
            self.reaches.extend(self.scales.iter().map(|h| (h * weight_reach * (1.0 + 1e-6)) as f32 + blur));
            self.reaches.resize(padded, 0.0);
        }
    }
}

/// Points and a box in single precision. The number of axes is that of the slices, so that this is compiled once for both
/// dimensions.
struct Sieve<'a> {
    local: &'a [&'a [f32]],
    /// One a point, or empty where `reach` holds for all.
    reaches: &'a [f32],
    reach: f32,
    low: &'a [f32],
    high: &'a [f32],
}

impl Sieve<'_> {
    /// Writes the places of all points within reach of the box to `out`, in order, and returns how many they are.
    fn sift(&self, level: Level, out: &mut [u32]) -> usize {
        dispatch!(level, simd => self.sift_lanes(simd, out))
    }

    #[inline(always)]
    fn sift_lanes<S: Simd>(&self, simd: S, out: &mut [u32]) -> usize {
        let width = S::f32s::LEN;
        let zero = S::f32s::splat(simd, 0.0);
        let uniform = S::f32s::splat(simd, self.reach * self.reach);
        let steps = S::u32s::from_fn(simd, |i| i as u32);
        let points = self.local.first().map_or(0, |axis| axis.len());
        let mut count = 0;
        for begin in (0..points).step_by(width) {
            let mut distance = zero;
            for ((axis, &low), &high) in self.local.iter().zip(self.low).zip(self.high) {
                let x = S::f32s::from_slice(simd, &axis[begin..begin + width]);
                let outside = (S::f32s::splat(simd, low) - x).max(x - S::f32s::splat(simd, high)).max(zero);
                distance += outside * outside;
            }
            let limit = match self.reaches.get(begin..begin + width) {
                Some(reaches) => {
                    let reach = S::f32s::from_slice(simd, reaches);
                    reach * reach
                }
                None => uniform,
            };
            let near = distance.simd_le(limit);
            let places = (steps + S::u32s::splat(simd, begin as u32)).compress(near);
            if let Some(out) = out.get_mut(count..count + width) {
                places.store_slice(out);
            }
            count += near.to_bitmask().count_ones() as usize;
        }
        count
    }
}
