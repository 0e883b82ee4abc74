//! Every option that says what to compute matters, and does what its help says.

mod common;

use common::{Folder, csv_of, sphere_csv};
use footpoint::samples::{Random, sphere};
use serde_json::Value;

/// A sphere with every column that an option can name, and points around it.
fn folder() -> Folder {
    let folder = Folder::new();
    let samples = sphere(1.0, 1500, 3).with_noise(0.01, 4);
    let mut random = Random::new(8);
    let rows = samples.points.iter().zip(&samples.normals).map(|(p, n)| {
        let reach = 0.3 + 0.1 * random.uniform();
        [&p[..], n, &[reach, 0.5 + random.uniform(), 2.0]].concat()
    });
    folder.write("cloud.csv", csv_of("x,y,z,nx,ny,nz,reach,area,two", rows));
    let mut random = Random::new(6);
    let around = |p: &[f64; 3]| p.map(|c| (1.0 + 0.15 * random.normal()) * c).to_vec();
    folder.write("queries.csv", csv_of("x,y,z", samples.points.iter().step_by(5).map(around)));
    folder
}

const WITH: &str = "--with weight_sum,support";

/// What `evaluate` writes with these options, and its report.
fn evaluate(folder: &Folder, options: &str) -> (Vec<u8>, Value) {
    let words = format!("evaluate cloud.csv --at queries.csv -o out.csv --force {WITH} {options}");
    let report = folder.report(&words);
    (folder.bytes("out.csv"), report)
}

fn project(folder: &Folder, options: &str) -> (Vec<u8>, Value) {
    let report = folder.report(&format!("project queries.csv --onto cloud.csv -o out.csv --force {options}"));
    (folder.bytes("out.csv"), report)
}

fn points_with(report: &Value, status: &str) -> u64 {
    let counts = report["statuses"].as_array().unwrap();
    counts.iter().filter(|c| c["status"] == status).map(|c| c["points"].as_u64().unwrap()).sum()
}

fn median_support(report: &Value) -> f64 {
    report["surface"]["support"]["median"].as_f64().unwrap()
}

#[track_caller]
fn all_differ(outputs: &[Vec<u8>]) {
    for (i, output) in outputs.iter().enumerate() {
        assert!(!outputs[..i].contains(output), "output {i} equals an earlier one");
    }
}

#[test]
fn support_rules() {
    let folder = folder();
    let (default, report) = evaluate(&folder, "");
    assert_eq!(evaluate(&folder, "--auto 16").0, default);
    let automatic = median_support(&report);
    // n_eff grows as h²: from 16 to 36, by 1.5.
    let wider = median_support(&evaluate(&folder, "--auto 36").1) / automatic;
    assert!((wider - 1.5).abs() < 0.1, "{wider}");

    let (radius, report) = evaluate(&folder, "--radius 0.35");
    assert_eq!(report["surface"]["support"]["uniform"], true);
    assert_eq!(median_support(&report), 0.35);
    let off = |h: &f64| (h / 0.35 - 1.0).abs();
    assert!(folder.csv("out.csv").numbers("support").iter().all(|h| h.is_nan() || off(h) < 1e-15));

    let (per_sample, report) = evaluate(&folder, "--per-sample 16");
    let support = &report["surface"]["support"];
    assert_eq!(support["uniform"], false);
    assert!(support["smallest"].as_f64() < support["largest"].as_f64());
    assert!((median_support(&report) / automatic - 1.0).abs() < 0.05);

    let (column, report) = evaluate(&folder, "--support-column reach");
    let reach = folder.csv("cloud.csv").numbers("reach");
    let largest = reach.iter().copied().fold(0.0, f64::max);
    assert_eq!(report["surface"]["support"]["largest"], largest);
    all_differ(&[default, radius, per_sample, column]);
}

