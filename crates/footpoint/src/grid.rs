//! The index: samples in canonical order, in cells of global grids, one grid per power of two of the support.

use crate::algebra::{compare, exponent};
use crate::cloud::Cloud;
use crate::run::Run;
use crate::support::Radii;
use std::cmp::Ordering;
use std::ops::Range;

/// Samples whose scaled coordinates are larger than this cannot be told apart within a support: doubles are too
/// coarse there. They count as absent.
pub(crate) const LARGEST_COORDINATE: f64 = (1_u64 << 50) as f64;

/// Samples in canonical order, in units of `unit`: a power of two with unit ≤ largest support < 2 unit.
///
/// The order depends on the samples alone: level by level (finest first), in each level cell by cell (row-major on a
/// grid that is fixed in space), in each cell by content. Every list of candidates keeps it, so every sum
/// adds in the same order whatever the input order, the batch or the number of threads.
#[derive(Debug)]
pub(crate) struct Grid<const D: usize> {
    pub(crate) unit: f64,
    pub(crate) points: Vec<[f64; D]>,
    /// h_i in units of `unit`; empty if all are `uniform_scale`.
    pub(crate) scales: Vec<f64>,
    pub(crate) uniform_scale: f64,
    /// Empty if every factor is one.
    pub(crate) factors: Vec<f64>,
    /// Zero where absent; empty if the cloud has none.
    pub(crate) normals: Vec<[f64; D]>,
    /// Which sample of the cloud each one is.
    original: Vec<u32>,
    levels: Vec<Level<D>>,
}

/// The samples whose support lies in one power of two.
#[derive(Debug)]
struct Level<const D: usize> {
    /// Cell side: twice the power of two, so a support reaches into neighbouring cells only.
    side: f64,
    /// Largest support radius here.
    reach: f64,
    cells: Cells<D>,
}

struct Entry<const D: usize> {
    level: i32,
    cell: [i64; D],
    point: [f64; D],
    sample: u32,
}

fn cell_of<const D: usize>(point: [f64; D], side: f64) -> [i64; D] {
    // Clamped, so that differences of cells stay in range where a support is tiny and a coordinate huge.
    const FARTHEST: f64 = (1_u64 << 61) as f64;
    point.map(|c| (c / side).floor().clamp(-FARTHEST, FARTHEST) as i64)
}

/// Row-major: the last axis counts most.
fn compare_cells<const D: usize>(a: [i64; D], b: [i64; D]) -> Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

impl<const D: usize> Grid<D> {
    /// Indexes the samples that are present. `reach` is the weight's support in units of h, `largest` the largest h.
    pub(crate) fn new(cloud: &Cloud<D>, radii: &Radii, largest: f64, reach: f64, run: &Run<'_>) -> Self {
        let unit = 2.0_f64.powi(exponent(largest * reach).clamp(-1000, 1000));
        let inverse = 1.0 / unit;
        let mut entries: Vec<Entry<D>> = (0..cloud.len())
            .filter_map(|i| {
                let radius = radii.of(cloud, i)? * inverse * reach;
                let point = cloud.points()[i].map(|c| c * inverse);
                let level = exponent(radius);
                let representable = point.iter().all(|c| c.abs() < LARGEST_COORDINATE);
                representable.then(|| Entry {
                    level,
                    cell: cell_of(point, side_of(level)),
                    point,
                    sample: i as u32,
                })
            })
            .collect();

        let content = |i: u32| {
            let i = i as usize;
            let normal = cloud.normals().map_or([0.0; D], |n| n[i]);
            let factor = cloud.factors().map_or(1.0, |f| f[i]);
            (radii.of(cloud, i).unwrap_or(0.0), factor, normal)
        };
        run.sort(&mut entries, |a, b| {
            a.level
                .cmp(&b.level)
                .then_with(|| compare_cells(a.cell, b.cell))
                .then_with(|| compare(a.point, b.point))
                .then_with(|| {
                    let ((ha, fa, na), (hb, fb, nb)) = (content(a.sample), content(b.sample));
                    ha.total_cmp(&hb).then(fa.total_cmp(&fb)).then_with(|| compare(na, nb))
                })
        });

        let sample = |e: &Entry<D>| e.sample as usize;
        let scales: Vec<f64> = match radii {
            Radii::Uniform(_) => Vec::new(),
            Radii::PerSample(h) => entries.iter().map(|e| h[sample(e)] * inverse).collect(),
        };
        let uniform_scale = largest * inverse;
        let column = |values: Option<&[f64]>| {
            values.map_or(Vec::new(), |v| entries.iter().map(|e| v[sample(e)]).collect())
        };
        let factors = column(cloud.factors());
        let normals = cloud.normals().map_or(Vec::new(), |n| {
            let absent_as_zero = |n: [f64; D]| if n[0].is_nan() { [0.0; D] } else { n };
            entries.iter().map(|e| absent_as_zero(n[sample(e)])).collect()
        });

        let mut levels = Vec::new();
        let mut begin = 0;
        for group in entries.chunk_by(|a, b| a.level == b.level) {
            let range = begin..begin + group.len();
            let largest = match scales.get(range.clone()) {
                Some(own) if !own.is_empty() => own.iter().fold(0.0, |m: f64, &h| m.max(h)),
                _ => uniform_scale,
            };
            let cells = Cells::new(group, begin);
            levels.push(Level { side: side_of(group[0].level), reach: largest * reach, cells });
            begin = range.end;
        }
        let points = entries.iter().map(|e| e.point).collect();
        let original = entries.iter().map(|e| e.sample).collect();
        Self { unit, points, scales, uniform_scale, factors, normals, original, levels }
    }

