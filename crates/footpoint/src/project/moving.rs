//! Points on their way to the surface: the plain iteration, a faster one, and what follows where either fails.

use super::{Landing, Operator, Project};
use crate::algebra::{Vector, add, add_scaled, dot, length, scale, sub};
use crate::evaluator::{Evaluator, Local, Position};
use crate::status::Status;
use crate::surface::{Sign, Surface};

/// How a point is taken on from iterate to iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// The plain iterates, mixed (Anderson's method): fewer evaluations.
    Mixed,
    /// This share of each plain step. Shares have the limits of the whole, and reach them where full steps go round in
    /// circles or leave the domain.
    Share(f64),
}

/// What is tried, all at once, where the first attempt fails: the plain iteration and shares of it. Of those that arrive the
/// first counts.
const SECOND_ATTEMPTS: [Way; 4] = [Way::Share(1.0), Way::Share(0.5), Way::Share(0.25), Way::Share(0.125)];

impl Way {
    /// Evaluations in which the residual must halve, or the attempt has failed. The plain iteration may take long: what it
    /// solves is to be solved.
    fn patience(self) -> u32 {
        match self {
            Self::Mixed => 8,
            Self::Share(1.0) => 64,
            Self::Share(_) => 20,
        }
    }
}

/// With fewer evaluations left none of these arrives.
const FEWEST: u32 = 4;

/// A mixed step may be this many times as long as the plain one: a leap may end at another zero.
const LONGEST_MIXED: f64 = 2.0;

/// One point on its way to the surface.
#[derive(Clone, Copy)]
pub(super) struct Moving<const D: usize> {
    position: Position<D>,
    /// Everything at `position`, once evaluated there.
    local: Local<D>,
    /// The square of the larger of |f| and the plain step, at the last position where f exists.
    squared_residual: f64,
    evaluations: u32,
    way: Way,
    /// The squared residual that the next is to fall to a quarter of, and the number of its evaluation.
    mark: (f64, u32),
    most_evaluations: u32,
    /// Earlier offsets of this attempt and their plain steps, the last first.
    history: [(Vector<f64, D>, Vector<f64, D>); 2],
    remembered: usize,
    /// Whether it has arrived or failed.
    ended: bool,
    /// *ok* while it moves and when it has arrived.
    status: Status,
}

impl<const D: usize> Moving<D> {
    /// The *basic* operator's limit depends on the way there, so it is not mixed.
    pub(super) fn new(position: Position<D>, how: &Project) -> Self {
        let way = if how.operator == Operator::Basic { Way::Share(1.0) } else { Way::Mixed };
        Self::on(position, way, how.most_evaluations)
    }

    fn on(position: Position<D>, way: Way, most_evaluations: u32) -> Self {
        Self {
            position,
            local: Local::NOWHERE,
            squared_residual: f64::NAN,
            evaluations: 0,
            way,
            mark: (f64::INFINITY, 0),
            most_evaluations,
            history: [([0.0; D], [0.0; D]); 2],
            remembered: 0,
            ended: false,
            status: Status::Ok,
        }
    }

    pub(super) fn landing(&self, surface: &Surface<D>) -> Landing<D> {
        Landing {
            point: self.position.rounded(),
            surface_normal: self.local.surface_normal,
            frame_normal: self.local.normal,
            distance: self.distance(surface.sign()),
            residual: self.squared_residual.sqrt(),
            evaluations: self.evaluations,
        }
    }

    pub(super) fn verdict(&self, surface: &Surface<D>) -> Status {
        if !self.status.is_ok() {
            return self.status;
        }
        self.local.verdict(&surface.definition)
    }

    fn distance(&self, sign: Sign) -> f64 {
        let back = scale(self.position.offset, -1.0);
        let distance = length(back);
        // Where no neighbour has a normal the sign is arbitrary even if the cloud has normals elsewhere.
        let signed = sign == Sign::Given && self.local.signed;
        if signed && dot(back, self.local.gradient) < 0.0 { -distance } else { distance }
    }

