//! Curvatures are exact for f, and those of the surface converge to the truth with the square of h.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{dot, length, median, near_samples, scale, sub};
use footpoint::samples::{self, Random};
use footpoint::{Cloud, Definition, NormalField, Precision, Project, Support, Surface, Want, Weight};
use std::f64::consts::TAU;

/// A cloud whose samples stand in rows `spacing` apart, where `place(u, v)` has unit speed at least nearly.
fn rows(
    along: f64,
    lines: impl Iterator<Item = (f64, f64)>,
    spacing: f64,
    place: impl Fn(f64, f64) -> [f64; 3],
) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for (i, (v, length)) in lines.enumerate() {
        let count = (length / spacing).round().max(1.0);
        for j in 0..count as usize {
            let u = along * (j as f64 + if i % 2 == 0 { 0.25 } else { 0.75 }) / count;
            points.push(place(u, v));
        }
    }
    points
}

/// A surface with known principal curvatures, the larger first, for the normal that `outwards` gives at a point.
struct Shape {
    name: &'static str,
    sample: fn(f64) -> Vec<[f64; 3]>,
    /// Whether a point is far from rims and poles.
    inside: fn([f64; 3]) -> bool,
    outwards: fn([f64; 3]) -> [f64; 3],
    curvatures: fn([f64; 3]) -> [f64; 2],
}

fn levels(first: f64, last: f64, spacing: f64) -> impl Iterator<Item = f64> {
    let count = ((last - first) / spacing).round() as usize;
    (0..count).map(move |i| first + (last - first) * (i as f64 + 0.5) / count as f64)
}

fn ring(x: [f64; 3]) -> [f64; 3] {
    let around = x[0].hypot(x[1]);
    [x[0] / around, x[1] / around, 0.0]
}

const SHAPES: [Shape; 4] = [
    Shape {
        name: "sphere",
        sample: |s| {
            let lines = levels(0.0, TAU / 2.0, s).map(|t| (t, TAU * t.sin()));
            rows(TAU, lines, s, |u, t| [t.sin() * u.cos(), t.sin() * u.sin(), t.cos()])
        },
        inside: |x| x[2].abs() < 0.7,
        outwards: |x| x,
        curvatures: |_| [1.0, 1.0],
    },
    Shape {
        name: "cylinder",
        sample: |s| {
            let lines = levels(-1.5, 1.5, s).map(|z| (z, TAU));
            rows(TAU, lines, s, |u, z| [u.cos(), u.sin(), z])
        },
        inside: |x| x[2].abs() < 0.7,
        outwards: |x| [x[0], x[1], 0.0],
        curvatures: |_| [1.0, 0.0],
    },
    Shape {
        name: "torus",
        sample: |s| {
            let lines = levels(0.0, 0.5 * TAU, s).map(|t| (2.0 * t, TAU * (1.0 + 0.5 * (2.0 * t).cos())));
            rows(TAU, lines, s, |u, t| {
                let r = 1.0 + 0.5 * t.cos();
                [r * u.cos(), r * u.sin(), 0.5 * t.sin()]
            })
        },
        inside: |_| true,
        outwards: |x| sub(x, ring(x)),
        curvatures: |x| {
            let away = sub(x, ring(x));
            let cosine = dot(away, ring(x)) / length(away);
            let across = cosine / (1.0 + 0.5 * cosine);
            [2.0, across]
        },
    },
    Shape {
        name: "saddle",
        sample: |s| {
            let lines = levels(-1.0, 1.0, s).map(|y| (y, 2.0));
            rows(2.0, lines, s, |u, y| [u - 1.0, y, 0.5 * ((u - 1.0) * (u - 1.0) - y * y)])
        },
        inside: |x| x[0].abs().max(x[1].abs()) < 0.4,
        outwards: |x| [-x[0], x[1], 1.0],
        curvatures: |x| {
            // Of the graph of z = (x² − y²)/2, upward normal; positive where it bends down, away from the normal.
            let (p, q) = (x[0], -x[1]);
            let w = (1.0 + p * p + q * q).sqrt();
            let mean = -((1.0 + q * q) - (1.0 + p * p)) / (2.0 * w.powi(3));
            let gaussian = -1.0 / w.powi(4);
            let root = (mean * mean - gaussian).sqrt();
            [mean + root, mean - root]
        },
    },
];

