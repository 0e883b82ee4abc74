//! Distances in words, with their histogram in bars.

use super::{count, short};
use footpoint_jobs::{DistanceReport, Histogram, Report};
use std::fmt::{Result, Write};

/// Characters of the longest bar.
const WIDTH: f64 = 40.0;

pub(super) fn describe(out: &mut String, report: &Report, found: &DistanceReport) -> Result {
    let between = if found.level_of_detection.is_some() { " between the surfaces" } else { "" };
    let kind = if found.signed { "signed by the cloud's normals" } else { "without sign" };
    writeln!(out, "distances{between}, {kind}: {}", count(found.answered, "point"))?;
    if let (false, Some(cloud)) = (found.signed, report.inputs.get(1)) {
        let axis = if cloud.dimension == 2 { "0,1" } else { "0,0,1" };
        writeln!(
            out,
            "  a sign needs normals: footpoint orient {} --along {axis}, then --to what it writes",
            cloud.path
        )?;
    }
    if found.walked > 0 {
        writeln!(out, "  {} of them beyond the projection, reached along the surface", found.walked)?;
    }
    if let Some(without @ 1..) = found.without_sigma {
        writeln!(
            out,
            "  {} not ok, with a distance and no sigma: no surface of their own, or none of the cloud near it",
            count(without, "more point")
        )?;
    }
    if found.answered == 0 {
        if found.level_of_detection.is_some() {
            writeln!(
                out,
                "  these points are too few to have a surface: --compare points takes them as they are"
            )?;
        }
        return Ok(());
    }
    if found.supports.len() > 1 {
        let supports: Vec<String> = found
            .supports
            .iter()
            .map(|s| format!("{} for {}", short(s.radius), count(s.points, "point")))
            .collect();
        writeln!(out, "  support of the least variance: {}", supports.join(", "))?;
    }
    let [mean, rms, deviation] = [found.mean, found.rms, found.standard_deviation].map(short);
    writeln!(out, "  mean {mean}, rms {rms}, standard deviation {deviation}")?;
    write!(out, "  median {}", short(found.median))?;
    if found.signed {
        write!(out, ", of magnitudes {}", short(found.median_magnitude))?;
    }
    writeln!(out, ", from {} to {}", short(found.smallest), short(found.largest))?;
    let quantiles: Vec<String> =
        found.quantiles.iter().map(|q| format!("{} % {}", q.percent, short(q.value))).collect();
    writeln!(out, "  quantiles: {}", quantiles.join(", "))?;
    if let Some(bias) = found.mean_bias {
        writeln!(out, "  bias from curvature {} (mean; not taken off)", short(bias))?;
    }
    if let (Some(level), Some(significant)) = (found.level_of_detection, found.significant) {
        let registration = match report.recipe.registration {
            Some(sigma) => format!("registration {} included", short(sigma)),
            None => "the registration not known: --registration SIGMA".to_owned(),
        };
        let share = 100.0 * significant as f64 / found.answered as f64;
        writeln!(out, "  level of detection {} (median, 95 %; {registration})", short(level))?;
        writeln!(out, "  {significant} significant ({share:.2} %; 5 % are where nothing has moved)")?;
    }
    if let Some(noise) = found.query_noise {
        writeln!(out, "  noise of the points {}, estimated from their residuals", short(noise))?;
    }
    if let (Some(sigma), Some(share)) = (found.median_sigma, found.share_beyond_two_sigma) {
        writeln!(out, "  sigma {} (median); {:.2} % beyond 2 sigma", short(sigma), 100.0 * share)?;
    }
    bars(out, &found.histogram)?;
    if let Some([low, high]) = found.colour_range {
        writeln!(out, "colours from {} to {}", short(low), short(high))?;
    }
    Ok(())
}

fn bars(out: &mut String, histogram: &Histogram) -> Result {
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    let step = (histogram.high - histogram.low) / histogram.counts.len().max(1) as f64;
    // One more than tells two bars apart.
    let digits = (1.0 - step.log10().floor()).max(0.0) as i32;
    let middles: Vec<String> = (0..histogram.counts.len())
        .map(|i| {
            let middle = histogram.low + (i as f64 + 0.5) * step;
            // The bar around 0 has only rounding there.
            let middle = if middle.abs() < 1e-9 * step { 0.0 } else { middle };
            if (0..=9).contains(&digits) {
                format!("{middle:.0$}", digits as usize)
            } else {
                format!("{middle:.3e}")
            }
        })
        .collect();
    let column = middles.iter().map(String::len).max().unwrap_or(0);
    let digits = most.max(histogram.below).max(histogram.above).to_string().len();
    let mut line = |name: &str, count: usize, bar: usize| {
        let text = format!("  {name:>column$} {count:>digits$} {}", "█".repeat(bar));
        writeln!(out, "{}", text.trim_end())
    };
    if histogram.below > 0 {
        line("below", histogram.below, 0)?;
    }
    for (middle, &count) in middles.iter().zip(&histogram.counts) {
        line(middle, count, (WIDTH * count as f64 / most as f64).round() as usize)?;
    }
    if histogram.above > 0 {
        line("above", histogram.above, 0)?;
    }
    Ok(())
}
