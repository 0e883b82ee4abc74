//! Job: the paper's figure 3 for any scan: shaded by n, by ∇f, and the cosine of the angle between the two.

use crate::clock::timed;
use crate::load::{Loaded, surface_of_cloud};
use crate::render::{RenderReport, check_picture, put};
use crate::report::Report;
use crate::scan::{ScanPlan, Vessel, scan};
use crate::{Context, JobError, Stage};
use footpoint::{Cloud, Support};
use footpoint_render::{Wish, triptych as draw, write_image};
use std::path::Path;

/// Rays along each side of a pixel.
const ACROSS: usize = 2;
/// The built-in scan's density varies tenfold, so each sample gets its own support, wide enough to average its noise.
const BUILT_IN: Support = Support::AutoPerSample { effective_neighbours: 24.0 };

/// Draws the three pictures of `input`, or of the simulated scan of a vase, side by side into `output`, a PNG of so many
/// pixels in a row.
///
/// The built-in scan has a support per sample unless the recipe's definition says otherwise. Fails as `render` does.
pub fn triptych(
    input: Option<&Path>,
    output: &Path,
    width: usize,
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_picture(output, context.overwrite)?;
    let mut report = Report::new("figure", context.recipe.clone());
    let mut wish = Wish::default();
    let (surface, name) = match input {
        Some(path) => {
            let loaded = read_space(path, context, &mut report)?;
            wish.origin = loaded.origin();
            (loaded.surface::<3>(context, &mut report)?, path.display().to_string())
        }
        None => {
            let made = timed(&mut report.times.read, || scan(&Vessel::new(), &ScanPlan::default()));
            let mut context = context.clone();
            if context.recipe == crate::Recipe::default() {
                context.recipe.definition = context.recipe.definition.with_support(BUILT_IN);
                report.recipe = context.recipe.clone();
            }
            let name = "the simulated scan".to_owned();
            (surface_of_cloud(Cloud::new(made.points), &name, &context, &mut report)?, name)
        }
    };
    context.begin(Stage::Draw);
    let drawn =
        timed(&mut report.times.draw, || draw(&surface, &wish, ([width / 3; 2], ACROSS), &context.run))
            .map_err(|problem| JobError::of_render(&name, problem))?;
    if drawn.hits == 0 {
        return Err(JobError::NothingHit(name));
    }
    let seconds = report.times.draw.wall_seconds;
    report.points = drawn.rays;
    report.points_per_second = if seconds > 0.0 { drawn.rays as f64 / seconds } else { 0.0 };
    report.render = Some(RenderReport {
        shading: "triptych",
        width: drawn.image.width(),
        height: drawn.image.height(),
        samples_per_pixel: ACROSS * ACROSS,
        camera: drawn.camera,
        up: drawn.upright,
        rays: drawn.rays,
        hits: drawn.hits,
        rays_per_second: report.points_per_second,
        range: Some(drawn.range),
        depth_range: None,
    });
    put(&mut report, output, context, &|out| write_image(&drawn.image, out))?;
    Ok(report)
}

/// Reads a file of points in space.
pub(crate) fn read_space(
    path: &Path,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Loaded, JobError> {
    let loaded = Loaded::read(path, context, report)?;
    report.inputs.push(loaded.report());
    loaded.check_space()?;
    Ok(loaded)
}
