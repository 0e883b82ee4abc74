//! Every option of `distance` matters, every column is kept, and the report says what stands in the file.

mod common;

use common::{Folder, bits, csv_of, numbers_of, sphere_csv};
use footpoint_io::Data;
use serde_json::Value;

/// A sphere of radius 1 with normals, and queries around it: inside, outside, far off, and one that is no point.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(3000));
    let radii = [0.7, 0.98, 1.01, 1.05, 1.4, 3.0];
    let directions = footpoint::samples::sphere(1.0, 60, 3).points;
    let rows =
        directions.iter().zip(radii.into_iter().cycle()).enumerate().map(|(i, (d, r))| {
            [&d.map(|c| c * r)[..], &[i as f64, 0.001 * (1 + i % 3) as f64, 200.0]].concat()
        });
    let last = vec![f64::NAN, 0.0, 0.0, 60.0, 0.001, 200.0];
    folder.write("q.csv", csv_of("x,y,z,id,accuracy,red", rows.chain([last])));
    folder
}

const DISTANCE: &str = "distance q.csv --to cloud.csv --compare points --force -o";

#[test]
fn every_column_is_kept_in_its_place() {
    let folder = folder();
    folder.done(&format!("{DISTANCE} d.csv"));
    let (given, found) = (folder.csv("q.csv"), folder.csv("d.csv"));
    let added =
        "foot_x foot_y foot_z distance distance_bias foot_normal_x foot_normal_y foot_normal_z status";
    assert_eq!(found.names.join(" "), format!("x y z id accuracy red {added}"));
    for name in &given.names {
        assert_eq!(bits(&given.numbers(name)), bits(&found.numbers(name)), "{name}");
    }
    let status = found.words("status");
    assert!(status[..60].iter().all(|s| *s == "ok") && status[60] == "invalid", "{status:?}");
    assert!(found.numbers("distance")[60].is_nan() && found.numbers("foot_x")[60].is_nan());
    folder.done(&format!("{DISTANCE} d.ply --noise 0.01 --colours"));
    let table = folder.table("d.ply");
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    let added = "foot_x foot_y foot_z red green blue distance distance_sigma distance_bias foot_nx foot_ny foot_nz status";
    // The colour that a query had has made room.
    assert_eq!(names.join(" "), format!("x y z id accuracy given_red {added}"));
    assert_eq!(bits(&numbers_of(&table, "distance")), bits(&found.numbers("distance")));
    assert_eq!(numbers_of(&table, "status")[60], 6.0);
}

#[test]
fn registration_and_queries_add_to_sigma_in_quadrature() {
    let folder = folder();
    let sigma = |options: &str| {
        folder.done(&format!("{DISTANCE} d.csv {options}"));
        folder.csv("d.csv").numbers("distance_sigma")
    };
    let plain = sigma("--noise 0.01");
    assert!(plain[..60].iter().all(|s| (0.001..0.01).contains(s)) && plain[60].is_nan());
    let same = |found: Vec<f64>, more: &dyn Fn(usize) -> f64| {
        for i in 0..60 {
            let expected = (plain[i].powi(2) + more(i).powi(2)).sqrt();
            assert!((found[i] / expected - 1.0).abs() < 1e-12, "{i}: {} for {expected}", found[i]);
        }
    };
    same(sigma("--noise 0.01 --registration 0.02"), &|_| 0.02);
    same(sigma("--noise 0.01 --query-noise 0.03"), &|_| 0.03);
    let accuracy = |i: usize| 0.001 * (1 + i % 3) as f64;
    same(sigma("--noise 0.01 --query-noise accuracy"), &accuracy);
    same(sigma("--noise 0.01 --query-noise accuracy --registration 0.02"), &|i| accuracy(i).hypot(0.02));
    assert_eq!(bits(&plain), bits(&sigma("--noise 0.01 --registration 0")));
    let bias = folder.csv("d.csv").numbers("distance_bias");
    folder.done(&format!("{DISTANCE} d.csv"));
    let csv = folder.csv("d.csv");
    assert!(!csv.names.iter().any(|n| n == "distance_sigma"), "there is no sigma without noise");
    assert_eq!(bits(&bias), bits(&csv.numbers("distance_bias")));
}

