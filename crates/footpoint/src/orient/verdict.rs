//! Whether signs can agree at all: edges that contradict the forest, and whether noise explains them.

use super::edge::Edge;
use super::signs::SignedSets;
use crate::columns::Counts;
use crate::neighbours::{Neighbour, Neighbours};
use crate::run::{Cancelled, Run};

/// A contradiction within this many reaches of a sample is one of noise, a crossing or a sharp tip there; one that is not
/// found within it goes around something.
const LOCAL: f64 = 4.0;

/// At every place the number of its odd edges to later ones: reliable edges whose ends have other signs than the edge says.
pub(super) fn odd_edges<const D: usize>(
    near: &Neighbours<'_, D>,
    normals: &[[f32; D]],
    sets: &SignedSets,
    run: &Run<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let mut odd = Vec::new();
    let counts = Counts::values(&mut odd, normals.len(), true);
    let is_present = |i: usize| !normals[i][0].is_nan();
    near.for_each(run, is_present, |member, others| {
        let opposed = sets.is_opposed(member.place);
        let is_odd = |other: &&Neighbour<D>| {
            edge(member, other, normals).is_some_and(|edge| {
                edge.is_reliable() && edge.opposed != (opposed ^ sets.is_opposed(other.place))
            })
        };
        let later = others.iter().filter(|other| other.place > member.place);
        counts.put(member.place, later.filter(is_odd).count() as u32);
    })?;
    Ok(odd)
}

#[inline]
fn edge<const D: usize>(a: &Neighbour<D>, b: &Neighbour<D>, normals: &[[f32; D]]) -> Option<Edge> {
    Edge::between(normals[a.place], normals[b.place], a.way_to(b)?)
}

/// Samples around a place, and whether their reliable edges contradict each other already.
pub(super) struct Around<const D: usize> {
    /// Those that are less than half as far away: their surroundings are much the same.
    pub(super) inner: Vec<usize>,
    pub(super) contradictory: bool,
}

/// Looks for an odd cycle of reliable edges among the samples within [`LOCAL`] reaches that hang together with this place.
pub(super) fn around<const D: usize>(
    near: &Neighbours<'_, D>,
    normals: &[[f32; D]],
    place: usize,
) -> Around<D> {
    let centre = near.at(place);
    let radius = LOCAL * centre.reach;
    let mut ball = Vec::new();
    near.gather(centre.point.map(|c| c - radius), centre.point.map(|c| c + radius), &mut ball);
    let distance = |sample: &Neighbour<D>| {
        (0..D).map(|k| (sample.point[k] - centre.point[k]).powi(2)).sum::<f64>().sqrt()
    };
    ball.retain(|sample| distance(sample) <= radius && !normals[sample.place][0].is_nan());
    // Along one axis, so that few pairs are tried.
    ball.sort_unstable_by(|a, b| a.point[0].total_cmp(&b.point[0]).then(a.place.cmp(&b.place)));
    let mut sets = SignedSets::new(ball.len());
    let mut contradictions = Vec::new();
    for (i, a) in ball.iter().enumerate() {
        for (j, b) in ball.iter().enumerate().skip(i + 1) {
            if b.point[0] - a.point[0] > a.reach {
                break;
            }
            let Some(edge) = edge(a, b, normals).filter(|edge| edge.is_reliable()) else { continue };
            let ((first, opposed), (other, other_opposed)) = (sets.find(i), sets.find(j));
            if first != other {
                sets.join((i, j), edge.opposed);
            } else if edge.opposed != (opposed ^ other_opposed) {
                contradictions.push(i);
            }
        }
    }
    let own = ball.iter().position(|sample| sample.place == place).map(|i| sets.find(i).0);
    let contradictory = contradictions.into_iter().any(|i| Some(sets.find(i).0) == own);
    let inner = ball.iter().filter(|s| distance(s) <= 0.5 * radius).map(|s| s.place).collect();
    Around { inner, contradictory }
}
