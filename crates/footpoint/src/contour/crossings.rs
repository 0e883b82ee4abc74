//! Where f vanishes on the sides of the cells, which are halved until that tells how the curve runs through them.

use super::Contour;
use super::cells::{Cell, Corner, Edge, HALVINGS, Lattice, cover};
use super::judge::{Judge, Seen};
use crate::algebra::dot;
use crate::run::Cancelled;
use crate::surface::Running;
use std::collections::HashMap;

/// A zero of f on an edge; accepted or not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) point: [f64; 2],
    pub(super) surface_normal: [f64; 2],
    pub(super) is_accepted: bool,
}

/// Below this cosine between the frame normals at its ends an edge does not tell whether f changes sign, and between the
/// surface normals of two crossings a cell is too wide for the curve in it.
const TURNED: f64 = 0.7;
/// A cell at whose corners |f| is larger than this many of its widths has no zero of f, if n is about the same at all.
const STEEPEST: f64 = 1.5;
/// Evaluations spent on one zero at most: secants need four or five, halving 40.
const MOST_STEPS: usize = 60;

/// In supports from the origin.
const FARTHEST: f64 = (1_u64 << 36) as f64;

/// The cells, what is known at their corners, and the zeros on their sides.
pub(super) struct Net<'r> {
    pub(super) judge: Judge<'r>,
    pub(super) lattice: Lattice,
    pub(super) cells: Vec<Cell>,
    corners: HashMap<Corner, Seen>,
    edges: HashMap<Edge, Option<usize>>,
    pub(super) crossings: Vec<Crossing>,
}

/// A part of an edge at whose ends f has different signs; `low` and `high` are shares of the edge.
struct Bracket {
    edge: Edge,
    low: (f64, f64),
    high: (f64, f64),
    /// n at the lower end, with the sign in which both values are told.
    normal: [f64; 2],
    /// Which end stayed the last time, and how often.
    stayed: i32,
}

impl<'r> Net<'r> {
    pub(super) fn new(running: Running<'r, 2>, how: &Contour) -> Self {
        let surface = running.surface;
        let reach = surface.definition().weight().reach() * surface.definition().domain_ratio();
        let mut discs = surface.samples_with_supports();
        // So far out doubles are too sparse for a zero of f to be told.
        let far = |(centre, radius): &([f64; 2], f64)| centre.iter().any(|c| c.abs() > FARTHEST * radius);
        discs.retain(|disc| !far(disc));
        discs.iter_mut().for_each(|(_, radius)| *radius *= reach);
        let (lattice, cells) = cover(&discs, how.share() / reach);
        Self {
            judge: Judge::new(running, how),
            lattice,
            cells,
            corners: HashMap::new(),
            edges: HashMap::new(),
            crossings: Vec::new(),
        }
    }

    /// Finds the zeros, and halves cells as long as that is of use.
    pub(super) fn refine(&mut self) -> Result<(), Cancelled> {
        self.see_corners()?;
        let cells = std::mem::take(&mut self.cells);
        self.cells = cells.into_iter().filter(|cell| self.may_meet(cell)).collect();
        for _ in 0..HALVINGS {
            self.find_crossings()?;
            if !self.halve_doubtful() {
                return Ok(());
            }
            self.see_corners()?;
        }
        self.find_crossings()
    }

    /// Evaluates at corners that are new.
    fn see_corners(&mut self) -> Result<(), Cancelled> {
        let mut new: Vec<Corner> = self.cells.iter().flat_map(Cell::corners).collect();
        new.retain(|corner| !self.corners.contains_key(corner));
        new.sort_unstable();
        new.dedup();
        let points: Vec<[f64; 2]> = new.iter().map(|&corner| self.lattice.at(corner)).collect();
        let seen = self.judge.see(&points)?;
        self.corners.extend(new.into_iter().zip(seen));
        Ok(())
    }

    /// Whether the curve may run through a cell or along its sides.
    fn may_meet(&self, cell: &Cell) -> bool {
        let width = self.lattice.length(cell.side);
        let seen = cell.corners().map(|corner| self.corners[&corner]);
        if seen.iter().all(|seen| seen.value.is_nan() || !self.is_near(seen, width)) {
            return false;
        }
        // Where frames agree f is about as steep as a distance.
        let agree = |other: &Seen| dot(seen[0].normal, other.normal).abs() >= TURNED;
        !seen.iter().all(|seen| seen.value.abs() > STEEPEST * width && agree(seen))
    }

    /// Whether an accepted zero may lie within a cell of this width at whose corner this is seen: a moves about as fast as x.
    fn is_near(&self, seen: &Seen, width: f64) -> bool {
        seen.aside <= self.judge.boundary * seen.support + 2.0 * width
    }

    /// The sides of a cell, cut where another cell has a corner.
    pub(super) fn edges(&self, cell: &Cell) -> Vec<Edge> {
        let mut uncut = cell.sides().to_vec();
        let mut edges = Vec::with_capacity(4);
        while let Some(edge) = uncut.pop() {
            if edge.length > 1 && self.corners.contains_key(&edge.middle()) {
                uncut.extend(edge.halves());
            } else {
                edges.push(edge);
            }
        }
        edges
    }

    /// The zeros on the sides of a cell, by their number.
    pub(super) fn crossings_of(&self, cell: &Cell) -> Vec<usize> {
        let number = |edge: Edge| self.edges.get(&edge).copied().flatten();
        self.edges(cell).into_iter().filter_map(number).collect()
    }

