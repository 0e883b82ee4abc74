//! Levin's projection reaches every status on purpose, and every option of it matters.

use crate::common::{Columns, Variant, length, near_samples, projection_rows, same_rows, sub};
use footpoint::samples;
use footpoint::{
    Acceptance, Cloud, Definition, Kind, NormalField, Operator, Project, Projections, Queries, Sign, Status,
    Support, Surface, Weight,
};

const DEGREES: [Option<u8>; 6] = [None, Some(0), Some(1), Some(2), Some(3), Some(4)];

fn levin(degree: Option<u8>) -> Project {
    Project::new().with_operator(Operator::Levin { degree })
}

fn uniform(h: f64) -> Definition {
    Definition::new().with_support(Support::Uniform(h))
}

/// What is not ok stays where it was, and has nothing else.
fn check<const D: usize>(p: &Projections<D>, queries: &[[f64; D]], degree: Option<u8>) {
    for i in 0..queries.len() {
        let label = format!("{degree:?}: row {i} is {}", p.status[i]);
        let answers = [&p.frame_normal[i][..], &p.distance[i..=i]];
        if p.status[i].is_ok() {
            assert!(answers.iter().all(|v| v.iter().all(|c| c.is_finite())), "{label}");
            assert!(p.residual[i] >= 0.0 && p.evaluations[i] > 0, "{label}");
            assert!((p.distance[i].abs() - length(sub(p.point[i], queries[i]))).abs() < 1e-14, "{label}");
            assert_eq!(p.surface_normal[i][0].is_nan(), degree.is_none_or(|d| d == 0), "{label}");
        } else {
            assert_eq!(p.point[i].map(f64::to_bits), queries[i].map(f64::to_bits), "{label}");
            assert!(answers.iter().all(|v| v.iter().all(|c| c.is_nan())), "{label}");
            assert!(p.surface_normal[i].iter().all(|c| c.is_nan()), "{label}");
            assert_eq!(p.evaluations[i] == 0, p.status[i] == Status::Invalid, "{label}");
        }
    }
}

#[test]
fn around_a_half_sphere_every_status_is_reached() {
    let whole = Columns::new(&samples::sphere(1.0, 2000, 1).with_noise(0.01, 2), 0.35, Variant::PerSample);
    let half: Vec<usize> = (0..whole.points.len()).filter(|&i| whole.points[i][2] > 0.0).collect();
    let columns = whole.select(&half);
    let mut queries = near_samples(&columns.points, 600, 1.2 * 0.35, 3);
    queries.extend([[f64::NAN; 3], [f64::INFINITY; 3], [1e300; 3], [5.0; 3], [1e12; 3]]);
    let surface = columns.surface(Definition::new());
    for degree in DEGREES {
        let p = surface.project(&queries, &levin(degree));
        check(&p, &queries, degree);
        assert_eq!(p.status[600..603], [Status::Invalid; 3]);
        assert_eq!(p.status[603..], [Status::Outside; 2]);
        for status in [Status::Ok, Status::Outside, Status::Boundary] {
            assert!(p.status.contains(&status), "{degree:?}: {status}");
        }
        let ok = p.status.iter().filter(|s| s.is_ok()).count();
        assert!(ok > 100, "{ok}");
    }
    for most in 0..8 {
        let p = surface.project(&queries, &levin(Some(2)).with_most_evaluations(most));
        check_evaluations(&p, most);
    }
    let never = surface.project(&queries, &levin(None).with_tolerance(f64::NAN).with_most_evaluations(90));
    check_evaluations(&never, 90);
    let rules = [
        (Acceptance { alignment: 10.0, ..Acceptance::default() }, Status::Singular),
        (Acceptance { gap: 2.0, ..Acceptance::default() }, Status::Degenerate),
        (Acceptance { boundary: Some(0.0), ..Acceptance::default() }, Status::Boundary),
    ];
    let usual = surface.project(&queries, &levin(None)).status;
    for (rule, expected) in rules {
        let strict = columns.surface(Definition::new().with_acceptance(rule));
        let found = strict.project(&queries, &levin(None)).status;
        assert!((0..600).all(|i| !usual[i].is_ok() || found[i] == expected), "{rule:?}");
    }
}

fn check_evaluations<const D: usize>(p: &Projections<D>, most: u32) {
    assert!(p.evaluations.iter().all(|&e| e <= most));
    assert!(p.status.contains(&Status::NotConverged), "{most}");
}

