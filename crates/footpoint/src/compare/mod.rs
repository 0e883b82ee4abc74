//! Question: how far a later surface lies from an earlier one, and whether that is more than the samples'
//! scatter explains.

mod pair;
mod student;

use crate::cloud::Cloud;
use crate::definition::{Definition, Error};
use crate::queries::Queries;
use crate::run::{Cancelled, Progress, Run};
use crate::status::Status;
use crate::support::{Support, radii_of};
use pair::Known;
pub use pair::Pair;
use student::widening;

/// How to compare two epochs of one thing, each by its own samples.
///
/// For every support h, the same for both: y₂ is the foot point of the query on the later surface and y₁
/// that of y₂ on the earlier; the distance is |y₂ − y₁|. Each surface is known there up to v = s²
/// Σ|G|²/|∇f|²: s² = Σwe²/Σw(1−H) is the scatter of the samples within h about their weighted plane (e
/// residuals, H leverages), G the exact sensitivities of f. Of several supports the one with the least v₁ +
/// v₂ counts, point by point. σ² = (v₁ + v₂)(t/1.96)² + registration², t by Student with the degrees of
/// freedom that Welch and Satterthwaite give.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    effective_neighbours: Vec<f64>,
    tolerance: f64,
    registration: f64,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            effective_neighbours: Self::EFFECTIVE_NEIGHBOURS.to_vec(),
            tolerance: Self::TOLERANCE,
            registration: 0.0,
        }
    }
}

/// Why two epochs cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The earlier cloud has no surface.
    #[error("the earlier cloud: {0}")]
    Earlier(Error),
    /// The later cloud has no surface.
    #[error("the later cloud: {0}")]
    Later(Error),
    /// The comparison was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CompareError {
    /// Why one of the clouds, which `whose` names, has no surface.
    fn of(problem: Error, whose: impl Fn(Error) -> Self) -> Self {
        match problem {
            Error::Cancelled(cancelled) => Self::Cancelled(cancelled),
            problem => whose(problem),
        }
    }
}

/// Distances between two surfaces, one row a query, in the order of the queries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences<const D: usize> {
    /// y₂ on the later surface; NaN where that is not near the query.
    pub start: Vec<[f64; D]>,
    /// y₁ on the earlier surface. NaN where the status is not *ok*, like all that follows.
    pub foot: Vec<[f64; D]>,
    /// The earlier surface's normal there.
    pub surface_normal: Vec<[f64; D]>,
    /// |y₂ − y₁|; negative behind the earlier surface if its sign is given.
    pub distance: Vec<f64>,
    /// Standard deviation of the distance, widened by Student's t, so that nothing has moved where it is
    /// below [`Comparison::LEVEL`] of it, in 95 of 100 cases. First order; no knowledge of errors that
    /// neighbours share but the registration.
    pub sigma: Vec<f64>,
    /// The support that counts.
    pub support: Vec<f64>,
    /// *ok*, or what became of the query at the widest support at which there is a y₂. *Degenerate* also
    /// where too few samples tell the scatter.
    pub status: Vec<Status>,
}

/// What was found, and the surfaces of the widest support.
#[derive(Debug)]
pub struct Compared<const D: usize> {
    /// The distances.
    pub differences: Differences<D>,
    /// The surfaces, for further questions.
    pub widest: Pair<D>,
}

impl Comparison {
    /// Effective neighbours of the supports that are tried unless told otherwise.
    pub const EFFECTIVE_NEIGHBOURS: [f64; 3] = [8.0, 16.0, 32.0];
    /// So many σ are significant: 95 %.
    pub const LEVEL: f64 = 1.96;
    /// How exactly foot points are sought unless told otherwise, in supports: σ is a hundredth of one and
    /// more.
    pub const TOLERANCE: f64 = 1e-4;

    /// Three supports, of 8, 16 and 32 effective neighbours of the earlier cloud, and no error of
    /// registration.
    pub fn new() -> Self {
        Self::default()
    }

    /// Tries these supports: radii for so many effective neighbours of the earlier cloud, as for
    /// [`Support::Auto`], with a median over 5000 samples. None: the definition's own support alone, with
    /// the earlier cloud's radius for both where it is one.
    pub fn with_effective_neighbours(mut self, numbers: Vec<f64>) -> Self {
        self.effective_neighbours = numbers;
        self
    }

