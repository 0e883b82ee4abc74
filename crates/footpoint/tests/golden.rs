//! Every golden number is reached within the bounds that its README promises.
#![allow(clippy::unwrap_used)]

mod common;

use common::{dot, length, numbers, scale, shared, sub, vector, vectors};
use footpoint::{
    Acceptance, Cloud, Definition, Evaluations, Kind, NormalField, Operator, Project, Status, Support,
    Surface, Want, Weight,
};
use serde_json::Value;

struct Golden<const D: usize> {
    file: Value,
    cloud: Cloud<D>,
    axes: Cloud<D>,
    /// Above this the coordinates' own rounding decides for absolute quantities.
    ulp: f64,
}

fn load<const D: usize>(name: &str) -> Option<Golden<D>> {
    let path = shared("golden")?.join(name);
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let points = vectors::<D>(&file["points"]);
    let ulp = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs())) * f64::EPSILON;
    let with = |normals: &str| {
        let mut cloud = Cloud::new(points.clone()).with_normals(vectors::<D>(&file[normals])).unwrap();
        if !file["factors"].is_null() {
            cloud = cloud.with_factors(numbers(&file["factors"])).unwrap();
        }
        cloud
    };
    Some(Golden { cloud: with("normals"), axes: with("axes"), file, ulp })
}

fn definition(case: &Value, cut: f64) -> Definition {
    let weight = match case["weight"].as_str().unwrap() {
        "poly2" => Weight::Poly2,
        "poly3" => Weight::Poly3,
        "poly4" => Weight::Poly4,
        "wendland" => Weight::Wendland,
        "gaussian" => Weight::Gaussian { cut },
        other => panic!("weight {other}"),
    };
    let field = match case["field"].as_str().unwrap() {
        "covariance" => NormalField::Covariance,
        "centred_covariance" => NormalField::CentredCovariance,
        "averaged_normals" => NormalField::AveragedNormals,
        "averaged_axes" => NormalField::AveragedAxes,
        other => panic!("field {other}"),
    };
    Definition::new().with_weight(weight).with_field(field).with_acceptance(Acceptance::EVERY_ZERO)
}

impl<const D: usize> Golden<D> {
    fn surface(&self, case: &Value, cut: f64) -> Surface<D> {
        self.surface_of(case, definition(case, cut))
    }

    fn surface_of(&self, case: &Value, definition: Definition) -> Surface<D> {
        let axes = definition.field() == NormalField::AveragedAxes;
        let mut cloud = if axes { self.axes.clone() } else { self.cloud.clone() };
        let half = if case["weight"] == "gaussian" { 0.5 } else { 1.0 };
        let support = match &self.file["support"] {
            Value::Array(_) => {
                let supports = numbers(&self.file["support"]).iter().map(|h| half * h).collect::<Vec<_>>();
                cloud = cloud.with_supports(supports).unwrap();
                Support::FromSamples
            }
            h => Support::Uniform(half * h.as_f64().unwrap()),
        };
        if let (Support::Uniform(h), Some(scale)) = (support, case["scale"].as_f64()) {
            assert_eq!(h, scale);
        }
        Surface::new(cloud, definition.with_support(support)).unwrap()
    }
}

#[track_caller]
fn close(found: f64, expected: f64, bound: f64, what: &str) {
    assert!((found - expected).abs() <= bound, "{what}: {found:e} is not {expected:e} within {bound:e}");
}

fn check<const D: usize>(name: &str) {
    let Some(golden) = load::<D>(name) else { return };
    for (number, case) in golden.file["cases"].as_array().unwrap().iter().enumerate() {
        let label = format!("{name} case {number} {} {}", case["weight"], case["field"]);
        let gaussian = case["weight"] == "gaussian";
        evaluation(&golden, case, 1e-16, 1e-11, &label);
        if gaussian {
            evaluation(&golden, case, 1e-9, 2e-6, &label);
            evaluation(&golden, case, 1e-12, 1e-9, &label);
        }
        projections(&golden, case, &label);
        levin(&golden, case, &label);
        degrees(&golden, case, &label);
    }
}