    /// Way from the anchor to the next iterate of the plain operator.
    fn next_offset(&self, operator: Operator) -> Vector<f64, D> {
        let Local { normal, value, gradient, aside, .. } = self.local;
        let offset = self.position.offset;
        match operator {
            Operator::Basic if self.is_first() => aside,
            Operator::Basic => add_scaled(offset, normal, -value),
            // φ = f + n·(x − y), and x − y = −offset.
            Operator::AlmostOrthogonal => scale(normal, dot(normal, offset) - value),
            Operator::Orthogonal => scale(gradient, (dot(normal, offset) - value) / dot(normal, gradient)),
            // It does not iterate on f.
            Operator::Levin { .. } => [f64::NAN; D],
        }
    }

    /// Whether it stands at its start.
    fn is_first(&self) -> bool {
        self.evaluations == 1
    }

    /// Takes in the evaluation at `position` and moves on, or ends.
    fn advance(&mut self, local: Local<D>, surface: &Surface<D>, how: &Project) {
        self.local = local;
        self.evaluations += 1;
        if !local.status.is_ok() {
            return self.fail(local.status);
        }
        let offset = self.position.offset;
        let step = sub(self.next_offset(how.operator), offset);
        let slides = how.operator == Operator::Basic && self.is_first();
        let squared_step = dot(step, step);
        self.squared_residual = squared_step.max(local.value * local.value);
        if squared_step.is_nan() {
            return self.fail(Status::Singular);
        }
        let tolerance = how.tolerance * local.support;
        if !slides && self.squared_residual <= tolerance * tolerance {
            self.ended = true;
            return;
        }
        if self.squared_residual < 0.25 * self.mark.0 {
            self.mark = (self.squared_residual, self.evaluations);
        }
        let stuck = self.evaluations - self.mark.1 >= self.way.patience();
        if stuck || self.evaluations >= self.most_evaluations {
            return self.fail(Status::NotConverged);
        }
        let next = match self.way {
            Way::Mixed if !slides => self.mixed(offset, step).unwrap_or(add(offset, step)),
            Way::Share(share) if !slides => add_scaled(offset, step, share),
            _ => add(offset, step),
        };
        let next = Position { offset: next, ..self.position };
        if !surface.grid.holds(next.rounded()) || !surface.grid.holds(next.offset) {
            return self.fail(Status::Singular);
        }
        if !slides {
            self.history = [(offset, step), self.history[0]];
            self.remembered = (self.remembered + 1).min(2);
        }
        self.position = next;
    }

    /// Anderson's mixture: of the plain images of this iterate and the last ones, the affine combination whose steps, combined
    /// alike, are shortest. None where it would be a leap, or is not defined.
    fn mixed(&self, offset: Vector<f64, D>, step: Vector<f64, D>) -> Option<Vector<f64, D>> {
        if self.remembered == 0 {
            return None;
        }
        let [(last, last_step), (earlier, earlier_step)] = self.history;
        // Where steps grow the iterates are not yet near a limit.
        let squared_step = dot(step, step);
        if squared_step > dot(last_step, last_step) {
            return None;
        }
        // Differences of the steps, and of the images.
        let first = sub(step, last_step);
        let first_image = add(sub(offset, last), first);
        let second = sub(last_step, earlier_step);
        let second_image = add(sub(last, earlier), second);
        let (a, b, c) = (dot(first, first), dot(first, second), dot(second, second));
        let (p, q) = (dot(first, step), dot(second, step));
        let determinant = a * c - b * b;
        let image = add(offset, step);
        let mixed = if self.remembered > 1 && determinant > 1e-3 * a * c {
            let alpha = (p * c - q * b) / determinant;
            let beta = (q * a - p * b) / determinant;
            add_scaled(add_scaled(image, first_image, -alpha), second_image, -beta)
        } else {
            add_scaled(image, first_image, -p / a)
        };
        let leap = sub(mixed, offset);
        // Not so for NaN.
        (dot(leap, leap) <= LONGEST_MIXED * LONGEST_MIXED * squared_step).then_some(mixed)
    }

