//! The level of least risk: variance by the jackknife, bias by references that are no wider, no lower and no surer.

use super::Aim;
use super::probe::{COPIES, Evidence, Level, PARTS};

/// The levels, by radius and then by degree.
pub(super) struct Ladder<'l> {
    pub(super) levels: &'l [Level],
    /// Effective neighbours of each radius.
    pub(super) neighbours: &'l [f64],
    /// Degrees at each radius.
    pub(super) degrees: usize,
    /// Distinct samples of the cloud.
    pub(super) samples: usize,
}

/// Where a level's probes find less of the surface than the best one's by more than this, it is no candidate.
const LESS_FOUND: f64 = 0.02;
/// A radius at which so many probes find the surface begins the watch for sheets that merge.
pub(super) const SETTLED: f64 = 0.95;
/// A reference whose variance is so many times as large finds bias that is none.
const NOISIER: f64 = 10.0;
/// Bias counts beyond so many of its standard deviations.
const EVIDENT: f64 = 1.5;

/// How the squares of an aim are averaged: without their largest share, and what that does to χ² of one square
/// (of as many degrees of freedom as the answer has) and of the jackknife's sum of four.
struct Trim {
    share: f64,
    one: f64,
    four: f64,
    freedom: f64,
}

impl Trim {
    fn of<const D: usize>(aim: Aim) -> Self {
        match aim {
            Aim::Positions => Self { share: 0.02, one: 0.873_465, four: 0.941_313, freedom: 1.0 },
            Aim::Normals if D == 3 => Self { share: 0.3, one: 0.484_012, four: 0.706_977, freedom: 2.0 },
            _ => Self { share: 0.3, one: 0.309_561, four: 0.586_520, freedom: 1.0 },
        }
    }

    fn mean(&self, mut squares: Vec<f64>) -> f64 {
        let kept = ((squares.len() as f64 * (1.0 - self.share)).ceil() as usize).max(1);
        if squares.len() > kept {
            squares.select_nth_unstable_by(kept, f64::total_cmp);
            squares.truncate(kept);
        }
        squares.iter().sum::<f64>() / squares.len() as f64
    }
}

/// The answer of a copy as a vector of up to D components.
fn answer<const D: usize>(evidence: &Evidence<D>, copy: usize, aim: Aim) -> [f64; D] {
    let mut vector = [0.0; D];
    match aim {
        Aim::Normals => return evidence.normals[copy],
        Aim::Positions => vector[0] = evidence.heights[copy],
        Aim::Curvatures => vector[0] = evidence.bends[copy],
    }
    vector
}

/// (K − 1)/K Σ|a_k − ā|² over the replicas.
fn jackknife<const D: usize>(answers: &[[f64; D]; COPIES]) -> f64 {
    let mean: [f64; D] =
        std::array::from_fn(|k| answers[1..].iter().map(|a| a[k]).sum::<f64>() / PARTS as f64);
    let squares = answers[1..].iter().map(|a| (0..D).map(|k| (a[k] - mean[k]).powi(2)).sum::<f64>());
    (PARTS - 1) as f64 / PARTS as f64 * squares.sum::<f64>()
}

/// The probes' evidence, with what is the same for all aims.
pub(super) struct Judge<'l, const D: usize> {
    ladder: &'l Ladder<'l>,
    probes: &'l [Vec<Evidence<D>>],
    /// The probes that count.
    base: Vec<bool>,
    /// By level: the share of these that find the surface, and how many know it in all copies.
    shares: Vec<(f64, usize)>,
}

impl<'l, const D: usize> Judge<'l, D> {
    pub(super) fn new(ladder: &'l Ladder<'l>, probes: &'l [Vec<Evidence<D>>]) -> Self {
        let found = apart(ladder, probes);
        let base: Vec<bool> = probes.iter().map(|probe| is_base(ladder, probe)).collect();
        let of_base = base.iter().filter(|b| **b).count();
        let share = |level: usize| {
            let count = |is: &dyn Fn(usize) -> bool| (0..probes.len()).filter(|&i| base[i] && is(i)).count();
            let accepted = count(&|i| probes[i][level].accepted);
            let found = count(&|i| found[level][i]);
            (accepted.min(found) as f64 / of_base as f64, accepted)
        };
        let shares = (0..ladder.levels.len()).map(share).collect();
        Self { ladder, probes, base, shares }
    }

    /// The levels that find enough of the surface, and give what is asked for.
    fn candidates(&self, aim: Aim) -> Vec<usize> {
        let Self { ladder, probes, shares, .. } = self;
        let best = shares.iter().map(|s| s.0).fold(0.0, f64::max);
        let few = 30.min(probes.len());
        let gives = |level: usize| aim != Aim::Curvatures || ladder.levels[level].degree > 1;
        let is_good = |&l: &usize| gives(l) && shares[l].0 >= best - LESS_FOUND && shares[l].1 >= few;
        (0..shares.len()).filter(is_good).collect()
    }

