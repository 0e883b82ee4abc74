//! Job: f, its gradient and what belongs to them at given points.

use crate::clock::timed;
use crate::load::Loaded;
use crate::output::{Naming, along, set_counts, set_numbers, set_vectors};
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::{Evaluations, Queries, Want};
use footpoint_io::{Column, Table, WriteOptions, check_table, check_writable, write};
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
}

const USUAL: [Want; 8] = [
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
    check_writable(output, context.overwrite)?;
    let mut report = Report::new("evaluate", context.recipe.clone());
    let loaded = Loaded::read(cloud, &mut report.times)?;
    report.inputs.push(loaded.report());
    let mut at = Loaded::read(queries, &mut report.times)?;
    report.inputs.push(at.report());
    at.drop_own_status();
    check_table(output, &at.input.table)?;
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
    let surface = loaded.surface::<D>(context, &mut report)?;
    let want = USUAL.into_iter().chain(extra.iter().map(|e| e.want())).reduce(|a, b| a | b);
    let points = at.points::<D>();
    let result = timed(&mut report.times.compute, || {
        surface.with(&context.run).evaluate(Queries::Points(&points), want.unwrap_or(Want::VALUE))
    })?;
    report.count(&result.status);

    let table = arrange(at, result, extra, Naming::of(output));
    let options = WriteOptions { overwrite: context.overwrite, ..WriteOptions::default() };
    timed(&mut report.times.write, || write(output, &table, &options))?;
    report.wrote(output);
    Ok(report)
}

/// Coordinates, answers, then what else the queries carried under names not taken.
fn arrange<const D: usize>(at: Loaded, result: Evaluations<D>, extra: &[Extra], naming: Naming) -> Table {
    let mut queries = at.input.table;
    let mut table = Table { columns: Vec::new(), comments: std::mem::take(&mut queries.comments) };
    for &i in &at.roles.coordinates {
        table.set(queries.columns[i].clone());
    }
    set_numbers(&mut table, "value", result.value);
    set_vectors(&mut table, along("average"), &result.average);
    set_vectors(&mut table, |axis| naming.frame_normal(axis), &result.frame_normal);
    set_vectors(&mut table, along("gradient"), &result.gradient);
    set_vectors(&mut table, |axis| naming.surface_normal(axis), &result.surface_normal);
    set_numbers(&mut table, "gap", result.gap);
    set_counts(&mut table, "neighbours", result.neighbours);
    set_numbers(&mut table, "effective_neighbours", result.effective_neighbours);
    table.set(naming.status(&result.status));
    for extra in extra {
        match extra {
            Extra::WeightSum => set_numbers(&mut table, "weight_sum", result.weight_sum.clone()),
            Extra::Eigenvalues => {
                set_vectors(&mut table, |k| format!("eigenvalue_{k}"), &result.eigenvalues);
            }
            Extra::SquaredSensitivity => {
                set_numbers(&mut table, "squared_sensitivity", result.squared_sensitivity.clone());
            }
            Extra::Support => set_numbers(&mut table, "support", result.support.clone()),
        }
    }
    for (i, Column { name, data }) in queries.columns.into_iter().enumerate() {
        if at.roles.coordinates.contains(&i) {
            continue;
        }
        let taken = table.columns.iter().any(|column| column.name.eq_ignore_ascii_case(&name));
        let name = if taken { format!("given_{name}") } else { name };
        table.set(Column { name, data });
    }
    table
}

impl Extra {
    /// Every extra column with the name that asks for it.
    pub const ALL: [(&'static str, Self); 4] = [
        ("weight_sum", Self::WeightSum),
        ("eigenvalues", Self::Eigenvalues),
        ("squared_sensitivity", Self::SquaredSensitivity),
        ("support", Self::Support),
    ];

    fn want(self) -> Want {
        match self {
            Self::WeightSum => Want::WEIGHT_SUM,
            Self::Eigenvalues => Want::EIGENVALUES,
            Self::SquaredSensitivity => Want::SQUARED_SENSITIVITY,
            Self::Support => Want::SUPPORT,
        }
    }
}
