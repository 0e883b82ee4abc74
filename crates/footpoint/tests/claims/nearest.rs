//! Near the surface the orthogonal projection is the nearest: no other operator's point is nearer to the start.
#![allow(clippy::print_stdout)]

use crate::common::{Columns, Variant, length, near_samples, sub};
use footpoint::samples::{self, Samples};
use footpoint::{NormalField, Operator, Project, Want};

/// How many starts were compared, and by how much another operator's point was nearer at most, in h.
fn compare<const D: usize>(columns: &Columns<D>, field: NormalField, starts: &[[f64; D]]) -> (usize, f64) {
    let surface = columns.field(field);
    let how = Project::new().with_tolerance(1e-12);
    let project = |operator| surface.project(starts, &how.with_operator(operator));
    let orthogonal = project(Operator::Orthogonal);
    let support = surface.evaluate(starts, Want::SUPPORT).support;
    let (mut compared, mut nearer) = (0, f64::NEG_INFINITY);
    for other in [Operator::Basic, Operator::AlmostOrthogonal].map(project) {
        for i in 0..starts.len() {
            if orthogonal.status[i].is_ok() && other.status[i].is_ok() {
                let far = length(sub(starts[i], orthogonal.point[i]));
                let excess = far - length(sub(starts[i], other.point[i]));
                compared += 1;
                nearer = nearer.max(excess / support[i]);
            }
        }
    }
    (compared, nearer)
}

fn check<const D: usize>(shape: &Samples<D>, radius: f64) {
    for variant in [Variant::Uniform, Variant::PerSample] {
        let columns = Columns::new(shape, radius, variant);
        // Within 0.3 h of the surface: starts spread in a box are kept if they came from that near.
        let all = near_samples(&columns.points, 3000, 0.3 * radius, 4);
        for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
            let surface = columns.field(field);
            let from = surface.project(&all, &Project::default());
            let near = |i: &usize| from.status[*i].is_ok() && from.distance[*i].abs() < 0.3 * 0.75 * radius;
            let starts: Vec<[f64; D]> = (0..all.len()).filter(near).map(|i| all[i]).collect();
            let (compared, nearer) = compare(&columns, field, &starts);
            println!("D = {D} {field:?} {variant:?}: {compared} compared, nearer by {nearer:.1e} h");
            assert!(compared > 4000, "{compared}");
            assert!(nearer <= 1e-9, "{field:?} {variant:?}: nearer by {nearer:e} h");
        }
    }
}

#[test]
fn on_a_noisy_torus() {
    check(&samples::torus(1.0, 0.4, 3000, 1).with_noise(0.02, 2), 0.3);
}

#[test]
fn on_a_noisy_sphere() {
    check(&samples::sphere(1.0, 2000, 5).with_noise(0.02, 6), 0.35);
}

#[test]
fn on_noisy_curves() {
    check(&samples::ellipse(1.0, 0.6, 400, 3).with_noise(0.01, 4), 0.3);
    check(&samples::circle(1.0, 300, 7).with_noise(0.02, 8), 0.3);
}
