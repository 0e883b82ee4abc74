//! From the foot points of samples near far queries along the surface to their foot points.
//!
//! The projection of a query ends where no sample is near. A foot point is also where the distance to the query is least along
//! the surface: so a walk starts at the nearest of the samples' own foot points, takes steps against the part of the way to the query
//! that lies in the tangent plane, and has every step projected onto the surface. Steps have Barzilai and Borwein's length, and
//! none may lead further away.

use footpoint::{Cancelled, Progress, Project, Queries, Run, Status, Surface, Want};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZero;

/// Longest step, in supports: so far the projection finds the way back.
const LONGEST: f64 = 0.25;
/// Where not even such a step, in supports, ends on the surface, it has an end there.
const SHORTEST: f64 = 1e-3;
/// Steps a walk may take.
const ROUNDS: usize = 200;

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

/// Walks to the foot point of each query from the nearest of the samples' own; *outside* where that is farther than `largest`
/// and a support.
pub(super) fn walk<const D: usize>(
    surface: &Surface<D>,
    queries: &[[f64; D]],
    (how, largest): (&Project, f64),
    run: &Run<'_>,
) -> Result<Vec<End<D>>, Cancelled> {
    let mut walkers = starts(surface, queries, (how, largest), run)?;
    let quiet = run.silent();
    for _ in 0..ROUNDS {
        let under_way: Vec<usize> = (0..walkers.len()).filter(|&i| walkers[i].end.is_none()).collect();
        run.announce(Progress { done: walkers.len() - under_way.len(), total: walkers.len() });
        if under_way.is_empty() {
            break;
        }
        let trials: Vec<[f64; D]> = under_way.iter().map(|&i| walkers[i].trial()).collect();
        let landed = surface.with(&quiet).project(Queries::Points(&trials), how)?;
        for (k, &i) in under_way.iter().enumerate() {
            walkers[i].advance(landed.status[k], (landed.point[k], landed.surface_normal[k]), how);
        }
    }
    let end = |walker: Walker<D>| match walker.end.unwrap_or(Status::NotConverged) {
        Status::Ok => Ok(Foot { point: walker.foot, support: walker.support }),
        status => Err(status),
    };
    Ok(walkers.into_iter().map(end).collect())
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

/// The walkers at their starts: of all samples' foot points the one nearest to each query.
fn starts<const D: usize>(
    surface: &Surface<D>,
    queries: &[[f64; D]],
    (how, largest): (&Project, f64),
    run: &Run<'_>,
) -> Result<Vec<Walker<D>>, Cancelled> {
    let mut feet = surface.with(run).project(Queries::Samples, how)?;
    let mut ok = feet.status.iter().map(|status| status.is_ok());
    feet.point.retain(|_| ok.next().unwrap_or(false));
    feet.surface_normal.retain(|normal| !normal[0].is_nan());
    // In supports squares stay in range, whatever the unit of the file.
    let unit = surface.support().median;
    let scaled: Vec<[f64; D]> = feet.point.iter().map(|point| point.map(|c| c / unit)).collect();
    let tree = ImmutableKdTree::<f64, D>::new_from_slice(&scaled).ok();
    let near: Vec<Option<usize>> = queries
        .iter()
        .map(|at| {
            let at = at.map(|c| c / unit);
            let found =
                tree.as_ref()?.query(&at).nearest_n::<SquaredEuclidean<f64>>(NonZero::<usize>::MIN).execute();
            found.first().map(|item| item.item as usize)
        })
        .collect();
    let starts: Vec<[f64; D]> = near.iter().flatten().map(|&i| feet.point[i]).collect();
    let quiet = run.silent();
    let supports = surface.with(&quiet).evaluate(Queries::Points(&starts), Want::SUPPORT)?.support;
    let mut supports = supports.into_iter();
    let limit = largest + surface.support().largest;
    let start = |(&query, near): (&[f64; D], &Option<usize>)| {
        let found = near.and_then(|i| Some((feet.point[i], feet.surface_normal[i], supports.next()?)));
        match found {
            Some((foot, normal, support)) if distance(query, foot) <= limit => {
                Walker::at(query, (foot, normal), support, how)
            }
            _ => Walker::ended(Status::Outside),
        }
    };
    Ok(queries.iter().zip(&near).map(start).collect())
}

pub(super) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub(super) fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let way = sub(a, b);
    dot(way, way).sqrt()
}
