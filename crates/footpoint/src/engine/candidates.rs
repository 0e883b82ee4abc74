//! Candidates: the samples around a group of positions, copied together, and of these the ones that a block needs.

use crate::grid::{Grid, Store, Stretch, snapped};
use crate::lane::{Number, vectorized};
use fearless_simd::Level;
use fearless_simd::prelude::*;

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent<const D: usize> {
    pub(crate) low: [f64; D],
    pub(crate) high: [f64; D],
}

impl<const D: usize> Extent<D> {
    pub(crate) const NOTHING: Self = Self { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };

    pub(crate) fn around(points: impl Iterator<Item = [f64; D]>) -> Self {
        let mut extent = Self::NOTHING;
        for x in points {
            for k in 0..D {
                extent.low[k] = if x[k] < extent.low[k] { x[k] } else { extent.low[k] };
                extent.high[k] = if x[k] > extent.high[k] { x[k] } else { extent.high[k] };
            }
        }
        extent
    }

    pub(crate) fn widened(self, margin: f64) -> Self {
        Self { low: self.low.map(|c| c - margin), high: self.high.map(|c| c + margin) }
    }

    pub(crate) fn contains(&self, other: &Self) -> bool {
        (0..D).all(|k| self.low[k] <= other.low[k] && other.high[k] <= self.high[k])
    }

    pub(crate) fn joined(self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| if other.low[k] < self.low[k] { other.low[k] } else { self.low[k] }),
            high: std::array::from_fn(|k| {
                if other.high[k] > self.high[k] { other.high[k] } else { self.high[k] }
            }),
        }
    }

    pub(crate) fn longest_side(&self) -> f64 {
        (0..D).fold(0.0, |m: f64, k| m.max(self.high[k] - self.low[k]))
    }

    /// What the number of samples within reach of the box grows with, on a curve (D = 2) or a surface (3).
    pub(crate) fn samples_around(&self, reach: f64) -> f64 {
        let mut sides: [f64; D] = std::array::from_fn(|k| self.high[k] - self.low[k] + 2.0 * reach);
        sides.sort_unstable_by(|a, b| b.total_cmp(a));
        sides[..D - 1].iter().product()
    }

    fn middle(&self) -> [f64; D] {
        std::array::from_fn(|k| 0.5 * self.low[k] + 0.5 * self.high[k])
    }

    /// More than any rounding of the corners.
    fn slack(&self) -> f64 {
        4.0 * f64::EPSILON * self.low.iter().chain(&self.high).fold(0.0_f64, |m, c| m.max(c.abs()))
    }
}

/// Columns of samples in canonical order, one array an axis, in the numbers that sums are computed in. Optional columns are
/// empty where the mode or the cloud does without.
#[derive(Debug)]
pub(crate) struct Columns<N, const D: usize> {
    /// Coordinates; of 32 bits, relative to the group's centre, and exact.
    pub(crate) points: [Vec<N>; D],
    pub(crate) len: usize,
    /// h where all supports are equal; the largest where not.
    pub(crate) uniform_scale: f64,
    /// h_i, 1/h_i², ω_i and ω_i/h_i²: in general mode.
    pub(crate) scales: Vec<N>,
    pub(crate) inverse: Vec<N>,
    pub(crate) factors: Vec<N>,
    pub(crate) slopes: Vec<N>,
    /// n_i, zero where absent.
    pub(crate) normals: [Vec<N>; D],
    /// As the grid has it.
    pub(crate) noise: Vec<Vec<N>>,
}

impl<N, const D: usize> Columns<N, D> {
    pub(crate) fn has_normals(&self) -> bool {
        !self.normals[0].is_empty()
    }
}

/// The candidates of a group of positions, and what it takes to find those of a batch, and in these those of a block.
#[derive(Debug)]
pub(crate) struct Candidates<N, const D: usize> {
    pub(crate) columns: Columns<N, D>,
    /// All samples of the group.
    group: Culling<D>,
    /// Those near the batch.
    batch: Culling<D>,
    /// The support, where all are equal.
    reach: f32,
    pub(crate) centre: [f64; D],
    covered: Extent<D>,
}

/// Samples as culling sees them, in single precision rounded to the safe side, padded to whole vectors with infinity, which
/// is in no box.
#[derive(Debug)]
struct Culling<const D: usize> {
    /// Relative to the group's centre.
    local: [Vec<f32>; D],
    /// Empty if all supports are equal.
    reaches: Vec<f32>,
    /// Place of each in the columns.
    places: Vec<u32>,
    len: usize,
}

