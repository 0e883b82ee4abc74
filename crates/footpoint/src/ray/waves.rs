//! Batches of rays: in each wave every ray is taken through the next stretch of the domain, together with its neighbours.
//!
//! Rays are grouped by where they enter, so that near ones share candidates whatever order they came in.

use super::march::{March, Next, Rules};
use super::{Cast, Hit, Ray};
use crate::algebra::{length, scale};
use crate::domain::{Domain, Line, Stretch};
use crate::evaluator::{Evaluator, Local, Position, Wanted};
use crate::queries::{Group, Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use std::sync::{Mutex, PoisonError};

/// Rays that are taken on together: enough to find near ones among them, few enough for the caches.
const TOGETHER: usize = 1 << 16;

/// Rays that march in step: what is kept of them stays in the fastest caches.
const IN_STEP: usize = 128;

/// Where rays end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    AtFirst,
    AtEnd,
}

/// What came of a batch.
pub(super) struct Found<const D: usize> {
    /// By ray, then by t; in any order where there is one a ray.
    pub(super) hits: Vec<Hit<D>>,
    pub(super) evaluations: Vec<u32>,
    pub(super) status: Vec<Status>,
}

/// A ray that is to go on, ways in units of the grid.
#[derive(Clone, Copy)]
struct Waiting {
    ray: u32,
    /// Whether a zero at `from` counts; not where an earlier stretch ended there.
    inclusive: bool,
    /// Way from the origin.
    from: f64,
}

/// A ray in a stretch of the domain, whose ways are counted from its beginning.
#[derive(Clone, Copy)]
struct Entered {
    waiting: Waiting,
    stretch: Stretch,
}

/// What a stretch left of a ray.
struct Rest {
    ray: u32,
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

/// What all rays of a batch share.
struct Batch<'b, const D: usize> {
    surface: &'b Surface<D>,
    rays: &'b [Ray<D>],
    how: &'b Cast,
    rules: Rules<'b, D>,
    stop: Stop,
}

pub(super) fn cast<const D: usize>(
    running: &Running<'_, D>,
    rays: &[Ray<D>],
    (how, stop): (&Cast, Stop),
) -> Result<Found<D>, Cancelled> {
    let Running { surface, run } = *running;
    let domain = surface.domain(run);
    let batch = Batch { surface, rays, how, rules: Rules::new((surface, domain), how), stop };
    let mut found = Found {
        hits: Vec::new(),
        evaluations: vec![0; rays.len()],
        status: vec![Status::Outside; rays.len()],
    };
    let mut waiting = Vec::new();
    let mut next = 0;
    while next < rays.len() || !waiting.is_empty() {
        // Few rays alone have no near ones among them.
        let first = next;
        next = rays.len().min(next + TOGETHER.saturating_sub(waiting.len()));
        for ray in first..next {
            if rays[ray].is_usable() {
                let from = batch.line(ray as u32).1 * how.from;
                waiting.push(Waiting { ray: ray as u32, inclusive: true, from });
            } else {
                found.status[ray] = Status::Invalid;
            }
        }
        run.check()?;
        wave((&batch, domain, run), &mut waiting, &mut found)?;
    }
    if stop == Stop::AtEnd {
        found.hits.sort_unstable_by(|a, b| a.ray.cmp(&b.ray).then(a.t.total_cmp(&b.t)));
    }
    Ok(found)
}

/// Takes all that wait through their next stretch.
fn wave<const D: usize>(
    (batch, domain, run): (&Batch<'_, D>, &Domain<D>, &Run<'_>),
    waiting: &mut Vec<Waiting>,
    found: &mut Found<D>,
) -> Result<(), Cancelled> {
    let entering = |i: usize| {
        let waiting: Waiting = waiting[i];
        let (line, per_t) = batch.line(waiting.ray);
        let stretch = domain.stretch(&line, (waiting.from, batch.how.to * per_t))?;
        let begin = stretch.begin;
        let relative =
            Stretch { begin: 0.0, first: stretch.first - begin, end: stretch.end - begin, ..stretch };
        let entry = scale(line.at(begin), batch.surface.grid.unit);
        Some((Entered { waiting: Waiting { from: begin, ..waiting }, stretch: relative }, entry))
    };
    let (entered, entries): (Vec<Entered>, Vec<[f64; D]>) =
        run.collect_some(waiting.len(), entering).into_iter().unzip();
    let grouped = Grouped::new(batch.surface, Queries::Points(&entries), run);
    let wanted = Wanted { moving: true, gradient: true, ..Wanted::default() };
    let gathered = Mutex::new(Gathered { hits: Vec::new(), rests: Vec::new() });
    grouped.for_each_group(run, wanted, |evaluator, group| {
        let found = through_group((evaluator, group), &entered, batch);
        let mut gathered = gathered.lock().unwrap_or_else(PoisonError::into_inner);
        gathered.hits.extend(found.hits);
        gathered.rests.extend(found.rests);
    })?;
    let gathered = gathered.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.hits.extend(gathered.hits);
    waiting.clear();
    for rest in gathered.rests {
        let ray = rest.ray as usize;
        found.evaluations[ray] += rest.evaluations;
        if found.status[ray] == Status::Outside {
            found.status[ray] = rest.rejected.unwrap_or(Status::Outside);
        }
        match rest.from {
            Some(from) => waiting.push(Waiting { ray: rest.ray, from, inclusive: false }),
            None if rest.spent => found.status[ray] = Status::NotConverged,
            None => {}
        }
    }
    // Threads finish in any order.
    waiting.sort_unstable_by_key(|waiting| waiting.ray);
    Ok(())
}

