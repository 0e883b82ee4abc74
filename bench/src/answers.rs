//! What the answers of a contestant amount to, compared with what is expected.

use crate::case::{Agreement, Expected};
use crate::cloud::Sampled;
use crate::contest::Contestant;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Answers by name.
pub(crate) type Summary = BTreeMap<String, f64>;

/// Angles are means in degrees between axes, lengths in units of the (common) support radius.
pub(crate) fn summary(contestant: &dyn Contestant, sampled: &Sampled, radius: f64) -> Summary {
    let rows = (0..sampled.points.len()).map(|sample| contestant.row(sample));
    let (mut squares, mut count) = (0.0, 0.0);
    let gradients: Vec<[f64; 3]> = rows
        .map(|row| {
            if row.value.is_finite() {
                squares += (row.value / radius).powi(2);
                count += 1.0;
            }
            row.gradient.into()
        })
        .collect();
    let mut summary = Summary::new();
    let mut put = |name: &str, value: f64| summary.insert(name.to_owned(), value);
    put("mean_neighbours", contestant.mean_neighbours());
    put("evaluated_share", count / sampled.points.len() as f64);
    put("rms_value", (squares / count).sqrt());
    put("gradient_angle", mean_angle(sampled, &sampled.points, &gradients));
    if !contestant.normals().is_empty() {
        put("normal_angle", mean_angle(sampled, &sampled.points, contestant.normals()));
    }
    if let Some(projections) = contestant.projections() {
        let feet: Vec<[f64; 3]> = (projections.point.iter().zip(&projections.status))
            .filter_map(|(point, status)| status.is_ok().then_some(*point))
            .collect();
        put("projected_share", feet.len() as f64 / sampled.points.len() as f64);
        put("projected_rms", rms_distance(sampled, &feet) / radius);
        // Where there is no foot point there is no normal either, and the mean passes over it.
        let angle = mean_angle(sampled, &projections.point, &projections.surface_normal);
        put("projected_angle", angle);
    }
    summary
}

/// Mean angle in degrees between axes and the torus' normals, over the rows that are numbers.
pub(crate) fn mean_angle(sampled: &Sampled, points: &[[f64; 3]], axes: &[[f64; 3]]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (point, axis) in points.iter().zip(axes) {
        let (axis, truth) = (Vector3::from(*axis), Vector3::from(sampled.truth(*point).1));
        let angle = axis.cross(&truth).norm().atan2(axis.dot(&truth).abs());
        if angle.is_finite() {
            sum += angle.to_degrees();
            count += 1.0;
        }
    }
    sum / count
}

/// Root of the mean square of the distance from the torus.
pub(crate) fn rms_distance(sampled: &Sampled, points: &[[f64; 3]]) -> f64 {
    let squares = points.iter().map(|point| sampled.truth(*point).0.powi(2)).sum::<f64>();
    (squares / points.len() as f64).sqrt()
}

/// Largest difference between two contestants where the gap of the first exceeds the limit; NaN where one of them has
/// no answer.
pub(crate) fn difference(
    one: &dyn Contestant,
    other: &dyn Contestant,
    agreement: &Agreement,
    radius: f64,
) -> f64 {
    let mut largest = 0.0;
    for (sample, gap) in one.gaps().unwrap_or_default().into_iter().enumerate() {
        if gap <= agreement.gap {
            continue;
        }
        let (a, b) = (one.row(sample), other.row(sample));
        // Neither has a sign that means anything.
        let sign = a.normal.dot(&b.normal).signum();
        let differences = [
            (a.value - sign * b.value).abs() / radius,
            (a.normal - b.normal * sign).norm(),
            (a.gradient - b.gradient * sign).norm() / b.gradient.norm(),
        ];
        for difference in differences {
            // NaN stays.
            if difference.is_nan() || difference > largest {
                largest = difference;
            }
        }
    }
    largest
}

/// The answers that are not as expected, in words.
pub(crate) fn failures(name: &str, summary: &Summary, expected: &BTreeMap<String, Expected>) -> Vec<String> {
    expected
        .iter()
        .filter_map(|(answer, Expected { value, tolerance })| {
            let found = summary.get(answer).copied().unwrap_or(f64::NAN);
            let holds = (found - value).abs() <= *tolerance;
            (!holds).then(|| format!("{name}: {answer} is {found}, expected {value} ± {tolerance}"))
        })
        .collect()
}
