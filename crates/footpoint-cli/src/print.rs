//! Reports in words.

mod distance;
mod plan;

use footpoint_jobs::{
    DegreeAim, DegreeChoice, InfoReport, NoiseSource, Projection, RenderReport, Report, Status,
};
use std::fmt::{Display, Write};

/// How much to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verbosity {
    Quiet,
    Normal,
    Verbose,
}

impl Verbosity {
    /// At least the normal amount.
    pub(crate) fn or_normal(self) -> Self {
        if self == Self::Quiet { Self::Normal } else { self }
    }
}

/// A larger share of undetermined frames than this is worth a hint.
const MANY: f64 = 0.05;
/// A median gap below this is too.
const POOR_GAP: f64 = 0.2;
/// Characters of a reference system.
const LONGEST_CRS: usize = 60;
const HINT: &str = "hint: many frames are poorly determined: a wider support averages more noise (--auto 40), \
    one per sample suits uneven density (--per-sample 16)";

/// The report for a reader.
pub(crate) fn report(report: &Report, verbosity: Verbosity) -> String {
    let mut text = String::new();
    if verbosity != Verbosity::Quiet {
        // Writing to a string does not fail.
        let _ = describe(&mut text, report, verbosity);
    }
    text
}

/// `1 point`, `2 points`.
pub(crate) fn count<N: Display + From<u8> + PartialEq>(number: N, what: &str) -> String {
    let plural = if number == N::from(1) { "" } else { "s" };
    format!("{number} {what}{plural}")
}

