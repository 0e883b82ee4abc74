//! Job: what a file holds, and the support that would be chosen for it.

use crate::clock::timed;
use crate::describe::unit_name;
use crate::load::Loaded;
use crate::numbers::median;
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::{Cloud, NormalField, Queries, Support, Surface, Want};
use serde::Serialize;
use std::path::Path;

/// What `info` finds. Lengths are in the unit of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InfoReport {
    /// Names of the columns, in the file's order.
    pub columns: Vec<String>,
    /// The unit of the coordinates, where the file states one.
    pub unit: Option<String>,
    /// Smallest finite coordinates.
    pub low: Vec<f64>,
    /// Largest finite coordinates.
    pub high: Vec<f64>,
    /// Finite points that repeat another one exactly.
    pub repeats: usize,
    /// Median distance to the nearest distinct point.
    pub spacing: Option<f64>,
    /// What the file's normals are worth.
    pub normals: Option<NormalsReport>,
    /// Why the support came out as it did.
    pub support_reason: String,
    /// Medians over the samples with the chosen support: samples with positive weight.
    pub median_neighbours: Option<f64>,
    /// Effective ones.
    pub median_effective_neighbours: Option<f64>,
    /// Gap of the frame: 1 is best, below the accepted one is no surface.
    pub median_gap: Option<f64>,
    /// Largest spacing of doubles at the coordinates, as a share of the support: what they can resolve.
    pub resolution: Option<f64>,
    /// Why no surface can be made of the file.
    pub problem: Option<String>,
}

/// What the normals of a file are worth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NormalsReport {
    /// Samples with a usable normal.
    pub usable: usize,
    /// Shortest and longest normal as given.
    pub shortest: f64,
    /// Longest.
    pub longest: f64,
    /// Median angle between the given normals and the frame's, sign aside.
    pub median_angle_degrees: Option<f64>,
    /// Share of samples whose normal points against the average of the normals around it.
    pub opposed_share: Option<f64>,
}

/// Describes a file: counts, bounds, repeats, spacing, normals, and the support that the recipe's rule gives.
pub fn info(input: &Path, context: &Context<'_>) -> Result<Report, JobError> {
    let mut report = Report::new("info", context.recipe.clone());
    let loaded = Loaded::read(input, context, &mut report)?;
    report.inputs.push(loaded.report());
    report.points = loaded.input.table.rows();
    if context.ends_before::<&Path>(&loaded, &[], &mut report)? {
        return Ok(report);
    }
    match loaded.roles.dimension() {
        2 => run::<2>(&loaded, context, report),
        _ => run::<3>(&loaded, context, report),
    }
}

fn run<const D: usize>(
    loaded: &Loaded,
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    let table = &loaded.input.table;
    let points = loaded.points::<D>();
    let finite: Vec<&[f64; D]> = points.iter().filter(|p| p.iter().all(|c| c.is_finite())).collect();
    let mut info = InfoReport {
        columns: table.columns.iter().map(|c| c.name.clone()).collect(),
        unit: table.frame.unit.map(|unit| unit_name(unit).to_owned()),
        repeats: repeats(&finite),
        ..InfoReport::default()
    };
    let extent = |start: f64, pick: fn(f64, f64) -> f64| -> Vec<f64> {
        (0..D).map(|k| finite.iter().map(|p| p[k]).fold(start, pick)).collect()
    };
    if !finite.is_empty() {
        info.low = extent(f64::INFINITY, f64::min);
        info.high = extent(f64::NEG_INFINITY, f64::max);
    }

    let cloud: Cloud<D> = loaded.cloud(&context.recipe)?;
    info.spacing = timed(&mut report.times.index, || footpoint::spacing(&cloud, &context.run.silent()));
    info.support_reason = reason::<D>(context);
    let has_normals = cloud.absent_normals() < cloud.len();
    match loaded.surface::<D>(context, &mut report) {
        Ok(surface) => {
            timed(&mut report.times.compute, || {
                describe(&surface, &mut info);
                if has_normals {
                    info.normals = Some(judge_normals(loaded, surface, context));
                }
            });
        }
        Err(JobError::Cancelled) => return Err(JobError::Cancelled),
        Err(problem) => info.problem = Some(problem.to_string()),
    }
    report.info = Some(info);
    Ok(report)
}