    fn fail(&mut self, status: Status) {
        self.ended = true;
        self.status = status;
    }
}

/// Projects the points of a group: all by the first attempt, then those that it leaves by the second ones.
pub(super) fn project<const D: usize>(
    (surface, evaluator): (&Surface<D>, &mut Evaluator<'_, D>),
    points: &mut [Moving<D>],
    how: &Project,
) {
    iterate((surface, evaluator), points, how, |_| (), |_, _| {});
    let most = SECOND_ATTEMPTS.len();
    let left_over = |point: &Moving<D>| how.most_evaluations.saturating_sub(point.evaluations) / most as u32;
    // Mixing may also have found another zero than the plain iteration, and one that does not belong to the surface.
    let left: Vec<usize> = (0..points.len())
        .filter(|&i| {
            let hopeless = points[i].is_first() && !points[i].local.status.is_ok();
            !hopeless && left_over(&points[i]) >= FEWEST && !points[i].verdict(surface).is_ok()
        })
        .collect();
    if left.is_empty() {
        return;
    }
    let start = |&i: &usize| {
        let (anchor, most) = (points[i].position.anchor, left_over(&points[i]));
        SECOND_ATTEMPTS.map(|way| Moving::on(Position::at(anchor), way, most))
    };
    let mut attempts: Vec<Moving<D>> = left.iter().flat_map(start).collect();
    let stop_the_others = |attempts: &mut [Moving<D>]| {
        for attempts in attempts.chunks_mut(most) {
            let accepted = attempts.iter().any(|attempt| attempt.ended && attempt.verdict(surface).is_ok());
            if accepted || (attempts[0].ended && attempts[0].status.is_ok()) {
                attempts
                    .iter_mut()
                    .filter(|attempt| !attempt.ended)
                    .for_each(|a| a.fail(Status::NotConverged));
            }
        }
    };
    iterate((surface, evaluator), &mut attempts, how, stop_the_others, |_, _| {});
    for (attempts, &i) in attempts.chunks(most).zip(&left) {
        // On the surface if any is; else what became of the plain one, unless only another came to a zero.
        let accepted = attempts.iter().find(|attempt| attempt.verdict(surface).is_ok());
        let arrived = attempts.iter().find(|attempt| attempt.status.is_ok());
        let spent = attempts.iter().map(|attempt| attempt.evaluations).sum::<u32>() + points[i].evaluations;
        points[i] = Moving { evaluations: spent, ..*accepted.or(arrived).unwrap_or(&attempts[0]) };
    }
}

/// The plain iteration from one point; `observe` sees every evaluation.
pub(super) fn trace<const D: usize>(
    (surface, evaluator): (&Surface<D>, &mut Evaluator<'_, D>),
    start: Position<D>,
    how: &Project,
    observe: impl FnMut(&Position<D>, &Local<D>),
) -> Status {
    let mut points = [Moving::on(start, Way::Share(1.0), how.most_evaluations)];
    iterate((surface, evaluator), &mut points, how, |_| (), observe);
    points[0].verdict(surface)
}

/// Iterates the operator (SPEC § 6) until every point has ended. Points under way stay together in full blocks. After each
/// round `prune` may end more; `observe` sees every evaluation.
fn iterate<const D: usize>(
    (surface, evaluator): (&Surface<D>, &mut Evaluator<'_, D>),
    points: &mut [Moving<D>],
    how: &Project,
    prune: impl Fn(&mut [Moving<D>]),
    mut observe: impl FnMut(&Position<D>, &Local<D>),
) {
    let mut under_way: Vec<usize> = (0..points.len()).collect();
    let mut positions = Vec::with_capacity(points.len());
    while !under_way.is_empty() {
        positions.clear();
        positions.extend(under_way.iter().map(|&i| points[i].position));
        evaluator.evaluate(&positions, &|_, _| {}, |place, answers, lane| {
            let local = answers.local(lane);
            observe(&positions[place], &local);
            points[under_way[place]].advance(local, surface, how);
        });
        prune(points);
        under_way.retain(|&i| !points[i].ended);
    }
}
