//! Job: how far points lie from the surface of a cloud.

mod feet;
mod summary;
mod walk;

use crate::clock::timed;
use crate::load::Loaded;
use crate::output::{Naming, along, check_output, merge, put_table, set_numbers, set_vectors};
use crate::report::{Recipe, Report};
use crate::{Context, JobError};
pub use feet::{DistanceSearch, Feet};
use footpoint::{Operator, Sign};
use footpoint_io::{Column, Data, Table};
use footpoint_render::{Colours, Map};
use std::path::Path;
use summary::Found;
pub use summary::{DistanceReport, Histogram, Quantile};

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

/// Writes every point of `queries`, in its order and with all its columns, with its foot point on the surface of `cloud`.
///
/// Columns: `foot_x` …, `distance` (positive on the side that the cloud's normals point to, if it has some), `distance_sigma`
/// where the recipe has noise, `distance_bias`, the surface normal at the foot point, `red green blue` on request, and `status`.
/// Numbers that do not exist are NaN. Distances beyond the recipe's largest are *outside*.
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
    let how = report.recipe.project.unwrap_or_default().with_operator(Operator::Orthogonal);
    report.recipe.project = Some(how);
    let queries = Loaded::read_for(output, queries, context, &mut report)?;
    let cloud = Loaded::read(cloud, context, &mut report)?;
    report.inputs.push(cloud.report());
    cloud.check_dimension(&queries)?;
    match cloud.roles.dimension() {
        2 => run::<2>(queries, &cloud, (output, coloured), context, report),
        _ => run::<3>(queries, &cloud, (output, coloured), context, report),
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
    if recipe.noise.is_some() {
        return Ok(());
    }
    if recipe.registration.is_some() {
        return Err(JobError::PartOfSigma("the error of the registration"));
    }
    if recipe.query_noise.is_some() || recipe.query_noise_column.is_some() {
        return Err(JobError::PartOfSigma("the noise of the queries"));
    }
    Ok(())
}

fn run<const D: usize>(
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
    let search = DistanceSearch::of(&report.recipe, noise);
    let points = queries.points::<D>();
    let Feet { found, walked } =
        timed(&mut report.times.compute, || search.feet(&surface, &points, &context.run))
            .map_err(|problem| queries.uncertainty_error(problem))?;
    report.count(&found.feet.status);
    let signed = surface.sign() == Sign::Given;
    let sigma = has_sigma.then_some(found.sigma.as_slice());
    let summary = DistanceReport::of(
        &Found { distance: &found.feet.distance, sigma, bias: &found.bias },
        signed,
        walked,
    );

    let naming = Naming::of(output);
    let mut computed = Table::default();
    set_vectors(&mut computed, along("foot"), &found.feet.point);
    let colours = match coloured {
        Coloured::No => None,
        Coloured::Yes => Some([summary.histogram.low, summary.histogram.high]),
        Coloured::UpTo(limit) => Some([if signed { -limit } else { 0.0 }, limit]),
    };
    if let Some(range) = colours {
        let map = if signed { Map::Diverging } else { Map::Sequential };
        paint(&mut computed, &Colours::new(map, range), &found.feet.distance);
    }
    set_numbers(&mut computed, "distance", found.feet.distance);
    if has_sigma {
        set_numbers(&mut computed, "distance_sigma", found.sigma);
    }
    set_numbers(&mut computed, "distance_bias", found.bias);
    set_vectors(&mut computed, |axis| naming.foot_normal(axis), &found.feet.surface_normal);
    computed.set(naming.status(&found.feet.status));
    report.distance = Some(DistanceReport { colour_range: colours, ..summary });
    let mut table = queries.input.table;
    merge(&mut table, &queries.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// `red green blue`, bytes of sRGB.
fn paint(table: &mut Table, colours: &Colours, distances: &[f64]) {
    let bytes: Vec<[u8; 3]> = distances.iter().map(|&d| colours.bytes(d)).collect();
    for (k, name) in ["red", "green", "blue"].into_iter().enumerate() {
        table.set(Column::new(name, Data::U8(bytes.iter().map(|rgb| rgb[k]).collect())));
    }
}
