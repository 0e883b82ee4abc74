//! Uncertainty of distances to the surface, their bias, and the noise that the residuals tell of (SPEC §§ 10 and 11).

use crate::algebra::{Matrix, dot, sub};
use crate::columns::Numbers;
use crate::curvature::Curvature;
use crate::evaluator::{Answers, Local, Position, Wanted};
use crate::noise::{Noise, NoiseError};
use crate::project::{Project, Projections};
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Sign, Surface};
use crate::variance::{variance, variance_by};

/// How to project, and how noisy the queries are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uncertainty<const D: usize> {
    project: Project,
    query_noise: Option<Noise<D>>,
}

impl<const D: usize> Uncertainty<D> {
    /// The orthogonal projection, of queries without noise of their own.
    pub fn new() -> Self {
        Self::default()
    }

    /// Projects in this way. σ is that of the definition's f at the result, also for Levin's operator, whose result f does not
    /// know.
    pub fn with_project(mut self, project: Project) -> Self {
        self.project = project;
        self
    }

    /// Gives foreign queries noise of their own, independent of the samples'. Queries that are the samples have the cloud's.
    pub fn with_query_noise(mut self, noise: Noise<D>) -> Self {
        self.query_noise = Some(noise);
        self
    }
}

/// Distances with what is known of their errors, one row a query, in the order of the queries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uncertainties<const D: usize> {
    /// Foot points, distances and statuses.
    pub feet: Projections<D>,
    /// Standard deviation of the distance, a length: √(σ_f²/|∇f|² + ĝᵀ C ĝ), C the query's noise; NaN where the status is not
    /// *ok* or the cloud's noise is not known. First order: within 2 % at noise of 0.02 h, 10 to 25 % too large at 0.2 h.
    pub sigma: Vec<f64>,
    /// What the distance is too large by where the surface is curved, because averages lie inside: κ h²/10 for the default
    /// definition. Not part of σ. For an even sampling; NaN like σ.
    pub bias: Vec<f64>,
}

/// The noise that fits the residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NoiseEstimate {
    /// Standard deviation along the normals, a length; NaN without a sample that tells.
    pub sigma: f64,
    /// Samples it comes from.
    pub samples: usize,
}

/// Why there are no uncertainties.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// The cloud's noise is not known.
    #[error("the noise of the samples is not known: give it to the cloud, or estimate it from the residuals")]
    NoNoise,
    /// The queries' noise does not fit them, or makes no sense.
    #[error(transparent)]
    QueryNoise(#[from] NoiseError),
    /// The computation was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The median of the magnitude of a standard normal variable.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

impl<const D: usize> Surface<D> {
    /// [`Running::uncertainty`] on all cores.
    pub fn uncertainty<'q>(
        &self,
        queries: impl Into<Queries<'q, D>>,
        how: &Uncertainty<D>,
    ) -> Result<Uncertainties<D>, UncertaintyError> {
        let run = Run::new();
        self.with(&run).uncertainty(queries, how)
    }

    /// [`Running::estimate_noise`] on all cores.
    pub fn estimate_noise(&self) -> NoiseEstimate {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).estimate_noise().unwrap_or(NoiseEstimate { sigma: f64::NAN, samples: 0 })
    }
}

