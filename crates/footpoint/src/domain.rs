//! The domain B along rays: which stretches of a ray may lie within reach of samples.
//!
//! Every level of the index has a pyramid of its own. Its lowest storey are bricks of 4^D voxels, one for each cell of the
//! index within reach of samples; a bit says whether a voxel may be within reach. Every storey above joins 4^D nodes of the
//! one below, down to a handful: a ray passes over empty space in few steps, however large the cloud and its outliers are.

use crate::algebra::add_scaled;
use crate::grid::{Grid, Occupied};
use crate::run::Run;
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// Voxels along a brick's side, and nodes along the side of the next higher one.
const WIDTH: i64 = 4;
/// Where marching begins, if samples come as near as this share of their reach: the frame is well determined there, and f is
/// still far from zero.
const CORE: f64 = 0.4;
/// Marching begins at most so many reaches after entering, or halfway to where the stretch ends.
const LATEST_BEGIN: f64 = 1.2;
/// Stretches are cut after so many reaches: most rays hit before.
const LONGEST_STRETCH: f64 = 2.5;
/// Directions nearer to a face than this are taken for this.
const FLATTEST: f64 = 1e-12;
const SHORTEST_STRETCH: f64 = 1e-3;
/// What rounding may do to a way, in reaches.
const TOUCH: f64 = 1e-6;
/// Gaps shorter than this many reaches do not end a stretch: rays that graze would enter again and again.
const GAP: f64 = 0.5;

/// Where balls around samples may be.
#[derive(Debug)]
pub(crate) struct Domain<const D: usize> {
    pyramids: Vec<Pyramid<D>>,
}

/// A stretch of a ray, by ways from its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) begin: f64,
    /// Where to look first.
    pub(crate) first: f64,
    pub(crate) end: f64,
    /// Whether it begins outside all balls; else at the end of what is already known.
    pub(crate) enters: bool,
    /// Whether it ends outside all balls; else more may follow.
    pub(crate) exits: bool,
    /// The shortest reach of the balls around here.
    pub(crate) reach: f64,
}

/// A line in units of the grid, its direction of length one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<const D: usize> {
    pub(crate) origin: [f64; D],
    pub(crate) direction: [f64; D],
}

impl<const D: usize> Line<D> {
    pub(crate) fn at(&self, way: f64) -> [f64; D] {
        add_scaled(self.origin, self.direction, way)
    }
}

impl<const D: usize> Domain<D> {
    /// `ratio`: radius of the domain's balls as a share of the support's.
    pub(crate) fn new(grid: &Grid<D>, ratio: f64, run: &Run<'_>) -> Self {
        Self { pyramids: grid.occupied().map(|level| Pyramid::new(&level, ratio, run)).collect() }
    }

    /// The first stretch between two ways.
    pub(crate) fn stretch(&self, line: &Line<D>, (from, to): (f64, f64)) -> Option<Stretch> {
        let mut stretch = self.marked_stretch(line, (from, to))?;
        // A ray that goes on at the face of a voxel may find nothing but that face: each stretch is to take it further.
        let least = (stretch.begin + SHORTEST_STRETCH * stretch.reach).min(to);
        if stretch.end < least {
            (stretch.end, stretch.exits) = (least, false);
        }
        Some(stretch)
    }

    fn marked_stretch(&self, line: &Line<D>, (from, to): (f64, f64)) -> Option<Stretch> {
        let several = self.pyramids.len() > 1;
        let runs = self.pyramids.iter().filter_map(|p| p.run(line, (from, to)).map(|run| (run, p.reach)));
        if !several {
            let (run, reach) = { runs }.next()?;
            return Some(run.stretch(reach, (from, to)));
        }
        let mut found: Option<Stretch> = None;
        let mut runs: Vec<_> = runs.collect();
        runs.sort_unstable_by(|a, b| a.0.begin.total_cmp(&b.0.begin));
        for (run, reach) in runs {
            let next = Stretch { exits: false, ..run.stretch(reach, (from, to)) };
            match &mut found {
                None => found = Some(next),
                Some(found) if next.begin <= found.end => {
                    found.end = found.end.max(next.end);
                    found.first = found.first.min(next.first);
                    found.reach = found.reach.min(next.reach);
                }
                Some(_) => {}
            }
        }
        found
    }
}