    /// Cell side of the level with most samples, in units of `unit`: queries are grouped by it.
    pub(crate) fn typical_side(&self) -> f64 {
        let count = |level: &&Level<D>| level.cells.len();
        self.levels.iter().max_by_key(count).map_or(2.0, |level| level.side)
    }

    /// The samples as queries, grouped by the cells they are in: no second search. The order names places in the grid.
    pub(crate) fn group_samples(&self) -> (Vec<u32>, Vec<Group>) {
        let mut grouping = Grouping::of(&self.points);
        for level in &self.levels {
            let cells = &level.cells;
            // Cells of a level are few against its samples, so sorting them costs little.
            let mut wide: Vec<([i64; D], u32)> =
                (0..cells.along.len()).map(|i| (self.wide_cell(level, i), i as u32)).collect();
            wide.sort_unstable_by(|a, b| compare_cells(a.0, b.0).then(a.1.cmp(&b.1)));
            for cell in wide.chunk_by(|a, b| a.0 == b.0) {
                grouping.add(
                    cell.iter().flat_map(|&(_, i)| cells.begins[i as usize]..cells.begins[i as usize + 1]),
                );
            }
        }
        (grouping.order, grouping.groups)
    }

    /// The wide cell that holds the `i`-th cell of a level.
    fn wide_cell(&self, level: &Level<D>, i: usize) -> [i64; D] {
        cell_of(self.points[level.cells.begins[i] as usize], level.side * WIDE)
    }

    /// Which sample of the cloud each one is.
    pub(crate) fn original(&self) -> &[u32] {
        &self.original
    }

    /// Calls `visit` with ranges of samples, in canonical order, that contain every sample whose support meets the
    /// box between `low` and `high`; `reach` of the level is given with each range.
    pub(crate) fn visit(&self, low: [f64; D], high: [f64; D], mut visit: impl FnMut(Range<usize>, f64)) {
        // Corners of a box at large coordinates are rounded; one unit in the last place more loses nothing.
        let largest = low.iter().chain(&high).fold(0.0_f64, |m, c| m.max(c.abs()));
        let slack = 4.0 * f64::EPSILON * largest;
        for level in &self.levels {
            let margin = level.reach * (1.0 + 1e-12) + slack;
            let first = cell_of(low.map(|c| c - margin), level.side);
            let last = cell_of(high.map(|c| c + margin), level.side);
            level.cells.visit(first, last, |range| visit(range, level.reach));
        }
    }
}

