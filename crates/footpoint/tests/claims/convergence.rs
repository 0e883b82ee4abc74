//! On surfaces without noise positions and normals converge with the square of h, with the constant that theory gives.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{self, add, dot, even_torus, in_cube, length, median, scale, sub};
use footpoint::samples::{Random, Samples};
use footpoint::{Cloud, Definition, Project, Support, Surface, Weight};

const WEIGHTS: [(Weight, f64); 3] = [(Weight::Poly2, 2.0), (Weight::Poly3, 3.0), (Weight::Poly4, 4.0)];

/// The foot on the true surface, its outward normal and the curvature that the bias follows.
type Truth<const D: usize> = fn([f64; D]) -> ([f64; D], [f64; D], f64);

fn on_unit_sphere<const D: usize>(x: [f64; D]) -> ([f64; D], [f64; D], f64) {
    let n = scale(x, 1.0 / length(x));
    (n, n, 1.0)
}

fn on_torus(x: [f64; 3]) -> ([f64; 3], [f64; 3], f64) {
    let around = x[0].hypot(x[1]);
    let centre = [x[0] / around, x[1] / around, 0.0];
    let away = sub(x, centre);
    let n = scale(away, 1.0 / length(away));
    let foot = add(centre, scale(n, 0.4));
    let cosine = dot(n, centre);
    (foot, n, 0.5 * (1.0 / 0.4 + cosine / (1.0 + 0.4 * cosine)))
}

/// Medians over points of the surface: signed offset inwards over the predicted bias, |offset|, angle to the truth.
fn errors<const D: usize>(
    shape: &Samples<D>,
    weight: Weight,
    predicted: impl Fn(f64) -> f64,
    h: f64,
    truth: Truth<D>,
) -> [f64; 3] {
    let definition = Definition::new().with_weight(weight).with_support(Support::Uniform(h));
    let surface = Surface::new(Cloud::new(shape.points.clone()), definition).unwrap();
    let stride = shape.points.len() / 400;
    let mut random = Random::new(21);
    let starts: Vec<[f64; D]> =
        (0..400).map(|i| add(shape.points[i * stride], scale(in_cube(&mut random), 0.1 * h))).collect();
    let p = surface.project(&starts, &Project::new().with_tolerance(1e-11));
    assert!(p.status.iter().all(|s| s.is_ok()));
    let each = |i: usize| {
        let (foot, n, curvature) = truth(p.point[i]);
        let inwards = dot(sub(foot, p.point[i]), n);
        let off = sub(p.surface_normal[i], scale(n, dot(p.surface_normal[i], n).signum()));
        [inwards / predicted(curvature), inwards.abs(), length(off)]
    };
    let all: Vec<[f64; 3]> = (0..starts.len()).map(each).collect();
    std::array::from_fn(|k| median(all.iter().map(|e| e[k])))
}

/// `bias(weight exponent, curvature, h)` is SPEC § 11.
fn check<const D: usize>(
    shape: &Samples<D>,
    supports: [f64; 3],
    truth: Truth<D>,
    bias: fn(f64, f64, f64) -> f64,
    normals_vary: bool,
) {
    for (weight, m) in WEIGHTS {
        let found = supports.map(|h| errors(shape, weight, |curvature| bias(m, curvature, h), h, truth));
        let order =
            |k: usize, j: usize| (found[j][k] / found[j + 1][k]).ln() / (supports[j] / supports[j + 1]).ln();
        let positions = [order(1, 0), order(1, 1)];
        let normals = [order(2, 0), order(2, 1)];
        let ratios = found.map(|e| e[0]);
        println!(
            "D = {D} {weight:?}: constant/theory {ratios:.3?}, order of positions {positions:.2?}, \
             angles {:?} of order {normals:.2?}",
            found.map(|e| format!("{:.1e}", e[2]))
        );
        assert!(positions.iter().all(|&o| o >= 1.8), "{weight:?}: positions of order {positions:?}");
        assert!((ratios[2] - 1.0).abs() < 0.05, "{weight:?}: bias is {} times the theory's", ratios[2]);
        if normals_vary {
            assert!(normals.iter().all(|&o| o >= 1.8), "{weight:?}: normals of order {normals:?}");
        } else {
            // By symmetry there is no bias: what is left is the unevenness of the sampling.
            assert!(found[2][2] < 1e-3, "{weight:?}: {:e}", found[2][2]);
        }
    }
}

#[test]
fn on_a_sphere() {
    let bias = |m, curvature: f64, h: f64| curvature * h * h / (2.0 * (m + 2.0));
    check(&common::fibonacci_sphere(150_000), [0.28, 0.2, 0.14], on_unit_sphere, bias, false);
}

#[test]
fn on_a_torus() {
    let bias = |m, curvature: f64, h: f64| curvature * h * h / (2.0 * (m + 2.0));
    check(&even_torus(1.0, 0.4, 300), [0.2, 0.14, 0.1], on_torus, bias, true);
}

#[test]
fn on_a_circle() {
    let bias = |m, curvature: f64, h: f64| curvature * h * h / (2.0 * (2.0 * m + 3.0));
    check(&common::even_circle(20_000), [0.2, 0.1, 0.05], on_unit_sphere, bias, false);
}
