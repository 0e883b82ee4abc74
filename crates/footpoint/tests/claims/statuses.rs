//! Every status is reached on purpose, and says which quantities exist.
#![allow(clippy::print_stdout)]

use crate::common::{self, Columns, FIELDS, OPERATORS, Variant, length, near_samples, sub};
use footpoint::samples::{self, Samples};
use footpoint::{
    Acceptance, Cloud, Definition, Evaluations, NormalField, Operator, Project, Projections, Queries, Status,
    Support, Surface, Want,
};

fn uniform(h: f64) -> Definition {
    Definition::new().with_support(Support::Uniform(h))
}

fn bare<const D: usize>(points: impl Into<Vec<[f64; D]>>, h: f64) -> Surface<D> {
    Surface::new(Cloud::new(points), uniform(h)).unwrap()
}

/// Which quantities exist is said by the status alone.
fn check_evaluations<const D: usize>(e: &Evaluations<D>, field: NormalField, label: &str) {
    for i in 0..e.status.len() {
        let finite = |v: &[f64]| v.iter().all(|c| c.is_finite());
        let nan = |v: &[f64]| v.iter().all(|c| c.is_nan());
        let label = format!("{label}: row {i} is {}", e.status[i]);
        let moments = [
            &e.average[i][..],
            &e.gap[i..=i],
            &e.effective_neighbours[i..=i],
            &e.weight_sum[i..=i],
            &e.support[i..=i],
        ];
        let eigenvalues = &e.eigenvalues[i];
        let frame = [&e.value[i..=i], &e.frame_normal[i], &e.gradient[i], &e.squared_sensitivity[i..=i]];
        let normal = &e.surface_normal[i];
        let (has_moments, has_frame, has_normal) = match e.status[i] {
            Status::Ok => (true, true, true),
            Status::Singular => (true, true, false),
            Status::Degenerate => (true, false, false),
            Status::Outside | Status::Invalid => (false, false, false),
            other => panic!("evaluate gave {other}"),
        };
        let check =
            |exists: bool, v: &[f64]| assert!(if exists { finite(v) } else { nan(v) }, "{label}: {v:?}");
        moments.iter().for_each(|v| check(has_moments, v));
        check(has_moments && field != NormalField::AveragedNormals, eigenvalues);
        frame.iter().for_each(|v| check(has_frame, v));
        check(has_normal, normal);
        assert_eq!(e.neighbours[i] > 0, has_moments, "{label}");
        if has_frame {
            assert!((length(e.frame_normal[i]) - 1.0).abs() < 1e-14, "{label}");
        }
        if has_normal {
            assert!((length(e.surface_normal[i]) - 1.0).abs() < 1e-15, "{label}");
        }
    }
}

/// What is not ok stays where it was.
fn check_projections<const D: usize>(p: &Projections<D>, queries: &[[f64; D]], label: &str) {
    for i in 0..queries.len() {
        let label = format!("{label}: row {i} is {}", p.status[i]);
        let answers = [&p.surface_normal[i][..], &p.frame_normal[i], &p.distance[i..=i]];
        if p.status[i].is_ok() {
            assert!(answers.iter().all(|v| v.iter().all(|c| c.is_finite())), "{label}");
            assert!(p.residual[i] >= 0.0 && p.evaluations[i] > 0, "{label}");
        } else {
            assert_eq!(p.point[i].map(f64::to_bits), queries[i].map(f64::to_bits), "{label}");
            assert!(answers.iter().all(|v| v.iter().all(|c| c.is_nan())), "{label}");
        }
        match p.status[i] {
            Status::Invalid => assert!(p.evaluations[i] == 0 && p.residual[i].is_nan(), "{label}"),
            Status::Boundary | Status::Singular | Status::NotConverged => {
                assert!(p.evaluations[i] > 0 && p.residual[i] >= 0.0, "{label}: {}", p.residual[i]);
            }
            _ => assert!(p.evaluations[i] > 0, "{label}"),
        }
    }
}

fn counts(statuses: &[Status]) -> [usize; 7] {
    Status::ALL.map(|status| statuses.iter().filter(|&&s| s == status).count())
}

