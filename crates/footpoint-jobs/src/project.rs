//! Job: points taken to the surface.

use crate::clock::timed;
use crate::load::Loaded;
use crate::numbers::Sorted;
use crate::output::{Naming, check_output, merge, put_table, set_counts, set_numbers, set_vectors};
use crate::report::{MovedReport, Report};
use crate::{Context, JobError};
use footpoint::{Noise, Project, Projections, Queries, Uncertainty};
use footpoint_io::Table;
use std::path::Path;

/// Projects every point of `input` onto the surface of `onto`, or onto its own.
///
/// Rows keep their order and all other columns; coordinates become the projected ones, as doubles. A point that
/// cannot be projected stays where it was, and its status says why. With noise each distance has its standard deviation and bias.
pub fn project(
    input: &Path,
    onto: Option<&Path>,
    output: &Path,
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_output(output, context)?;
    let mut report = Report::new("project", context.recipe.clone());
    report.recipe.project.get_or_insert_default();
    let points = Loaded::read_for(output, input, context, &mut report)?;
    let onto = onto.map(|path| Loaded::read(path, context, &mut report)).transpose()?;
    if let Some(onto) = &onto {
        report.inputs.push(onto.report());
        onto.check_dimension(&points)?;
    }
    match points.roles.dimension() {
        2 => run::<2>(points, onto, output, context, report),
        _ => run::<3>(points, onto, output, context, report),
    }
}

fn run<const D: usize>(
    points: Loaded,
    onto: Option<Loaded>,
    output: &Path,
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    let how: Project = report.recipe.project.unwrap_or_default();
    let cloud = onto.as_ref().unwrap_or(&points);
    let noise = points.query_noise(&context.recipe)?;
    if context.ends_before(cloud, &[output], &mut report)? {
        return Ok(report);
    }
    let surface = cloud.surface::<D>(context, &mut report)?;
    let estimate = timed(&mut report.times.compute, || points.estimated_query_noise::<D>(context))?;
    let noise = estimate.map(Noise::Uniform).or(noise);
    let foreign = onto.is_some().then(|| points.points::<D>());
    let queries = foreign.as_deref().map_or(Queries::Samples, Queries::Points);
    let running = surface.with(&context.run);
    let (result, errors) = if surface.cloud().noise().is_none() {
        (timed(&mut report.times.compute, || running.project(queries, &how))?, None)
    } else {
        let mut uncertainty = Uncertainty::new().with_project(how);
        if let Some(noise) = noise {
            uncertainty = uncertainty.with_query_noise(noise);
        }
        let found = timed(&mut report.times.compute, || running.uncertainty(queries, &uncertainty))
            .map_err(|problem| points.uncertainty_error(problem))?;
        (found.feet, Some((found.sigma, found.bias)))
    };
    report.count(&result.status);
    report.moved = Some(moved(&result));

    let naming = Naming::of(output);
    let mut table = points.input.table;
    let names = |axis: usize| table.columns[points.roles.coordinates[axis]].name.clone();
    let mut computed = projection_columns(names, naming, result);
    if let Some((sigma, bias)) = errors {
        set_numbers(&mut computed, "distance_sigma", sigma);
        set_numbers(&mut computed, "distance_bias", bias);
    }
    merge(&mut table, &points.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// Projected points, under the names of the coordinates, and what belongs to them.
pub(crate) fn projection_columns<const D: usize>(
    coordinate: impl Fn(usize) -> String,
    naming: Naming,
    result: Projections<D>,
) -> Table {
    let mut computed = Table::default();
    set_vectors(&mut computed, coordinate, &result.point);
    set_vectors(&mut computed, |axis| naming.surface_normal(axis), &result.surface_normal);
    set_numbers(&mut computed, "distance", result.distance);
    set_numbers(&mut computed, "residual", result.residual);
    set_counts(&mut computed, "evaluations", result.evaluations);
    computed.set(naming.status(&result.status));
    computed
}

/// How far the points that are *ok* were moved.
pub(crate) fn moved<const D: usize>(result: &Projections<D>) -> MovedReport {
    let distances = Sorted::of(result.distance.iter().map(|distance| distance.abs()));
    let evaluations: f64 = result.evaluations.iter().map(|&e| f64::from(e)).sum();
    let mean_evaluations = evaluations / result.evaluations.len().max(1) as f64;
    if distances.count() == 0 {
        return MovedReport { mean_evaluations, ..MovedReport::default() };
    }
    MovedReport {
        rms: distances.rms(),
        median: distances.quantile(0.5),
        largest: distances.quantile(1.0),
        mean_evaluations,
    }
}