impl<const D: usize> Ray<D> {
    fn is_usable(&self) -> bool {
        let pace = length(self.direction);
        self.origin.iter().all(|c| c.is_finite()) && pace > 0.0 && pace < f64::INFINITY
    }
}

impl<const D: usize> Batch<'_, D> {
    /// A ray in units of the grid, and the way that t of one is.
    fn line(&self, ray: u32) -> (Line<D>, f64) {
        let Ray { origin, direction } = self.rays[ray as usize];
        let (pace, inverse) = (length(direction), 1.0 / self.surface.grid.unit);
        let line = Line { origin: scale(origin, inverse), direction: scale(direction, 1.0 / pace) };
        (line, pace * inverse)
    }

    fn hit(&self, entered: &Entered, (way, point): (f64, [f64; D]), local: &Local<D>) -> Hit<D> {
        let ray = entered.waiting.ray;
        Hit {
            ray,
            t: (entered.waiting.from + way) / self.line(ray).1,
            point: scale(point, self.surface.grid.unit),
            surface_normal: local.surface_normal,
            frame_normal: local.normal,
            gradient: local.gradient,
        }
    }
}

/// Marches the rays of a group.
fn through_group<const D: usize>(
    (evaluator, group): (&mut Evaluator<'_, D>, &Group<D>),
    entered: &[Entered],
    batch: &Batch<'_, D>,
) -> Gathered<D> {
    let room = group.rows.len();
    let mut found = Gathered { hits: Vec::with_capacity(room), rests: Vec::with_capacity(room) };
    for &place in &group.invalid {
        let (ray, rejected) = (entered[place as usize].waiting.ray, Some(Status::Invalid));
        found.rests.push(Rest { ray, evaluations: 0, rejected, from: None, spent: false });
    }
    for (places, positions) in group.rows.chunks(IN_STEP).zip(group.positions.chunks(IN_STEP)) {
        in_step((evaluator, batch), (places, positions), entered, &mut found);
    }
    found
}

/// Marches rays, all by one evaluation at a time.
fn in_step<const D: usize>(
    (evaluator, batch): (&mut Evaluator<'_, D>, &Batch<'_, D>),
    (places, starts): (&[u32], &[Position<D>]),
    entered: &[Entered],
    found: &mut Gathered<D>,
) {
    let rules = &batch.rules;
    let start = |(&place, at): (&u32, &Position<D>)| {
        let Entered { waiting, stretch } = entered[place as usize];
        let (line, per_t) = batch.line(waiting.ray);
        let to = batch.how.to * per_t - waiting.from;
        March::new((at.anchor, line.direction), (stretch, to, waiting.inclusive), rules)
    };
    let mut marches: Vec<March<D>> = places.iter().zip(starts).map(start).collect();
    let mut under_way: Vec<usize> = (0..marches.len()).collect();
    let mut positions = Vec::with_capacity(marches.len());
    while !under_way.is_empty() {
        positions.clear();
        positions.extend(under_way.iter().map(|&i| marches[i].position()));
        evaluator.evaluate(&positions, &|_, _| {}, |place, answers, lane| {
            let i = under_way[place];
            let (march, entered) = (&mut marches[i], &entered[places[i] as usize]);
            let mut has_hit = false;
            let mut next = march.take(answers.local(lane), rules);
            while let Next::Hit(way, local) = next {
                found.hits.push(batch.hit(entered, (way, march.point_at(way)), &local));
                has_hit = true;
                next = if batch.stop == Stop::AtFirst { Next::End } else { march.proceed(None, rules) };
            }
            if matches!(next, Next::Evaluate) {
                return;
            }
            march.has_ended = true;
            let ray = entered.waiting.ray;
            let is_done = batch.stop == Stop::AtFirst && has_hit;
            let spent = march.is_spent() && !is_done;
            let from = entered.waiting.from + march.after();
            let goes_on = !is_done && !spent && from < batch.line(ray).1 * batch.how.to;
            found.rests.push(Rest {
                ray,
                evaluations: march.evaluations,
                rejected: march.rejected,
                from: goes_on.then_some(from),
                spent,
            });
        });
        under_way.retain(|&i| !marches[i].has_ended);
    }
}