fn evaluation<const D: usize>(golden: &Golden<D>, case: &Value, cut: f64, bound: f64, label: &str) {
    let surface = golden.surface(case, cut);
    let x = vector::<D>(&case["x"]);
    let e = surface.evaluate(&[x], Want::ALL);
    assert_eq!(e.status[0], Status::Ok, "{label}");
    let h = e.support[0];

    let expected = vector::<D>(&case["n"]);
    let unsigned = case["field"] != "averaged_normals";
    let sign = if unsigned && dot(expected, e.frame_normal[0]) < 0.0 { -1.0 } else { 1.0 };
    close(length(sub(scale(e.frame_normal[0], sign), expected)), 0.0, bound, &format!("{label} n"));
    close(sign * e.value[0], case["f"].as_f64().unwrap(), bound * h, &format!("{label} f"));
    let average = length(sub(e.average[0], vector(&case["a"])));
    close(average, 0.0, bound * h + golden.ulp, &format!("{label} a"));
    let gradient = vector::<D>(&case["gradient"]);
    let error = length(sub(scale(e.gradient[0], sign), gradient));
    close(error, 0.0, bound * length(gradient).max(1.0), &format!("{label} gradient"));
    let normal = scale(e.surface_normal[0], sign * length(gradient));
    close(length(sub(normal, gradient)), 0.0, bound * length(gradient).max(1.0), &format!("{label} normal"));

    let weight_sum = case["sum_of_weights"].as_f64().unwrap();
    close(e.weight_sum[0], weight_sum, bound * weight_sum, &format!("{label} S"));
    let effective = case["effective_neighbours"].as_f64().unwrap();
    close(e.effective_neighbours[0], effective, bound * effective, &format!("{label} n_eff"));
    if let Some(neighbours) = case["neighbours"].as_u64() {
        assert_eq!(u64::from(e.neighbours[0]), neighbours, "{label} neighbours");
    }
    if case["eigenvalues"].is_array() {
        let expected = vector::<D>(&case["eigenvalues"]);
        for k in 0..D {
            let what = format!("{label} eigenvalue {k}");
            close(e.eigenvalues[0][k], expected[k], bound * expected[D - 1], &what);
        }
    }
    if let Some(expected) = case["sum_of_squared_sensitivities"].as_f64() {
        let what = format!("{label} sensitivity");
        close(e.squared_sensitivity[0], expected, 10.0 * bound * expected, &what);
    }
    // The golden ones are differences, good to 1e-7; a Gaussian cut earlier is farther from them than that.
    if case["hessian"].is_array() && bound <= 1e-9 {
        second_derivatives(case, &e, sign, 1e-7, label);
    }
}

fn second_derivatives<const D: usize>(case: &Value, e: &Evaluations<D>, sign: f64, bound: f64, label: &str) {
    let expected = vectors::<D>(&case["hessian"]);
    let size = expected.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    for i in 0..D {
        for k in 0..D {
            let what = format!("{label} second derivative {i} {k}");
            close(sign * e.hessian[0][i][k], expected[i][k], bound * size, &what);
        }
    }
    let steep = length(e.gradient[0]);
    let curvature = &case["curvature"];
    let (mean, gaussian) = (e.curvature.mean[0], e.curvature.gaussian[0]);
    let expected = if D == 2 { &curvature["curvature"] } else { &curvature["mean"] };
    close(sign * mean, expected.as_f64().unwrap(), bound * size / steep, &format!("{label} curvature"));
    if let Some(expected) = curvature["gaussian"].as_f64() {
        let bound = bound * (size / steep) * (size / steep);
        close(gaussian, expected, bound, &format!("{label} Gaussian curvature"));
    }
}

/// Σψ d over all samples, which takes the gradient of f_L = −G/S to that of G.
fn sum_of_slopes<const D: usize>(surface: &Surface<D>, x: [f64; D]) -> [f64; D] {
    let cloud = surface.cloud();
    let mut sum = [0.0; D];
    for (i, &p) in cloud.points().iter().enumerate() {
        let d = sub(p, x);
        let h = cloud.supports().map_or(surface.support().median, |supports| supports[i]);
        let s2 = dot(d, d) / (h * h);
        let rest = (1.0 - s2).max(0.0);
        let slope = match surface.definition().weight() {
            Weight::Poly2 => -4.0 * rest,
            Weight::Poly3 => -6.0 * rest.powi(2),
            Weight::Poly4 => -8.0 * rest.powi(3),
            Weight::Wendland => -20.0 * (1.0 - s2.sqrt()).max(0.0).powi(3),
            _ => -2.0 * (-s2).exp(),
        };
        let factor = cloud.factors().map_or(1.0, |factors| factors[i]);
        sum = common::add(sum, scale(d, factor * slope / (h * h)));
    }
    sum
}

