//! From the foot points of samples near far queries along the surface to their foot points.
//!
//! The projection of a query ends where no sample is near. A foot point is also where the distance to the query is least along
//! the surface: so a walk starts at the nearest of the samples' own foot points, takes steps along the part of the way to the query
//! that lies in the tangent plane, and has every step projected onto the surface. Steps have Barzilai and Borwein's length, and
//! none may lead further away.

use footpoint::{Cancelled, Progress, Project, Queries, Run, Status, Surface, Want};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::cmp::Ordering;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Walks start at the foot of this rank, 0 the nearest; the next is tried where a walk is lost: noisy surfaces have holes.
const RANKS: [usize; 3] = [0, 7, 31];
/// So many walk together: enough for all threads, few enough to tell often how many have arrived.
const TOGETHER: usize = 1 << 16;
/// How often a thread that waits looks whether it is to end.
const TICK: Duration = Duration::from_millis(20);
/// Longest step, in supports: so far the projection finds the way back.
const LONGEST: f64 = 0.25;
/// Where not even such a step, in supports, ends on the surface, it has an end there.
const SHORTEST: f64 = 1e-2;

/// How much is tried for a walk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gait {
    how: Project,
    /// Where the nearest start is farther than this and a support the walk is not begun.
    largest: f64,
    from: Origins,
    ranks: &'static [usize],
    /// Evaluations for a step to come back to the surface: many where it does, few where it never will.
    most_evaluations: u32,
    /// Steps a walk may take.
    rounds: usize,
}

/// Which samples' foot points walks start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origins {
    /// Of all.
    All,
    /// Of those that are the first few to some query.
    Nearest,
}

impl Gait {
    /// All that helps to find the nearest foot point.
    pub(super) fn patient(how: Project, largest: f64) -> Self {
        Self { how, largest, from: Origins::All, ranks: &RANKS, most_evaluations: 100, rounds: 200 }
    }

    /// What few walks cost little by.
    pub(super) fn brisk(how: Project, largest: f64) -> Self {
        Self { how, largest, from: Origins::Nearest, ranks: &RANKS[..1], most_evaluations: 16, rounds: 40 }
    }
}

/// Where a walk ended: a foot point, or why there is none.
pub(super) type End<const D: usize> = Result<Foot<D>, Status>;

/// A foot point that was walked to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot<const D: usize> {
    /// On the surface.
    pub(super) point: [f64; D],
    /// h there.
    pub(super) support: f64,
}

/// Where a walk ended, the projection looks from here, in supports, towards the query: the foot point is the same.
const BESIDE: f64 = 0.1;

/// From where the projection finds a foot point that was walked to.
pub(super) fn beside<const D: usize>(foot: &Foot<D>, query: [f64; D]) -> [f64; D] {
    let away = sub(query, foot.point);
    let share = (BESIDE * foot.support / distance(query, foot.point)).min(1.0);
    std::array::from_fn(|k| foot.point[k] + share * away[k])
}

/// Walks to the foot point of each query from the nearest of the samples' own; *outside* where that is farther than `largest`
/// and a support.
pub(super) fn walk<const D: usize>(
    surface: &Surface<D>,
    queries: &[[f64; D]],
    gait: Gait,
    run: &Run<'_>,
) -> Result<Vec<End<D>>, Cancelled> {
    let starts = Starts::of(surface, queries, gait, run)?;
    let how = &gait.how;
    let limit = gait.largest + surface.support().largest;
    let mut ends: Vec<End<D>> = vec![Err(Status::Outside); queries.len()];
    for (attempt, rank) in gait.ranks.iter().copied().enumerate() {
        let lost = |end: &End<D>| attempt == 0 || matches!(end, Err(status) if *status != Status::Outside);
        let rows: Vec<usize> = (0..queries.len()).filter(|&row| lost(&ends[row])).collect();
        let mut gone = 0;
        for part in rows.chunks(TOGETHER) {
            let points: Vec<[f64; D]> = part.iter().map(|&row| queries[row]).collect();
            let mut walkers = starts.walkers(surface, &points, (how, rank, limit), run)?;
            let arrived = |here| run.announce(Progress { done: gone + here, total: rows.len() });
            iterate(surface, &mut walkers, gait, (run, &arrived))?;
            for (walker, &row) in walkers.iter().zip(part) {
                // The first reason stands.
                if attempt == 0 || walker.end == Some(Status::Ok) {
                    ends[row] = walker.arrival();
                }
            }
            gone += part.len();
        }
    }
    Ok(ends)
}