fn describe(out: &mut String, report: &Report, verbosity: Verbosity) -> std::fmt::Result {
    for input in &report.inputs {
        let points = count(input.points, "point");
        writeln!(out, "{}: {points}, {}-D, {}", input.path, input.dimension, input.format)?;
        if input.not_finite > 0 {
            let points = count(input.not_finite, "point");
            writeln!(out, "  {points} not finite, kept in place without an answer")?;
        }
        if input.missing_points > 0 {
            writeln!(out, "  {} missing: the file states more", count(input.missing_points, "point"))?;
        }
        if let Some(crs) = &input.crs {
            // Well-known text begins with what it is.
            let name: String = crs.chars().take(LONGEST_CRS).collect();
            let more = if name.len() < crs.len() { " …" } else { "" };
            writeln!(out, "  reference system {name}{more}")?;
        }
        if input.unusable_normals > 0 {
            writeln!(out, "  {} normals are zero or not finite and count as absent", input.unusable_normals)?;
        }
        for note in &input.notes {
            writeln!(out, "  note: {note}")?;
        }
    }
    if let Some(info) = &report.info {
        describe_info(out, info)?;
    }
    if let Some(surface) = &report.surface {
        let s = surface.support;
        if s.uniform {
            writeln!(out, "support radius {}", short(s.median))?;
        } else {
            let (low, middle, high) = (short(s.smallest), short(s.median), short(s.largest));
            writeln!(out, "support radius per sample, {low} to {high}, median {middle}")?;
        }
        if let Some(choice) = surface.support_choice {
            let (error, noise) = (short(choice.error()), short(choice.noise));
            writeln!(
                out,
                "  chosen for the least error: {:.1} effective neighbours",
                choice.effective_neighbours
            )?;
            writeln!(out, "  noise of the samples {noise}; expected error of the surface {error} rms")?;
            let (from_noise, from_bias) = (short(choice.error_from_noise), short(choice.error_from_bias));
            writeln!(out, "    {from_noise} from noise, {from_bias} from curvature")?;
        }
        if let Some(choice) = &surface.degree_choice {
            write_degree(out, choice)?;
        }
        if let (Some(sigma), Some(NoiseSource::Estimated)) = (surface.noise_sigma, &report.recipe.noise) {
            writeln!(out, "noise of the samples {}, estimated from the residuals", short(sigma))?;
        }
        if surface.samples_absent > 0 {
            writeln!(out, "{} left out of the surface", count(surface.samples_absent, "sample"))?;
        }
        if verbosity == Verbosity::Verbose {
            let definition = serde_json::to_string(&report.recipe.definition).unwrap_or_default();
            writeln!(out, "definition {definition}")?;
            writeln!(out, "boundary limit {}, cell side {}", surface.boundary_limit, surface.cell_side)?;
        }
    }
    if !report.statuses.is_empty() {
        let counts: Vec<String> =
            report.statuses.iter().map(|c| format!("{} {}", c.points, c.status)).collect();
        writeln!(out, "{}: {}", report.job, counts.join(", "))?;
        let degenerate = report.statuses.iter().find(|c| c.status == Status::Degenerate.name());
        let unsigned = report.orientation.as_ref().is_some_and(|found| found.non_orientable > 0);
        if !unsigned && degenerate.is_some_and(|c| c.points as f64 > MANY * report.points as f64) {
            writeln!(out, "  {HINT}")?;
        }
    }
    if let Some(moved) = &report.moved {
        let (rms, median, largest) = (short(moved.rms), short(moved.median), short(moved.largest));
        write!(out, "moved by {rms} rms, {median} median, {largest} at most")?;
        writeln!(out, "; {:.1} evaluations a point", moved.mean_evaluations)?;
    }
    if let Some(found) = &report.distance {
        distance::describe(out, report, found)?;
    }
    if let Some(found) = &report.orientation {
        writeln!(
            out,
            "{} oriented, {} of them reversed, {} doubtful",
            found.oriented, found.reversed, found.doubtful
        )?;
        if found.components > 0 {
            let largest = found.largest.first().map_or(0, |component| component.samples);
            let (components, largest) = (count(found.components, "component"), count(largest, "sample"));
            writeln!(out, "  {components}, the largest of {largest}")?;
        }
        if found.non_orientable > 0 {
            writeln!(
                out,
                "  {} not orientable: signs cannot agree there (a smaller support keeps near sheets apart; \
                 --force-orientation leaves a seam)",
                found.non_orientable
            )?;
        }
    }
    if let Some(demo) = &report.demo {
        let (before, after) = (1e3 * demo.rms_before_metres, 1e3 * demo.rms_after_metres);
        writeln!(out, "distance from the true surface, rms: {before:.4} mm before, {after:.4} mm after")?;
        writeln!(out, "  that is {:.3} of the noise; {:.2} % ok", demo.rms_ratio, 100.0 * demo.ok_share)?;
        writeln!(
            out,
            "normals against the truth, median: surface {:.3} degrees, frame {:.3}, at the samples {:.3}",
            demo.median_surface_normal_error_degrees,
            demo.median_frame_normal_error_degrees,
            demo.median_normal_error_at_samples_degrees,
        )?;
    }
    if let Some(render) = &report.render {
        describe_picture(out, render)?;
    }
    let wrote = if report.dry_run { "would write" } else { "wrote" };
    for output in &report.outputs {
        writeln!(out, "{wrote} {output}")?;
    }
    if report.dry_run {
        if !report.inputs.is_empty() {
            writeln!(out, "would compute `{}`: {}", report.job, plan::surface(&report.recipe))?;
        }
        writeln!(out, "dry run: nothing was computed or written")?;
    }
    let t = &report.times;
    write!(out, "seconds: read {:.2}, index {:.2}", t.read.wall_seconds, t.index.wall_seconds)?;
    write!(out, ", compute {:.2}", t.compute.wall_seconds)?;
    if t.draw.wall_seconds > 0.0 {
        write!(out, ", draw {:.2}", t.draw.wall_seconds)?;
    }
    write!(out, ", write {:.2}", t.write.wall_seconds)?;
    if report.points_per_second > 0.0 {
        let what = if report.render.is_some() { "rays" } else { "points" };
        write!(out, "; {:.0} {what} a second", report.points_per_second)?;
    }
    writeln!(out)
}

/// What is in the picture, with the options that give the same camera again.
fn describe_picture(out: &mut String, render: &RenderReport) -> std::fmt::Result {
    writeln!(
        out,
        "{} x {} pixels, {} of {} rays met the surface ({:.1} %)",
        render.width,
        render.height,
        render.hits,
        render.rays,
        100.0 * render.hits as f64 / render.rays as f64
    )?;
    writeln!(out, "up: {}, {}; --up says otherwise", axis_name(render.up.axis), render.up.why.words())?;
    let camera = render.camera;
    // Survey coordinates are long: digits count from the distance of the eye.
    let apart = (0..3).map(|k| (camera.from[k] - camera.at[k]).powi(2)).sum::<f64>().sqrt();
    let decimals = (4.0 - apart.log10().floor()).clamp(0.0, 12.0) as usize;
    let place = |v: [f64; 3]| v.map(|c| format!("{c:.decimals$}")).join(",");
    write!(out, "camera: --look-from {} --look-at {}", place(camera.from), place(camera.at))?;
    write!(out, " --look-up {}", camera.up.map(short).join(","))?;
    match camera.projection {
        Projection::Perspective { fov_degrees } => write!(out, " --fov {fov_degrees}")?,
        Projection::Orthographic { height } => {
            write!(out, " --camera orthographic --view-height {}", short(height))?;
        }
        _ => {}
    }
    writeln!(out, " --size {}x{}", render.width, render.height)?;
    if let Some([low, high]) = render.range {
        writeln!(out, "colours from {} to {}", short(low), short(high))?;
    }
    if let Some([near, far]) = render.depth_range {
        writeln!(out, "depths from {} to {}", short(near.into()), short(far.into()))?;
    }
    Ok(())
}

