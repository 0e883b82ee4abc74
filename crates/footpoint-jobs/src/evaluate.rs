//! Job: f, its gradient and what belongs to them at given points.

use crate::clock::timed;
use crate::load::Loaded;
use crate::output::{Naming, along, check_output, put_table, set_counts, set_numbers, set_vectors};
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::{Curvatures, Evaluations, Queries, Want};
use footpoint_io::{Column, Table};
use std::path::Path;

/// Columns of `evaluate` beyond the usual ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// `weight_sum`: S = Σθ.
    WeightSum,
    /// `eigenvalue_0` …: ascending, of the matrix that gives the frame.
    Eigenvalues,
    /// `squared_sensitivity`: Σ|∂f/∂p_i|².
    SquaredSensitivity,
    /// `support`: h at the point.
    Support,
    /// `eccentricity`: |a − x| across n over the support; above the acceptance rule's limit a surface point is *boundary*.
    Eccentricity,
    /// `hessian_xx`, `hessian_xy` …: the upper triangle of ∇²f.
    Hessian,
    /// `mean_curvature`, `gaussian_curvature`, `principal_curvature_1` …, `principal_direction_1_x` …; in 2-D `curvature`.
    Curvature,
    /// `sigma`: the standard deviation of f from the samples' noise.
    Sigma,
    /// `degree`: the degree of the polynomial that answered.
    Degree,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// What is computed unless something else is asked for.
pub const USUAL: [Want; 8] = [
    Want::VALUE,
    Want::AVERAGE,
    Want::FRAME_NORMAL,
    Want::GRADIENT,
    Want::SURFACE_NORMAL,
    Want::GAP,
    Want::NEIGHBOURS,
    Want::EFFECTIVE_NEIGHBOURS,
];

/// Evaluates the surface of `cloud` at the points of `queries`; one row a query, in their order.
///
/// Columns: coordinates, value, average, frame normal, gradient, surface normal, gap, neighbours, effective
/// neighbours, status, the extra ones, then all other columns of the queries.
pub fn evaluate(
    cloud: &Path,
    queries: &Path,
    output: &Path,
    extra: &[Extra],
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_output(output, context)?;
    let mut report = Report::new("evaluate", context.recipe.clone());
    let loaded = Loaded::read(cloud, context, &mut report)?;
    report.inputs.push(loaded.report());
    let at = Loaded::read_for(output, queries, context, &mut report)?;
    loaded.check_dimension(&at)?;
    match loaded.roles.dimension() {
        2 => run::<2>(&loaded, at, output, extra, context, report),
        _ => run::<3>(&loaded, at, output, extra, context, report),
    }
}