#[test]
fn the_largest_distance_leaves_the_nearer_ones_alone() {
    let folder = folder();
    folder.done(&format!("{DISTANCE} all.csv"));
    folder.done(&format!("{DISTANCE} some.csv --largest 0.35"));
    let (all, some) = (folder.csv("all.csv"), folder.csv("some.csv"));
    let (every, near, status) = (all.numbers("distance"), some.numbers("distance"), some.words("status"));
    let mut outside = 0;
    for i in 0..60 {
        if every[i].abs() > 0.35 {
            assert!(near[i].is_nan() && some.numbers("foot_x")[i].is_nan() && status[i] == "outside", "{i}");
            outside += 1;
        } else {
            assert_eq!((every[i].to_bits(), status[i]), (near[i].to_bits(), "ok"), "{i}");
        }
    }
    assert_eq!(outside, 20);
    let report = folder.report(&format!("{DISTANCE} some.csv --largest 0.35"));
    assert_eq!(report["distance"]["answered"], 40);
}

#[test]
fn the_tolerance_decides_how_near_the_foot_is() {
    let folder = folder();
    let feet = |tolerance: &str| {
        folder.done(&format!("{DISTANCE} d.csv --tolerance {tolerance}"));
        folder.csv("d.csv").numbers("foot_x")
    };
    let (rough, fine, finer) = (feet("1e-2"), feet("1e-9"), feet("1e-11"));
    let most = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most(&rough, &finer) > 1e-5, "{}", most(&rough, &finer));
    assert!(most(&fine, &finer) < 1e-7, "{}", most(&fine, &finer));
}

#[test]
fn colours_tell_distances() {
    let folder = folder();
    let colours = |name: &str, options: &str| -> (Vec<[u8; 3]>, Vec<f64>) {
        folder.done(&format!("{DISTANCE} {name} {options}"));
        let table = folder.table(name);
        let column = |name: &str| match &table.column(name).unwrap().data {
            Data::U8(bytes) => bytes.clone(),
            other => panic!("{name}: {other:?}"),
        };
        let [r, g, b] = ["red", "green", "blue"].map(column);
        ((0..r.len()).map(|i| [r[i], g[i], b[i]]).collect(), numbers_of(&table, "distance"))
    };
    let (signed, distances) = colours("s.ply", "--colours=0.2");
    for i in 0..60 {
        let [red, _, blue] = signed[i];
        // Blue is inside, red is outside, and both are dark at the ends.
        assert_eq!(distances[i] > 0.0, red > blue, "{i}: {:?} at {}", signed[i], distances[i]);
    }
    let [inside, outside] = [0, 5].map(|i| signed[i]);
    assert!(inside[2] > inside[0] + 50 && outside[0] > outside[2] + 50, "{inside:?} {outside:?}");
    // Beyond the limit all are alike; without it, they are not.
    assert_eq!(signed[4], signed[5]);
    let (robust, _) = colours("r.ply", "--colours");
    assert_ne!(robust[4], robust[5]);
    let (unsigned, distances) = colours("u.ply", "--colours=1 --drop normals");
    let brightness = |i: usize| unsigned[i].map(u32::from).iter().sum::<u32>();
    assert!(distances[2] < distances[4] && brightness(2) < brightness(4), "{unsigned:?}");
    // What has no distance has a colour that no distance has.
    assert_eq!(signed[60], unsigned[60]);
    assert!(!signed[..60].contains(&signed[60]) && !unsigned[..60].contains(&signed[60]));
    for (options, range) in [("--colours=0.2", [-0.2, 0.2]), ("--colours=0.2 --drop normals", [0.0, 0.2])] {
        let report = folder.report(&format!("{DISTANCE} c.ply {options}"));
        assert_eq!(report["distance"]["colour_range"], serde_json::json!(range), "{options}");
    }
    assert_eq!(folder.report(&format!("{DISTANCE} c.ply"))["distance"].get("colour_range"), None);
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (low, part) = (place as usize, place.fract());
    sorted[low] + part * (sorted[(low + 1).min(sorted.len() - 1)] - sorted[low])
}