#[test]
fn samples_that_do_not_determine_the_polynomial_are_degenerate() {
    // A grid of 4 × 4 in the support: enough for degree 3, which has ten coefficients, on 4 rows.
    let grid = |count: i32, step: f64| -> Vec<[f64; 3]> {
        let at = move |i: i32| step * (f64::from(i) - 0.5 * f64::from(count - 1));
        (0..count * count).map(|i| [at(i % count), 1.1 * at(i / count), 0.0]).collect()
    };
    let x = [[0.01, 0.02, 0.1]];
    for (count, most) in [(2, 1), (3, 2), (4, 3), (5, 4)] {
        let surface = Surface::new(Cloud::new(grid(count, 0.15)), uniform(1.0)).unwrap();
        for degree in 0..=4 {
            let status = surface.project(&x, &levin(Some(degree))).status[0];
            let expected = if degree <= most { Status::Ok } else { Status::Degenerate };
            assert_eq!(status, expected, "{count} × {count}, degree {degree}");
        }
        let status = surface.project(&x, &levin(Some(u8::MAX))).status[0];
        assert_eq!(status, Status::Degenerate);
    }
    let line: Vec<[f64; 3]> = (0..40).map(|i| [0.02 * f64::from(i), 0.0, 0.0]).collect();
    let points = [vec![[0.4, 0.0, 0.0]], vec![[0.4, 0.0, 0.0]; 9], line];
    for points in points {
        let surface = Surface::new(Cloud::new(points), uniform(0.7)).unwrap();
        let queries = [[0.4, 0.0, 0.0], [0.4, 0.1, 0.05], [0.3, 0.0, 0.2]];
        for degree in DEGREES {
            let p = surface.project(&queries, &levin(degree));
            check(&p, &queries, degree);
            assert!(p.status.iter().all(|s| !s.is_ok()), "{:?}", p.status);
        }
    }
}

#[test]
fn a_plane_is_reproduced_by_every_degree() {
    let shape = samples::plane(1.0, 4000, 1);
    let cloud = Cloud::new(shape.points.clone()).with_normals(shape.normals.clone()).unwrap();
    let surface = Surface::new(cloud, uniform(0.25)).unwrap();
    assert_eq!(surface.sign(), Sign::Given);
    let queries: Vec<[f64; 3]> =
        (0..60).map(|i| [0.01 * f64::from(i) - 0.3, 0.2, 0.002 * f64::from(i - 30)]).collect();
    for degree in DEGREES {
        let p = surface.project(&queries, &levin(degree).with_tolerance(1e-12));
        check(&p, &queries, degree);
        for (i, x) in queries.iter().enumerate() {
            assert_eq!(p.status[i], Status::Ok);
            assert!(p.point[i][2].abs() < 1e-12 && (p.distance[i] - x[2]).abs() < 1e-12, "{degree:?} {i}");
            assert!(p.frame_normal[i][2] > 1.0 - 1e-12);
        }
    }
}

#[test]
fn every_option_matters() {
    let columns = Columns::new(
        &samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2),
        0.3,
        Variant::PerSampleAndFactors,
    );
    let queries = near_samples(&columns.points, 100, 0.05, 3);
    let base = columns.surface(Definition::new());
    let points = |surface: &Surface<3>, how: Project| surface.project(&queries, &how).point;
    let all: Vec<Vec<[f64; 3]>> = DEGREES.iter().map(|&degree| points(&base, levin(degree))).collect();
    for (i, one) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|other| other != one), "{:?} changes nothing", DEGREES[i]);
    }
    let usual = &all[3];
    assert_ne!(usual, &points(&base, levin(Some(2)).with_tolerance(1e-2)));
    assert_ne!(
        usual,
        &points(&columns.surface(Definition::new().with_weight(Weight::Poly2)), levin(Some(2)))
    );
    let plain = Columns { supports: None, factors: None, ..columns.clone() };
    let without =
        [Columns { supports: None, ..columns.clone() }, Columns { factors: None, ..columns.clone() }, plain];
    for other in &without {
        assert_ne!(usual, &points(&other.surface(Definition::new()), levin(Some(2))));
    }
    let narrow = columns.surface(Definition::new().with_domain_ratio(0.3));
    let high: Vec<[f64; 3]> = queries.iter().map(|q| q.map(|c| 1.08 * c)).collect();
    let outside = |s: &Surface<3>| {
        s.project(&high, &levin(None)).status.iter().filter(|s| **s == Status::Outside).count()
    };
    assert!(outside(&narrow) > outside(&base));
    // It is the same whatever kind of surface the definition names.
    for kind in
        [Definition::new().with_kind(Kind::Levin), Definition::new().with_field(NormalField::AveragedNormals)]
    {
        assert_eq!(usual, &points(&columns.surface(kind), levin(Some(2))));
    }
    let own = projection_rows(&base.project(Queries::Samples, &levin(Some(2))));
    let given = projection_rows(&base.project(&columns.points, &levin(Some(2))));
    same_rows(&own, &given, "samples as points");
    let trace = base.trace(queries[0], &levin(None));
    assert!(trace.status.is_ok() && trace.iterates.len() == trace.values.len() && trace.iterates.len() > 3);
    assert!(length(sub(trace.iterates[0], queries[0])) < 1e-15);
    assert!(trace.iterates.iter().any(|&q| length(sub(q, all[0][0])) < 1e-15));
}