/// Median errors of k1, k2, mean and Gaussian curvature at feet of the surface.
fn errors(shape: &Shape, h: f64) -> [f64; 4] {
    // Unevenness of the sampling bends f by its own share, which falls only with the spacing over h.
    let cloud = Cloud::new((shape.sample)(h * h / 5.0));
    let starts: Vec<[f64; 3]> =
        cloud.points().iter().copied().filter(|&p| (shape.inside)(p)).step_by(97).take(300).collect();
    let surface = Surface::new(cloud, Definition::new().with_support(Support::Uniform(h))).unwrap();
    let feet = surface.project(&starts, &Project::new().with_tolerance(1e-10));
    assert!(feet.status.iter().all(|s| s.is_ok()), "{}", shape.name);
    let e = surface.evaluate(&feet.point, Want::CURVATURE | Want::SURFACE_NORMAL);
    let each = |i: usize| {
        let [a, b] = (shape.curvatures)(feet.point[i]);
        // Seen from the other side everything changes its sign, and the larger becomes the smaller.
        let same = dot(e.surface_normal[i], (shape.outwards)(feet.point[i])) > 0.0;
        let [k1, k2] = if same { [a, b] } else { [-b, -a] };
        let c = &e.curvature;
        [c.principal[i][0] - k1, c.principal[i][1] - k2, c.mean[i] - 0.5 * (k1 + k2), c.gaussian[i] - k1 * k2]
    };
    let all: Vec<[f64; 4]> = (0..starts.len()).map(each).collect();
    std::array::from_fn(|k| median(all.iter().map(|e| e[k].abs())))
}

#[test]
fn curvatures_converge_to_those_of_the_object() {
    for shape in &SHAPES {
        let supports = [0.4, 0.2];
        let found = supports.map(|h| errors(shape, h));
        println!("{}: errors {found:.6?} at h = {supports:?}", shape.name);
        // One curvature alone may be right by chance at one h.
        let worst = found.map(|errors| errors.into_iter().fold(0.0, f64::max));
        let order = (worst[0] / worst[1]).log2();
        // Below half a per cent what is left is the unevenness of the rows.
        assert!(worst[1] < 5e-3 || order > 1.6, "{}: order {order:.2}", shape.name);
        assert!(worst[1] < 0.1, "{}: {:e}", shape.name, worst[1]);
    }
}

#[test]
fn directions_are_those_of_the_object() {
    let shape = &SHAPES[1];
    let cloud = Cloud::new((shape.sample)(0.03));
    let surface = Surface::new(cloud, Definition::new().with_support(Support::Uniform(0.25))).unwrap();
    let at: Vec<[f64; 3]> = (0..50)
        .map(|i| (0.1 * f64::from(i), 0.02 * f64::from(i) - 0.5))
        .map(|(u, z)| [u.cos(), u.sin(), z])
        .collect();
    let e = surface.evaluate(&at, Want::CURVATURE | Want::SURFACE_NORMAL);
    for (i, x) in at.iter().enumerate() {
        let outwards = dot(e.surface_normal[i], [x[0], x[1], 0.0]) > 0.0;
        let [first, second] = e.curvature.directions[i];
        let axis = if outwards { second } else { first };
        assert!(axis[2] > 0.9999, "{axis:?}");
        assert!(dot(first, second).abs() < 1e-12 && (length(first) - 1.0).abs() < 1e-12);
    }
}