#[test]
fn the_support_of_least_error_says_why() {
    let folder = folder();
    let (default, report) = evaluate(&folder, "");
    assert!(report["surface"]["support_choice"].is_null());
    let (best, report) = evaluate(&folder, "--auto best");
    let (each, of_each) = evaluate(&folder, "--per-sample best");
    for report in [&report, &of_each] {
        let number = |key: &str| report["surface"]["support_choice"][key].as_f64().unwrap();
        // What the cloud was made with.
        assert!((number("noise") / 0.01 - 1.0).abs() < 0.2, "{report:#}");
        let error = number("error_from_noise").hypot(number("error_from_bias"));
        assert!(error > 0.0005 && error < 0.005, "{error}");
    }
    let chosen = &report["surface"]["support_choice"]["effective_neighbours"];
    let repeated = median_support(&evaluate(&folder, &format!("--auto {chosen}")).1);
    assert!((repeated / median_support(&report) - 1.0).abs() < 0.05);
    all_differ(&[default, best, each]);
    let said = folder.run("info cloud.csv --auto best");
    assert!(said.stdout.contains("chosen for the least error"), "{}", said.stdout);
}

#[test]
fn factors_multiply_the_weights() {
    let folder = folder();
    let plain = evaluate(&folder, "").0;
    let before = folder.csv("out.csv");
    let area = evaluate(&folder, "--factor-column area").0;
    let two = evaluate(&folder, "--factor-column two").0;
    let after = folder.csv("out.csv");
    all_differ(&[plain, area, two]);
    // With factors the sums run in another mode: what is equal is equal but for the last digits.
    let near = |a: f64, b: f64, size: f64| {
        assert!((a - b).abs() <= 1e-13 * size || (a.is_nan() && b.is_nan()), "{a} {b}");
    };
    for (before, after) in before.numbers("weight_sum").iter().zip(after.numbers("weight_sum")) {
        near(2.0 * before, after, after);
    }
    let support = before.numbers("support");
    for (i, (before, after)) in before.numbers("value").iter().zip(after.numbers("value")).enumerate() {
        near(*before, after, support[i]);
    }
}

#[test]
fn weights_fields_and_cut() {
    let folder = folder();
    let with = |name: &str, values: &[&str], rest: &str| -> Vec<Vec<u8>> {
        values.iter().map(|value| evaluate(&folder, &format!("--{name} {value} {rest}")).0).collect()
    };
    let weights = with("weight", &["poly2", "poly3", "poly4", "wendland", "gaussian"], "--radius 0.3");
    all_differ(&weights);
    assert_eq!(weights[1], evaluate(&folder, "--radius 0.3").0, "poly3 is the default");
    let fields = with("field", &["centred", "covariance", "averaged", "axes"], "");
    all_differ(&fields);
    assert_eq!(fields[0], evaluate(&folder, "").0, "centred is the default");

    let cuts = with("cut", &["1e-9", "1e-3"], "--weight gaussian --radius 0.15");
    all_differ(&cuts);
    assert_eq!(cuts[0], evaluate(&folder, "--weight gaussian --radius 0.15").0, "1e-9 is the default");
    // The Gaussian reaches √ln(1/cut) of its scale: three times as many neighbours for 1e-9 as for 1e-3.
    let neighbours = |cut: &str| {
        evaluate(&folder, &format!("--weight gaussian --radius 0.15 --cut {cut}"));
        folder.csv("out.csv").numbers("neighbours").iter().sum::<f64>()
    };
    let ratio = neighbours("1e-9") / neighbours("1e-3");
    assert!((2.5..3.5).contains(&ratio), "{ratio}");
}

#[test]
fn domain_and_acceptance() {
    let folder = folder();
    let (wide, all) = project(&folder, "");
    let (narrow, few) = project(&folder, "--domain-ratio 0.3");
    all_differ(&[wide, narrow]);
    assert!(points_with(&few, "outside") > points_with(&all, "outside") + 10, "{few}");
    assert_eq!(few["definition"]["domain_ratio"], 0.3);
    for (option, status) in [
        ("--accept-alignment 1.05", "singular"),
        ("--accept-gap 0.95", "degenerate"),
        ("--accept-boundary 0.02", "boundary"),
    ] {
        let strict = project(&folder, option).1;
        assert!(points_with(&strict, status) > points_with(&all, status) + 10, "{option}: {strict}");
        assert!(points_with(&strict, "ok") < points_with(&all, "ok"), "{option}");
    }
}

