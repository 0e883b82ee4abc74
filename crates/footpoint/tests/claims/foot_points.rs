//! Projected points are what their operator promises: foot points, points along n, points of the surface.
#![allow(clippy::print_stdout)]

use crate::common::{
    self, Columns, FIELDS, across, definitions, dot, largest, length, median, near_samples, sub,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, Evaluations, NormalField, Operator, Project, Projections, Sign, Surface, Want};

struct Projected<const D: usize> {
    starts: Vec<[f64; D]>,
    found: Projections<D>,
    there: Evaluations<D>,
    again: Projections<D>,
}

impl<const D: usize> Projected<D> {
    fn new(surface: &Surface<D>, queries: &[[f64; D]], operator: Operator) -> Self {
        let how = Project::new().with_operator(operator).with_tolerance(1e-12);
        let all = surface.project(queries, &how);
        let ok: Vec<usize> = (0..queries.len()).filter(|&i| all.status[i].is_ok()).collect();
        // A sign test would mean little if most starts had failed.
        assert!(ok.len() * 10 > queries.len() * 9, "{} of {}", ok.len(), queries.len());
        let starts: Vec<[f64; D]> = ok.iter().map(|&i| queries[i]).collect();
        let found = surface.project(&starts, &how);
        assert!(found.status.iter().all(|s| s.is_ok()));
        let there = surface.evaluate(&found.point, Want::ALL);
        let again = surface.project(&found.point, &how);
        Self { starts, found, there, again }
    }

    fn largest(&self, each: impl Fn(usize) -> f64) -> f64 {
        largest((0..self.starts.len()).map(|i| each(i) / self.there.support[i]))
    }

    fn way(&self, i: usize) -> [f64; D] {
        sub(self.starts[i], self.found.point[i])
    }

    fn moved_again(&self, i: usize) -> f64 {
        length(sub(self.found.point[i], self.again.point[i]))
    }
}

fn check<const D: usize>(shape: &Samples<D>, radius: f64) {
    let columns = Columns::new(shape, radius, common::Variant::PerSample);
    let queries = near_samples(&columns.points, 1000, 0.2 * radius, 9);
    for definition in definitions() {
        let (surface, field) = (columns.surface(definition), definition.kind());
        for operator in common::OPERATORS {
            let p = Projected::new(&surface, &queries, operator);
            let value = p.largest(|i| p.there.value[i].abs());
            let aside = p.largest(|i| match operator {
                Operator::Orthogonal => length(across(p.way(i), p.there.surface_normal[i])),
                _ => length(across(p.way(i), p.there.frame_normal[i])),
            });
            let again = p.largest(|i| p.moved_again(i));
            let distance = p.largest(|i| (p.found.distance[i].abs() - length(p.way(i))).abs());
            let again_median = median((0..p.starts.len()).map(|i| p.moved_again(i) / p.there.support[i]));
            println!(
                "D = {D} {field:?} {operator:?}: {} ok, |f| {value:.1e}, aside {aside:.1e}, \
                 again {again:.1e} (median {again_median:.1e}), distance {distance:.1e}",
                p.starts.len()
            );
            assert!(value <= 1e-12, "{field:?} {operator:?}: |f| = {value:e} h");
            assert!(distance <= 1e-14, "{field:?} {operator:?}: distance off by {distance:e} h");
            let normals = largest((0..p.starts.len()).map(|i| {
                length(sub(p.found.surface_normal[i], p.there.surface_normal[i]))
                    .max(length(sub(p.found.frame_normal[i], p.there.frame_normal[i])))
            }));
            assert!(normals <= 1e-9, "{field:?} {operator:?}: normals differ by {normals:e}");
            if operator == Operator::Basic {
                assert!(again_median > 1e-3, "{field:?}: the basic operator moved {again_median:e} h only");
            } else {
                assert!(aside <= 1e-9, "{field:?} {operator:?}: {aside:e} h beside the line");
                assert!(again < 1e-9, "{field:?} {operator:?}: a second projection moved {again:e} h");
            }
        }
    }
}

#[test]
fn on_a_noisy_torus() {
    check(&samples::torus(1.0, 0.4, 3000, 1).with_noise(0.02, 2), 0.3);
}

#[test]
fn on_a_noisy_ellipse() {
    check(&samples::ellipse(1.0, 0.6, 400, 3).with_noise(0.01, 4), 0.3);
}

fn sides<const D: usize>(shape: &Samples<D>, radius: f64, scale: f64) {
    let columns = Columns::new(shape, radius, common::Variant::Uniform);
    let bare = Columns { normals: None, ..columns.clone() };
    for factor in [1.0 - scale, 1.0 + scale] {
        let queries: Vec<[f64; D]> =
            columns.points.iter().step_by(5).map(|p| p.map(|c| c * factor)).collect();
        for operator in common::OPERATORS {
            let how = Project::new().with_operator(operator);
            for field in FIELDS {
                let surface = columns.field(field);
                let p = surface.project(&queries, &how);
                let signed = field != NormalField::AveragedAxes;
                assert_eq!(surface.sign() == Sign::Given, signed);
                for i in (0..queries.len()).filter(|&i| p.status[i].is_ok()) {
                    let inside = signed && factor < 1.0;
                    assert_eq!(p.distance[i] < 0.0, inside, "{field:?} {operator:?} × {factor}");
                    if signed {
                        assert!(dot(p.surface_normal[i], queries[i]) > 0.0);
                        assert!(dot(p.frame_normal[i], queries[i]) > 0.0);
                    }
                }
                assert!(p.status.iter().filter(|s| s.is_ok()).count() * 10 > 9 * queries.len());
            }
            for field in [NormalField::Covariance, NormalField::CentredCovariance] {
                let surface = bare.field(field);
                assert_eq!(surface.sign(), Sign::Arbitrary);
                let p = surface.project(&queries, &how);
                let ok = |i: &usize| p.status[*i].is_ok();
                assert!((0..queries.len()).filter(ok).all(|i| p.distance[i] >= 0.0));
            }
        }
    }
}

#[test]
fn distances_are_signed_when_normals_are_given_and_only_then() {
    sides(&samples::sphere(1.0, 2000, 5), 0.3, 0.06);
    sides(&samples::circle(1.0, 250, 6), 0.3, 0.06);
}

#[test]
fn the_sign_of_an_unsigned_field_follows_the_rule() {
    let columns = Columns::new(&samples::sphere(1.0, 2000, 5), 0.3, common::Variant::Uniform);
    let bare = Columns { normals: None, ..columns.clone() };
    let e = bare.surface(Definition::new()).evaluate(&columns.points, Want::FRAME_NORMAL);
    for n in &e.frame_normal {
        let first_largest = (0..3).fold(0, |best, k| if n[k].abs() > n[best].abs() { k } else { best });
        assert!(n[first_largest] > 0.0, "{n:?}");
    }
    let inwards = columns.normals.as_ref().map(|n| n.iter().map(|n| n.map(|c| -c)).collect());
    let inwards = Columns { normals: inwards, ..columns };
    let e = inwards.surface(Definition::new()).evaluate(&inwards.points, Want::FRAME_NORMAL);
    assert!(e.frame_normal.iter().zip(&inwards.points).all(|(&n, &p)| dot(n, p) < 0.0));
}