    /// Seeks foot points to so many supports; it is part of σ. NaN counts as 0.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = if tolerance.is_nan() { 0.0 } else { tolerance };
        self
    }

    /// Adds the error with which the clouds were brought together, one standard deviation along any
    /// direction. NaN counts as 0.
    pub fn with_registration(mut self, sigma: f64) -> Self {
        self.registration = if sigma.is_nan() { 0.0 } else { sigma };
        self
    }

    /// Compares the epochs at the queries: the later samples for [`Queries::Samples`].
    ///
    /// Fails where a cloud has no surface by this definition. The same bits for any number of threads and
    /// order of the samples.
    pub fn compare<'q, const D: usize>(
        &self,
        (earlier, later): (&Cloud<D>, &Cloud<D>),
        definition: Definition,
        queries: impl Into<Queries<'q, D>>,
        run: &Run<'_>,
    ) -> Result<Compared<D>, CompareError> {
        let queries = queries.into();
        let supports = self.supports(earlier, definition, run)?;
        let mut widest = None;
        let mut best = Best::default();
        for (number, &support) in supports.iter().enumerate() {
            let pair = Pair::build(earlier.clone(), later.clone(), definition.with_support(support), run)?;
            let part = |progress| {
                run.announce(within(progress, number, supports.len()));
            };
            let run = run.silent().progress(&part);
            if widest.is_none() {
                best = Best::of(queries.points(&pair.later).len());
            }
            best.take(&pair, queries, (self.tolerance, &run))?;
            widest = widest.or(Some(pair));
        }
        let differences = best.finish(self.registration);
        // There is one support at least.
        widest.map(|widest| Compared { differences, widest }).ok_or(CompareError::Cancelled(Cancelled))
    }

    /// σ of distances between points y₂ of the later and y₁ of the earlier surface, row by row; NaN where it
    /// is not known.
    pub fn judge<const D: usize>(
        &self,
        pair: &Pair<D>,
        (earlier, later): (&[[f64; D]], &[[f64; D]]),
        run: &Run<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let first = pair.earlier.with(run).known(earlier, self.tolerance)?;
        let second = pair.later.with(run).known(later, self.tolerance)?;
        Ok(first.iter().zip(&second).map(|(a, b)| a.joined(b).sigma(self.registration)).collect())
    }

    /// The supports to try, the widest first.
    fn supports<const D: usize>(
        &self,
        earlier: &Cloud<D>,
        definition: Definition,
        run: &Run<'_>,
    ) -> Result<Vec<Support>, CompareError> {
        if self.effective_neighbours.is_empty() {
            return Ok(vec![definition.support()]);
        }
        let mut numbers = self.effective_neighbours.clone();
        numbers.sort_by(|a, b| b.total_cmp(a));
        let radii = radii_of(earlier, definition.weight(), &numbers, run)
            .map_err(|problem| CompareError::of(problem.into(), CompareError::Earlier))?;
        Ok(radii.into_iter().map(Support::Uniform).collect())
    }
}

/// Progress of one part of several.
fn within(progress: Progress, part: usize, parts: usize) -> Progress {
    Progress { done: part * progress.total + progress.done, total: parts * progress.total }
}

/// The best answer of every query so far.
#[derive(Default)]
struct Best<const D: usize> {
    found: Differences<D>,
    known: Vec<Known>,
}

impl<const D: usize> Best<D> {
    fn of(rows: usize) -> Self {
        let found = Differences {
            start: vec![[f64::NAN; D]; rows],
            foot: vec![[f64::NAN; D]; rows],
            surface_normal: vec![[f64::NAN; D]; rows],
            distance: vec![f64::NAN; rows],
            sigma: Vec::new(),
            support: vec![f64::NAN; rows],
            status: Vec::new(),
        };
        Self { found, known: vec![Known::NOTHING; rows] }
    }

    /// Compares at one support more, and keeps what is better known than what there was.
    fn take(
        &mut self,
        pair: &Pair<D>,
        queries: Queries<'_, D>,
        (tolerance, run): (f64, &Run<'_>),
    ) -> Result<(), Cancelled> {
        let how = pair::way(tolerance);
        let Self { found, known } = self;
        let starts = pair.later.with(run).project(queries, &how)?;
        let quiet = run.silent();
        let ok = |row: &usize| starts.status[*row].is_ok();
        let rows: Vec<usize> = (0..known.len()).filter(ok).collect();
        let points: Vec<[f64; D]> = rows.iter().map(|&row| starts.point[row]).collect();
        let second = pair.later.with(&quiet).known(&points, tolerance)?;
        if found.status.is_empty() {
            found.status.clone_from(&starts.status);
        }
        // What one side alone leaves unknown beyond the best of both cannot be better.
        let may_win = |k: &usize| second[*k].variance < known[rows[*k]].variance;
        let chosen: Vec<usize> = (0..rows.len()).filter(may_win).collect();
        let points: Vec<[f64; D]> = chosen.iter().map(|&k| points[k]).collect();
        let feet = pair.earlier.with(&quiet).project(&points, &how)?;
        let landed: Vec<usize> = (0..chosen.len()).filter(|&j| feet.status[j].is_ok()).collect();
        let places: Vec<[f64; D]> = landed.iter().map(|&j| feet.point[j]).collect();
        let first_side = pair.earlier.with(&quiet).known(&places, tolerance)?;
        let mut theirs = vec![Known::NOTHING; chosen.len()];
        for (&j, side) in landed.iter().zip(first_side) {
            theirs[j] = side;
        }
        for (j, &k) in chosen.iter().enumerate() {
            let row = rows[k];
            let joined = second[k].joined(&theirs[j]);
            if joined.variance < known[row].variance {
                known[row] = joined;
                found.start[row] = points[j];
                found.foot[row] = feet.point[j];
                found.surface_normal[row] = feet.surface_normal[j];
                found.distance[row] = feet.distance[j];
                found.support[row] = pair.earlier.support().median;
                found.status[row] = Status::Ok;
            } else if known[row].is_nothing() && found.start[row][0].is_nan() {
                // Found on the later surface alone.
                found.start[row] = points[j];
                found.status[row] = if feet.status[j].is_ok() { Status::Degenerate } else { feet.status[j] };
            }
        }
        for (k, &row) in rows.iter().enumerate() {
            if known[row].is_nothing() && found.status[row].is_ok() && second[k].is_nothing() {
                found.status[row] = Status::Degenerate;
            }
        }
        Ok(())
    }

    fn finish(self, registration: f64) -> Differences<D> {
        let sigma = self.known.iter().map(|known| known.sigma(registration)).collect();
        Differences { sigma, ..self.found }
    }
}
