//! The support of least error: estimated noise against estimated bias, over a range of supports.
//!
//! At some samples the surface is found for a rising sequence of supports. With linear weights w_i the weighted mean of
//! the heights has variance σ²Σw², and its bias is what a quadratic fitted with the same weights differs from it by, less
//! what noise does to that difference: an unbiased estimate of the error, as in the choice of smoothing parameters by
//! unbiased risk. σ comes from the residuals of the quadratic. Only supports count at which nearly all samples find the
//! surface.

use super::SupportChoice;
use super::local_fit::{Frame, Neighbour, Quadratic};
use super::neighbours::Distinct;
use super::{SELECTION, median};
use crate::algebra::{add_scaled, scale};
use crate::cloud::Cloud;
use crate::run::{Cancelled, Run};
use crate::weight::Weight;

/// One radius for all samples, or one for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spread {
    Uniform,
    PerSample,
}

impl Spread {
    /// Least share of the probes that must find the surface, so that 99 % of the samples have a foot point. A probe takes
    /// one support for all its neighbours; where each has its own, twice or three times as many fail.
    fn least_found(self) -> f64 {
        match self {
            Self::Uniform => 0.993,
            Self::PerSample => 0.997,
        }
    }

    /// Share of the differences that count. Where each sample has its own support there are surfaces among outliers, too,
    /// with supports as wide as they are far apart.
    fn counted(self) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::PerSample => 0.95,
        }
    }
}

/// Samples at which the surface is looked for: their share that fails is known to a fifth where it is 1 %.
const PROBES: usize = 2000;
/// From one support to the next.
const RATIO: f64 = 1.2;
/// Effective neighbours of the middle, the first and the last of the sequence. Below the first no frame is determined;
/// beyond the last an evaluation costs more than any noise is worth.
const MIDDLE: f64 = 16.0;
const FEWEST: f64 = 2.0;
const MOST: f64 = 1000.0;
/// Residuals of a quadratic beyond this share of h mean a volume, not a surface.
const THICK: f64 = 0.2;
/// Steps towards the surface, and the value in h at which it is reached.
const STEPS: usize = 12;
const REACHED: f64 = 1e-3;

/// What was chosen, and the evidence.
pub(super) struct Found {
    /// The radius for all samples, in the unit of the coordinates.
    pub(super) radius: f64,
    /// The distinct neighbour whose distance is the radius, where each sample has its own.
    pub(super) count: usize,
    pub(super) choice: SupportChoice,
}

/// The probes with one support.
struct Level {
    /// Its radius over the middle's, or what that would be for equal density.
    factor: f64,
    /// Distinct points of the cloud, times the weight's share of effective ones.
    points: f64,
    spread: Spread,
    probes: Vec<Option<Probe>>,
}

/// The surface at one probe, lengths in units of the tree.
#[derive(Clone, Copy)]
struct Probe {
    h: f64,
    /// Where the points determine one.
    quadratic: Option<Quadratic>,
}

/// The estimated error of a level, lengths squared.
#[derive(Clone, Copy)]
struct Risk {
    noise: f64,
    bias: f64,
    /// The part of the bias that noise does not explain either.
    evident_bias: f64,
}

/// Chooses the support by the rule above.
pub(super) fn least_error<const D: usize>(
    (cloud, distinct): (&Cloud<D>, &Distinct<D>),
    weight: Weight,
    spread: Spread,
    run: &Run<'_>,
) -> Result<Found, Cancelled> {
    let prober = Prober::new(cloud, distinct, (weight, spread), run)?;
    let mut factor = 1.0;
    while effective_neighbours::<D>(factor) > FEWEST * power::<D>(RATIO) {
        factor /= RATIO;
    }
    let mut levels = Vec::new();
    while effective_neighbours::<D>(factor) <= MOST && prober.is_distinct(factor) {
        levels.push(prober.level(factor, run)?);
        if has_passed::<D>(&levels) {
            break;
        }
        factor *= RATIO;
    }
    let base = base(&levels);
    let (mut best, noise) = select(&levels, &base);
    let first = best;
    // Where the fewest neighbours that suffice are best, they are worth a closer look: without noise the error grows with
    // the square of the support.
    if first > 0 && !levels[first - 1].suffices(&base) {
        let (mut low, mut high) = (levels[first - 1].factor, levels[first].factor);
        for _ in 0..3 {
            let level = prober.level((low * high).sqrt(), run)?;
            let suffices =
                level.suffices(&base) && level.error(&base, noise) <= levels[best].error(&base, noise);
            *(if suffices { &mut high } else { &mut low }) = level.factor;
            if suffices {
                levels.push(level);
                best = levels.len() - 1;
            }
        }
    }
    let level = &levels[best];
    let risk = level.risk(&base, noise);
    let length = |square: f64| square.sqrt() * distinct.unit;
    let choice = SupportChoice {
        effective_neighbours: effective_neighbours::<D>(level.factor),
        noise: length(noise),
        error_from_noise: length(risk.noise),
        error_from_bias: length(risk.bias),
    };
    let radius = prober.middle * level.factor * distinct.unit;
    Ok(Found { radius, count: prober.count(level.factor), choice })
}