/// Starts of every kind around a half sphere or a half circle.
fn everywhere<const D: usize>(shape: &Samples<D>, radius: f64) {
    let whole = Columns::new(shape, radius, Variant::PerSample);
    let half: Vec<usize> = (0..whole.points.len()).filter(|&i| whole.points[i][D - 1] > 0.0).collect();
    let columns = whole.select(&half);
    let mut queries = near_samples(&columns.points, 2000, 1.2 * radius, 3);
    queries.extend([[f64::NAN; D], [f64::INFINITY; D], [f64::NEG_INFINITY; D], [1e300; D], [-1e17; D]]);
    queries.extend([[5.0; D], [1e12; D]]);
    for field in FIELDS {
        let surface = columns.field(field);
        let e = surface.evaluate(&queries, Want::ALL);
        check_evaluations(&e, field, &format!("{field:?}"));
        assert_eq!(counts(&e.status)[Status::Invalid as usize], 5);
        assert_eq!(e.status[2005..], [Status::Outside; 2]);
        let mut reached = [0; 7];
        for operator in OPERATORS {
            for most in [3, 200] {
                let how = Project::new().with_operator(operator).with_most_evaluations(most);
                let p = surface.project(&queries, &how);
                check_projections(&p, &queries, &format!("{field:?} {operator:?}"));
                assert!(p.evaluations.iter().all(|&spent| spent <= most));
                let found = counts(&p.status);
                (0..7).for_each(|k| reached[k] += found[k]);
            }
        }
        println!("D = {D} {field:?}: evaluate {:?}, project {reached:?}", counts(&e.status));
        for status in [Status::Ok, Status::Outside, Status::Boundary, Status::NotConverged, Status::Invalid] {
            assert!(reached[status as usize] > 0, "{field:?}: {status} was not reached");
        }
    }
}

#[test]
fn around_a_half_sphere() {
    everywhere(&samples::sphere(1.0, 2000, 1).with_noise(0.01, 2), 0.35);
}

#[test]
fn around_a_half_circle() {
    everywhere(&samples::circle(1.0, 300, 1).with_noise(0.01, 2), 0.3);
}

#[track_caller]
fn degenerate<const D: usize>(surface: &Surface<D>, queries: &[[f64; D]], label: &str) {
    let field = surface.definition().field();
    let e = surface.evaluate(queries, Want::ALL);
    let wrong = e.status.iter().filter(|&&s| s != Status::Degenerate).count();
    let first = e.status.iter().position(|&s| s != Status::Degenerate).unwrap_or(0);
    assert_eq!(
        wrong,
        0,
        "{label} {field:?}: {wrong} of {} are not degenerate, as {} at {:?}, gap {:e}",
        queries.len(),
        e.status[first],
        queries[first],
        e.gap[first]
    );
    check_evaluations(&e, field, label);
    let p = surface.project(queries, &Project::default());
    assert!(p.status.iter().all(|s| *s == Status::Degenerate), "{label}: {:?}", p.status);
    check_projections(&p, queries, label);
}

#[test]
fn too_few_coincident_and_collinear_samples_are_degenerate_in_space() {
    let h = 0.7;
    let at = [0.3, -0.2, 0.1];
    let direction = [0.36, 0.48, 0.8];
    let along = |t: f64| -> [f64; 3] { std::array::from_fn(|k| at[k] + t * direction[k]) };
    let queries = near_samples(&[at], 500, 0.35, 4);
    let clouds: [(&str, Vec<[f64; 3]>); 5] = [
        ("one sample", vec![at]),
        ("all samples equal", vec![at; 7]),
        ("two samples", vec![along(-0.05), along(0.04)]),
        ("collinear samples", (0..40).map(|i| along(0.01 * f64::from(i) - 0.2)).collect()),
        ("a tight cluster on a line", (0..5).map(|i| along(1e-4 * f64::from(i))).collect()),
    ];
    for (label, points) in clouds {
        let about_x = uniform(h).with_field(NormalField::Covariance);
        let about_x = Surface::new(Cloud::new(points.clone()), about_x).unwrap();
        degenerate(&bare(points, h), &queries, label);
        // About x a line spans a plane with x, in which f is zero: a frame without a gradient, and with no surface.
        let e = about_x.evaluate(&queries, Want::ALL);
        check_evaluations(&e, NormalField::Covariance, label);
        let p = about_x.project(&queries, &Project::default());
        check_projections(&p, &queries, label);
        for (e, p) in e.status.iter().zip(&p.status) {
            assert!(matches!(e, Status::Degenerate | Status::Singular), "{label} about x: {e}");
            assert!(!p.is_ok(), "{label} about x");
        }
    }
}

#[test]
fn one_place_is_degenerate_in_the_plane() {
    let at = [0.3, -0.2];
    let queries = near_samples(&[at], 500, 0.45, 4);
    for (label, points) in [("one sample", vec![at]), ("all samples equal", vec![at; 7])] {
        degenerate(&bare(points, 0.7), &queries, label);
    }
}