/// Consecutive voxels that are marked.
#[derive(Clone, Copy, Debug)]
struct Marked {
    begin: f64,
    core: f64,
    end: f64,
    /// Whether more may follow at once.
    cut: bool,
}

impl Marked {
    fn stretch(&self, reach: f64, (from, to): (f64, f64)) -> Stretch {
        let Self { begin, core, end, cut } = *self;
        // A ray that goes on at a face may seem to begin a rounding beyond it.
        let enters = begin > from + TOUCH * reach;
        let begin = if enters { begin } else { from };
        let first =
            if enters { core.min(begin + LATEST_BEGIN * reach).min(0.5 * (begin + end)) } else { begin };
        Stretch { begin, first, end, enters, exits: !cut && end < to, reach }
    }
}

/// Voxels of one level of the index.
#[derive(Debug)]
struct Pyramid<const D: usize> {
    reach: f64,
    voxel: f64,
    bricks: Vec<Brick>,
    /// Storeys above the bricks, lowest first.
    storeys: Vec<Vec<Node>>,
    /// Places of the highest nodes.
    tops: Vec<[i64; D]>,
}

/// Which of its voxels may be within reach of a sample, and which are well within.
#[derive(Clone, Copy, Debug)]
struct Brick {
    near: u64,
    core: u64,
}

/// Which of the nodes below are there, and the first of them.
#[derive(Clone, Copy, Debug)]
struct Node {
    mask: u64,
    first: u32,
}

impl<const D: usize> Pyramid<D> {
    fn new(level: &Occupied<D>, ratio: f64, run: &Run<'_>) -> Self {
        let voxel = level.side / WIDTH as f64;
        let reach = level.reach * ratio;
        let mut marked = dilated(level, reach / voxel, run);
        run.sort(&mut marked, |a, b| compare(a.0, b.0));
        let bricks = marked.iter().map(|entry| entry.1).collect();
        let mut tops: Vec<[i64; D]> = marked.into_iter().map(|entry| entry.0).collect();
        let mut storeys = Vec::new();
        while tops.len() > 1 << D {
            let mut nodes: Vec<Node> = Vec::new();
            let mut above: Vec<[i64; D]> = Vec::new();
            for (i, cell) in tops.iter().enumerate() {
                let parent = cell.map(|c| c.div_euclid(WIDTH));
                if above.last() != Some(&parent) {
                    above.push(parent);
                    nodes.push(Node { mask: 0, first: i as u32 });
                }
                if let Some(node) = nodes.last_mut() {
                    node.mask |= 1 << bit(cell.map(|c| c.rem_euclid(WIDTH)));
                }
            }
            storeys.push(nodes);
            tops = above;
        }
        Self { reach, voxel, bricks, storeys, tops }
    }

    /// The first run of marked voxels, not longer than need be.
    fn run(&self, line: &Line<D>, (from, to): (f64, f64)) -> Option<Marked> {
        // A ray along a face is taken for one that crosses it far away.
        let steady = |c: f64| if c.abs() < FLATTEST { FLATTEST.copysign(c) } else { c };
        let across = line.direction.map(|c| self.voxel / steady(c));
        let flip = (0..D).filter(|&k| across[k] < 0.0).fold(0, |flip, k| flip | 3 << (2 * k));
        let mut walk = Walk {
            pyramid: self,
            pace: across.map(f64::abs),
            flip,
            longest: LONGEST_STRETCH * self.reach,
            gap: GAP * self.reach,
            found: None,
        };
        let inverse = 1.0 / self.voxel;
        let size = (WIDTH as f64).powi(self.storeys.len() as i32 + 1);
        let mut entries = [(f64::INFINITY, 0.0, [0.0; D], 0); 8];
        let mut count = 0;
        for (i, top) in self.tops.iter().enumerate() {
            let (mut enter, mut leave) = (from, to);
            let mut near = [0.0; D];
            for k in 0..D {
                let low = top[k] as f64 * size - line.origin[k] * inverse;
                let (a, b) = (low * across[k], (low + size) * across[k]);
                near[k] = a.min(b);
                enter = enter.max(near[k]);
                leave = leave.min(a.max(b));
            }
            if enter <= leave && enter < f64::INFINITY {
                entries[count] = (enter, leave, near, i);
                count += 1;
            }
        }
        let entries = &mut entries[..count];
        // Of two that are entered at once, one is left at once.
        entries.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for &mut (enter, leave, near, i) in entries {
            let part = size / WIDTH as f64;
            if walk.through((self.storeys.len(), i), (near, part), (enter, leave)).is_break() {
                break;
            }
        }
        walk.found
    }
}