/// Side of the cells for supports between 2^level and 2^(level + 1).
fn side_of(level: i32) -> f64 {
    2.0_f64.powi(level + 1)
}

/// Side of the cells of the grid for one support radius, in the same unit.
pub(crate) fn cell_side(radius: f64) -> f64 {
    side_of(exponent(radius))
}

/// Occupied cells of one level: rows along the first axis, found through a table or by bisection.
#[derive(Debug)]
struct Cells<const D: usize> {
    /// Position along the first axis, and where the cell's samples begin; one more entry ends the last.
    along: Vec<i64>,
    begins: Vec<u32>,
    rows: Rows,
    /// Range of rows in each of the other axes (the third is 0 in two dimensions).
    first_row: [i64; 2],
    last_row: [i64; 2],
}

/// Where each row's cells begin in `along`.
#[derive(Debug)]
enum Rows {
    /// One entry for every row of the bounding rectangle.
    Dense(Vec<u32>),
    /// Occupied rows only, in order: outliers can make the rectangle huge.
    Sparse { rows: Vec<[i64; 2]>, begins: Vec<u32> },
}

/// A table of rows may be this many times longer than the list of cells.
const DENSE_SHARE: usize = 4;

fn row_of<const D: usize>(cell: [i64; D]) -> [i64; 2] {
    // From the slowest axis to the faster one, so that rows compare as arrays.
    if D == 3 { [cell[D - 1], cell[1]] } else { [0, cell[1]] }
}

impl<const D: usize> Cells<D> {
    fn new(entries: &[Entry<D>], offset: usize) -> Self {
        let (mut along, mut begins) = (Vec::new(), Vec::new());
        let (mut rows, mut row_begins) = (Vec::new(), Vec::new());
        let mut begin = offset;
        for cell in entries.chunk_by(|a, b| a.cell == b.cell) {
            let row = row_of(cell[0].cell);
            if rows.last() != Some(&row) {
                rows.push(row);
                row_begins.push(along.len() as u32);
            }
            along.push(cell[0].cell[0]);
            begins.push(begin as u32);
            begin += cell.len();
        }
        begins.push(begin as u32);
        row_begins.push(along.len() as u32);

        let bound = |axis: usize| {
            let axis = rows.iter().map(|row| row[axis]);
            axis.fold((i64::MAX, i64::MIN), |(low, high), r| (low.min(r), high.max(r)))
        };
        let ((first0, last0), (first1, last1)) = (bound(0), bound(1));
        let width = (last1 - first1 + 1) as usize;
        let area = width.saturating_mul((last0 - first0 + 1) as usize);
        let rows = if area <= DENSE_SHARE * along.len() + 1024 {
            let mut table = vec![0; area + 1];
            let mut next = 0;
            for (row, &cells_begin) in rows.iter().zip(&row_begins) {
                let place = (row[0] - first0) as usize * width + (row[1] - first1) as usize;
                table[next..=place].fill(cells_begin);
                next = place + 1;
            }
            table[next..].fill(along.len() as u32);
            Rows::Dense(table)
        } else {
            Rows::Sparse { rows, begins: row_begins }
        };
        Self { along, begins, rows, first_row: [first0, first1], last_row: [last0, last1] }
    }

    fn len(&self) -> usize {
        (self.begins[self.begins.len() - 1] - self.begins[0]) as usize
    }

