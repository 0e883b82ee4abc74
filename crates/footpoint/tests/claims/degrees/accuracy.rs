//! Without noise degrees 2 and 3 are thousands of times nearer than degree 0.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::{angle, on_torus};
use crate::common::{length, sub};
use footpoint::samples;
use footpoint::{Cloud, Definition, NormalField, Project, Queries, Support, Surface};
use std::f64::consts::PI;

#[test]
fn on_a_clean_torus_with_thirty_neighbours() {
    let count = 100_000;
    let shape = samples::torus(1.0, 0.4, count, 20_040_602);
    let h = (30.0 * 4.0 * PI * PI * 0.4 / count as f64 / PI).sqrt();
    // Position and angle (radians) at most, for degrees 2 and 3.
    let bounds = [(2, 6e-7, 0.007_f64.to_radians()), (3, 1e-7, 0.001_f64.to_radians())];
    for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
        for (degree, position, normal) in bounds {
            let cloud = Cloud::new(shape.points.clone()).with_normals(shape.normals.clone()).unwrap();
            let definition =
                Definition::new().with_field(field).with_support(Support::Uniform(h)).with_degree(degree);
            let p = Surface::new(cloud, definition).unwrap().project(Queries::Samples, &Project::new());
            let ok: Vec<usize> = (0..count).filter(|&i| p.status[i].is_ok()).collect();
            let mean = |of: &dyn Fn(usize) -> f64| ok.iter().map(|&i| of(i)).sum::<f64>() / ok.len() as f64;
            let off = |i: usize| length(sub(p.point[i], on_torus(p.point[i]).0)).powi(2);
            let rms = mean(&off).sqrt();
            let turned = mean(&|i| angle(p.surface_normal[i], on_torus(p.point[i]).1));
            println!("{field} degree {degree}: rms {rms:.2e}, {:.5}°, {} ok", turned.to_degrees(), ok.len());
            assert!(ok.len() as f64 > 0.9999 * count as f64, "{}", ok.len());
            assert!(rms <= position && turned <= normal, "{field} {degree}: {rms:e} {turned:e}");
        }
    }
}
