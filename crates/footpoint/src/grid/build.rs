//! Building the index: keys, one sort, columns.

use super::{
    Cells, Grid, Level, Store, cell_of, compare_cells, group::group_samples, is_held, side_of, snapped,
};
use crate::algebra::{compare, exponent};
use crate::cloud::Cloud;
use crate::lane::Precision;
use crate::run::Run;
use crate::support::Radii;
use std::cmp::Ordering;
use std::ops::Range;

/// What the sort sees of a sample. What it does not decide is looked up in the cloud.
#[derive(Clone, Copy)]
struct Entry {
    /// Level and cell, as far as they fit.
    key: u64,
    /// The first coordinate, as a number that orders like it.
    along: i64,
    sample: u32,
}

/// The cells that the samples of one level lie in, and how they are packed into a key.
struct Packing<const D: usize> {
    level: i32,
    first: [i64; D],
    bits: [u32; D],
}

/// Bits of a key for the cell; the others are for the level: radii differ by less than 2^200.
const CELL_BITS: u32 = 56;

impl<const D: usize> Packing<D> {
    /// Axes from the slowest on, as many as fit in full.
    fn pack(&self, cell: [i64; D]) -> u64 {
        let mut left = CELL_BITS;
        let mut key = 0;
        for k in (0..D).rev() {
            if self.bits[k] > left {
                break;
            }
            left -= self.bits[k];
            key = (key << self.bits[k]) | (cell[k] - self.first[k]) as u64;
        }
        key << left
    }

    /// Whether different cells have different keys.
    fn is_exact(&self) -> bool {
        self.bits.iter().sum::<u32>() <= CELL_BITS
    }
}

/// A number that orders like x; zeros of either sign are equal.
fn ordered(x: f64) -> i64 {
    let bits = (x + 0.0).to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

/// The cloud as the index sees it.
struct Samples<'a, const D: usize> {
    cloud: &'a Cloud<D>,
    radii: &'a Radii,
    inverse: f64,
    reach: f64,
    precision: Precision,
}

impl<const D: usize> Samples<'_, D> {
    /// In units of the grid.
    fn point(&self, sample: u32) -> [f64; D] {
        let point = self.cloud.points()[sample as usize].map(|c| c * self.inverse);
        match self.precision {
            Precision::Double => point,
            Precision::Single => snapped(point),
        }
    }

    /// The power of two of the support, if the sample takes part.
    fn level(&self, sample: usize) -> Option<i32> {
        let radius = self.radii.of(self.cloud, sample)? * self.inverse * self.reach;
        let holds = is_held(self.cloud.points()[sample].map(|c| c * self.inverse), self.precision);
        holds.then(|| exponent(radius))
    }

    /// The canonical order of two samples of one key.
    fn compare(&self, packings: &[Packing<D>], a: &Entry, b: &Entry) -> Ordering {
        let packing = &packings[(a.key >> CELL_BITS) as usize];
        let cell = |e: &Entry| cell_of(self.point(e.sample), side_of(packing.level));
        let cells = if packing.is_exact() { Ordering::Equal } else { compare_cells(cell(a), cell(b)) };
        cells.then(a.along.cmp(&b.along)).then_with(|| {
            let content = |e: &Entry| {
                let i = e.sample as usize;
                let normal = self.cloud.normals().map_or([0.0; D], |n| n[i]);
                let factor = self.cloud.factors().map_or(1.0, |f| f[i]);
                (self.cloud.points()[i], self.radii.of(self.cloud, i).unwrap_or(0.0), factor, normal)
            };
            let ((pa, ha, fa, na), (pb, hb, fb, nb)) = (content(a), content(b));
            compare(pa, pb)
                .then(ha.total_cmp(&hb))
                .then(fa.total_cmp(&fb))
                .then_with(|| compare(na, nb))
                .then_with(|| self.compare_noise(a.sample as usize, b.sample as usize))
        })
    }

    fn compare_noise(&self, a: usize, b: usize) -> Ordering {
        let Some(noise) = self.cloud.noise() else { return Ordering::Equal };
        (0..noise.columns())
            .map(|column| noise.entry(a, column).total_cmp(&noise.entry(b, column)))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    }

    /// The levels that occur, ascending, with the bounds of their cells.
    fn packings(&self, run: &Run<'_>) -> Vec<Packing<D>> {
        let count = self.cloud.len();
        let mut parts: Vec<(Range<usize>, Bounds<D>)> = (0..count)
            .step_by(BOUNDS_AT_A_TIME)
            .map(|begin| (begin..count.min(begin + BOUNDS_AT_A_TIME), Bounds::default()))
            .collect();
        run.for_each(&mut parts, |(range, bounds)| {
            for i in range.clone() {
                if let Some(level) = self.level(i) {
                    let point = self.point(i as u32);
                    bounds.include(level, point, point);
                }
            }
        });
        let mut all = Bounds::default();
        for (level, low, high) in parts.into_iter().flat_map(|(_, bounds)| bounds.0) {
            all.include(level, low, high);
        }
        all.0.sort_unstable_by_key(|b| b.0);
        let packing = |&(level, low, high): &(i32, [f64; D], [f64; D])| {
            let (first, last) = (cell_of(low, side_of(level)), cell_of(high, side_of(level)));
            let bits = std::array::from_fn(|k| 64 - (last[k] - first[k]).leading_zeros());
            Packing { level, first, bits }
        };
        all.0.iter().map(packing).collect()
    }
}

