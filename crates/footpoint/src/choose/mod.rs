//! Radius and degree by evidence: variance by the jackknife over five parts, bias against references that may
//! judge, for normals, positions and curvatures each for itself.

mod fit;
mod moments;
mod probe;
mod risk;

use crate::cloud::Cloud;
use crate::definition::Definition;
use crate::run::{Cancelled, Run};
use crate::samples::Random;
use crate::support::neighbours::Distinct;
use crate::support::{SupportError, median};
use crate::weight::Weight;
use moments::Near;
use probe::{Around, Evidence, Foot, Level, PARTS};
use risk::{Judge, Ladder, SETTLED};

/// What a surface is to give best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Aim {
    /// Surface normals.
    Normals,
    /// Positions of the surface: projections, distances, hits of rays.
    Positions,
    /// Mean curvatures.
    Curvatures,
}

/// A radius and a degree for one aim, as [`Cloud::choose`] finds them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Choice {
    /// What it is for.
    pub aim: Aim,
    /// For [`Support::Uniform`](crate::Support::Uniform), in the unit of the coordinates.
    pub radius: f64,
    /// Effective neighbours of an even sampling with this radius.
    pub effective_neighbours: f64,
    /// For [`Definition::with_degree`](crate::Definition::with_degree).
    pub degree: u8,
    /// The expected error, noise and bias together, root mean square: radians of normals, a length of
    /// positions, one over a length of curvatures. Edges and outliers do not count: the worst 30 % of normals
    /// and curvatures, 2 % of positions are left out.
    pub expected: f64,
}

/// Samples that are looked at.
const PROBES: usize = 300;
/// Effective neighbours of the narrowest level and the ratio from one to the next.
const NARROWEST: f64 = 8.0;
/// The degrees that are compared: 1 has the bias of 0 and the noise of 2.
const DEGREES: [u8; 3] = [0, 2, 3];
/// The ladder's places at which the pilot is looked for: 16, 32, … 512 neighbours.
const PILOTS: [usize; 6] = [2, 4, 6, 8, 10, 12];
/// From here on the pilot has degree 2: so wide a mean lies beside a curved surface.
const FIRST_WIDE: usize = 6;
/// Neighbours are gathered so much farther than the widest level reaches: feet lie beside their samples.
const MARGIN: f64 = 1.25;

impl<const D: usize> Cloud<D> {
    /// The radius and the degree (0, 2 or 3) of the least error for each aim, of fields of covariance: 14 radii
    /// from 8 to 724 effective neighbours, judged at 300 samples by what the surface does without a fifth of
    /// the samples and by narrower radii and higher degrees. Sheets that narrow radii tell apart stay apart.
    /// The same for any order of the samples.
    ///
    /// An aim is missing where nothing can be judged: fewer than some 40 samples, or no surface at any radius.
    /// Noise that is alike over several spacings counts as shape. Fails where no sample is usable, all
    /// coincide, or the run is cancelled.
    pub fn choose(&self, weight: Weight, run: &Run<'_>) -> Result<Vec<Choice>, SupportError> {
        Ok(choose(self, &Distinct::of(self)?, weight, run)?)
    }
}