impl<const D: usize> Running<'_, D> {
    /// Projects the queries and tells how uncertain their distances are (SPEC § 10). A query that is a sample moves
    /// with it.
    ///
    /// Fails where the cloud has no noise ([`Cloud::with_noise`](crate::Cloud::with_noise)) or the queries' does not fit.
    pub fn uncertainty<'q>(
        &self,
        queries: impl Into<Queries<'q, D>>,
        how: &Uncertainty<D>,
    ) -> Result<Uncertainties<D>, UncertaintyError> {
        let surface = self.surface;
        let queries = queries.into();
        let rows = queries.points(surface).len();
        if surface.cloud.noise().is_none() {
            return Err(UncertaintyError::NoNoise);
        }
        if let Some(noise) = &how.query_noise {
            noise.check(rows)?;
        }
        let own = Grouped::new(surface, queries, self.run).own_places();
        let feet = self.project(queries, &how.project)?;
        let mut found = Uncertainties { feet, ..Uncertainties::default() };
        let wanted = self.wanted();
        let grouped = Grouped::new(surface, Queries::Points(&found.feet.point), self.run);
        let points = queries.points(surface);
        let errors = |row: usize, at: &Position<D>, (answers, lane): (&Answers<D>, usize)| {
            if found.feet.status[row] != Status::Ok {
                return [f64::NAN; 2];
            }
            let local = answers.local(lane);
            let sample = own.get(row).copied().flatten().map(|place| (row, place));
            let of_surface = variance(surface, sample, at, (&local, &answers.extra(lane)))
                / dot(local.gradient, local.gradient);
            let of_query = match (&how.query_noise, sample) {
                (Some(noise), None) => noise.variance(row, local.surface_normal),
                _ => 0.0,
            };
            let behind = dot(sub(points[row], found.feet.point[row]), local.gradient) < 0.0;
            let signed = surface.sign() == Sign::Given && local.signed;
            let offset = self.offset((&local, answers.extra(lane).degree), answers.hessian(lane));
            [(of_surface + of_query).sqrt(), if behind && !signed { -offset } else { offset }]
        };
        {
            let sigma = Numbers::values(&mut found.sigma, rows, true);
            let bias = Numbers::values(&mut found.bias, rows, true);
            grouped.for_each_group(self.run, wanted, |evaluator, group| {
                for &row in &group.invalid {
                    sigma.put(row as usize, [f64::NAN]);
                    bias.put(row as usize, [f64::NAN]);
                }
                evaluator.evaluate(&group.positions, &|_, _| (), |i, answers, lane| {
                    let row = group.rows[i] as usize;
                    let [deviation, offset] = errors(row, &group.positions[i], (answers, lane));
                    sigma.put(row, [deviation]);
                    bias.put(row, [offset]);
                });
            })?;
        }
        Ok(found)
    }

    /// ∇²f only where the bias needs it.
    fn wanted(&self) -> Wanted {
        let definition = &self.surface.definition;
        let hessian = definition.degree() < 2 || definition.degree_fallback();
        Wanted { gradient: true, sensitivity: true, hessian, ..Wanted::default() }
    }

    /// How far the surface lies behind the one that the samples lie on, along −∇f (SPEC § 11).
    fn offset(&self, (local, degree): (&Local<D>, u8), hessian: Matrix<f64, D>) -> f64 {
        if degree > 1 {
            // Its bias is of order h⁴, and has no such formula.
            return 0.0;
        }
        let bent = Curvature::new(local.gradient, local.surface_normal, hessian);
        // κ h² is a length: one unit of the grid is left.
        let h = local.support;
        bent.mean * self.surface.definition.weight().bias(D) * h * h * self.surface.grid.unit
    }

    /// Estimates the noise of the samples along the normals from f at the samples, each over what one unit of noise would make
    /// of it (SPEC § 10, the query being a sample): the median of their magnitudes over that of a normal variable. The part
    /// that the curvature explains (SPEC § 11) is taken out: the mean of the product of f and its expected bias.
    ///
    /// For noise that is the same everywhere and in all directions, from some thousand samples on: within 5 % up to 0.1 h where
    /// the bias κ h²/10 is at most as large, 10 % too small at 0.2 h; a few per cent of the samples may be anything else.
    pub fn estimate_noise(&self) -> Result<NoiseEstimate, Cancelled> {
        let surface = self.surface;
        let rows = surface.cloud.len();
        let grouped = Grouped::new(surface, Queries::Samples, self.run);
        let own = grouped.own_places();
        let wanted = self.wanted();
        let mut residuals: Vec<[f64; 2]> = Vec::new();
        {
            let residual = Numbers::rows(&mut residuals, rows, true);
            grouped.for_each_group(self.run, wanted, |evaluator, group| {
                for &row in &group.invalid {
                    residual.put(row as usize, [f64::NAN; 2]);
                }
                evaluator.evaluate(&group.positions, &|_, _| (), |i, answers, lane| {
                    let row = group.rows[i] as usize;
                    let local = answers.local(lane);
                    let sample = own.get(row).copied().flatten().map(|place| (row, place));
                    let unit = (surface, &Noise::Uniform(1.0));
                    let one =
                        variance_by(unit, sample, &group.positions[i], (&local, &answers.extra(lane))).sqrt();
                    let known = local.acceptance(&surface.definition).is_ok();
                    let found = [
                        local.value * surface.grid.unit / one,
                        self.offset((&local, answers.extra(lane).degree), answers.hessian(lane)) / one,
                    ];
                    residual.put(row, if known { found } else { [f64::NAN; 2] });
                });
            })?;
        }
        residuals.retain(|pair| pair.iter().all(|r| r.is_finite()));
        Ok(noise_of(&residuals))
    }
}

/// The noise from pairs of f and its expected bias, both over what one unit of noise makes of f.
fn noise_of(residuals: &[[f64; 2]]) -> NoiseEstimate {
    let samples = residuals.len();
    if samples == 0 {
        return NoiseEstimate { sigma: f64::NAN, samples };
    }
    let mut magnitudes: Vec<f64> = residuals.iter().map(|pair| pair[0].abs()).collect();
    let (_, median, _) = magnitudes.select_nth_unstable_by(samples / 2, f64::total_cmp);
    let whole = *median / MEDIAN_OF_NORMAL;
    let (mut explained, mut count) = (0.0, 0.0);
    for [value, bias] in residuals {
        if value.abs() <= 3.0 * whole {
            explained += value * bias;
            count += 1.0;
        }
    }
    let left = whole * whole - f64::max(explained / count, 0.0);
    NoiseEstimate { sigma: f64::max(left, 0.0).sqrt(), samples }
}
