//! Zeros joined through the cells to chains, and their ends at the rims.

use super::Polyline;
use super::cells::Cell;
use super::crossings::{Crossing, Net};
use super::judge::Seen;
use crate::algebra::{add_scaled, dot, length, scale, sub};
use crate::run::Cancelled;

/// Halvings that find the end of a curve between two crossings.
const RIM_HALVINGS: usize = 20;
/// Newton's steps that take a point between two crossings to f = 0.
const CORRECTIONS: usize = 6;
/// Vertices nearer to each other than this share of the narrowest cell possible are one.
const SAME: f64 = 1e-6;

/// Which crossings follow each other along the curve.
pub(super) struct Chains {
    /// Of every crossing, and of the ends after them, at most two that it is joined to.
    links: Vec<Vec<usize>>,
    /// From an accepted crossing to one that is not.
    open: Vec<(usize, usize)>,
    /// Ends of the curve, numbered after the crossings.
    ends: Vec<Crossing>,
}

impl Chains {
    pub(super) fn of(net: &Net<'_>) -> Self {
        let mut chains =
            Self { links: vec![Vec::new(); net.crossings.len()], open: Vec::new(), ends: Vec::new() };
        for cell in &net.cells {
            for (one, other) in pairs(net, cell) {
                match [one, other].map(|number| net.crossings[number].is_accepted) {
                    [true, true] => chains.join(one, other),
                    [true, false] => chains.open.push((one, other)),
                    [false, true] => chains.open.push((other, one)),
                    [false, false] => {}
                }
            }
        }
        chains
    }

    fn join(&mut self, one: usize, other: usize) {
        self.links[one].push(other);
        self.links[other].push(one);
    }

    /// Follows the curve from the last accepted crossing to where the rule of acceptance ends it.
    pub(super) fn find_rims(&mut self, net: &mut Net<'_>) -> Result<(), Cancelled> {
        let open = std::mem::take(&mut self.open);
        let ways: Vec<[[f64; 2]; 2]> =
            open.iter().map(|&(one, other)| [one, other].map(|number| net.crossings[number].point)).collect();
        let mut shares = vec![(0.0_f64, 1.0_f64); open.len()];
        let mut found: Vec<Option<Crossing>> = vec![None; open.len()];
        for _ in 0..RIM_HALVINGS {
            let between = |(&[from, to], &(low, high)): (&[[f64; 2]; 2], &(f64, f64))| {
                add_scaled(from, sub(to, from), 0.5 * (low + high))
            };
            let mut points: Vec<[f64; 2]> = ways.iter().zip(&shares).map(between).collect();
            let mut seen = net.judge.see(&points)?;
            for _ in 0..CORRECTIONS {
                points.iter_mut().zip(&seen).for_each(|(point, seen)| *point = corrected(*point, seen));
                seen = net.judge.see(&points)?;
            }
            for (i, seen) in seen.iter().enumerate() {
                let middle = 0.5 * (shares[i].0 + shares[i].1);
                if seen.is_zero && seen.is_accepted {
                    shares[i].0 = middle;
                    let Seen { surface_normal, is_accepted, .. } = *seen;
                    found[i] = Some(Crossing { point: points[i], surface_normal, is_accepted });
                } else {
                    shares[i].1 = middle;
                }
            }
        }
        for ((last, _), end) in open.into_iter().zip(found) {
            let Some(end) = end else { continue };
            let number = self.links.len();
            self.links.push(Vec::new());
            self.ends.push(end);
            self.join(last, number);
        }
        Ok(())
    }

    /// The chains, longest first.
    pub(super) fn polylines(&self, net: &Net<'_>) -> Vec<Polyline> {
        let mut visited = vec![false; self.links.len()];
        let mut polylines = Vec::new();
        for links in [1, 2] {
            for first in 0..self.links.len() {
                if !visited[first] && self.links[first].len() == links {
                    let chain = self.follow(first, &mut visited);
                    polylines.extend(self.polyline(net, &chain, links == 2));
                }
            }
        }
        polylines.sort_by(|a: &Polyline, b: &Polyline| b.length().total_cmp(&a.length()));
        polylines
    }

    /// The chain that begins here.
    fn follow(&self, first: usize, visited: &mut [bool]) -> Vec<usize> {
        let mut chain = vec![first];
        let mut here = first;
        visited[first] = true;
        while let Some(&next) = self.links[here].iter().find(|&&next| !visited[next]) {
            visited[next] = true;
            chain.push(next);
            here = next;
        }
        chain
    }

    /// Its vertices; none where they are all one.
    fn polyline(&self, net: &Net<'_>, chain: &[usize], closed: bool) -> Option<Polyline> {
        let at = |number: usize| {
            net.crossings.get(number).unwrap_or_else(|| &self.ends[number - net.crossings.len()])
        };
        let apart = |a: [f64; 2], b: [f64; 2]| length(sub(a, b)) > SAME * net.lattice.length(1);
        let mut line = Polyline { closed, ..Polyline::default() };
        for crossing in chain.iter().map(|&number| at(number)) {
            if line.points.last().is_some_and(|&last| !apart(last, crossing.point)) {
                continue;
            }
            let normal = crossing.surface_normal;
            let agrees = line.surface_normal.last().is_none_or(|&last| dot(last, normal) >= 0.0);
            line.points.push(crossing.point);
            line.surface_normal.push(if agrees { normal } else { scale(normal, -1.0) });
        }
        if closed && line.points.len() > 2 && !apart(line.points[0], line.points[line.points.len() - 1]) {
            line.points.pop();
            line.surface_normal.pop();
        }
        (line.points.len() > 1).then_some(line)
    }
}

/// A step along ∇f towards f = 0.
fn corrected(point: [f64; 2], seen: &Seen) -> [f64; 2] {
    let square = dot(seen.gradient, seen.gradient);
    if seen.is_zero || seen.value.is_nan() || square.is_nan() || square <= 0.0 {
        return point;
    }
    add_scaled(point, seen.gradient, -seen.value / square)
}

/// Which zeros on the sides of a cell the curve joins inside it. Two are joined; of more, which are left only where halving
/// ended, those are joined first whose connection is nearest to a tangent at both.
fn pairs(net: &Net<'_>, cell: &Cell) -> Vec<(usize, usize)> {
    let crossings = net.crossings_of(cell);
    if !crossings.iter().any(|&number| net.crossings[number].is_accepted) {
        return Vec::new();
    }
    if let &[one, other] = crossings.as_slice() {
        return vec![(one, other)];
    }
    let mut all = Vec::new();
    for (i, &one) in crossings.iter().enumerate() {
        for &other in &crossings[i + 1..] {
            let [a, b] = [one, other].map(|number| &net.crossings[number]);
            let way = sub(b.point, a.point);
            let aside = dot(way, a.surface_normal).abs() + dot(way, b.surface_normal).abs();
            all.push((aside / length(way).max(f64::MIN_POSITIVE), one, other));
        }
    }
    // Connections at more than 45 degrees to the tangents are none.
    all.retain(|&(aside, ..)| aside < std::f64::consts::SQRT_2);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (_, one, other) in all {
        if !found.iter().any(|&(a, b)| [a, b].contains(&one) || [a, b].contains(&other)) {
            found.push((one, other));
        }
    }
    found
}
