//! Job: how far points lie from the surface of a cloud.

mod feet;
mod summary;
mod surfaces;
mod walk;

use crate::clock::timed;
use crate::load::Loaded;
use crate::output::{Naming, along, check_output, merge, put_table, set_numbers, set_vectors};
use crate::report::{Recipe, Report, SurfaceReport};
use crate::{Context, JobError, Stage};
pub use feet::{DistanceSearch, Feet};
use footpoint::{CompareError, Comparison, Noise, Operator, Project, Sign};
use footpoint_io::{Column, Data, Table};
use footpoint_render::{Colours, Map};
use std::path::Path;
use summary::Found;
pub use summary::{DistanceReport, Histogram, Quantile, SupportShare};
pub use surfaces::{Changes, SurfaceSearch};

/// Whether every point gets a colour for its distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coloured {
    /// No colours.
    #[default]
    No,
    /// Up to the ends of the histogram.
    Yes,
    /// Up to this distance, a length.
    UpTo(f64),
}

/// Writes every point of `queries`, in its order and with all its columns, with how far it lies from the surface of `cloud`.
///
/// Columns: `foot_x` …, `distance` (positive on the side that the cloud's normals point to, if it has some), `distance_sigma`,
/// the surface normal at the foot point, `red green blue` on request, and `status`. Where surfaces are compared the distance is
/// that of the points' own surface, with `level_of_detection` and `significant`; where points are, sigma is there with noise, and
/// `distance_bias`. Numbers that do not exist are NaN. Distances beyond the recipe's largest are *outside*.
pub fn distance(
    queries: &Path,
    cloud: &Path,
    output: &Path,
    coloured: Coloured,
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_distance(&context.recipe)?;
    if let Coloured::UpTo(limit) = coloured {
        check_positive("the distance at the end of the colours", limit.min(f64::MAX))?;
    }
    check_output(output, context)?;
    let mut report = Report::new("distance", context.recipe.clone());
    let points = report.recipe.compares_points();
    let usual = if points { Project::new() } else { Project::new().with_tolerance(Comparison::TOLERANCE) };
    let how = report.recipe.project.unwrap_or(usual).with_operator(Operator::Orthogonal);
    report.recipe.project = Some(how);
    if !points {
        report.recipe.compare.get_or_insert_default();
    }
    let queries = Loaded::read_for(output, queries, context, &mut report)?;
    let cloud = Loaded::read(cloud, context, &mut report)?;
    report.inputs.push(cloud.report());
    cloud.check_dimension(&queries)?;
    match (cloud.roles.dimension(), points) {
        (2, true) => of_points::<2>(queries, &cloud, (output, coloured), context, report),
        (2, false) => of_surfaces::<2>(queries, &cloud, (output, coloured), context, report),
        (_, true) => of_points::<3>(queries, &cloud, (output, coloured), context, report),
        (_, false) => of_surfaces::<3>(queries, &cloud, (output, coloured), context, report),
    }
}

fn check_positive(what: &'static str, value: f64) -> Result<(), JobError> {
    if value > 0.0 { Ok(()) } else { Err(JobError::Number { what, value, wanted: "above 0" }) }
}

/// Fails where a number of the recipe makes no sense, or belongs to a σ that is not computed.
pub fn check_distance(recipe: &Recipe) -> Result<(), JobError> {
    check_positive("the largest distance", recipe.largest_distance.unwrap_or(f64::INFINITY))?;
    match recipe.registration {
        Some(value) if !(value >= 0.0 && value.is_finite()) => {
            let wanted = "finite and not negative";
            return Err(JobError::Number { what: "the error of the registration", value, wanted });
        }
        _ => {}
    }
    let of_queries =
        recipe.query_noise.is_some() || recipe.query_noise_column.is_some() || recipe.query_noise_estimated;
    if !recipe.compares_points() {
        let only_points = [
            (recipe.noise.is_some(), "the noise of the samples"),
            (of_queries, "the noise of the queries"),
            (recipe.choose_degree.is_some(), "the choice of a degree"),
        ];
        return match only_points.iter().find(|(given, _)| *given) {
            Some((_, what)) => Err(JobError::OnlyPoints(what)),
            None => Ok(()),
        };
    }
    if recipe.noise.is_some() {
        return Ok(());
    }
    if recipe.registration.is_some() {
        return Err(JobError::PartOfSigma("the error of the registration"));
    }
    if of_queries {
        return Err(JobError::PartOfSigma("the noise of the queries"));
    }
    Ok(())
}