    /// Ranges of samples in the cells between two corners, in canonical order.
    fn visit(&self, first: [i64; D], last: [i64; D], mut visit: impl FnMut(Range<usize>)) {
        let (low, high) = (row_of(first), row_of(last));
        let low = [low[0].max(self.first_row[0]), low[1].max(self.first_row[1])];
        let high = [high[0].min(self.last_row[0]), high[1].min(self.last_row[1])];
        let mut in_row = |cells: Range<u32>| {
            let cells = cells.start as usize..cells.end as usize;
            let along = &self.along[cells.clone()];
            let from = cells.start + along.partition_point(|&x| x < first[0]);
            let to = from + self.along[from..cells.end].partition_point(|&x| x <= last[0]);
            if from < to {
                visit(self.begins[from] as usize..self.begins[to] as usize);
            }
        };
        match &self.rows {
            Rows::Dense(table) => {
                let width = self.last_row[1] - self.first_row[1] + 1;
                for slow in low[0]..=high[0] {
                    for fast in low[1]..=high[1] {
                        let place =
                            ((slow - self.first_row[0]) * width + (fast - self.first_row[1])) as usize;
                        in_row(table[place]..table[place + 1]);
                    }
                }
            }
            Rows::Sparse { rows, begins } => {
                let mut at = rows.partition_point(|row| *row < low);
                while at < rows.len() && rows[at] <= high {
                    let row = rows[at];
                    if row[1] < low[1] {
                        at += rows[at..].partition_point(|other| *other < [row[0], low[1]]);
                    } else if row[1] > high[1] {
                        at += rows[at..].partition_point(|other| *other < [row[0] + 1, low[1]]);
                    } else {
                        in_row(begins[at]..begins[at + 1]);
                        at += 1;
                    }
                }
            }
        }
    }
}

/// Nearby positions: what their blocks need is gathered once.
#[derive(Debug)]
pub(crate) struct Group {
    /// Range of the order.
    pub(crate) points: Range<usize>,
    /// Its blocks, ranges of the order too.
    pub(crate) blocks: Vec<Range<usize>>,
}

/// Queries are grouped inside cells this many times wider than the grid's, so that few blocks stay half empty.
const WIDE: f64 = 4.0;
/// Most positions of a group.
const GROUP: usize = 64;
/// Most positions of a block: the lanes of the widest vector unit.
pub(crate) const BLOCK: usize = 8;

/// Groups in the making.
struct Grouping<'p, const D: usize> {
    points: &'p [[f64; D]],
    order: Vec<u32>,
    groups: Vec<Group>,
}

impl<'p, const D: usize> Grouping<'p, D> {
    fn of(points: &'p [[f64; D]]) -> Self {
        Self { points, order: Vec::with_capacity(points.len()), groups: Vec::new() }
    }

    /// Halves the members of a cell into groups, and each group into blocks.
    fn add(&mut self, members: impl Iterator<Item = u32>) {
        let begin = self.order.len();
        self.order.extend(members);
        let mut ranges = Vec::new();
        halve(self.points, &mut self.order[begin..], begin, GROUP, &mut ranges);
        for points in ranges {
            let mut blocks = Vec::with_capacity(GROUP / BLOCK);
            halve(self.points, &mut self.order[points.clone()], points.start, BLOCK, &mut blocks);
            self.groups.push(Group { points, blocks });
        }
    }
}

/// Groups positions so that near ones stand together: by wide cells, then by halving.
///
/// Returns the order and the groups. Positions that are not representable make the last ones.
pub(crate) fn group<const D: usize>(points: &[[f64; D]], side: f64, run: &Run<'_>) -> (Vec<u32>, Vec<Group>) {
    let key = |point: [f64; D]| {
        let usable = point.iter().all(|c| c.abs() < LARGEST_COORDINATE);
        if usable { cell_of(point, side * WIDE) } else { [i64::MAX; D] }
    };
    let mut keyed: Vec<([i64; D], u32)> =
        points.iter().enumerate().map(|(i, &p)| (key(p), i as u32)).collect();
    run.sort(&mut keyed, |a, b| compare_cells(a.0, b.0).then(a.1.cmp(&b.1)));
    let mut grouping = Grouping::of(points);
    for cell in keyed.chunk_by(|a, b| a.0 == b.0) {
        grouping.add(cell.iter().map(|entry| entry.1));
    }
    (grouping.order, grouping.groups)
}

