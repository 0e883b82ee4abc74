//! Batches of rays: in each wave every ray is taken through the next stretch of the domain, together with its neighbours.
//!
//! Rays are grouped by where they enter, so that near ones share candidates whatever order they came in.

use super::march::{March, Next, Rules};
use super::{Cast, Hit, Ray};
use crate::algebra::{length, scale};
use crate::domain::{Line, Stretch};
use crate::evaluator::{Evaluator, Local, Position, Wanted};
use crate::queries::{Group, Grouped, Queries};
use crate::run::Cancelled;
use crate::status::Status;
use crate::surface::{Running, Surface};
use std::sync::{Mutex, PoisonError};

/// Where rays end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    AtFirst,
    AtEnd,
}

/// What came of a batch.
pub(super) struct Found<const D: usize> {
    /// By ray, then by t.
    pub(super) hits: Vec<Hit<D>>,
    pub(super) evaluations: Vec<u32>,
    pub(super) status: Vec<Status>,
}

/// A ray on its way, lengths in units of the grid.
#[derive(Clone, Copy)]
struct Traveller<const D: usize> {
    ray: u32,
    line: Line<D>,
    /// Ways from the origin between which to look.
    from: f64,
    to: f64,
    /// t of a way of one.
    per_way: f64,
    /// The stretch in hand, its ways counted from its beginning.
    stretch: Stretch,
    /// Whether a zero at `from` counts; not where an earlier stretch ended there.
    inclusive: bool,
}

/// What a stretch left of a ray.
struct Rest {
    place: u32,
    evaluations: u32,
    rejected: Option<Status>,
    /// Way from the origin at which to go on.
    from: Option<f64>,
    spent: bool,
}

/// What all threads have found.
struct Gathered<const D: usize> {
    hits: Vec<Hit<D>>,
    rests: Vec<Rest>,
}

pub(super) fn cast<const D: usize>(
    running: &Running<'_, D>,
    rays: &[Ray<D>],
    (how, stop): (&Cast, Stop),
) -> Result<Found<D>, Cancelled> {
    let Running { surface, run } = *running;
    let domain = surface.domain(run);
    let unit = surface.grid.unit;
    let rules = Rules::new(surface, how);
    let mut status = vec![Status::Outside; rays.len()];
    let mut evaluations = vec![0; rays.len()];
    let mut hits: Vec<Hit<D>> = Vec::new();
    let mut waiting: Vec<Traveller<D>> = Vec::with_capacity(rays.len());
    for (i, ray) in rays.iter().enumerate() {
        match traveller(surface, i, ray, how) {
            Some(traveller) => waiting.push(traveller),
            None => status[i] = Status::Invalid,
        }
    }
    while !waiting.is_empty() {
        run.check()?;
        let entering = |i: usize| {
            let traveller: &Traveller<D> = &waiting[i];
            let stretch = domain.stretch(&traveller.line, (traveller.from, traveller.to))?;
            let begin = stretch.begin;
            let entry = traveller.line.at(begin);
            let relative =
                Stretch { begin: 0.0, first: stretch.first - begin, end: stretch.end - begin, ..stretch };
            Some((Traveller { stretch: relative, from: begin, ..*traveller }, scale(entry, unit)))
        };
        let (travellers, entries): (Vec<Traveller<D>>, Vec<[f64; D]>) =
            run.collect_some(waiting.len(), entering).into_iter().unzip();
        let grouped = Grouped::new(surface, Queries::Points(&entries), run);
        let wanted = Wanted { moving: true, gradient: true, ..Wanted::default() };
        let gathered = Mutex::new(Gathered { hits: Vec::new(), rests: Vec::new() });
        grouped.for_each_group(run, wanted, |evaluator, group| {
            let found = through_group((evaluator, group), &travellers, (&rules, stop, unit));
            let mut gathered = gathered.lock().unwrap_or_else(PoisonError::into_inner);
            gathered.hits.extend(found.hits);
            gathered.rests.extend(found.rests);
        })?;
        let gathered = gathered.into_inner().unwrap_or_else(PoisonError::into_inner);
        hits.extend(gathered.hits);
        waiting.clear();
        for rest in gathered.rests {
            let traveller = travellers[rest.place as usize];
            let ray = traveller.ray as usize;
            evaluations[ray] += rest.evaluations;
            if status[ray] == Status::Outside {
                status[ray] = rest.rejected.unwrap_or(Status::Outside);
            }
            match rest.from {
                Some(from) => waiting.push(Traveller { from, inclusive: false, ..traveller }),
                None if rest.spent => status[ray] = Status::NotConverged,
                None => {}
            }
        }
    }
    hits.sort_unstable_by(|a, b| a.ray.cmp(&b.ray).then(a.t.total_cmp(&b.t)));
    Ok(Found { hits, evaluations, status })
}

