//! Every golden number is reached through files and the command line.

mod common;

use common::{Csv, Folder, csv_of, dot, gap, shared};
use serde_json::Value;
use std::collections::BTreeMap;

/// Accepts every zero of f, as the golden numbers do.
const EVERY_ZERO: &str = "--accept-alignment=-inf --accept-gap 0 --accept-boundary inf";

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn vector<const D: usize>(value: &Value) -> [f64; D] {
    numbers(value).try_into().unwrap()
}

/// Writes points with these normals, and supports and factors where there are any.
fn write_cloud<const D: usize>(folder: &Folder, name: &str, golden: &Value, normals: &str) {
    let mut names: Vec<&str> =
        if D == 2 { vec!["x", "y", "nx", "ny"] } else { vec!["x", "y", "z", "nx", "ny", "nz"] };
    let supports = golden["support"].is_array().then(|| numbers(&golden["support"]));
    let factors = golden["factors"].is_array().then(|| numbers(&golden["factors"]));
    if supports.is_some() {
        names.extend(["reach", "half_reach"]);
    }
    if factors.is_some() {
        names.push("area");
    }
    let (points, normals) = (golden["points"].as_array().unwrap(), golden[normals].as_array().unwrap());
    let rows = (0..points.len()).map(|i| {
        let mut row = [numbers(&points[i]), numbers(&normals[i])].concat();
        row.extend(supports.iter().flat_map(|h| [h[i], 0.5 * h[i]]));
        row.extend(factors.iter().map(|area| area[i]));
        row
    });
    folder.write(name, csv_of(&names.join(","), rows));
}

/// The words that choose the surface of a case.
fn surface(golden: &Value, weight: &str, field: &str) -> String {
    let gaussian = weight == "gaussian";
    let mut words = match golden["support"].as_f64() {
        Some(h) => format!("--radius {}", if gaussian { 0.5 * h } else { h }),
        None => format!("--support-column {}", if gaussian { "half_reach" } else { "reach" }),
    };
    if golden["factors"].is_array() {
        words += " --factor-column area";
    }
    if gaussian {
        words += " --cut 1e-16";
    }
    let field = match field {
        "covariance" => "covariance",
        "centred_covariance" => "centred",
        "averaged_normals" => "averaged",
        "averaged_axes" => "axes",
        other => panic!("field {other}"),
    };
    format!("{words} --weight {weight} --field {field} {EVERY_ZERO}")
}

#[track_caller]
fn close(found: f64, expected: f64, bound: f64, what: &str) {
    assert!((found - expected).abs() <= bound, "{what}: {found:e} is not {expected:e} within {bound:e}");
}

fn check<const D: usize>(name: &str) {
    let Some(path) = shared("golden") else { return };
    let golden: Value = serde_json::from_str(&std::fs::read_to_string(path.join(name)).unwrap()).unwrap();
    let folder = Folder::new();
    write_cloud::<D>(&folder, "cloud.csv", &golden, "normals");
    write_cloud::<D>(&folder, "axes.csv", &golden, "axes");
    let coordinates = golden["points"].as_array().unwrap().iter().flat_map(numbers);
    // Above this the coordinates' own rounding decides for absolute quantities.
    let ulp = coordinates.fold(0.0_f64, |m, c| m.max(c.abs())) * f64::EPSILON;

    let mut groups: BTreeMap<(&str, &str), Vec<&Value>> = BTreeMap::new();
    for case in golden["cases"].as_array().unwrap() {
        let key = (case["weight"].as_str().unwrap(), case["field"].as_str().unwrap());
        groups.entry(key).or_default().push(case);
    }
    assert_eq!(groups.len(), 20, "every weight with every field");
    let mut projected = 0;
    for ((weight, field), cases) in groups {
        let header = if D == 2 { "x,y" } else { "x,y,z" };
        folder.write("queries.csv", csv_of(header, cases.iter().map(|case| numbers(&case["x"]))));
        let cloud = if field == "averaged_axes" { "axes.csv" } else { "cloud.csv" };
        let surface = surface(&golden, weight, field);
        folder.done(&format!(
            "evaluate {cloud} --at queries.csv -o out.csv --force {surface} \
             --with weight_sum,eigenvalues,squared_sensitivity,support"
        ));
        let label = format!("{name} {weight} {field}");
        let out = folder.csv("out.csv");
        evaluation::<D>(&out, &cases, ulp, &label);
        let supports = out.numbers("support");
        for (option, key) in
            [("basic", "basic"), ("almost", "almost_orthogonal"), ("orthogonal", "orthogonal")]
        {
            folder.done(&format!(
                "project queries.csv --onto {cloud} -o feet.csv --force {surface} \
                 --operator {option} --tolerance 1e-13"
            ));
            let label = format!("{label} {key}");
            projected += projections::<D>(&folder.csv("feet.csv"), &cases, key, &supports, ulp, &label);
        }
    }
    println!("{name}: {projected} projections reached");
    assert!(projected > 200, "{projected}");
}