/// Samples whose bounds one thread finds in one go.
const BOUNDS_AT_A_TIME: usize = 1 << 14;

/// The levels that occur, with the box around the samples of each.
#[derive(Default)]
struct Bounds<const D: usize>(Vec<(i32, [f64; D], [f64; D])>);

impl<const D: usize> Bounds<D> {
    fn include(&mut self, level: i32, low: [f64; D], high: [f64; D]) {
        let Some((_, lowest, highest)) = self.0.iter_mut().find(|b| b.0 == level) else {
            self.0.push((level, low, high));
            return;
        };
        for k in 0..D {
            lowest[k] = lowest[k].min(low[k]);
            highest[k] = highest[k].max(high[k]);
        }
    }
}

impl<const D: usize> Grid<D> {
    /// Indexes the samples that are present. `reach` is the weight's support in units of h, `largest` the largest h.
    pub(crate) fn new(
        cloud: &Cloud<D>,
        radii: &Radii,
        largest: f64,
        reach: f64,
        precision: Precision,
        run: &Run<'_>,
    ) -> Self {
        let unit = 2.0_f64.powi(exponent(largest * reach).clamp(-1000, 1000));
        let inverse = 1.0 / unit;
        let samples = Samples { cloud, radii, inverse, reach, precision };
        let packings = samples.packings(run);
        let entries = sorted(&samples, &packings, run);

        let len = entries.len();
        let sample = |i: usize| entries[i].sample as usize;
        let scales: Vec<f64> = match radii {
            Radii::Uniform(_) => Vec::new(),
            Radii::PerSample(h) => run.collect(len, |i| h[sample(i)] * inverse),
        };
        let uniform_scale = largest * inverse;
        let factors = cloud.factors().map_or(Vec::new(), |f| run.collect(len, |i| f[sample(i)]));
        let normals = std::array::from_fn(|k| {
            let absent_as_zero = |n: [f64; D]| if n[0].is_nan() { 0.0 } else { n[k] };
            cloud.normals().map_or(Vec::new(), |n| run.collect(len, |i| absent_as_zero(n[sample(i)])))
        });
        let noise = cloud.noise().map_or(Vec::new(), |noise| {
            let entry =
                |column: usize| run.collect(len, |i| noise.entry(sample(i), column) * (inverse * inverse));
            (0..noise.columns()).map(entry).collect()
        });
        let points = run.collect(len, |i| samples.point(entries[i].sample));
        let original = run.collect(len, |i| entries[i].sample);

        let mut levels = Vec::new();
        let mut begin = 0;
        for level in entries.chunk_by(|a, b| a.key >> CELL_BITS == b.key >> CELL_BITS) {
            let range = begin..begin + level.len();
            begin = range.end;
            let largest = match scales.get(range.clone()) {
                Some(own) if !own.is_empty() => own.iter().fold(0.0, |m: f64, &h| m.max(h)),
                _ => uniform_scale,
            };
            let packing = &packings[(level[0].key >> CELL_BITS) as usize];
            let side = side_of(packing.level);
            let cell = |i: usize| cell_of(points[i], side);
            let opens = |i: usize| {
                let new = |before: usize| {
                    let same_key = entries[i].key == entries[before].key;
                    !(same_key && (packing.is_exact() || cell(i) == cell(before)))
                };
                i == range.start || new(i - 1)
            };
            let begins = run.collect_some(range.len(), |i| {
                let i = range.start + i;
                opens(i).then_some(i as u32)
            });
            let cells = Cells::new(begins, range.end, cell);
            levels.push(Level { side, reach: largest * reach, cells });
        }
        drop(entries);
        let groups = group_samples(&levels, |i| points[i as usize], run);
        let store = match precision {
            Precision::Double => Store::Double(std::array::from_fn(|k| run.collect(len, |i| points[i][k]))),
            Precision::Single => Store::Single(std::array::from_fn(|k| {
                let mut column = Vec::with_capacity(len);
                for level in &levels {
                    let own = &points[level.cells.samples()];
                    column.extend(run.collect(own.len(), |i| {
                        let corner = cell_of(own[i], level.side)[k] as f64 * level.side;
                        (own[i][k] - corner) as f32
                    }));
                }
                column
            })),
        };
        Self { unit, store, scales, uniform_scale, factors, normals, noise, original, groups, levels }
    }
}

/// The samples that take part, in canonical order.
fn sorted<const D: usize>(samples: &Samples<'_, D>, packings: &[Packing<D>], run: &Run<'_>) -> Vec<Entry> {
    let place = |level: i32| packings.iter().position(|p| p.level == level);
    let entry = |i: usize| {
        let place = place(samples.level(i)?)?;
        let packing = &packings[place];
        let point = samples.point(i as u32);
        let cell = packing.pack(cell_of(point, side_of(packing.level)));
        let key = ((place as u64) << CELL_BITS) | cell;
        Some(Entry { key, along: ordered(samples.cloud.points()[i][0]), sample: i as u32 })
    };
    let mut entries: Vec<Entry> = run.collect_some(samples.cloud.len(), entry);
    run.sort(&mut entries, |a, b| a.key.cmp(&b.key).then_with(|| samples.compare(packings, a, b)));
    entries
}