    fn ends(&self, edge: &Edge) -> Option<(&Seen, &Seen)> {
        let ends = (self.corners.get(&edge.from)?, self.corners.get(&edge.to())?);
        (!ends.0.value.is_nan() && !ends.1.value.is_nan()).then_some(ends)
    }

    /// Finds the zero on every edge that is new and has one.
    fn find_crossings(&mut self) -> Result<(), Cancelled> {
        let mut brackets = Vec::new();
        for cell in &self.cells {
            for edge in self.edges(cell) {
                if self.edges.contains_key(&edge) {
                    continue;
                }
                self.edges.insert(edge, None);
                brackets.extend(self.ends(&edge).and_then(|ends| Bracket::new(edge, ends)));
            }
        }
        for step in 0..MOST_STEPS {
            if brackets.is_empty() {
                return Ok(());
            }
            let shares: Vec<f64> = brackets.iter().map(|bracket| bracket.next(step)).collect();
            let point = |(bracket, &share): (&Bracket, &f64)| bracket.at(&self.lattice, share);
            let points: Vec<[f64; 2]> = brackets.iter().zip(&shares).map(point).collect();
            let seen = self.judge.see(&points)?;
            let mut open = Vec::new();
            for (i, mut bracket) in brackets.into_iter().enumerate() {
                let Seen { surface_normal, is_accepted, .. } = seen[i];
                if seen[i].is_zero {
                    self.edges.insert(bracket.edge, Some(self.crossings.len()));
                    self.crossings.push(Crossing { point: points[i], surface_normal, is_accepted });
                } else if bracket.narrow(shares[i], &seen[i]) {
                    open.push(bracket);
                }
            }
            brackets = open;
        }
        Ok(())
    }

    /// Halves the cells in which the way of the curve is in doubt; whether there are any.
    fn halve_doubtful(&mut self) -> bool {
        let doubtful: Vec<bool> = self.cells.iter().map(|cell| self.is_doubtful(cell)).collect();
        let halved = |(cell, &doubtful): (&Cell, &bool)| {
            if doubtful { cell.quarters().to_vec() } else { vec![*cell] }
        };
        self.cells = self.cells.iter().zip(&doubtful).flat_map(halved).collect();
        doubtful.contains(&true)
    }

    fn is_doubtful(&self, cell: &Cell) -> bool {
        let crossings: Vec<&Crossing> =
            self.crossings_of(cell).into_iter().map(|number| &self.crossings[number]).collect();
        if crossings.iter().any(|crossing| crossing.is_accepted) {
            let &[one, other] = crossings.as_slice() else { return true };
            if dot(one.surface_normal, other.surface_normal).abs() < TURNED {
                return true;
            }
        }
        let width = self.lattice.length(cell.side);
        self.edges(cell).iter().filter_map(|edge| self.ends(edge)).any(|(one, other)| {
            let turned = dot(one.normal, other.normal).abs() < TURNED;
            turned && self.is_near(one, width) && self.is_near(other, width)
        })
    }
}

impl Bracket {
    /// The whole edge, if f changes sign along it. Frames have no sign of their own, so that of n is carried along the edge. A
    /// zero at a corner counts as positive in the sign of its own frame, which is the same for all edges there.
    fn new(edge: Edge, (from, to): (&Seen, &Seen)) -> Option<Self> {
        let sign = if dot(from.normal, to.normal) < 0.0 { -1.0 } else { 1.0 };
        let nudged = |value: f64| if value == 0.0 { f64::MIN_POSITIVE } else { value };
        let (low, high) = (nudged(from.value), sign * nudged(to.value));
        let bracket = Self { edge, low: (0.0, low), high: (1.0, high), normal: from.normal, stayed: 0 };
        ((low < 0.0) != (high < 0.0)).then_some(bracket)
    }

    /// Where to look next: where the secant is zero, or in the middle every third time.
    fn next(&self, step: usize) -> f64 {
        let ((low, f_low), (high, f_high)) = (self.low, self.high);
        let share = if step % 3 == 2 { 0.5 } else { f_low / (f_low - f_high) };
        low + share * (high - low)
    }

    fn at(&self, lattice: &Lattice, share: f64) -> [f64; 2] {
        let mut point = lattice.at(self.edge.from);
        point[self.edge.axis] += share * lattice.length(self.edge.length);
        point
    }

    /// Takes in a value at this share; whether there is still something to look for.
    fn narrow(&mut self, share: f64, seen: &Seen) -> bool {
        if seen.value.is_nan() {
            return false;
        }
        let sign = if dot(self.normal, seen.normal) < 0.0 { -1.0 } else { 1.0 };
        let value = sign * seen.value;
        // An end that stays for the second time counts half, so that the other one moves (the Illinois rule).
        if (value < 0.0) == (self.low.1 < 0.0) {
            self.low = (share, value);
            self.normal = seen.normal.map(|c| sign * c);
            if self.stayed > 0 {
                self.high.1 *= 0.5;
            }
            self.stayed = 1;
        } else {
            self.high = (share, value);
            if self.stayed < 0 {
                self.low.1 *= 0.5;
            }
            self.stayed = -1;
        }
        self.high.0 - self.low.0 > f64::EPSILON
    }
}