/// Halves along the longest axis until a group is small enough.
fn halve<const D: usize>(
    points: &[[f64; D]],
    members: &mut [u32],
    offset: usize,
    most: usize,
    blocks: &mut Vec<Range<usize>>,
) {
    if members.len() <= most {
        blocks.push(offset..offset + members.len());
        return;
    }
    let mut longest = (0, -1.0);
    for axis in 0..D {
        let coordinates = members.iter().map(|&i| points[i as usize][axis]);
        let (low, high) = coordinates.fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(c), h.max(c)));
        if high - low > longest.1 {
            longest = (axis, high - low);
        }
    }
    let middle = (members.len() / 2).next_multiple_of(most).min(members.len() - 1);
    members.select_nth_unstable_by(middle, |&a, &b| {
        points[a as usize][longest.0].total_cmp(&points[b as usize][longest.0])
    });
    let (left, right) = members.split_at_mut(middle);
    halve(points, left, offset, most, blocks);
    halve(points, right, offset + middle, most, blocks);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Random;

    fn random_cloud<const D: usize>(count: usize, extent: f64, seed: u64) -> Vec<[f64; D]> {
        let mut random = Random::new(seed);
        (0..count).map(|_| std::array::from_fn(|_| extent * (random.uniform() - 0.5))).collect()
    }

    /// Every sample in reach of the box is visited once, in canonical order.
    fn check<const D: usize>(points: Vec<[f64; D]>, radii: Radii, largest: f64) {
        let cloud = Cloud::new(points);
        let grid = Grid::new(&cloud, &radii, largest, 1.0, &Run::new());
        let mut random = Random::new(9);
        for _ in 0..200 {
            let centre = grid.points[(random.uniform() * grid.points.len() as f64) as usize];
            let low = centre.map(|c| c - random.uniform());
            let high = centre.map(|c| c + random.uniform());
            let mut seen = vec![0; grid.points.len()];
            let mut last = 0;
            grid.visit(low, high, |range, _| {
                assert!(range.start >= last);
                last = range.end;
                for i in range {
                    seen[i] += 1;
                }
            });
            for (i, p) in grid.points.iter().enumerate() {
                let scale = grid.scales.get(i).copied().unwrap_or(grid.uniform_scale);
                let near = (0..D).all(|k| p[k] >= low[k] - scale && p[k] <= high[k] + scale);
                assert!(seen[i] == 1 || (seen[i] == 0 && !near));
            }
        }
    }

    #[test]
    fn no_sample_in_reach_is_missed() {
        check(random_cloud::<2>(3000, 40.0, 1), Radii::Uniform(1.3), 1.3);
        check(random_cloud::<3>(3000, 12.0, 2), Radii::Uniform(0.9), 0.9);
        let mut outliers = random_cloud::<3>(500, 6.0, 3);
        outliers.extend([[1e12, 0.0, 3.0], [-1e9, 1e9, 5e11], [1e300, 0.0, 0.0]]);
        check(outliers, Radii::Uniform(1.0), 1.0);
        let mut random = Random::new(4);
        let radii: Vec<f64> = (0..3000).map(|_| 2.0 * (-9.0 * random.uniform()).exp()).collect();
        let largest = radii.iter().fold(0.0, |m: f64, &h| m.max(h));
        check(random_cloud::<3>(3000, 12.0, 5), Radii::PerSample(radii), largest);
    }

    #[test]
    fn the_order_does_not_depend_on_the_input_order() {
        let points = random_cloud::<3>(2000, 10.0, 7);
        let reversed: Vec<_> = points.iter().rev().copied().collect();
        let grid = |p| Grid::new(&Cloud::new(p), &Radii::Uniform(1.1), 1.1, 1.0, &Run::new()).points;
        assert_eq!(grid(points), grid(reversed));
    }

    #[test]
    fn groups_hold_every_position_once_and_stay_small() {
        let mut points = random_cloud::<3>(5000, 10.0, 8);
        points.extend(vec![[1.0; 3]; 100]);
        points.push([f64::NAN; 3]);
        let (mut order, groups) = group(&points, 2.0, &Run::new());
        let blocks: Vec<Range<usize>> = groups.into_iter().flat_map(|g| g.blocks).collect();
        assert!(blocks.iter().all(|b| !b.is_empty() && b.len() <= 8));
        assert_eq!(blocks.iter().map(ExactSizeIterator::len).sum::<usize>(), points.len());
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, &o)| i == o as usize));
    }
}
