//! By default `distance` compares surfaces: every option of that matters, and nothing that is known is left
//! out.

mod common;

use common::{Folder, bits, csv_of};
use footpoint::samples::Random;

/// Two surveys of the same rolling ground, the later with a terrace far above and a point alone; normals
/// look up.
fn folder() -> Folder {
    let folder = Folder::new();
    let rows = |seed: u64, terrace: bool| {
        let mut random = Random::new(seed);
        let mut rows: Vec<Vec<f64>> = (0..3000)
            .map(|i| {
                let (x, y) = (10.0 * random.uniform(), 10.0 * random.uniform());
                let up = if terrace && i % 3 == 0 { 6.0 } else { 0.0 };
                vec![x, y, 0.2 * x.sin() + up + 0.02 * random.normal(), 0.0, 0.0, 1.0]
            })
            .collect();
        if terrace {
            rows.push(vec![5.0, 5.0, 40.0, 0.0, 0.0, 1.0]);
        }
        rows
    };
    folder.write("old.csv", csv_of("x,y,z,nx,ny,nz", rows(1, false).into_iter()));
    folder.write("new.csv", csv_of("x,y,z,nx,ny,nz", rows(2, true).into_iter()));
    folder
}

const DISTANCE: &str = "distance new.csv --to old.csv --force -o";

#[test]
fn the_columns_say_what_is_significant() {
    let folder = folder();
    let report = folder.report(&format!("{DISTANCE} d.csv"));
    let csv = folder.csv("d.csv");
    let added = "foot_x foot_y foot_z distance distance_sigma level_of_detection significant foot_normal_x foot_normal_y \
                 foot_normal_z status";
    assert_eq!(csv.names.join(" "), format!("x y z nx ny nz {added}"));
    let [distance, sigma, level, significant] =
        ["distance", "distance_sigma", "level_of_detection", "significant"].map(|name| csv.numbers(name));
    let status = csv.words("status");
    let mut loud = [0, 0];
    for i in 0..3000 {
        let expected = f64::from(u8::from(distance[i].abs() > level[i]));
        assert_eq!(significant[i], expected, "{i}");
        if status[i] == "ok" {
            assert!((level[i] / sigma[i] - 1.96).abs() < 1e-12, "{i}");
            loud[usize::from(i % 3 == 0)] += usize::from(significant[i] == 1.0);
        }
    }
    // The terrace is reached by walks, with sigma; elsewhere nothing moved.
    assert!(loud[1] > 900 && (40..180).contains(&loud[0]), "{loud:?}");
    let terrace: Vec<usize> = (0..3000).step_by(3).filter(|&i| status[i] == "ok").collect();
    assert!(terrace.iter().all(|&i| (5.0..6.3).contains(&distance[i]) && sigma[i] < 0.1));
    // The point alone has no surface: its own distance, and no more.
    assert!((39.0..40.5).contains(&distance[3000]) && sigma[3000].is_nan() && status[3000] != "ok");
    assert_eq!(significant[3000], 0.0);
    let found = &report["distance"];
    let ok = status.iter().filter(|s| **s == "ok").count();
    assert_eq!(found["answered"], ok);
    assert_eq!(found["significant"], significant.iter().filter(|s| **s == 1.0).count());
    let without = (0..=3000).filter(|&i| status[i] != "ok" && distance[i].is_finite()).count();
    assert!(found["without_sigma"] == without && without > 0, "{found}");
    let mut levels: Vec<f64> = level.into_iter().filter(|l| l.is_finite()).collect();
    levels.sort_by(f64::total_cmp);
    let median = 0.5 * (levels[(levels.len() - 1) / 2] + levels[levels.len() / 2]);
    assert!((found["level_of_detection"].as_f64().unwrap() / median - 1.0).abs() < 1e-9);
    let supports = found["supports"].as_array().unwrap();
    let points: u64 = supports.iter().map(|s| s["points"].as_u64().unwrap()).sum();
    assert_eq!((supports.len(), points as usize), (3, ok));
    assert_eq!((found.get("mean_bias"), &found["signed"]), (None, &true.into()));
    let said = folder.done(&format!("{DISTANCE} d.csv --registration 0.01")).stderr;
    for part in
        ["between the surfaces, signed", "level of detection", "registration 0.01 included", "significant ("]
    {
        assert!(said.contains(part), "{part} in {said}");
    }
}

