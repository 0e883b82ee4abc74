//! The report says what was computed and how it went, in JSON alone on standard output, and can be replayed.

mod common;

use common::{Folder, csv_of};
use footpoint::samples::{Random, sphere};
use serde_json::Value;

fn folder() -> Folder {
    let folder = Folder::new();
    let mut random = Random::new(8);
    let rows = sphere(1.0, 800, 7)
        .points
        .into_iter()
        .map(|p| [&p[..], &p, &[0.25 + 0.1 * random.uniform(), 0.5 + random.uniform()]].concat());
    folder.write("cloud.csv", csv_of("x,y,z,nx,ny,nz,reach,area", rows));
    let queries = sphere(1.1, 90, 5).points.into_iter().map(Vec::from).chain([vec![9.0, 9.0, 9.0]]);
    folder.write("queries.csv", csv_of("x,y,z", queries));
    folder
}

#[test]
fn every_job_reports_what_it_did() {
    let folder = folder();
    for (job, words, points, files) in [
        ("info", "info cloud.csv", 800, 0),
        ("normals", "normals cloud.csv -o n.ply", 800, 1),
        ("orient", "orient cloud.csv -o o.ply", 800, 1),
        ("project", "project queries.csv --onto cloud.csv -o p.ply", 91, 1),
        ("distance", "distance queries.csv --to cloud.csv -o d.ply", 91, 1),
        ("evaluate", "evaluate cloud.csv --at queries.csv -o e.csv", 91, 1),
        ("demo", "demo --rays 400 -o demo --picture-width 0", 618, 3),
    ] {
        let report = folder.report(words);
        assert_eq!(report["schema"], "footpoint-report/1", "{job}");
        assert_eq!(report["version"], env!("CARGO_PKG_VERSION"), "{job}");
        assert_eq!(report["job"], job);
        assert_eq!(report["points"], points, "{job}");
        assert_eq!(report["outputs"].as_array().unwrap().len(), files, "{job}");
        assert!(report["definition"]["weight"] == "poly3", "{job}");
        for stage in ["read", "index", "compute", "write"] {
            let spent = &report["times"][stage];
            assert!(spent["wall_seconds"].as_f64().unwrap() >= 0.0, "{job} {stage}: {spent}");
            let timed = spent["cpu_seconds"].is_number() || cfg!(not(unix));
            assert!(timed || spent["wall_seconds"] == 0.0, "{job} {stage}: {spent}");
        }
        if job == "info" {
            continue;
        }
        let computed = report["times"]["compute"]["wall_seconds"].as_f64().unwrap();
        let speed = report["points_per_second"].as_f64().unwrap();
        assert!((speed * computed / f64::from(points) - 1.0).abs() < 1e-9, "{job}: {speed}");
        let counts = report["statuses"].as_array().unwrap();
        let sum: u64 = counts.iter().map(|c| c["points"].as_u64().unwrap()).sum();
        assert_eq!(sum, points as u64, "{job}");
        assert_eq!(report["surface"]["samples_absent"], 0, "{job}");
        let side = report["surface"]["cell_side"].as_f64().unwrap();
        assert_eq!(side.log2().fract(), 0.0, "{job}: {side}");
    }
}

#[test]
fn the_words_on_the_error_stream_leave_the_json_alone() {
    let folder = folder();
    let ran = folder.run("normals cloud.csv -o n.ply --json --verbose");
    assert_eq!(ran.code, 0, "{ran:?}");
    let report: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(report["inputs"][0]["path"], "cloud.csv");
    assert_eq!(report["inputs"][0]["normals"], true);
}

#[test]
fn more_and_fewer_words() {
    let folder = folder();
    let words = |option: &str| folder.done(&format!("normals cloud.csv -o n.ply --force {option}")).stderr;
    let usual = words("");
    assert!(usual.contains("normals: 800 ok") && usual.contains("wrote n.ply"), "{usual}");
    assert_eq!(words("-q"), "");
    assert_eq!(words("--quiet"), "");
    let more = words("-v");
    assert!(more.len() > usual.len() && more.contains("cell side"), "{more}");
    for plain in ["{ ", "Some(", "CentredCovariance"] {
        assert!(!more.contains(plain), "`{plain}` is no word for users: {more}");
    }
    assert_eq!(folder.run("normals cloud.csv -o n.ply -q -v").code, 2);
}

/// The options of the first call, replayed from its report, must give the same bytes.
#[test]
fn a_report_replays_to_the_same_bytes() {
    let folder = folder();
    for options in [
        "",
        "--weight gaussian --cut 1e-7 --radius 0.2 --field axes",
        "--per-sample 20 --domain-ratio 0.8 --operator almost --tolerance 1e-9",
        "--support-column reach --factor-column area --accept-gap 0.02 --accept-boundary 0.4",
        "--accept-alignment=-inf --accept-gap 0 --accept-boundary inf --operator basic",
    ] {
        let project = "project queries.csv --onto cloud.csv --force -o";
        let first = folder.report(&format!("{project} first.csv {options}"));
        folder.write("report.json", first.to_string());
        let second = folder.report(&format!("{project} second.csv --definition report.json"));
        assert_eq!(folder.bytes("first.csv"), folder.bytes("second.csv"), "{options}");
        for part in ["definition", "project", "support_column", "factor_column", "surface"] {
            assert_eq!(first[part], second[part], "{options}: {part}");
        }
        if !options.is_empty() {
            folder.report(&format!("{project} third.csv"));
            assert_ne!(folder.bytes("first.csv"), folder.bytes("third.csv"), "{options} matter");
        }
    }
}

#[test]
fn other_options_override_the_replayed_ones() {
    let folder = folder();
    let project = "project queries.csv --onto cloud.csv --force -o out.csv";
    let first = folder.report(&format!(
        "{project} --weight gaussian --cut 1e-7 --support-column reach --factor-column area --accept-gap 0.02 \
         --operator basic --tolerance 1e-3"
    ));
    folder.write("report.json", first.to_string());
    for (options, part, value) in [
        ("--weight wendland", "/definition/weight", Value::from("wendland")),
        ("--cut 1e-5", "/definition/weight/gaussian/cut", Value::from(1e-5)),
        ("--radius 0.3", "/definition/support/uniform", Value::from(0.3)),
        ("--radius 0.3", "/support_column", Value::Null),
        ("--factor-column reach", "/factor_column", Value::from("reach")),
        ("--field axes", "/definition/kind/point_set/field", Value::from("averaged_axes")),
        ("--domain-ratio 0.5", "/definition/domain_ratio", Value::from(0.5)),
        ("--accept-alignment 0.2", "/definition/acceptance/alignment", Value::from(0.2)),
        ("--operator almost", "/project/operator", Value::from("almost_orthogonal")),
        ("--tolerance 1e-8", "/project/tolerance", Value::from(1e-8)),
    ] {
        let second = folder.report(&format!("{project} --definition report.json {options}"));
        assert_eq!(second.pointer(part), Some(&value), "{options}: {second}");
        let kept = "/definition/acceptance/gap";
        assert_eq!(second.pointer(kept), Some(&Value::from(0.02)), "{options} must leave the rest");
    }
}