fn run<const D: usize>(
    loaded: &Loaded,
    at: Loaded,
    output: &Path,
    extra: &[Extra],
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    if extra.contains(&Extra::Sigma) && context.recipe.noise.is_none() {
        return Err(JobError::NoNoise);
    }
    if context.ends_before(loaded, &[output], &mut report)? {
        return Ok(report);
    }
    let surface = loaded.surface::<D>(context, &mut report)?;
    let want = USUAL.into_iter().chain(extra.iter().map(|e| e.want())).reduce(|a, b| a | b);
    let points = at.points::<D>();
    let result = timed(&mut report.times.compute, || {
        surface.with(&context.run).evaluate(Queries::Points(&points), want.unwrap_or(Want::VALUE))
    })?;
    report.count(&result.status);

    let table = arrange(at, result, extra, Naming::of(output));
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// Coordinates, answers, then what else the queries carried under names not taken.
fn arrange<const D: usize>(at: Loaded, result: Evaluations<D>, extra: &[Extra], naming: Naming) -> Table {
    let mut table = at.input.table;
    let queries = std::mem::take(&mut table.columns);
    for &i in &at.roles.coordinates {
        table.set(queries[i].clone());
    }
    let mut more = Table::default();
    extra.iter().for_each(|extra| extra.set(&mut more, &result));
    set_numbers(&mut table, "value", result.value);
    set_vectors(&mut table, along("average"), &result.average);
    set_vectors(&mut table, |axis| naming.frame_normal(axis), &result.frame_normal);
    set_vectors(&mut table, along("gradient"), &result.gradient);
    set_vectors(&mut table, |axis| naming.surface_normal(axis), &result.surface_normal);
    set_numbers(&mut table, "gap", result.gap);
    set_counts(&mut table, "neighbours", result.neighbours);
    set_numbers(&mut table, "effective_neighbours", result.effective_neighbours);
    table.set(naming.status(&result.status));
    more.columns.into_iter().for_each(|column| table.set(column));
    for (i, Column { name, data }) in queries.into_iter().enumerate() {
        if at.roles.coordinates.contains(&i) {
            continue;
        }
        let taken = table.columns.iter().any(|column| column.name.eq_ignore_ascii_case(&name));
        let name = if taken { format!("given_{name}") } else { name };
        table.set(Column { name, data });
    }
    table
}

/// Curvatures under their names; in 2-D there is one.
pub(crate) fn set_curvatures<const D: usize>(table: &mut Table, curvature: &Curvatures<D>) {
    if D == 2 {
        set_numbers(table, "curvature", curvature.mean.clone());
        return;
    }
    set_numbers(table, "mean_curvature", curvature.mean.clone());
    set_numbers(table, "gaussian_curvature", curvature.gaussian.clone());
    set_vectors(table, |k| format!("principal_curvature_{}", k + 1), &curvature.principal);
    for k in 0..2 {
        let directions: Vec<[f64; D]> = curvature.directions.iter().map(|pair| pair[k]).collect();
        set_vectors(table, along(&format!("principal_direction_{}", k + 1)), &directions);
    }
}

impl Extra {
    fn set<const D: usize>(self, table: &mut Table, result: &Evaluations<D>) {
        match self {
            Self::WeightSum => set_numbers(table, "weight_sum", result.weight_sum.clone()),
            Self::Eigenvalues => set_vectors(table, |k| format!("eigenvalue_{k}"), &result.eigenvalues),
            Self::SquaredSensitivity => {
                set_numbers(table, "squared_sensitivity", result.squared_sensitivity.clone());
            }
            Self::Support => set_numbers(table, "support", result.support.clone()),
            Self::Eccentricity => set_numbers(table, "eccentricity", result.eccentricity.clone()),
            Self::Hessian => {
                for (i, first) in AXES.iter().enumerate().take(D) {
                    for (k, second) in AXES.iter().enumerate().take(D).skip(i) {
                        let entries = result.hessian.iter().map(|h| h[i][k]).collect();
                        set_numbers(table, &format!("hessian_{first}{second}"), entries);
                    }
                }
            }
            Self::Curvature => set_curvatures(table, &result.curvature),
            Self::Sigma => set_numbers(table, "sigma", result.sigma.clone()),
            Self::Degree => set_counts(table, "degree", result.degree.clone()),
        }
    }

    /// Every extra column with the name that asks for it.
    pub const ALL: [(&'static str, Self); 9] = [
        ("weight_sum", Self::WeightSum),
        ("eigenvalues", Self::Eigenvalues),
        ("squared_sensitivity", Self::SquaredSensitivity),
        ("support", Self::Support),
        ("eccentricity", Self::Eccentricity),
        ("hessian", Self::Hessian),
        ("curvature", Self::Curvature),
        ("sigma", Self::Sigma),
        ("degree", Self::Degree),
    ];

    fn want(self) -> Want {
        match self {
            Self::WeightSum => Want::WEIGHT_SUM,
            Self::Eigenvalues => Want::EIGENVALUES,
            Self::SquaredSensitivity => Want::SQUARED_SENSITIVITY,
            Self::Support => Want::SUPPORT,
            Self::Eccentricity => Want::ECCENTRICITY,
            Self::Hessian => Want::HESSIAN,
            Self::Curvature => Want::CURVATURE,
            Self::Sigma => Want::SIGMA,
            Self::Degree => Want::DEGREE,
        }
    }
}
