//! Where samples do not determine a polynomial the point is *degenerate*, or a lower degree answers and says so.
#![allow(clippy::unwrap_used)]

use crate::common::{evaluation_rows, near_samples, same_rows};
use footpoint::samples::{self, Random};
use footpoint::{
    Cloud, Definition, Evaluations, Kind, NormalField, Precision, Project, Queries, Status, Support, Surface,
    Want,
};

/// f at the origin for these heights over the plane z = 0, with and without fallback.
fn at_origin<const D: usize>(points: &[[f64; D]], degree: u8) -> [Evaluations<D>; 2] {
    [false, true].map(|fallback| {
        let definition = Definition::new()
            .with_support(Support::Uniform(1.0))
            .with_degree(degree)
            .with_degree_fallback(fallback);
        let normals: Vec<[f64; D]> =
            points.iter().map(|_| std::array::from_fn(|k| if k == D - 1 { 1.0 } else { 0.0 })).collect();
        let cloud = Cloud::new(points).with_normals(normals).unwrap();
        Surface::new(cloud, definition).unwrap().evaluate(&[[0.0; D]], Want::ALL)
    })
}

/// Degrees that are not determined are *degenerate*; with fallback the highest that is answers.
fn determines<const D: usize>(what: &str, points: &[[f64; D]], highest: u8) {
    for degree in 0..=3 {
        let [plain, fallback] = at_origin(points, degree);
        let expected = degree.min(highest);
        assert_eq!(fallback.status[0], Status::Ok, "{what}, degree {degree} with fallback");
        assert_eq!(fallback.degree[0], u32::from(expected), "{what}, degree {degree} with fallback");
        assert!(fallback.value[0].is_finite() && fallback.squared_sensitivity[0] < 1e4, "{what} {degree}");
        if degree <= highest {
            assert_eq!(
                (plain.status[0], plain.degree[0]),
                (Status::Ok, u32::from(degree)),
                "{what} {degree}"
            );
            same_rows(&evaluation_rows(&plain), &evaluation_rows(&fallback), what);
        } else {
            assert_eq!((plain.status[0], plain.degree[0]), (Status::Degenerate, 0), "{what} {degree}");
            assert!(plain.value[0].is_nan() && plain.gradient[0][0].is_nan(), "{what} {degree}");
            assert!(
                plain.squared_sensitivity[0].is_nan() && plain.hessian[0][0][0].is_nan(),
                "{what} {degree}"
            );
            // The frame is there all the same.
            assert!(plain.gap[0] > 0.0 && plain.frame_normal[0][D - 1].abs() > 0.5, "{what} {degree}");
        }
        // The answer of a lower degree is that degree's own.
        let [own, _] = at_origin(points, expected);
        let apart = (own.value[0] - fallback.value[0]).abs();
        assert!(apart <= 1e-12, "{what} {degree}: {apart:e}");
    }
}

fn height(x: f64, y: f64) -> f64 {
    0.1 * x - 0.07 * y * y + 0.05 * x * y + 0.02
}

#[test]
fn few_samples() {
    let mut random = Random::new(1);
    let points: Vec<[f64; 3]> = (0..40)
        .map(|_| [1.2 * random.uniform() - 0.6, 1.2 * random.uniform() - 0.6])
        .map(|[x, y]| [x, y, height(x, y)])
        .collect();
    for (count, highest) in [(5, 1), (8, 2), (40, 3)] {
        determines(&format!("{count} samples"), &points[..count], highest);
    }
    let curve: Vec<[f64; 2]> = [-0.7, -0.3, 0.2, 0.5, 0.65].map(|x| [x, height(x, 0.3)]).to_vec();
    for (count, highest) in [(2, 1), (3, 2), (5, 3)] {
        determines(&format!("{count} samples of a curve"), &curve[..count], highest);
    }
}

#[test]
fn repeated_samples() {
    let five = [[-0.5, -0.4], [0.6, -0.3], [0.1, 0.5], [-0.3, 0.3], [0.2, -0.1]];
    let points: Vec<[f64; 3]> = (0..100).map(|i| five[i % 5]).map(|[x, y]| [x, y, height(x, y)]).collect();
    determines("five samples, each twenty times", &points, 1);
}

#[test]
fn samples_on_lines_and_circles() {
    // Two lines: y² is a linear function there.
    let lines: Vec<[f64; 3]> = (0..30)
        .map(|i| [f64::from(i / 2) / 15.0 - 0.47, if i % 2 == 0 { 0.3 } else { -0.3 }])
        .map(|[x, y]| [x, y, height(x, y)])
        .collect();
    determines("two lines", &lines, 1);
    let circle: Vec<[f64; 3]> = (0..30)
        .map(|i| (f64::from(i) * 0.21).sin_cos())
        .map(|(s, c)| [0.6 * c, 0.6 * s, 0.02 + 0.1 * c])
        .collect();
    determines("a circle", &circle, 1);
    // Collinear: there is no frame, whatever the degree.
    let line: Vec<[f64; 3]> = (0..20).map(|i| [f64::from(i) / 20.0 - 0.5, 0.0, 0.0]).collect();
    for degree in 0..=3 {
        let surface = Surface::new(
            Cloud::new(line.as_slice()),
            Definition::new()
                .with_support(Support::Uniform(1.0))
                .with_degree(degree)
                .with_degree_fallback(true),
        );
        assert_eq!(surface.unwrap().evaluate(&[[0.0; 3]], Want::ALL).status[0], Status::Degenerate);
    }
}