/// How neighbours grow with the radius.
fn power<const D: usize>(factor: f64) -> f64 {
    if D == 2 { factor } else { factor * factor }
}

fn effective_neighbours<const D: usize>(factor: f64) -> f64 {
    MIDDLE * power::<D>(factor)
}

/// Finds the surface near the probes.
struct Prober<'c, const D: usize> {
    distinct: &'c Distinct<D>,
    weight: Weight,
    spread: Spread,
    /// Sum of the factors at each distinct point.
    factors: Vec<f64>,
    /// The middle's radius.
    middle: f64,
}

impl<'c, const D: usize> Prober<'c, D> {
    fn new(
        cloud: &Cloud<D>,
        distinct: &'c Distinct<D>,
        (weight, spread): (Weight, Spread),
        run: &Run<'_>,
    ) -> Result<Self, Cancelled> {
        let stride = distinct.len().div_ceil(SELECTION);
        let count = (MIDDLE / weight.effective_share(D)).ceil() as usize;
        let middle = median(distinct.distances(count, stride, run)?) / distinct.unit;
        Ok(Self { distinct, weight, spread, factors: distinct.factors(cloud), middle })
    }

    /// Whether there are as many points as the level asks for.
    fn is_distinct(&self, factor: f64) -> bool {
        let smallest = effective_neighbours::<D>(factor) <= MIDDLE;
        smallest || self.count(factor) < self.distinct.len()
    }

    fn count(&self, factor: f64) -> usize {
        (effective_neighbours::<D>(factor) / self.weight.effective_share(D)).ceil() as usize
    }

    fn level(&self, factor: f64, run: &Run<'_>) -> Result<Level, Cancelled> {
        let all = self.distinct.len();
        let stride = all.div_ceil(PROBES);
        let probe = |j: usize| self.probe(self.distinct.point(j * stride), factor);
        let probes = run.map(all.div_ceil(stride), probe)?;
        Ok(Level { factor, points: all as f64 * self.weight.effective_share(D), spread: self.spread, probes })
    }

    /// Follows n from a sample to the surface; `None` where it is not found.
    fn probe(&self, sample: [f64; D], factor: f64) -> Option<Probe> {
        let mut x = sample;
        let mut neighbours: Vec<Neighbour<D>> = Vec::new();
        for _ in 0..STEPS {
            let h = match self.spread {
                Spread::Uniform => self.middle * factor,
                Spread::PerSample => self.distinct.distance(x, self.count(factor)),
            };
            let inverse = 1.0 / h;
            neighbours.clear();
            self.distinct.within(x, h * self.weight.reach(), |j, d| {
                neighbours.push((scale(d, inverse), self.factors[j]));
            });
            let frame = Frame::fit(&neighbours, self.weight)?;
            if frame.value.abs() <= REACHED {
                let quadratic = frame.quadratic(&neighbours);
                let thick = quadratic.is_some_and(|q| q.noise > THICK * THICK);
                let accepted = frame.is_accepted(self.weight.boundary_limit()) && !thick;
                return accepted.then_some(Probe { h, quadratic });
            }
            if frame.value.is_nan() {
                return None;
            }
            x = add_scaled(x, frame.normal, -frame.value * h);
        }
        None
    }
}

impl Level {
    /// Whether enough of the base's probes find the surface.
    fn suffices(&self, base: &[bool]) -> bool {
        let of_base = base.iter().filter(|&&b| b).count();
        let found = self.probes.iter().zip(base).filter(|(probe, b)| **b && probe.is_some()).count();
        of_base > 0 && found as f64 >= self.spread.least_found() * of_base as f64
    }

