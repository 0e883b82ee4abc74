//! Job: a simulated scan, its normals and its projection, compared with the known truth.

use crate::clock::timed;
use crate::load::surface_of_cloud;
use crate::numbers::{Sorted, median};
use crate::output::{Naming, set_numbers, set_vectors};
use crate::project::{moved, projection_columns};
use crate::render::{RenderPlan, picture, put};
use crate::report::Report;
use crate::scan::{ScanPlan, Vessel, scan};
use crate::{Context, JobError, Stage};
use footpoint::{Cloud, Project, Queries, Status, Surface, Want};
use footpoint_io::{Column, Data, Table};
use footpoint_render::{Canvas, RenderError, Shading, Wish, triptych, write_image};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What to simulate and where to put it.
#[derive(Clone, Debug, PartialEq)]
pub struct DemoPlan {
    /// Folder for clouds and pictures; made if it does not exist.
    pub folder: PathBuf,
    /// The scan.
    pub scan: ScanPlan,
    /// Pixels in a row of `picture.png`, three quarters as many rows; 0 draws nothing.
    pub picture_width: usize,
}

const CLOUDS: [&str; 3] = ["scan.ply", "normals.ply", "projected.ply"];
const PICTURES: [&str; 2] = ["picture.png", "triptych.png"];

impl DemoPlan {
    /// The files that are written.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let pictures = PICTURES.iter().filter(|_| self.picture_width > 0);
        CLOUDS.iter().chain(pictures).map(|name| self.folder.join(name)).collect()
    }
}

/// How near the computed surface comes to the truth, over the points that are *ok*.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DemoReport {
    /// Standard deviation of the simulated ranges.
    pub noise_metres: f64,
    /// Root mean square distance of the samples from the true surface.
    pub rms_before_metres: f64,
    /// The same of the projected points.
    pub rms_after_metres: f64,
    /// After over before.
    pub rms_ratio: f64,
    /// Median angle between the surface normal at a projected point and the truth there.
    pub median_surface_normal_error_degrees: f64,
    /// The same at the samples themselves, as the job `normals` gives them.
    pub median_normal_error_at_samples_degrees: f64,
    /// The same of the frame normals.
    pub median_frame_normal_error_degrees: f64,
    /// Share of projected points that are *ok*.
    pub ok_share: f64,
}

/// Scans the vase, computes normals and orthogonal projections, writes `scan.ply`, `normals.ply` and
/// `projected.ply`, compares with the truth, and draws the surface: `picture.png` and, as the paper's figure 3, `triptych.png`.
pub fn demo(plan: &DemoPlan, context: &Context<'_>) -> Result<Report, JobError> {
    plan.scan.check()?;
    let mut report = Report::new("demo", context.recipe.clone());
    let how: Project = *report.recipe.project.get_or_insert_default();
    let files = CLOUDS.map(|name| plan.folder.join(name));
    let pictures = PICTURES.map(|name| plan.folder.join(name));
    context.prepare_folder(&plan.folder, &plan.files())?;
    if context.is_dry() {
        context.plan(&plan.files(), &mut report);
        return Ok(report);
    }

    // The simulation stands where other jobs read a file.
    let vessel = Vessel::new();
    let scan = timed(&mut report.times.read, || scan(&vessel, &plan.scan));
    let mut table = Table::default();
    let coordinate = |axis: usize| ["x", "y", "z"][axis].to_owned();
    set_vectors(&mut table, coordinate, &scan.points);
    table.set(Column::new("station", Data::U8(scan.station)));
    let cloud = Cloud::new(scan.points);
    let surface = surface_of_cloud(cloud, "the simulated scan", context, &mut report)?;

    let (evaluated, projected) = timed(&mut report.times.compute, || -> Result<_, JobError> {
        let running = surface.with(&context.run);
        let want = Want::SURFACE_NORMAL | Want::FRAME_NORMAL;
        Ok((running.evaluate(Queries::Samples, want)?, running.project(Queries::Samples, &how)?))
    })?;
    report.count(&projected.status);
    report.moved = Some(moved(&projected));

    let mut error = Errors::default();
    let samples = surface.cloud().points();
    for (i, sample) in samples.iter().enumerate() {
        let (before, _, truth) = vessel.distance(*sample);
        let (after, _, truth_there) = vessel.distance(projected.point[i]);
        let ok = projected.status[i] == Status::Ok;
        error.after.push(if ok { after } else { f64::NAN });
        error.before.push(if ok { before } else { f64::NAN });
        error.surface_normal.push(degrees(projected.surface_normal[i], truth_there));
        error.frame_normal.push(degrees(projected.frame_normal[i], truth_there));
        error.at_sample.push(degrees(evaluated.surface_normal[i], truth));
    }
    report.demo = Some(error.report(plan.scan.noise));

    timed(&mut report.times.write, || -> Result<(), JobError> {
        let mut put = |file: &Path, table: &Table| -> Result<(), JobError> {
            context.write(file, table)?;
            report.outputs.push(file.display().to_string());
            Ok(())
        };
        put(&files[0], &table)?;
        let mut normals = table.clone();
        set_vectors(&mut normals, |axis| Naming::Ply.surface_normal(axis), &evaluated.surface_normal);
        set_vectors(&mut normals, |axis| Naming::Ply.frame_normal(axis), &evaluated.frame_normal);
        normals.set(Naming::Ply.status(&evaluated.status));
        put(&files[1], &normals)?;
        for column in projection_columns(coordinate, Naming::Ply, projected).columns {
            table.set(column);
        }
        set_numbers(&mut table, "error_before", error.before);
        set_numbers(&mut table, "error_after", error.after);
        put(&files[2], &table)
    })?;
    if plan.picture_width > 0 {
        draw(&surface, plan.picture_width, &pictures, context, &mut report)?;
    }
    Ok(report)
}