/// Takes steps until every walk has ended, or for so many rounds; tells how many have ended.
fn iterate<const D: usize>(
    surface: &Surface<D>,
    walkers: &mut [Walker<D>],
    gait: Gait,
    (run, arrived): (&Run<'_>, &dyn Fn(usize)),
) -> Result<(), Cancelled> {
    let quiet = run.silent();
    let how = &gait.how;
    let back = how.with_most_evaluations(gait.most_evaluations);
    for _ in 0..gait.rounds {
        let under_way: Vec<usize> = (0..walkers.len()).filter(|&i| walkers[i].end.is_none()).collect();
        arrived(walkers.len() - under_way.len());
        if under_way.is_empty() {
            break;
        }
        let trials: Vec<[f64; D]> = under_way.iter().map(|&i| walkers[i].trial()).collect();
        let landed = surface.with(&quiet).project(Queries::Points(&trials), &back)?;
        for (k, &i) in under_way.iter().enumerate() {
            walkers[i].advance(landed.status[k], (landed.point[k], landed.surface_normal[k]), how);
        }
    }
    Ok(())
}

/// One walk: a query, and the point of the surface that it has come to.
#[derive(Clone, Copy)]
struct Walker<const D: usize> {
    query: [f64; D],
    foot: [f64; D],
    /// Unit normal of the surface at the foot.
    normal: [f64; D],
    /// h there.
    support: f64,
    /// The next step as a share of the way to the query in the tangent plane.
    share: f64,
    end: Option<Status>,
}

impl<const D: usize> Walker<D> {
    fn ended(status: Status) -> Self {
        let nowhere = [f64::NAN; D];
        Self {
            query: nowhere,
            foot: nowhere,
            normal: nowhere,
            support: f64::NAN,
            share: 0.0,
            end: Some(status),
        }
    }

    fn at(query: [f64; D], (foot, normal): ([f64; D], [f64; D]), support: f64, how: &Project) -> Self {
        let longest = LONGEST * support;
        // As far as a point goes that takes such a step straight to the query.
        let share = longest / distance(query, foot).max(longest);
        let mut walker = Self { query, foot, normal, support, share, end: None };
        walker.settle(how);
        walker
    }

    /// The way to the query in the tangent plane.
    fn tangent(&self) -> [f64; D] {
        let away = sub(self.query, self.foot);
        let across = dot(away, self.normal);
        std::array::from_fn(|k| away[k] - across * self.normal[k])
    }

    /// Ends the walk where the query stands upright over the foot.
    fn settle(&mut self, how: &Project) {
        let tangent = self.tangent();
        let reach = self.support + distance(self.query, self.foot);
        // The normal turns with the foot: what that is uncertain by, over a support, is an angle.
        if dot(tangent, tangent).sqrt() <= 2.0 * self.precision(how) * reach {
            self.end = Some(Status::Ok);
        }
    }

    fn arrival(&self) -> End<D> {
        match self.end.unwrap_or(Status::NotConverged) {
            Status::Ok => Ok(Foot { point: self.foot, support: self.support }),
            status => Err(status),
        }
    }

    /// How well the foot is known, in supports: by the tolerance, and the rounding of its coordinates.
    fn precision(&self, how: &Project) -> f64 {
        let largest = self.foot.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        how.tolerance() + 2.0 * f64::EPSILON * largest / self.support
    }

    /// Where the next step ends, beside the surface.
    fn trial(&self) -> [f64; D] {
        let tangent = self.tangent();
        let share = self.share.min(LONGEST * self.support / dot(tangent, tangent).sqrt());
        std::array::from_fn(|k| self.foot[k] + share * tangent[k])
    }

    /// Takes in what the projection made of the trial.
    fn advance(&mut self, status: Status, (foot, normal): ([f64; D], [f64; D]), how: &Project) {
        let (tangent, before) = (self.tangent(), distance(self.query, self.foot));
        let slack = 4.0 * self.precision(how) * self.support;
        // Not so for NaN.
        if status.is_ok() && distance(self.query, foot) <= before + slack {
            let step = sub(foot, self.foot);
            (self.foot, self.normal) = (foot, normal);
            let turned = dot(step, sub(tangent, self.tangent()));
            let share = dot(step, step) / turned;
            self.share = if turned > 0.0 { share.clamp(1e-6, 10.0) } else { (2.0 * self.share).min(10.0) };
            return self.settle(how);
        }
        let length = dot(tangent, tangent).sqrt();
        self.share = 0.25 * self.share.min(LONGEST * self.support / length);
        let shortest = if status.is_ok() { self.precision(how).min(SHORTEST) } else { SHORTEST };
        if self.share * length < shortest * self.support {
            self.end = Some(match status {
                Status::Ok => Status::NotConverged,
                // The surface ends with the samples: this is the rim.
                Status::Outside | Status::Degenerate => Status::Boundary,
                status => status,
            });
        }
    }
}

/// Where walks start: the samples' own foot points.
struct Starts<const D: usize> {
    feet: Vec<[f64; D]>,
    normals: Vec<[f64; D]>,
    /// Rows of the feet, in `unit`s of a support, whose squares stay in range whatever the unit of the file. A tree of boxes,
    /// for they are looked for from far away: without boxes most of a tree is visited from there.
    tree: RTree<Place<D>>,
    unit: f64,
}

/// A foot, in units of a support, and its row.
type Place<const D: usize> = GeomWithData<[f64; D], usize>;

/// The tree of these feet. It takes a second for two million: on a thread of its own, which nobody waits for once cancelled.
fn tree<const D: usize>(
    feet: impl Fn() -> Vec<Place<D>>,
    run: &Run<'_>,
) -> Result<RTree<Place<D>>, Cancelled> {
    let (tell, told) = mpsc::channel();
    let theirs = feet();
    // Where no thread can be made the channel has lost its other end.
    drop(thread::Builder::new().spawn(move || drop(tell.send(RTree::bulk_load(theirs)))));
    loop {
        match told.recv_timeout(TICK) {
            Ok(tree) => return Ok(tree),
            Err(RecvTimeoutError::Timeout) if run.is_cancelled() => return Err(Cancelled),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(RTree::bulk_load(feet())),
        }
    }
}

/// These rows of the points, in the order of their coordinates, so that answers depend on no other, and each point
/// once.
fn ordered<const D: usize>(points: &[[f64; D]], mut rows: Vec<usize>) -> Vec<usize> {
    rows.sort_unstable_by(|&a, &b| {
        let mut axes = points[a].into_iter().zip(points[b]).map(|(a, b)| a.total_cmp(&b));
        axes.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    rows.dedup_by(|a, b| points[*a] == points[*b]);
    rows
}

/// Points and their rows in the tree's unit.
fn places<const D: usize>(points: &[[f64; D]], unit: f64) -> Vec<Place<D>> {
    let scaled = |(row, point): (usize, &[f64; D])| {
        let point = point.map(|c| c / unit);
        // The tree has no place for others.
        point.iter().all(|c| c.is_finite()).then(|| GeomWithData::new(point, row))
    };
    points.iter().enumerate().filter_map(scaled).collect()
}

/// The samples that are of one of the usual ranks to some of the queries.
fn nearest<const D: usize>(
    samples: &[[f64; D]],
    queries: &[[f64; D]],
    unit: f64,
    run: &Run<'_>,
) -> Result<Vec<[f64; D]>, Cancelled> {
    let samples: Vec<[f64; D]> =
        ordered(samples, (0..samples.len()).collect()).into_iter().map(|row| samples[row]).collect();
    let tree = tree(|| places(&samples, unit), run)?;
    let last = RANKS[RANKS.len() - 1];
    let found = run.map(queries.len(), |i| {
        let at = queries[i].map(|c| c / unit);
        let all = tree.nearest_neighbor_iter(&at).take(last + 1).enumerate();
        all.filter(|(rank, _)| RANKS.contains(rank)).map(|(_, place)| place.data).collect::<Vec<_>>()
    })?;
    let mut rows: Vec<usize> = found.into_iter().flatten().collect();
    rows.sort_unstable();
    rows.dedup();
    Ok(rows.into_iter().map(|row| samples[row]).collect())
}

impl<const D: usize> Starts<D> {
    fn of(surface: &Surface<D>, queries: &[[f64; D]], gait: Gait, run: &Run<'_>) -> Result<Self, Cancelled> {
        let unit = surface.support().median;
        let found = match gait.from {
            Origins::All => surface.with(run).project(Queries::Samples, &gait.how)?,
            Origins::Nearest => {
                let samples = nearest(surface.cloud().points(), queries, unit, run)?;
                let how = gait.how.with_most_evaluations(gait.most_evaluations);
                surface.with(&run.silent()).project(&samples, &how)?
            }
        };
        let ok = |row: &usize| found.status[*row].is_ok();
        let rows = ordered(&found.point, (0..found.status.len()).filter(ok).collect());
        if run.is_cancelled() {
            return Err(Cancelled);
        }
        let feet: Vec<[f64; D]> = rows.iter().map(|&row| found.point[row]).collect();
        let normals = rows.iter().map(|&row| found.surface_normal[row]).collect();
        let tree = tree(|| places(&feet, unit), run)?;
        Ok(Self { tree, feet, normals, unit })
    }

    /// The foot of this rank among those near a location: 0 is the nearest. The last there is where there are fewer.
    fn near(&self, at: [f64; D], rank: usize) -> Option<usize> {
        let at = at.map(|c| c / self.unit);
        let foot = match rank {
            0 => self.tree.nearest_neighbor(&at),
            _ => self.tree.nearest_neighbor_iter(&at).take(rank + 1).last(),
        };
        foot.map(|foot| foot.data)
    }

    /// Walkers at their starts; *outside* for queries without one nearer than `limit`.
    fn walkers(
        &self,
        surface: &Surface<D>,
        queries: &[[f64; D]],
        (how, rank, limit): (&Project, usize, f64),
        run: &Run<'_>,
    ) -> Result<Vec<Walker<D>>, Cancelled> {
        let near = run.map(queries.len(), |i| self.near(queries[i], rank))?;
        let feet: Vec<[f64; D]> = near.iter().flatten().map(|&i| self.feet[i]).collect();
        let quiet = run.silent();
        let mut supports =
            surface.with(&quiet).evaluate(Queries::Points(&feet), Want::SUPPORT)?.support.into_iter();
        let start = |(&query, near): (&[f64; D], &Option<usize>)| {
            let found = near.and_then(|i| Some((self.feet[i], self.normals[i], supports.next()?)));
            match found {
                Some((foot, normal, support)) if distance(query, foot) <= limit => {
                    Walker::at(query, (foot, normal), support, how)
                }
                _ => Walker::ended(Status::Outside),
            }
        };
        Ok(queries.iter().zip(&near).map(start).collect())
    }
}

fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub(super) fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let way = sub(a, b);
    dot(way, way).sqrt()
}