/// ∇²f against differences of the exact gradient, the largest error over the largest entry.
fn differences<const D: usize>(weight: Weight, field: NormalField, varied: bool) -> f64 {
    let mut random = Random::new(5);
    let mut sheet: Vec<[f64; D]> = Vec::new();
    for _ in 0..if D == 3 { 1500 } else { 150 } {
        let mut p: [f64; D] = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
        p[D - 1] = 0.2 * p[0] * p[0] + 0.02 * random.normal();
        sheet.push(p);
    }
    let normals: Vec<[f64; D]> = sheet
        .iter()
        .map(|p| {
            std::array::from_fn(|k| {
                [-0.4 * p[0], 1.0][usize::from(k == D - 1)] * f64::from(u8::from(k == 0 || k == D - 1))
            })
        })
        .collect();
    let supports: Vec<f64> = sheet.iter().map(|_| 0.35 + 0.2 * random.uniform()).collect();
    let factors: Vec<f64> = sheet.iter().map(|_| 0.5 + random.uniform()).collect();
    let mut cloud = Cloud::new(sheet).with_normals(normals).unwrap();
    let mut support = Support::Uniform(0.45);
    if varied {
        cloud = cloud.with_supports(supports).unwrap().with_factors(factors).unwrap();
        support = Support::FromSamples;
    }
    let definition = Definition::new().with_weight(weight).with_field(field).with_support(support);
    let surface = Surface::new(cloud, definition).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..5 {
        let mut x: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
        x[D - 1] = 0.05;
        let e = surface.evaluate(&[x], Want::HESSIAN);
        let step = 1e-4;
        let size = e.hessian[0].iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        for k in 0..D {
            let at = |by: f64| {
                let mut y = x;
                y[k] += by * step;
                surface.evaluate(&[y], Want::GRADIENT).gradient[0]
            };
            let (near, far) = (sub(at(1.0), at(-1.0)), sub(at(2.0), at(-2.0)));
            let slope = scale(sub(scale(near, 8.0), far), 1.0 / (12.0 * step));
            worst = worst.max(length(sub(slope, e.hessian[0][k])) / size);
            for i in 0..D {
                assert_eq!(e.hessian[0][i][k].to_bits(), e.hessian[0][k][i].to_bits());
            }
        }
    }
    worst
}

#[test]
fn second_derivatives_are_those_of_f() {
    let mut worst = 0.0_f64;
    for weight in [Weight::Poly3, Weight::Poly4, Weight::Wendland, Weight::Gaussian { cut: 1e-16 }] {
        for field in crate::common::FIELDS {
            for varied in [false, true] {
                let found =
                    differences::<2>(weight, field, varied).max(differences::<3>(weight, field, varied));
                // Poly3's third derivatives jump where a sample enters the support: differences feel it.
                let bound = if weight == Weight::Poly3 { 1e-5 } else { 1e-7 };
                assert!(found < bound, "{weight:?} {field:?} varied {varied}: {found:e}");
                worst = worst.max(found);
            }
        }
    }
    println!("second derivatives: worst {worst:e} of the largest");
}

#[test]
fn single_precision_has_the_same_curvatures_within_a_thousandth() {
    let torus = samples::torus(1.0, 0.4, 20_000, 4).with_noise(0.002, 5);
    let at = near_samples(&torus.points, 500, 0.01, 6);
    let found = [Precision::Double, Precision::Single].map(|precision| {
        let definition = Definition::new().with_support(Support::Uniform(0.15)).with_precision(precision);
        Surface::new(Cloud::new(torus.points.clone()), definition).unwrap().evaluate(&at, Want::CURVATURE)
    });
    for i in 0..at.len() {
        let [double, single] = [0, 1].map(|k| found[k].curvature.principal[i]);
        let error = (double[0] - single[0]).abs().max((double[1] - single[1]).abs());
        // One over h is the scale of what a support can resolve.
        assert!(error < 1e-3 / 0.15, "{double:?} {single:?}");
    }
}

#[test]
fn curvature_is_one_over_a_length() {
    let sphere = |unit: f64| {
        let points: Vec<[f64; 3]> =
            samples::sphere(1.0, 4000, 3).points.into_iter().map(|p| scale(p, unit)).collect();
        let definition = Definition::new().with_support(Support::Uniform(0.25 * unit));
        let surface = Surface::new(Cloud::new(points), definition).unwrap();
        surface.evaluate(&[[0.0, 0.0, unit]], Want::ALL)
    };
    let (one, thousand) = (sphere(1.0), sphere(1024.0));
    assert_eq!(one.curvature.mean[0], 1024.0 * thousand.curvature.mean[0]);
    assert_eq!(one.curvature.gaussian[0], 1024.0 * 1024.0 * thousand.curvature.gaussian[0]);
    assert_eq!(one.hessian[0][1][2], 1024.0 * thousand.hessian[0][1][2]);
    assert_eq!(one.eccentricity[0], thousand.eccentricity[0]);
}