/// Neighbours, gap and resolution with the chosen support.
fn describe<const D: usize>(surface: &Surface<D>, info: &mut InfoReport) {
    let want = Want::NEIGHBOURS | Want::EFFECTIVE_NEIGHBOURS | Want::GAP;
    let found = surface.evaluate(Queries::Samples, want);
    info.median_neighbours = median(found.neighbours.iter().map(|&n| f64::from(n)).collect());
    info.median_effective_neighbours = median(found.effective_neighbours);
    info.median_gap = median(found.gap);
    let largest = info.low.iter().chain(&info.high).fold(0.0_f64, |m, c| m.max(c.abs()));
    info.resolution = Some(largest * f64::EPSILON / surface.support().median);
}

fn judge_normals<const D: usize>(
    loaded: &Loaded,
    surface: Surface<D>,
    context: &Context<'_>,
) -> NormalsReport {
    let raw = loaded.roles.normals::<D>(&loaded.input.table).unwrap_or_default();
    let length = |n: &[f64; D]| n.iter().map(|c| c * c).sum::<f64>().sqrt();
    let lengths: Vec<f64> = raw.iter().map(length).filter(|l| *l > 0.0 && l.is_finite()).collect();
    let mut report = NormalsReport {
        usable: surface.cloud().len() - surface.cloud().absent_normals(),
        shortest: lengths.iter().copied().fold(f64::INFINITY, f64::min),
        longest: lengths.iter().copied().fold(0.0, f64::max),
        ..NormalsReport::default()
    };
    let cosines = |surface: &Surface<D>| -> Vec<f64> {
        let frames = surface.evaluate(Queries::Samples, Want::FRAME_NORMAL).frame_normal;
        let given = surface.cloud().normals().unwrap_or_default();
        let cosine = |(a, b): (&[f64; D], &[f64; D])| (0..D).map(|k| a[k] * b[k]).sum::<f64>();
        given.iter().zip(&frames).map(cosine).filter(|c| c.is_finite()).collect()
    };
    let angles = cosines(&surface).iter().map(|c| c.abs().min(1.0).acos().to_degrees()).collect();
    report.median_angle_degrees = median(angles);
    let averaged = surface.definition().with_field(NormalField::AveragedNormals);
    if let Ok(averaged) = Surface::build(surface.cloud().clone(), averaged, &context.run.silent()) {
        let cosines = cosines(&averaged);
        let opposed = cosines.iter().filter(|c| **c < 0.0).count();
        report.opposed_share = (!cosines.is_empty()).then(|| opposed as f64 / cosines.len() as f64);
    }
    report
}

/// Why the support is what it is, in a sentence.
fn reason<const D: usize>(context: &Context<'_>) -> String {
    let definition = context.definition();
    let wanted = |n: f64| {
        let k = (n / definition.weight().effective_share(D)).ceil();
        format!(
            "the {} distinct neighbour, so that an even sampling has {n} effective neighbours",
            ordinal(k as u64)
        )
    };
    match definition.support() {
        Support::Uniform(_) => "the radius given".to_owned(),
        Support::FromSamples => "the column of supports".to_owned(),
        Support::Auto { effective_neighbours } => {
            format!("median distance to {}", wanted(effective_neighbours))
        }
        Support::AutoPerSample { effective_neighbours } => {
            format!("each sample's distance to {}", wanted(effective_neighbours))
        }
        Support::LeastError => "the radius at which noise and curvature make the least error".to_owned(),
        Support::LeastErrorPerSample => {
            "each sample's distance to the neighbour at which noise and curvature make the least error"
                .to_owned()
        }
        _ => String::new(),
    }
}

/// 1st, 2nd, 3rd, 4th, … 11th, …
fn ordinal(number: u64) -> String {
    let ending = match (number % 100, number % 10) {
        (11..=13, _) => "th",
        (_, 1) => "st",
        (_, 2) => "nd",
        (_, 3) => "rd",
        _ => "th",
    };
    format!("{number}{ending}")
}

/// Points that equal one before them.
fn repeats<const D: usize>(points: &[&[f64; D]]) -> usize {
    // Adding zero makes both zeros one.
    let mut bits: Vec<[u64; D]> = points.iter().map(|p| p.map(|c| (c + 0.0).to_bits())).collect();
    bits.sort_unstable();
    bits.dedup();
    points.len() - bits.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinals_are_written_as_they_are_read() {
        let written = [1, 2, 3, 4, 11, 12, 13, 22, 37, 101, 111, 112].map(ordinal);
        let wanted =
            ["1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "22nd", "37th", "101st", "111th", "112th"];
        assert_eq!(written, wanted);
    }
}