/// A ray through a pyramid, and what it has found. Axes along which the ray goes down are mirrored.
struct Walk<'p, const D: usize> {
    pyramid: &'p Pyramid<D>,
    /// Way from voxel to voxel along each axis.
    pace: [f64; D],
    /// Which bits of a child's place are mirrored.
    flip: u32,
    longest: f64,
    gap: f64,
    found: Option<Marked>,
}

impl<const D: usize> Walk<'_, D> {
    /// Through the marked voxels of a node in the order of the ray, until the run has ended. `near` are the ways to the faces
    /// where it would enter along each axis, `part` is the side of a child in voxels.
    fn through(
        &mut self,
        (storey, index): (usize, usize),
        (near, part): ([f64; D], f64),
        (mut enter, leave): (f64, f64),
    ) -> ControlFlow<()> {
        let (mask, core, first) = match storey {
            0 => (self.pyramid.bricks[index].near, self.pyramid.bricks[index].core, 0),
            _ => {
                let node = self.pyramid.storeys[storey - 1][index];
                (node.mask, 0, node.first as usize)
            }
        };
        // Three bits an axis: the child that the ray is in, and one that is set when it leaves the node.
        let mut child = 0_u32;
        let mut next = [0.0; D];
        let pace: [f64; D] = std::array::from_fn(|k| self.pace[k] * part);
        for k in 0..D {
            let passed = |faces: f64| i32::from(near[k] + faces * pace[k] <= enter);
            let along = passed(1.0) + passed(2.0) + passed(3.0);
            child |= (along as u32) << (3 * k);
            next[k] = near[k] + f64::from(along + 1) * pace[k];
        }
        loop {
            let face =
                next.iter().fold(f64::INFINITY, |nearest, &way| if way < nearest { way } else { nearest });
            let out = if face < leave { face } else { leave };
            let place = (child & 3 | child >> 1 & 12 | child >> 2 & 48) ^ self.flip;
            let here = 1_u64 << place;
            if mask & here == 0 {
                // Behind the run.
                if self.found.is_some_and(|run| out > run.end + self.gap) {
                    return ControlFlow::Break(());
                }
            } else if out >= enter {
                if storey == 0 {
                    self.mark(enter, out, core & here != 0)?;
                } else {
                    let below = first + (mask & (here - 1)).count_ones() as usize;
                    let near = std::array::from_fn(|k| next[k] - pace[k]);
                    self.through((storey - 1, below), (near, 0.25 * part), (enter, out))?;
                }
            }
            if face >= leave {
                return ControlFlow::Continue(());
            }
            enter = if face > enter { face } else { enter };
            // Without a branch: which axis comes next cannot be foreseen.
            let mut crosses = true;
            for k in 0..D {
                let moves = crosses && next[k] == face;
                crosses &= !moves;
                next[k] += if moves { pace[k] } else { 0.0 };
                child += u32::from(moves) << (3 * k);
            }
            if child & 0o444 != 0 {
                return ControlFlow::Continue(());
            }
        }
    }

    fn mark(&mut self, enter: f64, leave: f64, core: bool) -> ControlFlow<()> {
        let gap = self.gap;
        let run = match &mut self.found {
            None => self.found.insert(Marked { begin: enter, core: f64::INFINITY, end: leave, cut: false }),
            Some(run) if enter > run.end + gap => return ControlFlow::Break(()),
            Some(run) => run,
        };
        run.end = run.end.max(leave);
        if core && run.core == f64::INFINITY {
            run.core = enter;
        }
        run.cut = run.end - run.begin >= self.longest;
        if run.cut { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Place of a child among the 4^D of its node.
fn bit<const D: usize>(child: [i64; D]) -> u32 {
    child.iter().rev().fold(0, |bit, &c| bit * WIDTH as u32 + c as u32)
}

/// The order in which the children of every node, on every storey, stand together.
fn compare<const D: usize>(a: [i64; D], b: [i64; D]) -> Ordering {
    let differing = (0..D).fold(0, |all, k| all | (a[k] ^ b[k]));
    if differing < 0 {
        // Across zero: storeys never join the sides.
        return bit_of_signs(a).cmp(&bit_of_signs(b));
    }
    let shift = if differing == 0 { 0 } else { (63 - differing.leading_zeros()) & !1 };
    let digits = |x: [i64; D]| bit(x.map(|c| (c >> shift) & (WIDTH - 1)));
    digits(a).cmp(&digits(b))
}

fn bit_of_signs<const D: usize>(x: [i64; D]) -> u32 {
    bit(x.map(|c| i64::from(c >= 0)))
}

/// Voxels near an occupied one: masks for the 3^D cells around, for each voxel of the middle one.
struct Stencil {
    around: Vec<u64>,
    cells: usize,
}

impl Stencil {
    /// Marks all voxels of which some point is within `reach` voxel sides of some point of the occupied one.
    fn new<const D: usize>(reach: f64) -> Self {
        let cells = 3_usize.pow(D as u32);
        let voxels = 1_usize << (2 * D);
        let mut around = vec![0; voxels * cells];
        // More than any rounding of a ray's way.
        let squared = (reach * (1.0 + 1e-6)).powi(2);
        for voxel in 0..voxels {
            let from: [i64; D] = std::array::from_fn(|k| (voxel >> (2 * k)) as i64 & (WIDTH - 1));
            for cell in 0..cells {
                let shift = shift_of::<D>(cell);
                for other in 0..voxels {
                    let gap = |k: usize| {
                        let to = shift[k] * WIDTH + ((other >> (2 * k)) as i64 & (WIDTH - 1));
                        ((to - from[k]).abs() - 1).max(0) as f64
                    };
                    if (0..D).map(|k| gap(k) * gap(k)).sum::<f64>() <= squared {
                        around[voxel * cells + cell] |= 1 << other;
                    }
                }
            }
        }
        Self { around, cells }
    }

    /// What the occupied voxels of a cell mark in the cell at this place around it.
    fn spread(&self, mut occupied: u64, cell: usize) -> u64 {
        let mut marked = 0;
        while occupied != 0 {
            let voxel = occupied.trailing_zeros() as usize;
            marked |= self.around[voxel * self.cells + cell];
            occupied &= occupied - 1;
        }
        marked
    }
}

/// Which way the cell at this place of the 3^D lies.
fn shift_of<const D: usize>(place: usize) -> [i64; D] {
    std::array::from_fn(|k| (place / 3_usize.pow(k as u32) % 3) as i64 - 1)
}

/// The bricks with marked voxels: those of cells around occupied ones. `reach` is in voxels, at most four.
fn dilated<const D: usize>(level: &Occupied<D>, reach: f64, run: &Run<'_>) -> Vec<([i64; D], Brick)> {
    let near = Stencil::new::<D>(reach);
    let core = Stencil::new::<D>((CORE * reach - 0.5).max(0.0));
    // Rows along the first axis, in order.
    let mut rows: Vec<([i64; D], usize, usize)> = Vec::new();
    for (i, (cell, _)) in level.cells.iter().enumerate() {
        let mut row = *cell;
        row[0] = 0;
        match rows.last_mut() {
            Some(last) if last.0 == row => last.2 = i + 1,
            _ => rows.push((row, i, i + 1)),
        }
    }
    let slow = |row: &[i64; D], to: &[i64; D]| row.iter().rev().cmp(to.iter().rev());
    let across = 3_usize.pow(D as u32 - 1);
    let mut targets: Vec<[i64; D]> = Vec::with_capacity(rows.len() * across);
    for place in 0..across {
        let shift = shift_of::<D>(3 * place);
        targets.extend(
            rows.iter().map(|row| std::array::from_fn(|k| if k == 0 { 0 } else { row.0[k] + shift[k] })),
        );
    }
    targets.sort_unstable_by(slow);
    targets.dedup();
    let bricks_of = |target: [i64; D]| -> Vec<([i64; D], Brick)> {
        let mut found: Vec<(i64, Brick)> = Vec::new();
        for place in 0..across {
            let shift = shift_of::<D>(3 * place);
            let source: [i64; D] = std::array::from_fn(|k| if k == 0 { 0 } else { target[k] - shift[k] });
            let Ok(row) = rows.binary_search_by(|row| slow(&row.0, &source)) else { continue };
            for &(cell, occupied) in &level.cells[rows[row].1..rows[row].2] {
                for along in 0..3 {
                    let around = 3 * place + along;
                    let brick =
                        Brick { near: near.spread(occupied, around), core: core.spread(occupied, around) };
                    if brick.near != 0 {
                        found.push((cell[0] + along as i64 - 1, brick));
                    }
                }
            }
        }
        found.sort_unstable_by_key(|entry| entry.0);
        let join = |part: &[(i64, Brick)]| {
            let mut cell = target;
            cell[0] = part[0].0;
            let all = |brick: Brick, &(_, other): &(i64, Brick)| Brick {
                near: brick.near | other.near,
                core: brick.core | other.core,
            };
            (cell, part.iter().fold(Brick { near: 0, core: 0 }, all))
        };
        found.chunk_by(|a, b| a.0 == b.0).map(join).collect()
    };
    run.collect(targets.len(), |i| bricks_of(targets[i])).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{dot, length, scale, sub};
    use crate::cloud::Cloud;
    use crate::lane::Precision;
    use crate::samples::Random;
    use crate::support::Radii;

    /// A ball's part of a line, if it meets it by more than rounding.
    fn through_ball<const D: usize>(line: &Line<D>, centre: [f64; D], radius: f64) -> Option<(f64, f64)> {
        let to = sub(centre, line.origin);
        let along = dot(to, line.direction);
        let half = (radius * radius - dot(to, to) + along * along).sqrt();
        (half > 1e-6 * radius).then_some((along - half, along + half))
    }

    /// All stretches of a line, one after the other.
    fn stretches<const D: usize>(domain: &Domain<D>, line: &Line<D>) -> Vec<Stretch> {
        let mut found: Vec<Stretch> = Vec::new();
        let mut from = 0.0;
        while let Some(stretch) = domain.stretch(line, (from, f64::INFINITY)) {
            assert!(stretch.begin >= from && stretch.end > from, "{stretch:?} from {from}");
            assert!(stretch.begin <= stretch.first, "{stretch:?}");
            assert!(stretch.first <= stretch.end, "{stretch:?}");
            from = stretch.end;
            found.push(stretch);
            assert!(found.len() < 10_000, "no progress");
        }
        found
    }

    fn check<const D: usize>(points: Vec<[f64; D]>, radii: &Radii, largest: f64) {
        let cloud = Cloud::new(points);
        let run = Run::new();
        let grid = Grid::new(&cloud, radii, largest, 1.0, Precision::Double, &run);
        for ratio in [1.0, 0.6] {
            let domain = Domain::new(&grid, ratio, &run);
            let mut random = Random::new(5);
            let (mut met, mut long) = (0, 0.0);
            for i in 0..300 {
                let near = scale(cloud.points()[i % cloud.len()], 1.0 / grid.unit);
                let mut direction: [f64; D] = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
                if i % 5 == 0 {
                    direction[i % D] = 0.0;
                }
                let direction = scale(direction, 1.0 / length(direction));
                let origin =
                    std::array::from_fn(|k| near[k] + 2.0 * random.uniform() - 1.0 - 40.0 * direction[k]);
                let line = Line { origin, direction };
                let stretches = stretches(&domain, &line);
                long += stretches.iter().map(|s| s.end - s.begin).sum::<f64>();
                for (place, p) in cloud.points().iter().enumerate() {
                    let radius = match radii {
                        Radii::Uniform(h) => *h,
                        Radii::PerSample(h) => h[place],
                    };
                    let (centre, radius) = (scale(*p, 1.0 / grid.unit), ratio * radius / grid.unit);
                    let Some((enter, leave)) = through_ball(&line, centre, radius) else { continue };
                    met += 1;
                    // Every part of the ball is in some stretch, up to where rays are said to leave all balls.
                    let mut covered = enter.max(0.0);
                    for stretch in &stretches {
                        if stretch.begin <= covered + 1e-6 {
                            covered = covered.max(stretch.end);
                        }
                    }
                    assert!(covered >= leave - 1e-6, "ball from {enter} to {leave}: {stretches:?}");
                }
            }
            assert!(met > 100 && long < 300.0 * 60.0, "{met} {long}");
        }
    }

    fn random_cloud<const D: usize>(count: usize, extent: f64) -> Vec<[f64; D]> {
        let mut random = Random::new(3);
        (0..count).map(|_| std::array::from_fn(|_| extent * (random.uniform() - 0.5))).collect()
    }

    #[test]
    fn no_ball_is_passed_over() {
        check(random_cloud::<3>(300, 20.0), &Radii::Uniform(1.1), 1.1);
        check(random_cloud::<3>(300, 20.0), &Radii::Uniform(1.9), 1.9);
        check(random_cloud::<2>(60, 20.0), &Radii::Uniform(1.3), 1.3);
        let each = (0..300).map(|i| 0.1 * 1.01_f64.powi(i)).collect();
        check(random_cloud::<3>(300, 20.0), &Radii::PerSample(each), 0.1 * 1.01_f64.powi(299));
    }

    #[test]
    fn outliers_cost_little() {
        let mut points = random_cloud::<3>(300, 20.0);
        points.extend([[1e12, 1e13, -1e13], [-1e13, 2e12, 1e12]]);
        let cloud = Cloud::new(points.clone());
        let run = Run::new();
        let grid = Grid::new(&cloud, &Radii::Uniform(1.1), 1.1, 1.0, Precision::Double, &run);
        let domain = Domain::new(&grid, 1.0, &run);
        let nodes: usize = domain.pyramids.iter().flat_map(|p| &p.storeys).map(Vec::len).sum();
        assert!(nodes < 4000, "{nodes}");
        // To the outlier and into it.
        let aim = scale([1e12, 1e13, -1e13], 1.0 / grid.unit);
        let line = Line { origin: [0.0; 3], direction: scale(aim, 1.0 / length(aim)) };
        let last = stretches(&domain, &line).pop().unwrap();
        assert!((last.begin - length(aim)).abs() < 4.0, "{last:?}");
    }

    #[test]
    fn far_from_all_balls_there_is_no_stretch() {
        let cloud = Cloud::new(random_cloud::<3>(300, 20.0));
        let run = Run::new();
        let grid = Grid::new(&cloud, &Radii::Uniform(1.1), 1.1, 1.0, Precision::Double, &run);
        let domain = Domain::new(&grid, 1.0, &run);
        let beside = Line { origin: [0.0, 0.0, 30.0], direction: [1.0, 0.0, 0.0] };
        let away = Line { origin: [0.0, 0.0, 30.0], direction: [0.0, 0.0, 1.0] };
        for line in [beside, away] {
            assert_eq!(domain.stretch(&line, (0.0, f64::INFINITY)), None);
        }
        assert!(domain.stretch(&away, (-60.0, f64::INFINITY)).is_some());
        assert_eq!(domain.stretch(&away, (-60.0, -55.0)), None);
    }
}
