//! Shapes whose surface is known: samples of them, and the truth at any point near them.

use footpoint::samples::{self, Samples};
use std::f64::consts::PI;

/// The nearest point of the true surface, its unit normal, and the mean curvature there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truth<const D: usize> {
    pub(super) foot: [f64; D],
    pub(super) normal: [f64; D],
    pub(super) curvature: f64,
}

/// A shape to sample, of D − 1 dimensions and of this measure (area or length).
#[derive(Clone, Copy)]
pub(super) struct Shape<const D: usize> {
    pub(super) name: &'static str,
    measure: f64,
    sample: fn(usize, u64) -> Samples<D>,
    pub(super) truth: fn([f64; D]) -> Truth<D>,
}

const MINOR: f64 = 0.4;
const HALF_AXES: [f64; 2] = [1.0, 0.5];
/// Perimeter of that ellipse.
const PERIMETER: f64 = 4.844_224_110_273_838;

pub(super) const SURFACES: [Shape<3>; 3] = [
    Shape {
        name: "sphere",
        measure: 4.0 * PI,
        sample: |count, seed| samples::sphere(1.0, count, seed),
        truth: on_sphere,
    },
    Shape {
        name: "torus",
        measure: 4.0 * PI * PI * MINOR,
        sample: |count, seed| samples::torus(1.0, MINOR, count, seed),
        truth: on_torus,
    },
    Shape {
        name: "plane",
        measure: 4.0,
        sample: |count, seed| samples::plane(1.0, count, seed),
        truth: |[x, y, _]| Truth { foot: [x, y, 0.0], normal: [0.0, 0.0, 1.0], curvature: 0.0 },
    },
];

pub(super) const CURVES: [Shape<2>; 1] = [Shape {
    name: "ellipse",
    measure: PERIMETER,
    sample: |count, seed| samples::ellipse(HALF_AXES[0], HALF_AXES[1], count, seed),
    truth: on_ellipse,
}];

impl<const D: usize> Shape<D> {
    /// Mean distance between neighbours on an even sampling.
    pub(super) fn spacing(&self, count: usize) -> f64 {
        let each = self.measure / count as f64;
        if D == 2 { each } else { each.sqrt() }
    }

    /// Samples with noise of so many spacings along every axis, and the normals that they had before it.
    pub(super) fn samples(&self, count: usize, noise: f64) -> Samples<D> {
        (self.sample)(count, SEED).with_noise(noise * self.spacing(count), SEED + 1)
    }
}

const SEED: u64 = 20_040_602;

fn length<const D: usize>(a: [f64; D]) -> f64 {
    a.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn on_sphere(x: [f64; 3]) -> Truth<3> {
    let normal = x.map(|c| c / length(x));
    Truth { foot: normal, normal, curvature: 1.0 }
}

fn on_torus([x, y, z]: [f64; 3]) -> Truth<3> {
    let ring = x.hypot(y);
    let away = [ring - 1.0, z];
    let [outward, up] = away.map(|c| c / length(away));
    let (cosine, sine) = (x / ring, y / ring);
    let normal = [outward * cosine, outward * sine, up];
    let foot_ring = 1.0 + MINOR * outward;
    let foot = [foot_ring * cosine, foot_ring * sine, MINOR * up];
    Truth { foot, normal, curvature: 0.5 * (1.0 / MINOR + outward / foot_ring) }
}

/// By Newton's iteration from the nearest of many points.
fn on_ellipse(x: [f64; 2]) -> Truth<2> {
    let [a, b] = HALF_AXES;
    let way = |t: f64| [a * t.cos() - x[0], b * t.sin() - x[1]];
    let mut t = (0..100)
        .map(|k| 2.0 * PI * f64::from(k) / 100.0)
        .fold(0.0, |best, t| if length(way(t)) < length(way(best)) { t } else { best });
    for _ in 0..20 {
        let ([dx, dy], (sine, cosine)) = (way(t), t.sin_cos());
        let slope = b * cosine * dy - a * sine * dx;
        let bend = (a * sine).powi(2) + (b * cosine).powi(2) - a * cosine * dx - b * sine * dy;
        t -= slope / bend.abs();
    }
    let (sine, cosine) = t.sin_cos();
    let normal = [b * cosine, a * sine];
    let speed = length([a * sine, b * cosine]);
    Truth {
        foot: [a * cosine, b * sine],
        normal: normal.map(|c| c / length(normal)),
        curvature: a * b / speed.powi(3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const D: usize>(shape: &Shape<D>) {
        let clean = shape.samples(300, 0.0);
        for (point, normal) in clean.points.iter().zip(&clean.normals) {
            for height in [-0.05, 0.0, 0.1] {
                let x: [f64; D] = std::array::from_fn(|k| point[k] + height * normal[k]);
                let truth = (shape.truth)(x);
                let off = |a: &[f64; D], b: &[f64; D]| length::<D>(std::array::from_fn(|k| a[k] - b[k]));
                assert!(off(&truth.foot, point) < 1e-12, "{}: {x:?}", shape.name);
                assert!(off(&truth.normal, normal) < 1e-12, "{}: {x:?}", shape.name);
            }
        }
    }

    #[test]
    fn the_truth_is_that_of_the_samples() {
        SURFACES.iter().for_each(check);
        CURVES.iter().for_each(check);
    }
}
