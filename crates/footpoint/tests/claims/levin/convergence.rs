//! Levin's second step with a polynomial of degree m converges with the power m + 1 of h, or faster.
#![allow(clippy::print_stdout)]

use crate::common::{Columns, Variant, dot, in_cube, length, median, scale};
use footpoint::samples::{self, Random, Samples};
use footpoint::{Definition, Operator, Project};

/// Distance to the true surface, for points very near to it.
type Error<const D: usize> = fn([f64; D]) -> f64;

fn off_ellipse(x: [f64; 2]) -> f64 {
    let (u, v) = (x[0], x[1] / 0.6);
    (u * u + v * v - 1.0) / (2.0 * u.hypot(v / 0.6))
}

fn off_torus(x: [f64; 3]) -> f64 {
    (x[0].hypot(x[1]) - 1.0).hypot(x[2]) - 0.4
}

fn check<const D: usize>(shape: &Samples<D>, supports: [f64; 3], error: Error<D>) {
    let stride = shape.points.len() / 150;
    for degree in 0..=4 {
        let found: [f64; 3] = supports.map(|h| {
            let surface = Columns::new(shape, h, Variant::Uniform).surface(Definition::new());
            let mut random = Random::new(51);
            let starts: Vec<[f64; D]> = (0..150)
                .map(|i| crate::common::add(shape.points[i * stride], scale(in_cube(&mut random), 0.1 * h)))
                .collect();
            let how = Project::new().with_operator(Operator::Levin { degree: Some(degree) });
            let p = surface.project(&starts, &how.with_tolerance(1e-12));
            assert!(p.status.iter().all(|s| s.is_ok()), "degree {degree}, h {h}");
            if degree > 0 {
                // The polynomial's normal is a unit vector near that of the plane.
                let tilt = |i: usize| (length(p.surface_normal[i]) - 1.0).abs();
                assert!(
                    (0..150).all(|i| tilt(i) < 1e-14 && dot(p.surface_normal[i], p.frame_normal[i]) > 0.9)
                );
            }
            median(p.point.iter().map(|&y| error(y).abs()))
        });
        let order = |k: usize| (found[k] / found[k + 1]).ln() / (supports[k] / supports[k + 1]).ln();
        let orders = [order(0), order(1)];
        println!("D = {D}, degree {degree}: errors {found:?}, orders {orders:.2?}");
        let expected = f64::from(degree) + 1.0;
        assert!(orders.iter().all(|&o| o > expected - 0.1), "degree {degree}: {orders:?}");
    }
}

#[test]
fn on_an_ellipse() {
    check(&samples::ellipse(1.0, 0.6, 6000, 1), [0.4, 0.28, 0.2], off_ellipse);
}

#[test]
fn on_a_torus() {
    check(&samples::torus(1.0, 0.4, 100_000, 1), [0.24, 0.17, 0.12], off_torus);
}
