//! The minimum spanning forest of the neighbour graph, which signs are carried along.

use super::edge::Edge;
use super::signs::SignedSets;
use crate::neighbours::Neighbours;
use crate::run::{Cancelled, Run};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The forest: its trees with the signs that its edges give their places.
pub(super) struct Forest {
    /// Settled.
    pub(super) sets: SignedSets,
    /// One end of each doubtful edge in it.
    pub(super) doubtful: Vec<u32>,
}

/// No edge leads out of the tree from here, nor will one.
const NO_EDGE: u64 = u64::MAX;
const NO_PLACE: u32 = u32::MAX;

/// An edge as a number that orders by weight, then by the other end; the sign stands between them and is the same from
/// either end. Weights are positive, so their bits order like them, and at most 2, so the highest bit is free.
fn packed(edge: Edge, to: usize) -> u64 {
    let head = (edge.weight.to_bits() << 1) | u32::from(edge.opposed);
    (u64::from(head) << 32) | to as u64
}

fn other_end(packed: u64) -> usize {
    (packed & u64::from(u32::MAX)) as usize
}

fn is_opposed(packed: u64) -> bool {
    (packed >> 32) & 1 == 1
}

fn is_doubtful(packed: u64) -> bool {
    (packed >> 33) as u32 >= 1.0_f32.to_bits()
}

/// The strict total order of edges: weight, then the ends in canonical order, which is one of content.
fn rank(place: usize, packed: u64) -> (u64, usize, usize) {
    let to = other_end(packed);
    (packed >> 32, place.min(to), place.max(to))
}

/// Borůvka's algorithm, with the edges found anew where they are needed instead of stored: in every round each tree is
/// joined by its least edge to another. A place looks again only when its own least edge has come to lie inside its tree, and
/// for the last time when all its neighbours do.
pub(super) fn grow<const D: usize>(
    near: &Neighbours<'_, D>,
    normals: &[[f32; D]],
    run: &Run<'_>,
) -> Result<Forest, Cancelled> {
    let count = normals.len();
    let mut sets = SignedSets::new(count);
    let mut doubtful = Vec::new();
    // An edge to itself lies inside any tree: to be looked for.
    let unknown = |i: usize| if normals[i][0].is_nan() { NO_EDGE } else { i as u64 };
    let least: Vec<AtomicU64> = (0..count).map(|i| AtomicU64::new(unknown(i))).collect();
    let mut of_tree = vec![NO_PLACE; count];
    loop {
        let is_stale = |i: usize| {
            let edge = least[i].load(Relaxed);
            edge != NO_EDGE && sets.first(i) == sets.first(other_end(edge))
        };
        near.for_each(run, is_stale, |member, others| {
            let (tree, normal) = (sets.first(member.place), normals[member.place]);
            let mut found = NO_EDGE;
            for other in others {
                if sets.first(other.place) == tree {
                    continue;
                }
                let Some(way) = member.way_to(other) else { continue };
                if let Some(edge) = Edge::between(normal, normals[other.place], way) {
                    found = found.min(packed(edge, other.place));
                }
            }
            least[member.place].store(found, Relaxed);
        })?;
        for (place, edge) in least.iter().enumerate() {
            let edge = edge.load(Relaxed);
            if edge == NO_EDGE {
                continue;
            }
            let best = &mut of_tree[sets.first(place)];
            let beats = |other: usize| rank(place, edge) < rank(other, least[other].load(Relaxed));
            if *best == NO_PLACE || beats(*best as usize) {
                *best = place as u32;
            }
        }
        let mut joined = 0;
        for best in &mut of_tree {
            let place = std::mem::replace(best, NO_PLACE);
            if place == NO_PLACE {
                continue;
            }
            let edge = least[place as usize].load(Relaxed);
            if sets.join((place as usize, other_end(edge)), is_opposed(edge)).is_some() {
                joined += 1;
                if is_doubtful(edge) {
                    doubtful.push(place);
                }
            }
        }
        if joined == 0 {
            return Ok(Forest { sets, doubtful });
        }
        sets.settle();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Cloud;
    use crate::grid::Grid;
    use crate::lane::Precision;
    use crate::samples::{self, Random};
    use crate::support::Radii;

    /// The forest's doubtful edges and components are those of Kruskal's algorithm over all edges, sorted.
    #[test]
    fn it_is_the_minimum_spanning_forest() {
        let mut shape = samples::torus(1.0, 0.4, 900, 1).with_noise(0.05, 2);
        shape.points.extend(samples::sphere(0.3, 60, 3).points);
        let mut random = Random::new(4);
        let run = Run::new();
        let cloud = Cloud::new(shape.points);
        let grid = Grid::new(&cloud, &Radii::Uniform(0.15), 0.15, 1.0, Precision::Double, &run);
        // Normals that mean nothing: edges of every weight.
        let normals: Vec<[f32; 3]> = (0..cloud.len())
            .map(|_| {
                let n = samples::sphere(1.0, 1, random.bits()).points[0];
                n.map(|c| c as f32)
            })
            .collect();
        let near = Neighbours::new(&cloud, &grid, 1.0);
        let mut forest = grow(&near, &normals, &run).unwrap();

        let all: Vec<_> = (0..grid.len()).map(|i| near.at(i)).collect();
        let mut edges = Vec::new();
        for a in &all {
            for b in &all[a.place + 1..] {
                if let Some(way) = a.way_to(b) {
                    let edge = Edge::between(normals[a.place], normals[b.place], way).unwrap();
                    edges.push((rank(a.place, packed(edge, b.place)), edge));
                }
            }
        }
        edges.sort_unstable_by_key(|e| e.0);
        let mut sets = SignedSets::new(all.len());
        let mut doubtful = 0;
        let mut trees = all.len();
        for ((_, a, b), edge) in edges {
            if sets.join((a, b), edge.opposed).is_some() {
                doubtful += usize::from(!edge.is_reliable());
                trees -= 1;
            }
        }
        assert!(trees > 3 && doubtful > 100, "{trees} trees, {doubtful} doubtful edges");
        assert_eq!(forest.doubtful.len(), doubtful);
        for i in 0..all.len() {
            assert_eq!(forest.sets.find(i), sets.find(i));
        }
    }
}