#[test]
fn operators_and_tolerance() {
    let folder = folder();
    let outputs: Vec<Vec<u8>> = ["basic", "almost", "orthogonal"]
        .map(|operator| project(&folder, &format!("--operator {operator} --tolerance 1e-12")).0)
        .into();
    all_differ(&outputs);
    let feet = folder.csv("out.csv");
    let (from, to) = (folder.csv("queries.csv").points::<3>(), feet.points::<3>());
    let (normal, distance) = (feet.vectors::<3>("surface_normal"), feet.numbers("distance"));
    let mut judged = 0;
    for i in (0..to.len()).filter(|&i| distance[i].abs() > 1e-3) {
        // Along the normal of the surface at the foot point, by the signed distance.
        let way: [f64; 3] = std::array::from_fn(|k| from[i][k] - to[i][k]);
        assert!(common::gap(way, distance[i], normal[i]) < 1e-9, "{i}");
        judged += 1;
    }
    assert!(judged > 200, "{judged}");
    assert_eq!(
        project(&folder, "").0,
        project(&folder, "--operator orthogonal --tolerance 1e-6").0,
        "the defaults"
    );

    let work = |tolerance: &str| {
        let (_, report) = project(&folder, &format!("--tolerance {tolerance}"));
        let h = median_support(&report);
        let feet = folder.csv("out.csv");
        let (status, residual) = (feet.words("status"), feet.numbers("residual"));
        let bound = tolerance.parse::<f64>().unwrap() * h;
        assert!((0..feet.len()).all(|i| status[i] != "ok" || residual[i] <= bound), "{tolerance}");
        report["moved"]["mean_evaluations"].as_f64().unwrap()
    };
    let (coarse, fine) = (work("1e-2"), work("1e-12"));
    assert!(coarse + 1.0 < fine, "{coarse} and {fine} evaluations");
}

#[test]
fn levins_surface_and_levins_projection() {
    let folder = folder();
    let (plain, _) = evaluate(&folder, "");
    let (levin, report) = evaluate(&folder, "--surface levin");
    let (covariance, _) = evaluate(&folder, "--field covariance");
    assert_eq!(report["definition"]["kind"], "levin");
    assert_eq!(evaluate(&folder, "--surface pss").0, plain, "pss is the default");
    all_differ(&[plain.clone(), levin.clone(), covariance]);
    folder.write("levin.json", serde_json::to_string(&report).unwrap());
    assert_eq!(evaluate(&folder, "--definition levin.json").0, levin);
    assert_eq!(evaluate(&folder, "--definition levin.json --surface pss").0, plain);
    for wrong in ["--surface levin --field centred", "--definition levin.json --field axes"] {
        let ran = folder.run(&format!("evaluate cloud.csv --at queries.csv -o no.csv {wrong}"));
        assert!(ran.code == 2 && ran.stderr.contains("--field belongs to --surface pss"), "{ran:?}");
    }

    let step_one = project(&folder, "--operator levin").0;
    let mut outputs = vec![project(&folder, "").0, project(&folder, "--surface levin").0, step_one.clone()];
    for degree in 0..=4 {
        let (output, report) = project(&folder, &format!("--operator levin --levin-degree {degree}"));
        assert_eq!(report["project"]["operator"]["levin"]["degree"], degree);
        outputs.push(output);
        folder.write("degree.json", serde_json::to_string(&report).unwrap());
    }
    all_differ(&outputs);
    assert_eq!(project(&folder, "--definition degree.json").0, outputs[7]);
    assert_eq!(project(&folder, "--definition degree.json --levin-degree 2").0, outputs[5]);
    assert_eq!(project(&folder, "--definition degree.json --operator levin").0, step_one);
    assert_eq!(project(&folder, "--operator levin --surface levin").0, step_one);
    let ran = folder.run("project cloud.csv -o no.csv --levin-degree 2");
    assert!(ran.code == 2 && ran.stderr.contains("--levin-degree belongs to --operator levin"), "{ran:?}");
    assert_eq!(folder.run("project cloud.csv -o no.csv --operator levin --levin-degree 5").code, 2);
}