#[test]
fn where_no_sample_has_a_normal_an_averaged_field_is_degenerate() {
    let shape = samples::plane(1.0, 800, 1);
    let normals: Vec<[f64; 3]> =
        shape.points.iter().map(|p| if p[0] > 0.0 { [0.0, 0.0, 1.0] } else { [f64::NAN; 3] }).collect();
    for field in [NormalField::AveragedNormals, NormalField::AveragedAxes] {
        let cloud = Cloud::new(shape.points.clone()).with_normals(normals.clone()).unwrap();
        let surface = Surface::new(cloud, uniform(0.25).with_field(field)).unwrap();
        degenerate(&surface, &[[-0.6, 0.1, 0.02], [-0.4, -0.5, 0.0]], "normals absent");
        assert_eq!(surface.evaluate(&[[0.5, 0.1, 0.0]], Want::GRADIENT).status, [Status::Ok]);
    }
    // Normals that cancel exactly.
    let cloud = Cloud::new([[-0.1, 0.0], [0.1, 0.0]]).with_normals([[0.0, 1.0], [0.0, -1.0]]).unwrap();
    let definition = uniform(0.5).with_field(NormalField::AveragedNormals);
    degenerate(&Surface::new(cloud, definition).unwrap(), &[[0.0, 0.1]], "normals cancel");
}

#[test]
fn a_gradient_that_vanishes_is_singular() {
    // One sample in the plane, with a frame about x: f is zero everywhere.
    let surface =
        Surface::new(Cloud::new([[0.0, 0.0]]), uniform(1.0).with_field(NormalField::Covariance)).unwrap();
    let e = surface.evaluate(&[[0.3, 0.2]], Want::ALL);
    assert_eq!(e.status, [Status::Singular]);
    check_evaluations(&e, NormalField::Covariance, "one sample about x");
    // Only who asks for the gradient hears of it.
    assert_eq!(surface.evaluate(&[[0.3, 0.2]], Want::VALUE).status, [Status::Ok]);
    let p = surface.project(&[[0.3, 0.2]], &Project::new().with_operator(Operator::AlmostOrthogonal));
    assert_eq!(p.status, [Status::Singular]);
    check_projections(&p, &[[0.3, 0.2]], "one sample about x");
}

#[test]
fn medial_points_project_to_singular() {
    // Half way between two sheets f is nearly zero, and falls along n.
    let sheet =
        |z: f64, seed| samples::plane(1.0, 1500, seed).points.into_iter().map(move |p| [p[0], p[1], z]);
    let points: Vec<[f64; 3]> = sheet(0.15, 1).chain(sheet(-0.15, 1)).collect();
    let normals = vec![[0.0, 0.0, 1.0]; points.len()];
    let cloud = Cloud::new(points).with_normals(normals).unwrap();
    let surface = Surface::new(cloud, uniform(0.25).with_field(NormalField::AveragedNormals)).unwrap();
    let queries = [[0.0, 0.0, 0.0], [0.2, 0.1, 0.0], [-0.3, 0.2, 0.0]];
    let p = surface.project(&queries, &Project::default());
    assert_eq!(p.status, [Status::Singular; 3]);
    check_projections(&p, &queries, "medial");
}

#[test]
fn a_support_too_small_for_neighbours_leaves_every_point_outside_or_degenerate() {
    let shape = samples::sphere(1.0, 500, 1);
    let surface = bare(shape.points.clone(), 1e-9);
    let own = surface.evaluate(Queries::Samples, Want::ALL);
    assert!(own.status.iter().all(|s| *s == Status::Degenerate) && own.neighbours.iter().all(|&n| n == 1));
    let queries = near_samples(&shape.points, 500, 0.01, 2);
    let e = surface.evaluate(&queries, Want::ALL);
    check_evaluations(&e, NormalField::CentredCovariance, "small support");
    assert!(e.status.iter().all(|s| *s == Status::Outside));
}