/// The points against the surface of the cloud.
fn of_points<const D: usize>(
    queries: Loaded,
    cloud: &Loaded,
    (output, coloured): (&Path, Coloured),
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    let noise = queries.query_noise::<D>(&context.recipe)?;
    if context.ends_before(cloud, &[output], &mut report)? {
        return Ok(report);
    }
    let mut surface = cloud.surface::<D>(context, &mut report)?;
    let has_sigma = context.recipe.noise.is_some();
    if !has_sigma {
        // The bias is known without noise.
        surface = surface.with_uniform_noise(0.0).map_err(|problem| cloud.noise_error(problem))?;
    }
    let estimate = timed(&mut report.times.compute, || queries.estimated_query_noise::<D>(context))?;
    let noise = estimate.map(Noise::Uniform).or(noise);
    let search = DistanceSearch::of(&report.recipe, noise);
    let points = queries.points::<D>();
    let Feet { found, walked } =
        timed(&mut report.times.compute, || search.feet(&surface, &points, &context.run))
            .map_err(|problem| queries.uncertainty_error(problem))?;
    report.count(&found.feet.status);
    let signed = surface.sign() == Sign::Given;
    let sigma = has_sigma.then_some(found.sigma.as_slice());
    let summary = DistanceReport::of(
        &Found { distance: &found.feet.distance, sigma, bias: Some(&found.bias) },
        signed,
        walked,
    );

    let summary = DistanceReport { query_noise: estimate, ..summary };

    let naming = Naming::of(output);
    let mut computed = Table::default();
    set_vectors(&mut computed, along("foot"), &found.feet.point);
    let colour_range = paint(&mut computed, coloured, &summary, &found.feet.distance);
    set_numbers(&mut computed, "distance", found.feet.distance);
    if has_sigma {
        set_numbers(&mut computed, "distance_sigma", found.sigma);
    }
    set_numbers(&mut computed, "distance_bias", found.bias);
    set_vectors(&mut computed, |axis| naming.foot_normal(axis), &found.feet.surface_normal);
    computed.set(naming.status(&found.feet.status));
    report.distance = Some(DistanceReport { colour_range, ..summary });
    let mut table = queries.input.table;
    merge(&mut table, &queries.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// The surface of the points against that of the cloud.
fn of_surfaces<const D: usize>(
    queries: Loaded,
    cloud: &Loaded,
    (output, coloured): (&Path, Coloured),
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    if context.ends_before(cloud, &[output], &mut report)? {
        return Ok(report);
    }
    let (earlier, later) = (cloud.cloud::<D>(&context.recipe)?, queries.later_cloud::<D>(&context.recipe)?);
    context.begin(Stage::Compute);
    let search = SurfaceSearch::of(&report.recipe);
    let definition = context.definition();
    let changes =
        timed(&mut report.times.compute, || search.changes((&earlier, &later), definition, &context.run))
            .map_err(|problem| match problem {
                CompareError::Earlier(problem) => cloud.surface_error(problem),
                CompareError::Later(problem) => queries.surface_error(problem),
                _ => JobError::Cancelled,
            })?;
    report.surface = Some(SurfaceReport::of(&changes.widest.earlier));
    report.count(&changes.found.status);
    let signed = changes.widest.earlier.sign() == Sign::Given;
    let summary = DistanceReport::of_changes(&changes, signed);

    let naming = Naming::of(output);
    let mut computed = Table::default();
    let found = &changes.found;
    set_vectors(&mut computed, along("foot"), &found.foot);
    let colour_range = paint(&mut computed, coloured, &summary, &found.distance);
    set_numbers(&mut computed, "distance", found.distance.clone());
    set_numbers(&mut computed, "distance_sigma", found.sigma.clone());
    let level = found.sigma.iter().map(|sigma| Comparison::LEVEL * sigma).collect();
    set_numbers(&mut computed, "level_of_detection", level);
    let significant = (0..found.status.len()).map(|row| u8::from(changes.is_significant(row))).collect();
    computed.set(Column::new("significant", Data::U8(significant)));
    set_vectors(&mut computed, |axis| naming.foot_normal(axis), &found.surface_normal);
    computed.set(naming.status(&found.status));
    report.distance = Some(DistanceReport { colour_range, ..summary });
    let mut table = queries.input.table;
    merge(&mut table, &queries.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// `red green blue`, bytes of sRGB, where they are wanted; the distances at the ends of the colours.
fn paint(
    table: &mut Table,
    coloured: Coloured,
    summary: &DistanceReport,
    distances: &[f64],
) -> Option<[f64; 2]> {
    let range = match coloured {
        Coloured::No => return None,
        Coloured::Yes => [summary.histogram.low, summary.histogram.high],
        Coloured::UpTo(limit) => [if summary.signed { -limit } else { 0.0 }, limit],
    };
    let colours = Colours::new(if summary.signed { Map::Diverging } else { Map::Sequential }, range);
    let bytes: Vec<[u8; 3]> = distances.iter().map(|&d| colours.bytes(d)).collect();
    for (k, name) in ["red", "green", "blue"].into_iter().enumerate() {
        table.set(Column::new(name, Data::U8(bytes.iter().map(|rgb| rgb[k]).collect())));
    }
    Some(range)
}
