//! Even degrees m converge with h^(m + 2), odd ones with h^(m + 1), in the interior of even samplings.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::on_torus;
use crate::common::{add, even_torus, in_cube, length, median, scale, sub};
use footpoint::samples::{Random, Samples};
use footpoint::{Cloud, Definition, NormalField, Project, Support, Surface};

/// Median distance of projections from the true surface.
fn off<const D: usize>(
    shape: &Samples<D>,
    (field, degree, h): (NormalField, u8, f64),
    foot: impl Fn([f64; D]) -> [f64; D],
) -> f64 {
    let cloud = Cloud::new(shape.points.clone()).with_normals(shape.normals.clone()).unwrap();
    let definition =
        Definition::new().with_field(field).with_support(Support::Uniform(h)).with_degree(degree);
    let surface = Surface::new(cloud, definition).unwrap();
    let mut random = Random::new(21);
    let stride = shape.points.len() / 200;
    let starts: Vec<[f64; D]> =
        (0..200).map(|i| add(shape.points[i * stride], scale(in_cube(&mut random), 0.1 * h))).collect();
    let p = surface.project(&starts, &Project::new().with_tolerance(1e-12));
    assert!(p.status.iter().all(|s| s.is_ok()));
    median(p.point.iter().map(|&q| length(sub(q, foot(q)))))
}

fn check<const D: usize>(shape: &Samples<D>, supports: [f64; 3], foot: impl Fn([f64; D]) -> [f64; D] + Copy) {
    for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
        for degree in 0..=3 {
            let found = supports.map(|h| off(shape, (field, degree, h), foot));
            let order = |j: usize| (found[j] / found[j + 1]).ln() / (supports[j] / supports[j + 1]).ln();
            println!("D = {D} {field} degree {degree}: {found:?} of order {:.2} {:.2}", order(0), order(1));
            let expected = f64::from(degree + 2 - degree % 2);
            for j in 0..2 {
                assert!((order(j) - expected).abs() < 0.3, "{field} {degree}: order {}", order(j));
            }
        }
    }
}

#[test]
fn on_a_torus() {
    check(&even_torus(1.0, 0.4, 400), [0.24, 0.17, 0.12], |x| on_torus(x).0);
}

#[test]
fn on_an_ellipse() {
    let [a, b] = [1.0, 0.6];
    let shape = Samples::<2> {
        points: (0..20_000)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 20_000.0)
            .map(|t| [a * t.cos(), b * t.sin()])
            .collect(),
        normals: (0..20_000)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 20_000.0)
            .map(|t| [b * t.cos(), a * t.sin()])
            .collect(),
    };
    let foot = |x: [f64; 2]| {
        // Newton's iteration for the parameter of the nearest point.
        let mut t = (x[1] / b).atan2(x[0] / a);
        for _ in 0..20 {
            let (sine, cosine) = t.sin_cos();
            let (dx, dy) = (a * cosine - x[0], b * sine - x[1]);
            let slope = -a * sine * dx + b * cosine * dy;
            t -= slope / (a * a * sine * sine + b * b * cosine * cosine - a * cosine * dx - b * sine * dy);
        }
        [a * t.cos(), b * t.sin()]
    };
    check(&shape, [0.3, 0.2, 0.13], foot);
}