#[test]
fn samples_that_are_not_finite_count_as_absent() {
    let shape = samples::sphere(1.0, 1500, 1);
    let clean = Columns::new(&shape, 0.3, Variant::PerSampleAndFactors);
    let mut spoilt = clean.clone();
    let count = clean.points.len();
    let mut expect_absent = 0;
    for (i, p) in (0..count).step_by(10).enumerate() {
        match i % 7 {
            0 => spoilt.points[p][i % 3] = f64::NAN,
            1 => spoilt.points[p][i % 3] = f64::INFINITY,
            2 => spoilt.points[p][i % 3] = 1e300,
            3 => spoilt.supports.as_mut().unwrap()[p] = [0.0, f64::NAN, f64::INFINITY][i % 3],
            4 => spoilt.factors.as_mut().unwrap()[p] = [0.0, f64::NAN, f64::INFINITY][i % 3],
            5 => spoilt.points[p][i % 3] = f64::NEG_INFINITY,
            _ => spoilt.factors.as_mut().unwrap()[p] = -0.0,
        }
        expect_absent += 1;
    }
    let kept: Vec<usize> = (0..count).filter(|i| i % 10 != 0).collect();
    let kept = clean.select(&kept);
    let queries = near_samples(&kept.points, 400, 0.1, 2);
    for field in FIELDS {
        let (spoilt, kept) = (spoilt.field(field), kept.field(field));
        assert_eq!(spoilt.samples_used(), count - expect_absent);
        let rows = |s: &Surface<3>| common::evaluation_rows(&s.evaluate(&queries, Want::ALL));
        common::same_rows(&rows(&spoilt), &rows(&kept), &format!("{field:?}"));
        // Their own queries are invalid where they are no place, and ordinary where only a column was at fault.
        let own = spoilt.evaluate(Queries::Samples, Want::ALL);
        check_evaluations(&own, field, "spoilt");
        let p = spoilt.project(Queries::Samples, &Project::default());
        check_projections(&p, spoilt.cloud().points(), "spoilt");
        for i in 0..count {
            let place = spoilt.cloud().points()[i].iter().all(|c| c.abs() < 1e10);
            assert_eq!(own.status[i] == Status::Invalid, !place, "{i}");
            assert_eq!(p.status[i] == Status::Invalid, !place, "{i}");
        }
    }
}

#[test]
fn huge_coordinates_are_invalid_and_large_ones_are_not() {
    let mut points = samples::sphere(1.0, 1500, 1).points;
    let surface = bare(points.clone(), 0.3);
    for far in [1e9, 1e13, 1e14] {
        let status = surface.evaluate(&[[far, 0.0, 0.0]], Want::VALUE).status;
        assert_eq!(status, [Status::Outside], "{far:e}");
    }
    for far in [1e15, 1e20, f64::MAX, -1e17] {
        let e = surface.evaluate(&[[0.0, far, 0.0]], Want::ALL);
        assert_eq!(e.status, [Status::Invalid], "{far:e}");
        check_evaluations(&e, NormalField::CentredCovariance, "huge");
    }
    // At 1e9 a double still tells 1e-7: a sphere of radius 1 is a sphere.
    points.iter_mut().for_each(|p| p[1] += 1e9);
    let moved = bare(points.clone(), 0.3);
    let p = moved.project(&points, &Project::new().with_tolerance(1e-12));
    assert!(p.status.iter().all(|s| s.is_ok()));
    assert!((0..points.len()).all(|i| length(sub(p.point[i], points[i])) < 0.05));
}

#[test]
fn acceptance_of_the_degenerate_gap_has_its_own_status() {
    let columns = Columns::new(&samples::torus(1.0, 0.4, 1500, 1), 0.3, Variant::Uniform);
    let rule = Acceptance { gap: 2.0, ..Acceptance::default() };
    let surface = columns.surface(Definition::new().with_acceptance(rule));
    let p = surface.project(&columns.points[..50], &Project::default());
    assert!(p.status.iter().all(|s| *s == Status::Degenerate));
    check_projections(&p, &columns.points[..50], "gap");
}

/// Ground with noise, and clutter above it.
fn ground_under_clutter(seed: u64) -> Vec<[f64; 3]> {
    let mut random = samples::Random::new(seed);
    let mut aside = || 2.0 * random.uniform() - 1.0;
    let flat: Vec<[f64; 2]> = (0..4500).map(|_| [aside(), aside()]).collect();
    let height = |i: usize| if i < 3000 { 0.02 * random.normal() } else { random.uniform() };
    let heights: Vec<f64> = (0..4500).map(height).collect();
    flat.iter().zip(heights).map(|(&[x, y], z)| [x, y, z]).collect()
}

#[test]
fn no_sample_is_taken_farther_than_its_support() {
    let far = |feet: &Projections<3>| feet.distance.iter().filter(|d| d.abs() > 0.2).count();
    let mut strayed = 0;
    for seed in 0..8 {
        let points = ground_under_clutter(seed);
        let cloud = Cloud::new(points.clone());
        let each = cloud.clone().with_supports(vec![0.2; points.len()]).unwrap();
        let from_samples = Definition::new().with_support(Support::FromSamples);
        for surface in [Surface::new(cloud, uniform(0.2)), Surface::new(each, from_samples)] {
            let surface = surface.unwrap();
            let [own, foreign] = [Queries::Samples, Queries::Points(&points)]
                .map(|queries| surface.project(queries, &Project::default()));
            assert_eq!(far(&own), 0);
            strayed += far(&foreign);
            let differ = (0..points.len()).filter(|&i| own.status[i] != foreign.status[i]);
            for i in differ {
                assert_eq!((own.status[i], own.point[i]), (Status::Outside, points[i]));
            }
        }
    }
    assert!(strayed > 0, "as points of their own some of them go farther");
}
