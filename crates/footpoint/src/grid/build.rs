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
            compare(pa, pb).then(ha.total_cmp(&hb)).then(fa.total_cmp(&fb)).then_with(|| compare(na, nb))
        })
    }

    /// The levels that occur, ascending, with the bounds of their cells.
    fn packings(&self) -> Vec<Packing<D>> {
        let mut bounds: Vec<(i32, [f64; D], [f64; D])> = Vec::new();
        for i in 0..self.cloud.len() {
            let Some(level) = self.level(i) else { continue };
            let point = self.point(i as u32);
            let place = match bounds.iter().position(|b| b.0 == level) {
                Some(place) => place,
                None => {
                    bounds.push((level, point, point));
                    bounds.len() - 1
                }
            };
            let (_, low, high) = &mut bounds[place];
            for k in 0..D {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        bounds.sort_unstable_by_key(|b| b.0);
        let packing = |&(level, low, high): &(i32, [f64; D], [f64; D])| {
            let (first, last) = (cell_of(low, side_of(level)), cell_of(high, side_of(level)));
            let bits = std::array::from_fn(|k| 64 - (last[k] - first[k]).leading_zeros());
            Packing { level, first, bits }
        };
        bounds.iter().map(packing).collect()
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
        let packings = samples.packings();
        let entries = sorted(&samples, &packings, run);

        let sample = |e: &Entry| e.sample as usize;
        let scales: Vec<f64> = match radii {
            Radii::Uniform(_) => Vec::new(),
            Radii::PerSample(h) => entries.iter().map(|e| h[sample(e)] * inverse).collect(),
        };
        let uniform_scale = largest * inverse;
        let factors = cloud.factors().map_or(Vec::new(), |f| entries.iter().map(|e| f[sample(e)]).collect());
        let normals = std::array::from_fn(|k| {
            let absent_as_zero = |n: [f64; D]| if n[0].is_nan() { 0.0 } else { n[k] };
            cloud
                .normals()
                .map_or(Vec::new(), |n| entries.iter().map(|e| absent_as_zero(n[sample(e)])).collect())
        });
        let points = run.collect(entries.len(), |i| samples.point(entries[i].sample));
        let original: Vec<u32> = entries.iter().map(|e| e.sample).collect();

        let mut levels = Vec::new();
        let mut begin = 0;
        for level in entries.chunk_by(|a, b| a.key >> CELL_BITS == b.key >> CELL_BITS) {
            let range = begin..begin + level.len();
            begin = range.end;
            let largest = match scales.get(range.clone()) {
                Some(own) if !own.is_empty() => own.iter().fold(0.0, |m: f64, &h| m.max(h)),
                _ => uniform_scale,
            };
            let side = side_of(packings[(level[0].key >> CELL_BITS) as usize].level);
            let cells = Cells::new(points[range.clone()].iter().map(|&p| cell_of(p, side)), range.start);
            levels.push(Level { side, reach: largest * reach, cells });
        }
        drop(entries);
        let groups = group_samples(&levels, |i| points[i as usize], run);
        let store = match precision {
            Precision::Double => {
                Store::Double(std::array::from_fn(|k| points.iter().map(|p| p[k]).collect()))
            }
            Precision::Single => Store::Single(std::array::from_fn(|k| {
                let mut column = Vec::with_capacity(points.len());
                for level in &levels {
                    column.extend(points[level.cells.samples()].iter().map(|&p| {
                        let corner = cell_of(p, level.side)[k] as f64 * level.side;
                        (p[k] - corner) as f32
                    }));
                }
                column
            })),
        };
        Self { unit, store, scales, uniform_scale, factors, normals, original, groups, levels }
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