#[test]
fn the_report_is_that_of_the_column() {
    let folder = folder();
    let report = folder.report(&format!("{DISTANCE} d.csv --noise 0.01 --colours"));
    let found = &report["distance"];
    let keys: Vec<&str> = found.as_object().unwrap().keys().map(String::as_str).collect();
    let wanted = "answered colour_range histogram largest mean mean_bias median median_magnitude median_sigma \
                  quantiles rms share_beyond_two_sigma signed smallest standard_deviation walked";
    assert_eq!(keys, wanted.split_whitespace().collect::<Vec<_>>());
    let csv = folder.csv("d.csv");
    let mut d: Vec<f64> = csv.numbers("distance").into_iter().filter(|d| d.is_finite()).collect();
    let sigma = csv.numbers("distance_sigma");
    let beyond = (0..60).filter(|&i| d[i].abs() > 2.0 * sigma[i]).count();
    d.sort_by(f64::total_cmp);
    let mean = d.iter().sum::<f64>() / 60.0;
    let squares = d.iter().map(|d| d * d).sum::<f64>() / 60.0;
    for (key, value) in [
        ("answered", 60.0),
        ("mean", mean),
        ("rms", squares.sqrt()),
        ("standard_deviation", (squares - mean * mean).sqrt()),
        ("median", quantile(&d, 0.5)),
        ("smallest", d[0]),
        ("largest", d[59]),
        ("share_beyond_two_sigma", beyond as f64 / 60.0),
    ] {
        let told = found[key].as_f64().unwrap();
        assert!((told - value).abs() < 1e-12 * (1.0 + value.abs()), "{key}: {told} for {value}");
    }
    let percent: Vec<u64> =
        found["quantiles"].as_array().unwrap().iter().map(|q| q["percent"].as_u64().unwrap()).collect();
    assert_eq!(percent, [1, 5, 25, 75, 95, 99]);
    let upper = found["quantiles"][4]["value"].as_f64().unwrap();
    assert!((upper - quantile(&d, 0.95)).abs() < 1e-12);
    let histogram = &found["histogram"];
    let count = |value: &Value| value.as_u64().unwrap();
    let counts: Vec<u64> = histogram["counts"].as_array().unwrap().iter().map(count).collect();
    assert_eq!(counts.len(), 21);
    assert_eq!(counts.iter().sum::<u64>() + count(&histogram["below"]) + count(&histogram["above"]), 60);
    assert_eq!(found["colour_range"][1], histogram["high"]);
    assert_eq!(report["points"], 61);

    let said = folder.done(&format!("{DISTANCE} d.csv --noise 0.01")).stderr;
    for part in [
        "distance: 60 ok, 1 invalid",
        "signed by the cloud's normals",
        "quantiles: 1 %",
        "beyond 2 sigma",
        "█",
    ] {
        assert!(said.contains(part), "{part} in {said}");
    }
    assert_eq!(
        said.lines().filter(|line| line.contains('█')).count(),
        counts.iter().filter(|&&c| c > 0).count()
    );
}