impl<const D: usize> Culling<D> {
    fn new() -> Self {
        let local = std::array::from_fn(|_| Vec::new());
        Self { local, reaches: Vec::new(), places: Vec::new(), len: 0 }
    }

    /// Makes room for this many, and vectors that overlap the end.
    fn reserve(&mut self, count: usize, has_reaches: bool) {
        let room = count.next_multiple_of(WIDEST) + WIDEST;
        if self.places.len() < room {
            self.local.iter_mut().for_each(|local| local.resize(room, 0.0));
            self.places.resize(room, 0);
        }
        let reaches = if has_reaches { self.places.len() } else { 0 };
        self.reaches.resize(reaches, 0.0);
    }

    /// Sets the number of samples, and infinity behind them.
    fn end(&mut self, count: usize) {
        self.len = count;
        for local in &mut self.local {
            local[count..count.next_multiple_of(WIDEST)].fill(f32::INFINITY);
        }
    }
}

/// Lanes of single precision in the widest vector: the padding.
const WIDEST: usize = 16;

/// How positions enter columns of a number.
pub(crate) trait Culled: Number {
    /// Whether positions move away from their anchors.
    const HAS_OFFSETS: bool;
    /// The centre that coordinates may be relative to.
    fn centre(middle: f64) -> f64;
    /// A coordinate relative to the centre.
    fn local(self, centre: f64) -> f32;
    /// Where sums are computed for a position, and the way from there to where it is: single precision moves it to the
    /// lattice. Both depend on the anchor's place on the lattice, not on its size, so that a moved cloud keeps its bits.
    fn taken_at(anchor: f64, offset: f64) -> (f64, f64);
    /// Anchor and offset of a position that is taken at `at`.
    fn place(at: f64, centre: f64, anchor: f64, offset: f64) -> (Self, Self);
}

impl Culled for f64 {
    const HAS_OFFSETS: bool = true;

    fn centre(middle: f64) -> f64 {
        middle
    }

    #[inline(always)]
    fn local(self, centre: f64) -> f32 {
        (self - centre) as f32
    }

    fn place(_: f64, _: f64, anchor: f64, offset: f64) -> (f64, f64) {
        (anchor, offset)
    }

    #[inline(always)]
    fn taken_at(anchor: f64, offset: f64) -> (f64, f64) {
        (anchor + offset, 0.0)
    }
}

impl Culled for f32 {
    const HAS_OFFSETS: bool = false;

    fn centre(middle: f64) -> f64 {
        snapped([middle])[0]
    }

    #[inline(always)]
    fn local(self, _: f64) -> f32 {
        self
    }

    fn place(at: f64, centre: f64, _: f64, _: f64) -> (f32, f32) {
        ((at - centre) as f32, 0.0)
    }

    #[inline(always)]
    fn taken_at(anchor: f64, offset: f64) -> (f64, f64) {
        let [near] = snapped([anchor]);
        let rest = (anchor - near) + offset;
        let [step] = snapped([rest]);
        (near + step, rest - step)
    }
}

impl<N: Culled, const D: usize> Candidates<N, D> {
    /// An empty list that covers nothing.
    pub(crate) fn new() -> Self {
        let axes = || std::array::from_fn(|_| Vec::new());
        let columns = Columns {
            points: axes(),
            len: 0,
            uniform_scale: 1.0,
            scales: Vec::new(),
            inverse: Vec::new(),
            factors: Vec::new(),
            slopes: Vec::new(),
            normals: axes(),
            noise: Vec::new(),
        };
        Self {
            columns,
            group: Culling::new(),
            batch: Culling::new(),
            reach: 0.0,
            centre: [0.0; D],
            covered: Extent::NOTHING,
        }
    }

    pub(crate) fn covers(&self, extent: &Extent<D>) -> bool {
        self.covered.contains(extent)
    }

