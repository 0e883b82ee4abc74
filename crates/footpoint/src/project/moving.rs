//! Points on their way to the surface: the plain iteration, a faster one, and what follows where either fails.

use super::{Operator, Project};
use crate::algebra::{Vector, add, add_scaled, dot, length, scale, sub};
use crate::evaluator::{Evaluator, Local, Position};
use crate::status::Status;
use crate::surface::{Sign, Surface};

/// The first attempt mixes iterates (Anderson's method); the second is the plain iteration; then steps are halved, time after
/// time: they have the same limits, and reach them where full steps go round in circles or leave the domain; the last takes
/// full steps again and all the evaluations left, so that what plain iteration solves, however slowly, is solved.
pub(super) const ATTEMPTS: i32 = 7;
/// Evaluations in which the residual must halve, or the attempt has failed.
const PATIENCE: u32 = 20;
/// The same while iterates are mixed.
const PATIENCE_MIXED: u32 = 8;
/// A mixed step may be this many times as long as the plain one.
const LONGEST_MIXED: f64 = 5.0;

/// One point on its way to the surface.
#[derive(Clone, Copy)]
pub(super) struct Moving<const D: usize> {
    pub(super) position: Position<D>,
    /// Everything at `position`, once evaluated there.
    pub(super) local: Local<D>,
    /// The larger of |f| and the plain step, at the last position where f exists.
    pub(super) residual: f64,
    pub(super) evaluations: u32,
    /// Attempts before this one, and evaluations before it.
    failed: i32,
    before: u32,
    /// The residual that the next one is to halve, and the number of its evaluation.
    mark: (f64, u32),
    /// Earlier offsets of this attempt and their plain steps, the last first.
    history: [(Vector<f64, D>, Vector<f64, D>); 2],
    remembered: usize,
    /// *ok* while it moves and when it has arrived.
    status: Status,
}

impl<const D: usize> Moving<D> {
    pub(super) fn new(position: Position<D>) -> Self {
        Self {
            position,
            local: Local::NOWHERE,
            residual: f64::NAN,
            evaluations: 0,
            failed: 0,
            before: 0,
            mark: (f64::INFINITY, 0),
            history: [([0.0; D], [0.0; D]); 2],
            remembered: 0,
            status: Status::Ok,
        }
    }

    pub(super) fn verdict(&self, surface: &Surface<D>) -> Status {
        if !self.status.is_ok() {
            return self.status;
        }
        match self.local.acceptance(&surface.definition) {
            Status::Ok if !self.local.has_surface_normal() => Status::Singular,
            verdict => verdict,
        }
    }

    pub(super) fn distance(&self, sign: Sign) -> f64 {
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
        }
    }

    /// Whether the attempt stands at its start.
    fn is_first(&self) -> bool {
        self.evaluations == self.before + 1
    }

    /// Takes in the evaluation at `position` and moves on, or ends; true while it is under way.
    fn advance(&mut self, local: Local<D>, surface: &Surface<D>, how: &Project, attempts: i32) -> bool {
        self.local = local;
        self.evaluations += 1;
        if !local.status.is_ok() {
            return self.fail(local.status, how, attempts);
        }
        let last = self.failed + 1 == attempts;
        let mixing = self.failed == 0 && !last;
        let offset = self.position.offset;
        let step = sub(self.next_offset(how.operator), offset);
        let slides = how.operator == Operator::Basic && self.is_first();
        self.residual = length(step).max(local.value.abs());
        if !slides && self.residual <= how.tolerance * local.support {
            // Mixing may have found another zero than the plain iteration, and one that does not belong to the surface.
            return mixing
                && !self.verdict(surface).is_ok()
                && self.fail(Status::NotConverged, how, attempts);
        }
        if self.residual < 0.5 * self.mark.0 {
            self.mark = (self.residual, self.evaluations);
        }
        let patience = if mixing { PATIENCE_MIXED } else { PATIENCE };
        let stuck = !last && self.evaluations - self.mark.1 >= patience;
        if stuck || self.evaluations >= how.most_evaluations || self.residual.is_nan() {
            let status = if self.residual.is_nan() { Status::Singular } else { Status::NotConverged };
            return self.fail(status, how, attempts);
        }
        let share = if slides || last { 1.0 } else { 0.5_f64.powi((self.failed - 1).max(0)) };
        let mixed = if mixing && !slides { self.mixed(offset, step) } else { None };
        let next = Position { offset: mixed.unwrap_or(add_scaled(offset, step, share)), ..self.position };
        if !surface.grid.holds(next.rounded()) || !surface.grid.holds(next.offset) {
            return self.fail(Status::Singular, how, attempts);
        }
        if !slides {
            self.history = [(offset, step), self.history[0]];
            self.remembered = (self.remembered + 1).min(2);
        }
        self.position = next;
        true
    }

    /// Anderson's mixture: of the plain images of this iterate and the last ones, the affine combination whose steps, combined
    /// alike, are shortest. None where it would be a leap, or is not defined.
    fn mixed(&self, offset: Vector<f64, D>, step: Vector<f64, D>) -> Option<Vector<f64, D>> {
        if self.remembered == 0 {
            return None;
        }
        let [(last, last_step), (earlier, earlier_step)] = self.history;
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
        // Not so for NaN.
        (length(sub(mixed, offset)) <= LONGEST_MIXED * length(step)).then_some(mixed)
    }

    /// Begins the next attempt, or ends with the status of the failure.
    fn fail(&mut self, status: Status, how: &Project, attempts: i32) -> bool {
        let hopeless = self.is_first() && !self.local.status.is_ok();
        if hopeless || self.failed + 1 >= attempts || self.evaluations >= how.most_evaluations {
            self.status = status;
            return false;
        }
        self.failed += 1;
        self.before = self.evaluations;
        self.mark = (f64::INFINITY, self.evaluations);
        self.remembered = 0;
        self.position = Position::at(self.position.anchor);
        true
    }
}

/// Iterates the operator (SPEC § 6) for a group until every point has ended, with at most so many attempts each; one
/// attempt gives the plain iterates. Points under way stay together in full blocks. `observe` sees every evaluation.
pub(super) fn iterate<const D: usize>(
    (surface, evaluator): (&Surface<D>, &mut Evaluator<'_, D>),
    points: &mut [Moving<D>],
    how: &Project,
    attempts: i32,
    mut observe: impl FnMut(&Position<D>, &Local<D>),
) {
    let mut under_way: Vec<usize> = (0..points.len()).collect();
    let mut positions = Vec::with_capacity(points.len());
    let mut moves = Vec::with_capacity(points.len());
    while !under_way.is_empty() {
        positions.clear();
        positions.extend(under_way.iter().map(|&i| points[i].position));
        moves.clear();
        evaluator.evaluate(&positions, &|_, _| {}, |place, answers, lane| {
            let local = answers.local(lane);
            observe(&positions[place], &local);
            let point = &mut points[under_way[place]];
            moves.push(point.advance(local, surface, how, attempts));
        });
        let mut moves = moves.iter();
        under_way.retain(|_| moves.next().is_some_and(|&moves| moves));
    }
}