    /// The level of least estimated error for an aim, and that error squared.
    pub(super) fn select(&self, aim: Aim) -> Option<(usize, f64)> {
        let Self { ladder, probes, base, .. } = self;
        let levels = ladder.levels.len();
        let good = self.candidates(aim);
        let trim = Trim::of::<D>(aim);
        let copies = |i: usize, level: usize| -> [[f64; D]; COPIES] {
            std::array::from_fn(|copy| answer(&probes[i][level], copy, aim))
        };
        let variance: Vec<f64> = (0..levels)
            .map(|l| {
                if !good.contains(&l) {
                    return f64::INFINITY;
                }
                let rows = (0..probes.len()).filter(|&i| base[i] && probes[i][l].accepted);
                trim.mean(rows.map(|i| jackknife(&copies(i, l))).collect()) / trim.four
            })
            .collect();
        let class = |l: usize| ladder.levels[l].degree.min(2) / 2;
        let bias = |l: usize| {
            let may_judge = |r: &&usize| {
                **r != l
                    && ladder.levels[**r].h <= ladder.levels[l].h
                    && class(**r) >= class(l)
                    && (variance[**r] >= variance[l] || class(**r) > class(l))
                    && variance[**r] <= NOISIER * variance[l]
            };
            let against = |&r: &usize| {
                let rows: Vec<usize> = (0..probes.len())
                    .filter(|&i| base[i] && probes[i][l].accepted && probes[i][r].accepted)
                    .collect();
                if rows.is_empty() {
                    return 0.0;
                }
                let difference = |&i: &usize| {
                    let (a, b) = (copies(i, l), copies(i, r));
                    let way: [[f64; D]; COPIES] =
                        std::array::from_fn(|c| std::array::from_fn(|k| a[c][k] - b[c][k]));
                    (way[0].iter().map(|c| c * c).sum::<f64>(), jackknife(&way))
                };
                let both: Vec<(f64, f64)> = rows.iter().map(difference).collect();
                let square = trim.mean(both.iter().map(|d| d.0).collect()) / trim.one;
                let by_noise = trim.mean(both.iter().map(|d| d.1).collect()) / trim.four;
                let neighbours = ladder.neighbours[r / ladder.degrees];
                let apart = (rows.len() as f64).min((ladder.samples as f64 / (2.3 * neighbours)).max(4.0));
                square - by_noise - EVIDENT * by_noise * (2.0 / (trim.freedom * apart) + 0.01).sqrt()
            };
            good.iter().filter(may_judge).map(against).fold(0.0, f64::max)
        };
        let risks = good.iter().map(|&l| (l, variance[l] + bias(l))).filter(|r| !r.1.is_nan());
        risks.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The probes that every narrow level of degree 0 nearly knows.
fn is_base<const D: usize>(ladder: &Ladder<'_>, probe: &[Evidence<D>]) -> bool {
    let narrow = (0..ladder.levels.len()).filter(|&l| {
        ladder.levels[l].degree == 0 && (15.9..64.1).contains(&ladder.neighbours[l / ladder.degrees])
    });
    let accepted: Vec<bool> = narrow.map(|l| probe[l].accepted).collect();
    accepted.iter().filter(|a| **a).count() as f64 >= 0.6 * accepted.len() as f64
}

/// Which probes find the surface, by level: once the radius has settled, a probe that loses it at two radii in a
/// row has met another sheet and is lost for all wider ones, though these may find one between the two.
fn apart<const D: usize>(ladder: &Ladder<'_>, probes: &[Vec<Evidence<D>>]) -> Vec<Vec<bool>> {
    let mut found: Vec<Vec<bool>> =
        (0..ladder.levels.len()).map(|l| probes.iter().map(|p| p[l].found).collect()).collect();
    for degree in 0..ladder.degrees {
        let mut settled = false;
        let mut had = vec![false; probes.len()];
        let mut missed = vec![0; probes.len()];
        let mut lost = vec![false; probes.len()];
        for level in (degree..found.len()).step_by(ladder.degrees) {
            let row = &mut found[level];
            for i in 0..probes.len() {
                missed[i] = if had[i] && !row[i] { missed[i] + 1 } else { 0 };
                lost[i] |= missed[i] >= 2;
            }
            let share = row.iter().filter(|f| **f).count() as f64 / probes.len().max(1) as f64;
            settled |= share >= SETTLED;
            for i in 0..probes.len() {
                had[i] |= settled && row[i];
                row[i] &= !lost[i];
            }
        }
    }
    found
}