    /// The base's probes at which a quadratic is determined.
    fn quadratics(&self, base: &[bool]) -> Vec<(f64, Quadratic)> {
        let known = |probe: &Option<Probe>| probe.and_then(|p| Some((p.h * p.h, p.quadratic?)));
        self.probes.iter().zip(base).filter(|(_, b)| **b).filter_map(|(probe, _)| known(probe)).collect()
    }

    /// The variance σ² of the samples across the surface: the median forgives outliers.
    fn noise(&self, base: &[bool]) -> f64 {
        let all = self.quadratics(base);
        if all.is_empty() {
            f64::NAN
        } else {
            median(all.iter().map(|(square, q)| square * q.noise).collect())
        }
    }

    fn risk(&self, base: &[bool], noise: f64) -> Risk {
        let all = self.quadratics(base);
        let mean = |of: &dyn Fn(f64, &Quadratic) -> f64| {
            all.iter().map(|(square, q)| of(*square, q)).sum::<f64>() / all.len() as f64
        };
        let mean_variance = mean(&|_, q| q.mean_variance);
        let mut squares: Vec<f64> =
            all.iter().map(|(square, q)| square * q.difference * q.difference).collect();
        squares.sort_unstable_by(f64::total_cmp);
        squares.truncate((self.spread.counted() * all.len() as f64).ceil() as usize);
        let difference = squares.iter().sum::<f64>() / squares.len() as f64;
        // Noise alone gives differences too. Their mean square is known as well as there are neighbourhoods that do not
        // overlap: what is within its standard deviation is no evidence of bias.
        let apart = (self.points * mean_variance).clamp(1.0, all.len().max(1) as f64);
        let by_noise = noise * mean(&|_, q| q.difference_variance);
        let within = by_noise * (1.0 + (2.0 / apart).sqrt());
        let above = |explained: f64| (difference - explained).max(0.0);
        Risk { noise: noise * mean_variance, bias: above(by_noise), evident_bias: above(within) }
    }

    fn error(&self, base: &[bool], noise: f64) -> f64 {
        let risk = self.risk(base, noise);
        risk.noise + risk.evident_bias
    }
}

/// The probes that find the surface where it is found best: at the first level, from the middle on, after which hardly any
/// more find it, and at the two levels after that. The others are outliers, which nothing is chosen for.
fn base(levels: &[Level]) -> Vec<bool> {
    let share = |level: &Level| {
        level.probes.iter().filter(|p| p.is_some()).count() as f64 / level.probes.len() as f64
    };
    let settled = |three: &&[Level]| {
        let [now, next] = [share(&three[0]), share(&three[1])];
        is_from_middle(&three[0]) && now >= 0.9 && next <= now + 0.01
    };
    let best =
        || levels.chunks(1).reduce(|best, one| if share(&one[0]) > share(&best[0]) { one } else { best });
    let taken = levels.windows(3).find(settled).or_else(best).unwrap_or_default();
    let count = taken.first().map_or(0, |level| level.probes.len());
    (0..count).map(|i| taken.iter().all(|level| level.probes[i].is_some())).collect()
}

/// Rounding of the factors aside.
fn is_from_middle(level: &Level) -> bool {
    level.factor > 0.99
}

/// The level of least error and σ², which is taken where the best level is, but with no fewer neighbours than the middle.
fn select(levels: &[Level], base: &[bool]) -> (usize, f64) {
    let middle = levels.iter().position(is_from_middle).unwrap_or(0);
    let (mut best, mut noise, mut from) = (middle, f64::NAN, middle);
    // It settles after two or three rounds; where it goes to and fro either will do.
    for _ in 0..8 {
        noise = levels[from].noise(base);
        let errors = levels.iter().enumerate().filter(|(_, level)| level.suffices(base));
        let errors = errors.map(|(i, level)| (i, level.error(base, noise))).filter(|(_, e)| !e.is_nan());
        best = errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(middle, |(i, _)| i);
        if best.max(middle) == from {
            break;
        }
        from = best.max(middle);
    }
    (best, noise)
}

/// Whether the least error has been passed: the last three levels are twice as bad.
fn has_passed<const D: usize>(levels: &[Level]) -> bool {
    let Some([.., last]) = levels.last_chunk::<3>() else { return false };
    if effective_neighbours::<D>(last.factor) < 2.5 * MIDDLE {
        return false;
    }
    let base = base(levels);
    let (best, noise) = select(levels, &base);
    let error = |level: &Level| level.error(&base, noise);
    best + 3 < levels.len()
        && levels[levels.len() - 3..].iter().all(|level| error(level) > 4.0 * error(&levels[best]))
}