/// A ray in units of the grid; none where it is not valid.
fn traveller<const D: usize>(
    surface: &Surface<D>,
    i: usize,
    ray: &Ray<D>,
    how: &Cast,
) -> Option<Traveller<D>> {
    let pace = length(ray.direction);
    let usable = ray.origin.iter().all(|c| c.is_finite()) && pace > 0.0 && pace < f64::INFINITY;
    if !usable {
        return None;
    }
    let inverse = 1.0 / surface.grid.unit;
    let line = Line { origin: scale(ray.origin, inverse), direction: scale(ray.direction, 1.0 / pace) };
    let way = |t: f64| t * pace * inverse;
    let stretch = Stretch { begin: 0.0, first: 0.0, end: 0.0, enters: false, exits: false, reach: 0.0 };
    let (from, to, per_way) = (way(how.from), way(how.to), surface.grid.unit / pace);
    Some(Traveller { ray: i as u32, line, from, to, per_way, stretch, inclusive: true })
}

/// Marches the rays of a group, all by one step at a time.
fn through_group<const D: usize>(
    (evaluator, group): (&mut Evaluator<'_, D>, &Group<D>),
    travellers: &[Traveller<D>],
    (rules, stop, unit): (&Rules<'_, D>, Stop, f64),
) -> Gathered<D> {
    let mut found = Gathered { hits: Vec::new(), rests: Vec::with_capacity(group.rows.len()) };
    let start = |(&row, at): (&u32, &Position<D>)| {
        let Traveller { line, stretch, inclusive, .. } = travellers[row as usize];
        March::new((at.anchor, line.direction), (stretch, inclusive), rules)
    };
    for &place in &group.invalid {
        let rejected = Some(Status::Invalid);
        found.rests.push(Rest { place, evaluations: 0, rejected, from: None, spent: false });
    }
    let mut marches: Vec<March<D>> = group.rows.iter().zip(&group.positions).map(start).collect();
    let mut under_way: Vec<usize> = (0..marches.len()).collect();
    let mut positions = Vec::with_capacity(marches.len());
    let mut ended = vec![false; marches.len()];
    while !under_way.is_empty() {
        positions.clear();
        positions.extend(under_way.iter().map(|&i| marches[i].position()));
        evaluator.evaluate(&positions, &|_, _| {}, |place, answers, lane| {
            let i = under_way[place];
            let (march, row) = (&mut marches[i], group.rows[i]);
            let traveller = &travellers[row as usize];
            let mut next = march.take(answers.local(lane), rules);
            while let Next::Hit(way, local) = next {
                found.hits.push(hit(traveller, (way, march.point_at(way)), &local, unit));
                next = if stop == Stop::AtFirst { Next::End } else { march.proceed(rules) };
            }
            if matches!(next, Next::Evaluate) {
                return;
            }
            ended[i] = true;
            let hit = stop == Stop::AtFirst && found.hits.last().is_some_and(|hit| hit.ray == traveller.ray);
            let from = Some(march.after()).map(|way| traveller.from + way);
            let from = from.filter(|&from| !hit && !march.is_spent() && from < traveller.to);
            let (evaluations, rejected, spent) =
                (march.evaluations, march.rejected, march.is_spent() && !hit);
            found.rests.push(Rest { place: row, evaluations, rejected, from, spent });
        });
        under_way.retain(|&i| !ended[i]);
    }
    found
}

fn hit<const D: usize>(
    traveller: &Traveller<D>,
    (way, point): (f64, [f64; D]),
    local: &Local<D>,
    unit: f64,
) -> Hit<D> {
    Hit {
        ray: traveller.ray,
        t: (traveller.from + way) * traveller.per_way,
        point: scale(point, unit),
        surface_normal: local.surface_normal,
        frame_normal: local.normal,
        gradient: local.gradient,
    }
}