    /// Collects all samples whose supports meet the box, with the columns of general mode or without.
    pub(crate) fn gather(
        &mut self,
        grid: &Grid<D>,
        extent: Extent<D>,
        weight_reach: f64,
        varied: bool,
        level: Level,
    ) {
        self.covered = extent;
        self.centre = extent.middle().map(N::centre);
        let (columns, centre) = (&mut self.columns, self.centre);
        columns.uniform_scale = grid.uniform_scale;
        columns.points.iter_mut().for_each(Vec::clear);
        columns.normals.iter_mut().for_each(Vec::clear);
        columns.scales.clear();
        columns.factors.clear();
        columns.noise.resize_with(grid.noise.len(), Vec::new);
        columns.noise.iter_mut().for_each(Vec::clear);
        grid.visit(extent.low, extent.high, |stretch| {
            copy_points(&grid.store, &stretch, centre, &mut columns.points);
            let range = stretch.samples();
            let copy = |to: &mut Vec<N>, from: &[f64]| {
                to.extend(from.get(range.clone()).unwrap_or_default().iter().map(|&v| N::of(v)));
            };
            copy(&mut columns.scales, &grid.scales);
            copy(&mut columns.factors, &grid.factors);
            for (to, from) in columns.normals.iter_mut().zip(&grid.normals) {
                copy(to, from);
            }
            for (to, from) in columns.noise.iter_mut().zip(&grid.noise) {
                copy(to, from);
            }
        });
        columns.len = columns.points[0].len();
        if varied {
            self.complete(grid);
        }
        self.prepare_culling(grid, weight_reach, level);
    }

    /// The columns of general mode.
    fn complete(&mut self, grid: &Grid<D>) {
        let columns = &mut self.columns;
        let Columns { len, scales, inverse, factors, slopes, .. } = columns;
        scales.resize(*len, N::of(grid.uniform_scale));
        factors.resize(*len, N::of(1.0));
        inverse.clear();
        inverse.extend(scales.iter().map(|&h| N::of(1.0 / (h.wide() * h.wide()))));
        slopes.clear();
        slopes.extend(inverse.iter().zip(factors.iter()).map(|(&i, &w)| N::of(i.wide() * w.wide())));
    }

    fn prepare_culling(&mut self, grid: &Grid<D>, weight_reach: f64, level: Level) {
        let half = 0.5 * self.covered.longest_side() + grid.overhang();
        // What single precision may be off by.
        let blur = (half * 1e-6 + self.covered.slack()) as f32;
        let wider = |h: f64| (h * weight_reach * (1.0 + 1e-6)) as f32 + blur;
        self.reach = wider(grid.uniform_scale);
        let count = self.columns.len;
        let group = &mut self.group;
        group.reserve(count, !grid.scales.is_empty());
        for (reach, h) in group.reaches.iter_mut().zip(&self.columns.scales) {
            *reach = wider(h.wide());
        }
        for k in 0..D {
            let (from, to, centre) = (&self.columns.points[k], &mut group.local[k], self.centre[k]);
            vectorized!(level, _simd => recentre(from, centre, to));
        }
        for (i, place) in group.places.iter_mut().enumerate() {
            *place = i as u32;
        }
        group.end(count);
    }

    /// Appends the places of the samples whose supports meet each box, in order, and the ends of the lists. The boxes are
    /// those of one batch.
    pub(crate) fn sift(
        &mut self,
        boxes: &[Extent<D>],
        level: Level,
        places: &mut Vec<u32>,
        ends: &mut Vec<usize>,
    ) {
        let has_reaches = !self.group.reaches.is_empty();
        let all = boxes.iter().fold(Extent::NOTHING, |all, extent| all.joined(extent));
        self.batch.reserve(self.group.len, has_reaches);
        let sieve = self.sieve(&self.group, &all);
        let mut local = self.batch.local.each_mut().map(Vec::as_mut_slice);
        let out =
            Sifted { places: &mut self.batch.places, reaches: &mut self.batch.reaches, local: &mut local };
        let count = sieve.sift(level, out);
        self.batch.end(count);
        let mut end = 0;
        for extent in boxes {
            let room = end + self.batch.len.next_multiple_of(WIDEST) + WIDEST;
            if places.len() < room {
                places.resize(room, 0);
            }
            let out = Sifted { places: &mut places[end..], reaches: &mut [], local: &mut [] };
            end += self.sieve(&self.batch, extent).sift(level, out);
            ends.push(end);
        }
    }

    fn sieve<'c>(&self, culling: &'c Culling<D>, extent: &Extent<D>) -> Sieve<'c> {
        let relative = |corner: [f64; D]| -> [f32; 3] {
            let mut relative = [0.0; 3];
            for k in 0..D {
                relative[k] = (corner[k] - self.centre[k]) as f32;
            }
            relative
        };
        let mut local: [&[f32]; 3] = [&[]; 3];
        for (slice, column) in local.iter_mut().zip(&culling.local) {
            *slice = column;
        }
        Sieve {
            dimension: D,
            local,
            reaches: &culling.reaches,
            places: &culling.places,
            len: culling.len,
            reach: self.reach,
            low: relative(extent.low),
            high: relative(extent.high),
        }
    }
}