#[test]
fn a_report_replays_to_the_same_bytes() {
    let folder = folder();
    let options = "--noise 0.01 --registration 0.02 --query-noise accuracy --largest 0.35 --radius 0.2 --tolerance 1e-8";
    let first = folder.report(&format!("{DISTANCE} first.csv {options}"));
    folder.write("report.json", first.to_string());
    folder.report(&format!("{DISTANCE} second.csv --definition report.json"));
    assert_eq!(folder.bytes("first.csv"), folder.bytes("second.csv"));
    let third = folder
        .report(&format!("{DISTANCE} third.csv --definition report.json --query-noise 0.5 --largest 9"));
    assert_eq!((&third["query_noise"], &third["query_noise_column"]), (&Value::from(0.5), &Value::Null));
    assert_eq!((&third["largest_distance"], &third["registration"]), (&Value::from(9.0), &Value::from(0.02)));
    // Distances are orthogonal whatever the projection was that is replayed.
    let basic = folder.report("project q.csv --onto cloud.csv -o p.csv --operator basic --radius 0.2");
    folder.write("basic.json", basic.to_string());
    let again = folder.report(&format!("{DISTANCE} again.csv --definition basic.json"));
    assert_eq!(again["project"]["operator"], "orthogonal");
    folder.done(&format!("{DISTANCE} direct.csv --radius 0.2"));
    assert_eq!(folder.bytes("again.csv"), folder.bytes("direct.csv"));
}

#[test]
fn threads_and_strictness() {
    let folder = folder();
    folder.done(&format!("{DISTANCE} one.csv --threads 1 --noise 0.01"));
    folder.done(&format!("{DISTANCE} two.csv --threads 2 --noise 0.01"));
    assert_eq!(folder.bytes("one.csv"), folder.bytes("two.csv"));
    assert_eq!(folder.run(&format!("{DISTANCE} s.csv --strict")).code, 1);
    assert_eq!(folder.run(&format!("{DISTANCE} s.csv --strict=2%")).code, 0);
    assert_eq!(folder.run(&format!("{DISTANCE} s.csv --strict=2% --largest 0.35")).code, 1);
}

#[test]
fn what_makes_no_sense_is_named() {
    let folder = folder();
    folder.write("flat.csv", "x,y\n0,0\n1,0\n0,1\n");
    folder.write("there.csv", "kept");
    for (words, problem) in [
        ("distance q.csv -o o.csv", "--to"),
        ("distance q.csv --to cloud.csv", "--output"),
        ("distance none.csv --to cloud.csv -o o.csv", "none.csv"),
        ("distance q.csv --to none.csv -o o.csv", "none.csv"),
        ("distance q.csv --to cloud.csv -o o.xxx", "no format to write"),
        ("distance q.csv --to cloud.csv -o there.csv", "exists already"),
        ("distance q.csv --to flat.csv -o o.csv", "must agree"),
        ("distance q.csv --to cloud.csv -o o.csv --largest 0", "above 0"),
        ("distance q.csv --to cloud.csv -o o.csv --largest -1", "above 0"),
        ("distance q.csv --to cloud.csv -o o.csv --colours=0", "above 0"),
        ("distance q.csv --to cloud.csv -o o.csv --tolerance 0", "above 0"),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --registration 0.1",
            "needs the noise of the samples",
        ),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --query-noise 0.1",
            "needs the noise of the samples",
        ),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --noise 1 --registration -1",
            "finite and not negative",
        ),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --noise 1 --registration nan",
            "finite and not negative",
        ),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --noise 1 --query-noise nothing",
            "no column of numbers named `nothing`",
        ),
        (
            "distance q.csv --to cloud.csv -o o.csv --compare points --noise 1 --query-noise -1",
            "q.csv: noise of point 0",
        ),
        ("distance q.csv --to cloud.csv -o o.csv --operator basic", "--operator"),
        ("distance q.csv --to cloud.csv -o o.csv --registration -1", "finite and not negative"),
        ("distance q.csv --to cloud.csv -o o.csv --compare lines", "--compare"),
        ("distance q.csv --to cloud.csv -o o.csv --noise 1", "belongs to --compare points"),
        ("distance q.csv --to cloud.csv -o o.csv --query-noise auto", "belongs to --compare points"),
        ("distance q.csv --to cloud.csv -o o.csv --degree auto", "belongs to --compare points"),
    ] {
        let ran = folder.run(words);
        assert_eq!(ran.code, 2, "{words}: {}", ran.stderr);
        assert!(ran.stderr.contains(problem), "{words}: {}", ran.stderr);
        assert!(!folder.path("o.csv").exists(), "{words}");
    }
    assert_eq!(folder.text("there.csv"), "kept");
}