/// x, y or z, or the numbers of a direction.
fn axis_name(axis: [f64; 3]) -> String {
    for (place, letter) in ["x", "y", "z"].iter().enumerate() {
        if (0..3).all(|k| k == place || axis[k] == 0.0) {
            return if axis[place] < 0.0 { format!("-{letter}") } else { (*letter).to_owned() };
        }
    }
    axis.map(short).join(",")
}

fn describe_info(out: &mut String, info: &InfoReport) -> std::fmt::Result {
    writeln!(out, "columns: {}", info.columns.join(" "))?;
    let corner = |c: &[f64]| c.iter().map(|v| format!("{v}")).collect::<Vec<_>>().join(" ");
    if !info.low.is_empty() {
        writeln!(out, "bounds: {} to {}", corner(&info.low), corner(&info.high))?;
    }
    let flat = info.low.iter().zip(&info.high).any(|(low, high)| low == high);
    if flat && info.low.len() == 3 {
        writeln!(
            out,
            "  the points lie in a plane across an axis: two columns would make them a curve in the plane"
        )?;
    }
    writeln!(
        out,
        "unit: {}",
        info.unit
            .as_deref()
            .map_or_else(|| "not stated in the file".to_owned(), |unit| unit.replace('_', " "))
    )?;
    writeln!(out, "exact repeats: {}", info.repeats)?;
    if let Some(spacing) = info.spacing {
        writeln!(out, "spacing: {} (median distance to the nearest distinct point)", short(spacing))?;
    }
    if let Some(normals) = &info.normals {
        write!(out, "normals: {} usable", normals.usable)?;
        write!(out, ", lengths {} to {}", short(normals.shortest), short(normals.longest))?;
        if let Some(angle) = normals.median_angle_degrees {
            write!(out, ", {angle:.2} degrees from the frame's (median)")?;
        }
        if let Some(opposed) = normals.opposed_share {
            write!(out, ", {:.2} % against their neighbours", 100.0 * opposed)?;
        }
        writeln!(out)?;
    }
    writeln!(out, "support: {}", info.support_reason)?;
    if let (Some(all), Some(effective)) = (info.median_neighbours, info.median_effective_neighbours) {
        writeln!(out, "  gives {all} neighbours, {effective:.1} effective (medians)")?;
    }
    if let Some(gap) = info.median_gap {
        writeln!(out, "  gap of the frames {gap:.3} (median; 1 is best, 0 no surface)")?;
        if gap < POOR_GAP {
            writeln!(out, "  {HINT}")?;
        }
    }
    if let Some(resolution) = info.resolution.filter(|r| *r > 1e-9) {
        writeln!(out, "  coordinates resolve {} of a support", short(resolution))?;
    }
    if let Some(problem) = &info.problem {
        writeln!(out, "no surface: {problem}")?;
    }
    Ok(())
}

/// The degree that was chosen, and what was expected of every one.
fn write_degree(out: &mut String, choice: &DegreeChoice) -> std::fmt::Result {
    let aim = match choice.aim {
        DegreeAim::Position => "positions",
        DegreeAim::Normal => "normals",
    };
    writeln!(out, "degree {} chosen for the least error of {aim}; expected, rms:", choice.degree)?;
    for evidence in &choice.evidence {
        writeln!(
            out,
            "  degree {}: position {}, normal {:.3} degrees, {:.1} % ok",
            evidence.degree,
            short(evidence.position),
            evidence.normal.to_degrees(),
            100.0 * evidence.ok
        )?;
    }
    Ok(())
}

/// A length with five significant digits.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let digits = if value == 0.0 { 0 } else { 4 - value.abs().log10().floor() as i32 };
    let text = format!("{value:.*}", digits.clamp(0, 12) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