/// Appends the coordinates of the samples in consecutive cells.
fn copy_points<N: Number, const D: usize>(
    store: &Store<D>,
    stretch: &Stretch<'_, D>,
    centre: [f64; D],
    points: &mut [Vec<N>; D],
) {
    match store {
        Store::Double(columns) => {
            for (to, from) in points.iter_mut().zip(columns) {
                to.extend(from[stretch.samples()].iter().map(|&c| N::of(c)));
            }
        }
        Store::Single(columns) => {
            for (corner, samples) in stretch.cells() {
                for k in 0..D {
                    // Cells begin farther out than the samples that matter lie: only the sum is short enough for 24 bits.
                    let shift = corner[k] - centre[k];
                    points[k]
                        .extend(columns[k][samples.clone()].iter().map(|&c| N::of(f64::from(c) + shift)));
                }
            }
        }
    }
}

/// Coordinates relative to a centre, in single precision.
#[inline(always)]
fn recentre<N: Culled>(from: &[N], centre: f64, to: &mut [f32]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = from.local(centre);
    }
}

/// Samples and a box in single precision. The dimension is a number, so that this is compiled once, with the library.
struct Sieve<'a> {
    dimension: usize,
    local: [&'a [f32]; 3],
    /// One a sample, or empty where `reach` holds for all.
    reaches: &'a [f32],
    places: &'a [u32],
    len: usize,
    reach: f32,
    low: [f32; 3],
    high: [f32; 3],
}

/// What passes a sieve: places, and where they are to be sifted again, coordinates and radii.
struct Sifted<'o, 'c> {
    places: &'o mut [u32],
    reaches: &'o mut [f32],
    local: &'o mut [&'c mut [f32]],
}

impl Sieve<'_> {
    /// Hands on all samples within reach of the box, in order, and returns how many they are.
    fn sift(&self, level: Level, out: Sifted<'_, '_>) -> usize {
        let mut count = 0;
        vectorized!(level, simd => {
            count = match (self.dimension, out.local.is_empty()) {
                (2, true) => self.sift_lanes::<_, 2, false>(simd, out),
                (2, false) => self.sift_lanes::<_, 2, true>(simd, out),
                (_, true) => self.sift_lanes::<_, 3, false>(simd, out),
                (_, false) => self.sift_lanes::<_, 3, true>(simd, out),
            };
        });
        count
    }

    #[inline(always)]
    fn sift_lanes<S: Simd, const D: usize, const AGAIN: bool>(&self, simd: S, out: Sifted<'_, '_>) -> usize {
        let width = S::f32s::LEN;
        let zero = S::f32s::splat(simd, 0.0);
        let uniform = S::f32s::splat(simd, self.reach * self.reach);
        let low: [S::f32s; D] = std::array::from_fn(|k| S::f32s::splat(simd, self.low[k]));
        let high: [S::f32s; D] = std::array::from_fn(|k| S::f32s::splat(simd, self.high[k]));
        let padded = self.len.next_multiple_of(WIDEST);
        let local: [&[f32]; D] = std::array::from_fn(|k| &self.local[k][..padded]);
        let places = &self.places[..padded];
        let mut count = 0;
        for begin in (0..padded).step_by(width) {
            let mut distance = zero;
            let x: [S::f32s; D] =
                std::array::from_fn(|k| S::f32s::from_slice(simd, &local[k][begin..begin + width]));
            for k in 0..D {
                let outside = (low[k] - x[k]).max(x[k] - high[k]).max(zero);
                distance = outside.mul_add(outside, distance);
            }
            let reaches =
                self.reaches.get(begin..begin + width).map(|reaches| S::f32s::from_slice(simd, reaches));
            let limit = reaches.map_or(uniform, |reach| reach * reach);
            let near = distance.simd_le(limit);
            let end = count + width;
            S::u32s::from_slice(simd, &places[begin..begin + width])
                .compress(near)
                .store_slice(&mut out.places[count..end]);
            if AGAIN {
                for k in 0..D {
                    x[k].compress(near).store_slice(&mut out.local[k][count..end]);
                }
                if let Some(reaches) = reaches {
                    reaches.compress(near).store_slice(&mut out.reaches[count..end]);
                }
            }
            count += near.to_bitmask().count_ones() as usize;
        }
        count
    }
}