/// Draws the surface and the triptych. A scan of a few rays has no surface to see: its pictures are empty, and no error.
fn draw(
    surface: &Surface<3>,
    width: usize,
    files: &[PathBuf; 2],
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), JobError> {
    let wrong = |problem: RenderError| JobError::of_render("the simulated scan", problem);
    let canvas = Canvas::Given([width, (3 * width).div_ceil(4)]);
    let plan = RenderPlan { canvas, ..RenderPlan::default() };
    // Half as wide again as the picture.
    let panel = [width.div_ceil(2); 2];
    let run = context.run.silent();
    context.begin(Stage::Draw);
    let (picture, three) = timed(&mut report.times.draw, || -> Result<_, RenderError> {
        let (_, picture) = picture(surface, &plan, (Shading::Surface, ""), &run)?;
        Ok((picture, triptych(surface, &Wish::default(), (panel, plan.across), &run)?))
    })
    .map_err(wrong)?;
    put(report, &files[0], context, &|out| write_image(&picture.image, out))?;
    put(report, &files[1], context, &|out| write_image(&three.image, out))
}

/// Errors at every sample; NaN where there is no answer.
#[derive(Default)]
struct Errors {
    before: Vec<f64>,
    after: Vec<f64>,
    surface_normal: Vec<f64>,
    frame_normal: Vec<f64>,
    at_sample: Vec<f64>,
}

impl Errors {
    fn report(&self, noise: f64) -> DemoReport {
        let before = Sorted::of(self.before.iter().copied()).rms();
        let after = Sorted::of(self.after.iter().copied()).rms();
        let ok = self.after.iter().filter(|e| !e.is_nan()).count();
        let median = |errors: &[f64]| median(errors.to_vec()).unwrap_or(f64::NAN);
        DemoReport {
            noise_metres: noise,
            rms_before_metres: before,
            rms_after_metres: after,
            rms_ratio: after / before,
            median_surface_normal_error_degrees: median(&self.surface_normal),
            median_normal_error_at_samples_degrees: median(&self.at_sample),
            median_frame_normal_error_degrees: median(&self.frame_normal),
            ok_share: ok as f64 / self.after.len() as f64,
        }
    }
}

/// Angle between two axes, whatever their signs.
fn degrees(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot: f64 = (0..3).map(|k| a[k] * b[k]).sum();
    // The arc tangent is exact for small angles, where the arc cosine is not.
    cross.iter().map(|c| c * c).sum::<f64>().sqrt().atan2(dot.abs()).to_degrees()
}
