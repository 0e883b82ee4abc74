//! Groups of near queries, and in them blocks: what a block needs is sought once for all its positions.

use super::{Grid, Level, cell_of, compare_cells};
use crate::run::Run;

/// Queries are grouped inside cells this many times wider than the grid's, so that few blocks stay half empty.
const WIDE: f64 = 8.0;
/// Most positions of a group.
const GROUP: usize = 512;
/// Positions are halved down to this many; blocks are made of one or two such leaves.
const LEAF: usize = 8;

/// Queries in an order in which near ones stand together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    pub(crate) order: Vec<u32>,
    /// Where each group begins in the order, and where the last ends.
    bounds: Vec<u32>,
}

impl Groups {
    pub(crate) fn count(&self) -> usize {
        self.bounds.len().saturating_sub(1)
    }

    /// Where a group's queries stand in the order.
    pub(crate) fn range(&self, group: usize) -> std::ops::Range<usize> {
        self.bounds[group] as usize..self.bounds[group + 1] as usize
    }

    /// From an order in which each wide cell's members are consecutive, with their numbers.
    fn of<const D: usize>(
        mut order: Vec<u32>,
        cells: impl Iterator<Item = usize>,
        point: impl Fn(u32) -> [f64; D] + Sync,
        run: &Run<'_>,
    ) -> Self {
        let mut bounds = vec![0];
        let mut parts = Vec::new();
        let mut rest = order.as_mut_slice();
        let mut end = 0;
        for members in cells {
            let (part, after) = rest.split_at_mut(members);
            parts.push(part);
            rest = after;
            for begin in (0..members).step_by(GROUP) {
                bounds.push((end + (begin + GROUP).min(members)) as u32);
            }
            end += members;
        }
        run.for_each(&mut parts, |part| {
            // The order serves speed alone, and nobody waits for it now.
            if !run.is_cancelled() {
                arrange(part, &point);
            }
        });
        Self { order, bounds }
    }
}

/// The samples of a grid, grouped by the cells they are in. `point` gives the coordinates at a place in the grid.
pub(super) fn group_samples<const D: usize>(
    levels: &[Level<D>],
    point: impl Fn(u32) -> [f64; D] + Sync,
    run: &Run<'_>,
) -> Groups {
    let mut order = Vec::new();
    let mut members = Vec::new();
    for level in levels {
        let begins = level.cells.begins();
        // Cells of a level are few against its samples, so sorting them costs little.
        let wide_cell = |i: usize| cell_of(point(begins[i]), level.side * WIDE);
        let mut wide: Vec<([i64; D], u32)> =
            (0..begins.len() - 1).map(|i| (wide_cell(i), i as u32)).collect();
        wide.sort_unstable_by(|a, b| compare_cells(a.0, b.0).then(a.1.cmp(&b.1)));
        for cell in wide.chunk_by(|a, b| a.0 == b.0) {
            let before = order.len();
            order.extend(cell.iter().flat_map(|&(_, i)| begins[i as usize]..begins[i as usize + 1]));
            members.push(order.len() - before);
        }
    }
    Groups::of(order, members.into_iter(), point, run)
}

/// Groups foreign points, given in the unit of the cloud: by wide cells, then by halving. Points that the grid does not hold make the last groups.
pub(crate) fn group<const D: usize>(points: &[[f64; D]], grid: &Grid<D>, run: &Run<'_>) -> Groups {
    let inverse = 1.0 / grid.unit;
    let side = grid.typical_side() * WIDE;
    let mut keyed: Vec<([i64; D], u32)> = run.collect(points.len(), |i| {
        let point = points[i].map(|c| c * inverse);
        let cell = if grid.holds(point) { cell_of(point, side) } else { [i64::MAX; D] };
        (cell, i as u32)
    });
    run.sort(&mut keyed, |a, b| compare_cells(a.0, b.0).then(a.1.cmp(&b.1)));
    let order: Vec<u32> = keyed.iter().map(|entry| entry.1).collect();
    let members = keyed.chunk_by(|a, b| a.0 == b.0).map(<[_]>::len);
    Groups::of(order, members, |i| points[i as usize], run)
}

/// Orders the members of a wide cell so that each eight of them lie close together.
fn arrange<const D: usize>(members: &mut [u32], point: &impl Fn(u32) -> [f64; D]) {
    let Some(&first) = members.first() else { return };
    // Relative to a member and in single precision: the order serves speed alone.
    let origin = point(first);
    let mut keyed: Vec<([f32; D], u32)> = members
        .iter()
        .map(|&i| {
            let x = point(i);
            (std::array::from_fn(|k| (x[k] - origin[k]) as f32), i)
        })
        .collect();
    halve(&mut keyed);
    for (member, (_, i)) in members.iter_mut().zip(keyed) {
        *member = i;
    }
}

/// Halves along the longest axis until a leaf is left. Only the last leaf is not full.
fn halve<const D: usize>(members: &mut [([f32; D], u32)]) {
    if members.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
    for (x, _) in members.iter() {
        for k in 0..D {
            low[k] = if x[k] < low[k] { x[k] } else { low[k] };
            high[k] = if x[k] > high[k] { x[k] } else { high[k] };
        }
    }
    let longest = (1..D).fold(0, |best, k| if high[k] - low[k] > high[best] - low[best] { k } else { best });
    // Groups begin at multiples of their size: the halves above that size end at one.
    let unit = if members.len() > GROUP { GROUP } else { LEAF };
    let middle = (members.len() / 2).next_multiple_of(unit).min(members.len() - 1);
    members.select_nth_unstable_by(middle, |a, b| a.0[longest].total_cmp(&b.0[longest]));
    let (left, right) = members.split_at_mut(middle);
    halve(left);
    halve(right);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Cloud;
    use crate::lane::Precision;
    use crate::samples::Random;
    use crate::support::Radii;

    #[test]
    fn groups_hold_every_position_once_and_stay_small() {
        let mut random = Random::new(8);
        let mut points: Vec<[f64; 3]> =
            (0..5000).map(|_| std::array::from_fn(|_| 10.0 * random.uniform())).collect();
        points.extend(vec![[1.0; 3]; 300]);
        let cloud = Cloud::new(points.clone());
        points.push([f64::NAN; 3]);
        let run = Run::new();
        let grid = Grid::new(&cloud, &Radii::Uniform(1.0), 1.0, 1.0, Precision::Double, &run);
        let mut groups = group(&points, &grid, &run);
        let sizes: Vec<usize> = (0..groups.count()).map(|g| groups.range(g).len()).collect();
        assert!(sizes.iter().all(|&size| size > 0 && size <= GROUP));
        assert_eq!(sizes.iter().sum::<usize>(), points.len());
        // Blocks are compact: far smaller than the wide cell they are in.
        let points = &points;
        let spread = |block: &[u32]| {
            let along = |k: usize| block.iter().map(move |&i| points[i as usize][k]);
            (0..3).fold(0.0_f64, |m, k| {
                m.max(along(k).fold(f64::MIN, f64::max) - along(k).fold(f64::MAX, f64::min))
            })
        };
        let full = |group: usize| &groups.order[groups.range(group)];
        let blocks: Vec<&[u32]> = (0..groups.count() - 1).flat_map(|g| full(g).chunks(LEAF)).collect();
        let mean = blocks.iter().map(|block| spread(block)).sum::<f64>() / blocks.len() as f64;
        assert!(mean < 2.0, "{mean}");
        groups.order.sort_unstable();
        assert!(groups.order.iter().enumerate().all(|(i, &o)| i == o as usize));
    }
}