#[test]
fn one_sided_samples_of_a_plane_give_the_plane() {
    let mut random = Random::new(2);
    let points: Vec<[f64; 3]> =
        (0..300).map(|_| [random.uniform(), 2.0 * random.uniform() - 1.0, 0.0]).collect();
    for degree in 0..=3 {
        let definition = Definition::new().with_support(Support::Uniform(0.6)).with_degree(degree);
        let surface = Surface::new(Cloud::new(points.as_slice()), definition).unwrap();
        let at: Vec<[f64; 3]> = (0..20).map(|i| [0.0, f64::from(i) / 20.0 - 0.5, 0.05]).collect();
        let e = surface.evaluate(&at, Want::VALUE | Want::SURFACE_NORMAL);
        for i in 0..at.len() {
            assert!((e.value[i].abs() - 0.05).abs() < 1e-12 && e.surface_normal[i][2].abs() > 1.0 - 1e-12);
        }
        let p = surface.project(&at, &Project::new());
        assert!(p.status.iter().all(|s| s.is_ok()) && p.point.iter().all(|q| q[2].abs() < 1e-12));
    }
}

#[test]
fn fallback_matters_at_the_thin_places_of_a_cloud_and_nowhere_else() {
    let shape = samples::torus(1.0, 0.4, 4000, 1).with_noise(0.01, 2);
    let definition =
        Definition::new().with_support(Support::Auto { effective_neighbours: 4.0 }).with_degree(3);
    let made = |definition| Surface::new(Cloud::new(shape.points.clone()), definition).unwrap();
    let plain = made(definition).evaluate(Queries::Samples, Want::ALL);
    let with = made(definition.with_degree_fallback(true)).evaluate(Queries::Samples, Want::ALL);
    let lower = with.degree.iter().filter(|&&degree| degree < 3).count();
    assert!(lower > 10 && lower < 3000, "{lower}");
    let (found, expected) = (evaluation_rows(&with), evaluation_rows(&plain));
    for i in 0..shape.points.len() {
        assert_eq!(plain.status[i] == Status::Ok, with.degree[i] == 3 && with.status[i] == Status::Ok, "{i}");
        if with.degree[i] == 3 {
            same_rows(&found[i..=i], &expected[i..=i], "where degree 3 answers");
        }
    }
}

#[test]
fn degrees_that_make_no_sense_are_refused() {
    let made = |definition: Definition| {
        let shape = samples::sphere(1.0, 200, 1);
        let cloud = Cloud::new(shape.points).with_normals(shape.normals).unwrap();
        Surface::new(cloud, definition).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(made(Definition::new().with_degree(4)), Err("degree 4: it must be 0, 1, 2 or 3".to_owned()));
    for field in [NormalField::Covariance, NormalField::AveragedAxes] {
        let refused = made(Definition::new().with_field(field).with_degree(2));
        assert!(refused.unwrap_err().contains("use centred covariance or averaged normals"));
        assert_eq!(made(Definition::new().with_field(field).with_degree(0)), Ok(()));
    }
    // Order of the settings makes no difference; Levin's surface has no degree.
    let averaged = Definition::new().with_degree(2).with_field(NormalField::AveragedNormals);
    assert_eq!(averaged, Definition::new().with_field(NormalField::AveragedNormals).with_degree(2));
    assert_eq!(Definition::new().with_degree(2).with_kind(Kind::Levin).degree(), 0);
}

#[test]
fn every_degree_and_precision_projects_and_matters() {
    let shape = samples::torus(1.0, 0.4, 3000, 1).with_noise(0.01, 2);
    let at = near_samples(&shape.points, 50, 0.05, 3);
    let mut all: Vec<Vec<[f64; 3]>> = Vec::new();
    for precision in [Precision::Double, Precision::Single] {
        for degree in [0, 2, 3] {
            let definition = Definition::new()
                .with_support(Support::Auto { effective_neighbours: 32.0 })
                .with_precision(precision)
                .with_degree(degree);
            let surface = Surface::new(Cloud::new(shape.points.clone()), definition).unwrap();
            let p = surface.project(&at, &Project::new());
            assert!(p.status.iter().all(|s| s.is_ok()), "{precision:?} {degree}");
            assert!(all.iter().all(|other| *other != p.point));
            all.push(p.point);
        }
    }
}
