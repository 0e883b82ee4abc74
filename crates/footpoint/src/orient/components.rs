//! Connected components of the forest: their counts, their verdict, and their side.

use super::forest::Forest;
use super::verdict::{around, odd_edges};
use super::{Component, NO_COMPONENT, Verdict};
use crate::neighbours::Neighbours;
use crate::run::{Cancelled, Run};
use crate::surface::Surface;

/// Where |the axis' component| of a normal is above this, the normal tells sides along that axis.
const TELLING: f64 = 0.5;

/// The components of a forest.
pub(super) struct Components {
    /// Number of each place's component; `NO_COMPONENT` without a normal.
    pub(super) number: Vec<u32>,
    /// Largest first, then in canonical order.
    pub(super) all: Vec<Component>,
}

impl Components {
    /// Numbers the trees and counts their samples and doubtful edges.
    pub(super) fn of<const D: usize>(forest: &Forest, normals: &[[f32; D]]) -> Self {
        let mut number = vec![0; normals.len()];
        let present = |place: usize| !normals[place][0].is_nan();
        for place in (0..normals.len()).filter(|&i| present(i)) {
            number[forest.sets.first(place)] += 1;
        }
        let mut trees: Vec<(u32, u32)> =
            (0..number.len()).filter(|&i| number[i] > 0).map(|i| (number[i], i as u32)).collect();
        trees.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        number.fill(NO_COMPONENT);
        let mut all = Vec::with_capacity(trees.len());
        for (rank, (samples, first)) in trees.into_iter().enumerate() {
            number[first as usize] = rank as u32;
            all.push(Component { samples: samples as usize, ..Component::default() });
        }
        // The first place of a tree comes before the others.
        for place in (0..number.len()).filter(|&i| present(i)) {
            number[place] = number[forest.sets.first(place)];
        }
        for &place in &forest.doubtful {
            all[number[place as usize] as usize].doubtful_edges += 1;
        }
        Self { number, all }
    }

    /// Counts the odd edges and judges: a component is not orientable if it has an odd edge that nothing near it explains.
    pub(super) fn judge<const D: usize>(
        &mut self,
        near: &Neighbours<'_, D>,
        normals: &[[f32; D]],
        forest: &Forest,
        run: &Run<'_>,
    ) -> Result<(), Cancelled> {
        let odd = odd_edges(near, normals, &forest.sets, run)?;
        let mut explained = vec![false; if odd.iter().any(|&o| o > 0) { odd.len() } else { 0 }];
        for (place, &odd) in odd.iter().enumerate().filter(|(_, odd)| **odd > 0) {
            let component = &mut self.all[self.number[place] as usize];
            component.odd_edges += odd as usize;
            if component.verdict == Verdict::NonOrientable || explained[place] {
                continue;
            }
            run.check()?;
            let around = around(near, normals, place);
            if around.contradictory {
                around.inner.into_iter().for_each(|i| explained[i] = true);
            } else {
                component.verdict = Verdict::NonOrientable;
            }
        }
        Ok(())
    }

    /// For each component whether its signs are all to be reversed, so that it faces outward: the sample that is highest along
    /// the last axis, or the next one where its normal does not tell, has a normal that points up that axis.
    pub(super) fn reversed<const D: usize>(
        &self,
        surface: &Surface<D>,
        normal: &[[f64; D]],
        forest: &Forest,
    ) -> Vec<bool> {
        let (original, points) = (surface.grid.original(), surface.cloud.points());
        let mut highest = vec![[u32::MAX; D]; self.all.len()];
        for (place, &row) in original.iter().enumerate() {
            let Some(highest) = highest.get_mut(self.number[place] as usize) else { continue };
            for k in 0..D {
                let height = |place: u32| points[original[place as usize] as usize][k];
                if highest[k] == u32::MAX || points[row as usize][k] > height(highest[k]) {
                    highest[k] = place as u32;
                }
            }
        }
        let signed = |place: u32| {
            let n = normal[original[place as usize] as usize];
            if forest.sets.is_opposed(place as usize) { n.map(|c| -c) } else { n }
        };
        let is_reversed = |highest: &[u32; D]| {
            let telling = (0..D).rev().map(|k| signed(highest[k])[k]).find(|c| c.abs() > TELLING);
            // Else the largest component of the last one is positive, as of any normal without a sign (SPEC § 3).
            let last = signed(highest[D - 1]);
            let largest = (1..D).fold(0, |best, k| if last[k].abs() > last[best].abs() { k } else { best });
            telling.unwrap_or(last[largest]) < 0.0
        };
        highest.iter().map(is_reversed).collect()
    }
}