#[test]
fn every_option_matters() {
    let folder = folder();
    let column = |options: &str, name: &str| {
        folder.done(&format!("{DISTANCE} o.csv {options}"));
        folder.csv("o.csv").numbers(name)
    };
    let usual = column("", "distance_sigma");
    assert_eq!(bits(&usual), bits(&column("--compare surfaces", "distance_sigma")));
    for (plain, registered) in usual.iter().zip(column("--registration 0.05", "distance_sigma")) {
        assert!(plain.is_nan() || (registered / plain.hypot(0.05) - 1.0).abs() < 1e-12);
    }
    for options in
        ["--radius 0.8", "--auto 20", "--per-sample 20", "--tolerance 0.02", "--weight poly4", "--degree 2"]
    {
        assert_ne!(bits(&usual), bits(&column(options, "distance_sigma")), "{options}");
    }
    let report = folder.report(&format!("{DISTANCE} o.csv --radius 0.8"));
    assert_eq!(report["surface"]["support"]["median"], 0.8);
    assert_eq!(report["distance"]["supports"].as_array().unwrap().len(), 1);
    let near = column("--largest 3", "distance");
    assert!(near.iter().all(|d| d.is_nan() || d.abs() <= 3.0) && near[0].is_nan());
    folder.done(&format!("{DISTANCE} o.csv --largest 3"));
    assert_eq!(folder.csv("o.csv").words("status")[0], "outside");
    let unsigned = column("--drop normals", "distance");
    assert!(unsigned.iter().all(|d| d.is_nan() || *d >= 0.0));
    let said = folder.done(&format!("{DISTANCE} o.csv --drop normals")).stderr;
    assert!(said.contains("footpoint orient old.csv --along 0,0,1"), "{said}");
    folder.done(&format!("{DISTANCE} c.ply --colours=0.1"));
    assert!(folder.table("c.ply").column("red").is_some());
}

#[test]
fn a_report_replays_to_the_same_bytes() {
    let folder = folder();
    for options in
        ["", "--radius 0.8 --registration 0.01", "--compare points", "--tolerance 1e-3 --largest 9"]
    {
        let report = folder.report(&format!("{DISTANCE} first.csv {options}"));
        folder.write("report.json", report.to_string());
        folder.done(&format!("{DISTANCE} second.csv --definition report.json"));
        assert_eq!(folder.bytes("first.csv"), folder.bytes("second.csv"), "{options}");
    }
    let report = folder.report(&format!("{DISTANCE} first.csv"));
    folder.write("report.json", report.to_string());
    for (options, compare) in [
        ("--compare points", serde_json::json!("points")),
        ("--radius 1", serde_json::json!({"surfaces": {"effective_neighbours": []}})),
        ("", serde_json::json!({"surfaces": {"effective_neighbours": [8.0, 16.0, 32.0]}})),
    ] {
        let again = folder.report(&format!("{DISTANCE} third.csv --definition report.json {options}"));
        assert_eq!(again["compare"], compare, "{options}");
    }
}

#[test]
fn points_too_few_for_a_surface_are_told_so() {
    let folder = folder();
    folder.write("few.csv", "x,y,z\n5,5,1\n2,2,30\n");
    let said = folder.done("distance few.csv --to old.csv -o f.csv").stderr;
    assert!(said.contains("--compare points"), "{said}");
    let surfaces = folder.csv("f.csv").numbers("distance");
    folder.done("distance few.csv --to old.csv -o p.csv --compare points --auto 32");
    for (a, b) in surfaces.iter().zip(folder.csv("p.csv").numbers("distance")) {
        assert!((a - b).abs() < 0.02, "{a} {b}");
    }
}

#[test]
fn the_noise_of_points_is_estimated_from_their_own_surface() {
    let folder = folder();
    let report = folder.report(&format!("{DISTANCE} a.csv --compare points --noise 0.02 --query-noise auto"));
    let estimate = report["distance"]["query_noise"].as_f64().unwrap();
    assert!((0.005..0.03).contains(&estimate), "{estimate}");
    folder.done(&format!("{DISTANCE} b.csv --compare points --noise 0.02 --query-noise {estimate}"));
    assert_eq!(folder.bytes("a.csv"), folder.bytes("b.csv"));
    folder.write("report.json", report.to_string());
    folder.done(&format!("{DISTANCE} c.csv --definition report.json"));
    assert_eq!(folder.bytes("a.csv"), folder.bytes("c.csv"));
    let project = "project new.csv --onto old.csv --noise 0.02 --force -o";
    folder.done(&format!("{project} p.csv --query-noise auto"));
    folder.done(&format!("{project} q.csv --query-noise {estimate}"));
    assert_eq!(folder.bytes("p.csv"), folder.bytes("q.csv"));
}

#[test]
fn curves_compare_too() {
    let folder = Folder::new();
    let mut random = Random::new(3);
    for name in ["old.csv", "new.csv"] {
        let rows = (0..800).map(|i| {
            let (s, c) = (0.00785 * f64::from(i)).sin_cos();
            let r = 1.0 + 0.004 * random.normal();
            vec![r * c, r * s]
        });
        folder.write(name, csv_of("x,y", rows.collect::<Vec<_>>().into_iter()));
    }
    let report = folder.report(&format!("{DISTANCE} d.csv"));
    let found = &report["distance"];
    let share = found["significant"].as_f64().unwrap() / found["answered"].as_f64().unwrap();
    assert!(found["answered"].as_u64().unwrap() > 750 && share < 0.12, "{found}");
    let said = folder.done(&format!("{DISTANCE} d.csv")).stderr;
    assert!(said.contains("--along 0,1,"), "{said}");
}