fn levin<const D: usize>(golden: &Golden<D>, case: &Value, label: &str) {
    let Some(f) = case["levin"]["f"].as_f64() else { return };
    let surface = golden.surface_of(case, definition(case, 1e-16).with_kind(Kind::Levin));
    let x = vector::<D>(&case["x"]);
    let e = surface.evaluate(&[x], Want::ALL);
    assert_eq!(e.status[0], Status::Ok, "{label}");
    let sign = dot(e.frame_normal[0], vector(&case["n"])).signum();
    close(sign * e.value[0], f, 1e-11 * e.support[0], &format!("{label} f_L"));
    let weight = e.weight_sum[0];
    let g = case["levin"]["G"].as_f64().unwrap();
    close(-sign * e.value[0] * weight, g, 1e-11 * e.support[0] * weight, &format!("{label} G"));
    let slopes = scale(sum_of_slopes(&surface, x), e.value[0]);
    let found = scale(sub(slopes, scale(e.gradient[0], weight)), sign);
    let expected = vector::<D>(&case["levin"]["gradient_of_G"]);
    let bound = 1e-11 * weight * length(e.gradient[0]).max(1.0);
    close(length(sub(found, expected)), 0.0, bound, &format!("{label} gradient of G"));
}

fn degrees<const D: usize>(golden: &Golden<D>, case: &Value, label: &str) {
    let Some(degrees) = case["degrees"].as_object() else { return };
    for (degree, expected) in degrees {
        let definition = definition(case, 1e-16).with_degree(degree.parse().unwrap());
        let surface = golden.surface_of(case, definition);
        let e = surface.evaluate(&[vector::<D>(&case["x"])], Want::ALL);
        let label = format!("{label} degree {degree}");
        assert_eq!((e.status[0], e.degree[0].to_string()), (Status::Ok, degree.clone()), "{label}");
        let sign = dot(e.frame_normal[0], vector(&case["n"])).signum();
        close(
            sign * e.value[0],
            expected["f"].as_f64().unwrap(),
            1e-10 * e.support[0],
            &format!("{label} f"),
        );
        let gradient = vector::<D>(&expected["gradient"]);
        let error = length(sub(scale(e.gradient[0], sign), gradient));
        close(error, 0.0, 1e-10 * length(gradient).max(1.0), &format!("{label} gradient"));
    }
}

fn projections<const D: usize>(golden: &Golden<D>, case: &Value, label: &str) {
    let surface = golden.surface(case, 1e-16);
    let x = vector::<D>(&case["x"]);
    for (name, operator) in [
        ("basic", Operator::Basic),
        ("almost_orthogonal", Operator::AlmostOrthogonal),
        ("orthogonal", Operator::Orthogonal),
    ] {
        let expected = &case["projections"][name];
        if !expected["point"].is_array() {
            continue;
        }
        let how = Project::new().with_operator(operator).with_tolerance(1e-13).with_most_evaluations(2000);
        let found = surface.project(&[x], &how);
        let label = format!("{label} {name}");
        assert_eq!(found.status[0], Status::Ok, "{label}");
        let h = surface.evaluate(&found.point, Want::SUPPORT).support[0];
        let error = length(sub(found.point[0], vector(&expected["point"])));
        close(error, 0.0, 1e-10 * h + 2.0 * golden.ulp, &label);
        let normal = vector::<D>(&expected["unit_normal"]);
        let sign = dot(normal, found.surface_normal[0]).signum();
        close(
            length(sub(scale(found.surface_normal[0], sign), normal)),
            0.0,
            1e-8,
            &format!("{label} normal"),
        );
        let moved = length(sub(x, found.point[0]));
        close(found.distance[0].abs(), moved, 4.0 * golden.ulp, &format!("{label} distance"));
    }
}

#[test]
fn ellipse() {
    check::<2>("ellipse.json");
}

#[test]
fn sphere() {
    check::<3>("sphere.json");
}

#[test]
fn torus() {
    check::<3>("torus.json");
}

#[test]
fn sheet() {
    check::<3>("sheet.json");
}

#[test]
fn sheet_with_factors() {
    check::<3>("sheet-with-factors.json");
}

#[test]
fn sheet_at_survey_coordinates() {
    check::<3>("sheet-utm.json");
}

#[test]
fn scan_with_a_support_per_sample() {
    check::<3>("scan-per-sample-support.json");
}