fn choose<const D: usize>(
    cloud: &Cloud<D>,
    distinct: &Distinct<D>,
    weight: Weight,
    run: &Run<'_>,
) -> Result<Vec<Choice>, Cancelled> {
    let all = distinct.len();
    let factors = distinct.factors(cloud);
    let stride = all.div_ceil(PROBES);
    let count = all.div_ceil(stride);
    let neighbours: Vec<f64> = (0..14)
        .map(|k| NARROWEST * 2.0_f64.powi(k).sqrt())
        .filter(|n| n / weight.effective_share(D) < 0.5 * all as f64)
        .collect();
    let counts: Vec<usize> =
        neighbours.iter().map(|n| (n / weight.effective_share(D)).ceil() as usize).collect();
    let Some(&most) = counts.last() else { return Ok(Vec::new()) };
    // Distances to the k-th neighbours, whose medians are the radii.
    let far = run.map(count, |j| distinct.distance(distinct.point(j * stride), most))?;
    let reach = median(far) * MARGIN * weight.reach();
    let around = run.map(count, |j| gather(distinct, (j * stride, reach), weight, &factors))?;
    let radius = |&k: &usize| {
        let distance = |squares: &Vec<f64>| squares.get(k).map_or(f64::INFINITY, |square| square.sqrt());
        median(around.iter().map(|(_, squares)| distance(squares)).collect())
    };
    let radii: Vec<f64> = counts.iter().map(radius).collect();
    let levels: Vec<Level> = radii.iter().flat_map(|&h| DEGREES.map(|degree| Level { h, degree })).collect();
    // The pilot: the narrowest radius at which as many samples find the surface as anywhere, or nearly all: two
    // sheets found at a narrow radius may be one at a wide one.
    let pilots: Vec<usize> = PILOTS.into_iter().filter(|&k| k < radii.len()).collect();
    let shares = pilots
        .iter()
        .map(|&k| {
            let found = run.map(count.div_ceil(2), |j| {
                around[2 * j].0.project([0.0; D], Level { h: radii[k], degree: 0 }).is_some()
            })?;
            Ok(found.iter().filter(|f| **f).count() as f64 / found.len() as f64)
        })
        .collect::<Result<Vec<f64>, Cancelled>>()?;
    let best = shares.iter().copied().fold(0.0, f64::max);
    let Some(pilot) = pilots
        .iter()
        .zip(&shares)
        .find(|(_, share)| **share >= f64::min(best - 0.01, SETTLED))
        .map(|(&k, _)| k)
    else {
        return Ok(Vec::new());
    };
    let degree = if pilot < FIRST_WIDE { 0 } else { 2 };
    let feet: Vec<Option<Foot<D>>> = run.map(count, |j| {
        let at = Level { h: radii[pilot], degree };
        around[j].0.project([0.0; D], at).or_else(|| around[j].0.project([0.0; D], Level { degree: 0, ..at }))
    })?;
    let known: Vec<(&Around<D>, Foot<D>)> =
        around.iter().zip(feet).filter_map(|((around, _), foot)| Some((around, foot?))).collect();
    let evidence: Vec<Vec<Evidence<D>>> = run.map(known.len(), |i| {
        let (around, foot) = &known[i];
        radii.iter().flat_map(|&h| around.evidence(foot, h, &DEGREES)).collect()
    })?;
    let ladder = Ladder { levels: &levels, neighbours: &neighbours, degrees: DEGREES.len(), samples: all };
    let judge = Judge::new(&ladder, &evidence);
    let unit = distinct.unit;
    Ok([Aim::Normals, Aim::Positions, Aim::Curvatures]
        .into_iter()
        .filter_map(|aim| {
            let (level, risk) = judge.select(aim)?;
            let scale = match aim {
                Aim::Normals => 1.0,
                Aim::Positions => unit,
                Aim::Curvatures => 1.0 / unit,
            };
            Some(Choice {
                aim,
                radius: levels[level].h * unit,
                effective_neighbours: neighbours[level / DEGREES.len()],
                degree: levels[level].degree,
                expected: risk.sqrt() * scale,
            })
        })
        .collect())
}

/// The neighbours of one probe, and the squares of all their distances in ascending order.
fn gather<const D: usize>(
    distinct: &Distinct<D>,
    (j, reach): (usize, f64),
    weight: Weight,
    factors: &[f64],
) -> (Around<D>, Vec<f64>) {
    let at = distinct.point(j);
    let mut found: Vec<(f64, usize, [f64; D])> = Vec::new();
    distinct.within(at, reach, |i, way| found.push((way.iter().map(|c| c * c).sum(), i, way)));
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let squares = found.iter().map(|f| f.0).collect();
    let mut parts: [Vec<Near<D>>; PARTS] = Default::default();
    for (square, i, way) in found {
        parts[part(i)].push(Near { way, square, factor: factors[i] });
    }
    (Around { parts, definition: Definition::new().with_weight(weight) }, squares)
}

/// The part that a distinct point is dealt to: by its place in the order of coordinates, mixed, so that rows of
/// samples are in all parts.
fn part(place: usize) -> usize {
    (Random::new(place as u64).bits() % PARTS as u64) as usize
}