fn evaluation<const D: usize>(out: &Csv, cases: &[&Value], ulp: f64, label: &str) {
    assert_eq!(out.len(), cases.len(), "{label}");
    let bound = 1e-11;
    let status = out.words("status");
    let (value, support) = (out.numbers("value"), out.numbers("support"));
    let (average, normal) = (out.vectors::<D>("average"), out.vectors::<D>("frame_normal"));
    let (gradient, unit) = (out.vectors::<D>("gradient"), out.vectors::<D>("surface_normal"));
    let (weight_sum, sensitivity) = (out.numbers("weight_sum"), out.numbers("squared_sensitivity"));
    let (count, effective) = (out.numbers("neighbours"), out.numbers("effective_neighbours"));
    let eigenvalues = out.arrays::<D>(std::array::from_fn(|k| format!("eigenvalue_{k}")));
    let points = out.points::<D>();
    for (i, case) in cases.iter().enumerate() {
        let label = format!("{label} {i}");
        assert_eq!(status[i], "ok", "{label}");
        assert_eq!(points[i], vector::<D>(&case["x"]), "{label}: the query itself");
        let h = support[i];
        let n = vector::<D>(&case["n"]);
        let unsigned = case["field"] != "averaged_normals";
        let sign = if unsigned && dot(n, normal[i]) < 0.0 { -1.0 } else { 1.0 };
        close(gap(normal[i], sign, n), 0.0, bound, &format!("{label} n"));
        close(sign * value[i], number(&case["f"]), bound * h, &format!("{label} f"));
        let off = gap(average[i], 1.0, vector(&case["a"]));
        close(off, 0.0, bound * h + ulp, &format!("{label} a"));
        let slope = vector::<D>(&case["gradient"]);
        let length = dot(slope, slope).sqrt();
        close(gap(gradient[i], sign, slope), 0.0, bound * length.max(1.0), &format!("{label} gradient"));
        let direction = slope.map(|c| c / length);
        let normal_bound = bound * (1.0 / length).max(1.0);
        close(gap(unit[i], sign, direction), 0.0, normal_bound, &format!("{label} surface normal"));
        let s = number(&case["sum_of_weights"]);
        close(weight_sum[i], s, bound * s, &format!("{label} S"));
        let n_eff = number(&case["effective_neighbours"]);
        close(effective[i], n_eff, bound * n_eff, &format!("{label} n_eff"));
        if let Some(neighbours) = case["neighbours"].as_f64() {
            assert_eq!(count[i], neighbours, "{label} neighbours");
        }
        if case["eigenvalues"].is_array() {
            let expected = vector::<D>(&case["eigenvalues"]);
            for k in 0..D {
                close(eigenvalues[i][k], expected[k], bound * expected[D - 1], &format!("{label} λ{k}"));
            }
        }
        if let Some(expected) = case["sum_of_squared_sensitivities"].as_f64() {
            close(sensitivity[i], expected, 10.0 * bound * expected, &format!("{label} sensitivity"));
        }
    }
}

/// Compares every case that has a limit point; gives their number.
fn projections<const D: usize>(
    out: &Csv,
    cases: &[&Value],
    operator: &str,
    supports: &[f64],
    ulp: f64,
    label: &str,
) -> usize {
    let mut reached = 0;
    let (status, point) = (out.words("status"), out.points::<D>());
    let (normal, distance) = (out.vectors::<D>("surface_normal"), out.numbers("distance"));
    for (i, case) in cases.iter().enumerate() {
        let expected = &case["projections"][operator];
        if !expected["point"].is_array() {
            continue;
        }
        let label = format!("{label} {i}");
        assert_eq!(status[i], "ok", "{label}");
        let off = gap(point[i], 1.0, vector(&expected["point"]));
        close(off, 0.0, 1e-10 * supports[i] + 2.0 * ulp, &label);
        let truth = vector::<D>(&expected["unit_normal"]);
        let sign = dot(truth, normal[i]).signum();
        close(gap(normal[i], sign, truth), 0.0, 1e-8, &format!("{label} normal"));
        let moved = gap(point[i], 1.0, vector(&case["x"]));
        close(distance[i].abs(), moved, 4.0 * ulp, &format!("{label} distance"));
        reached += 1;
    }
    reached
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