#[test]
fn degrees_and_their_fallback() {
    let folder = folder();
    let (plain, report) = evaluate(&folder, "--auto 24");
    assert_eq!(report["definition"]["kind"]["point_set"]["degree"], 0);
    assert_eq!(evaluate(&folder, "--auto 24 --degree 0").0, plain);
    let (quadratic, report) = evaluate(&folder, "--auto 24 --degree 2");
    assert_eq!(report["definition"]["kind"]["point_set"]["degree"], 2);
    folder.write("quadratic.json", serde_json::to_string(&report).unwrap());
    assert_eq!(evaluate(&folder, "--definition quadratic.json").0, quadratic);
    assert_eq!(evaluate(&folder, "--definition quadratic.json --degree 0").0, plain);
    let averaged = evaluate(&folder, "--definition quadratic.json --field averaged").0;
    all_differ(&[plain, quadratic, averaged, evaluate(&folder, "--auto 24 --degree 3").0]);

    // So few neighbours that a cubic is not determined everywhere.
    let degrees = |options: &str| {
        folder.report(&format!(
            "evaluate cloud.csv --at cloud.csv -o d.csv --force --auto 4 --with degree {options}"
        ));
        let table = folder.csv("d.csv");
        let status: Vec<String> = table.words("status").iter().map(ToString::to_string).collect();
        (status, table.numbers("degree"))
    };
    let (status, degree) = degrees("--degree 3");
    let degenerate = |status: &[String]| status.iter().filter(|s| *s == "degenerate").count();
    let without = degenerate(&status);
    assert!(without > 100, "{without}");
    assert!(status.iter().zip(&degree).all(|(s, &d)| d == if s == "degenerate" { 0.0 } else { 3.0 }));
    let (status, degree) = degrees("--degree 3 --degree-fallback");
    assert!(degenerate(&status) < without / 10, "{} of {without}", degenerate(&status));
    assert!(degree.contains(&2.0) && degree.contains(&3.0));

    for (options, problem) in [
        ("--degree 4", "degree 4: it must be 0, 1, 2 or 3"),
        ("--degree two", "it must be 0, 1, 2, 3 or `auto`"),
        ("--degree 2 --field covariance", "use centred covariance or averaged normals"),
        ("--degree 2 --surface levin", "--degree belongs to --surface pss"),
    ] {
        let ran = folder.run(&format!("evaluate cloud.csv --at queries.csv -o no.csv {options}"));
        assert!(ran.code == 2 && ran.stderr.contains(problem), "{options}: {ran:?}");
    }
}

#[test]
fn an_automatic_degree_is_what_the_report_says_it_is() {
    let folder = folder();
    let (automatic, report) = evaluate(&folder, "--auto 64 --degree auto");
    let chosen = report["surface"]["degree_choice"]["degree"].as_u64().unwrap();
    assert_eq!(report["surface"]["degree_choice"]["aim"], "position");
    assert_eq!(report["definition"]["kind"]["point_set"]["degree"], chosen);
    assert!(chosen > 0, "{report}");
    assert_eq!(evaluate(&folder, &format!("--auto 64 --degree {chosen}")).0, automatic);
    folder.write("chosen.json", serde_json::to_string(&report).unwrap());
    assert_eq!(evaluate(&folder, "--definition chosen.json").0, automatic);
    let normals = folder.report("normals cloud.csv -o n.csv --degree auto");
    assert_eq!(normals["surface"]["degree_choice"]["aim"], "normal");
    assert_eq!(normals["surface"]["degree_choice"]["evidence"].as_array().unwrap().len(), 3);
    let said = folder.run("normals cloud.csv -o n.csv --force --degree auto");
    assert!(said.stderr.contains("chosen for the least error of normals"), "{said:?}");
}

#[test]
fn onto_names_another_cloud() {
    let folder = folder();
    let own = folder.report("project queries.csv -o own.csv");
    let (other, report) = project(&folder, "");
    assert_ne!(folder.bytes("own.csv"), other);
    assert_eq!(own["inputs"].as_array().unwrap().len(), 1);
    assert_eq!(report["inputs"][1]["path"], "cloud.csv");
    assert_eq!(folder.csv("out.csv").len(), folder.csv("queries.csv").len());
}

#[test]
fn normal_chooses_the_columns() {
    let folder = folder();
    let columns = |choice: &str| {
        folder.done(&format!("normals cloud.csv -o out.csv --force --normal {choice}"));
        let names = folder.csv("out.csv").names;
        ["surface_normal_x", "frame_normal_x"].map(|name| names.contains(&name.to_owned()))
    };
    assert_eq!(columns("surface"), [true, false]);
    assert_eq!(columns("frame"), [false, true]);
    assert_eq!(columns("both"), [true, true]);
}

#[test]
fn with_adds_exactly_what_it_names() {
    let folder = folder();
    let names = |with: &str| {
        folder.done(&format!("evaluate cloud.csv --at queries.csv -o out.csv --force {with}"));
        folder.csv("out.csv").names
    };
    let usual = names("");
    for (extra, columns) in [
        ("weight_sum", vec!["weight_sum"]),
        ("eigenvalues", vec!["eigenvalue_0", "eigenvalue_1", "eigenvalue_2"]),
        ("squared_sensitivity", vec!["squared_sensitivity"]),
        ("support", vec!["support"]),
    ] {
        let more = names(&format!("--with {extra}"));
        let added: Vec<&str> = more.iter().filter(|n| !usual.contains(n)).map(String::as_str).collect();
        assert_eq!(added, columns);
        assert_eq!(more.len(), usual.len() + columns.len());
    }
}

#[test]
fn threads_change_no_byte() {
    let folder = folder();
    for verb in ["normals cloud.csv --normal both", "project queries.csv --onto cloud.csv"] {
        let outputs: Vec<Vec<u8>> = ["1", "2", "7", "0"]
            .map(|threads| {
                folder.done(&format!("{verb} -o out.ply --force --threads {threads}"));
                folder.bytes("out.ply")
            })
            .into();
        assert!(outputs.iter().all(|output| *output == outputs[0]), "{verb}");
    }
    // A pool of one worker computes no faster on the clock than on its core.
    folder.write("large.csv", sphere_csv(30_000));
    let times = folder.report("normals large.csv -o out.csv --force --threads 1");
    let spent = &times["times"]["compute"];
    if let Some(cpu) = spent["cpu_seconds"].as_f64() {
        assert!(cpu < 1.2 * spent["wall_seconds"].as_f64().unwrap() + 0.02, "{spent}");
    }
}

#[test]
fn the_demo_takes_its_plan() {
    let folder = Folder::new();
    let demo = |options: &str| {
        let report = folder.report(&format!("demo -o out --force --picture-width 0 {options}"));
        (folder.bytes("out/scan.ply"), report)
    };
    let (plain, report) = demo("--rays 900");
    let points = report["points"].as_u64().unwrap();
    assert!(demo("--rays 1600").1["points"].as_u64().unwrap() > points);
    let (quiet, still) = demo("--rays 900 --range-noise 0");
    assert!(still["demo"]["rms_before_metres"].as_f64().unwrap() < 1e-12, "{still}");
    assert_eq!(still["demo"]["noise_metres"], 0.0);
    let (seeded, other) = demo("--rays 900 --seed 2");
    all_differ(&[plain, quiet, seeded]);
    assert_eq!(folder.table("out/scan.ply").rows() as u64, other["points"]);
    let (_, uniform) = demo("--rays 900 --radius 0.05");
    assert_eq!(uniform["surface"]["support"]["uniform"], true);
    assert_eq!(report["surface"]["support"]["uniform"], false, "its own support unless told otherwise");
}
