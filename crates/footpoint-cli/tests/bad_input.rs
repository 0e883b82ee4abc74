//! Input that cannot be used ends with exit code 2, one clear message that names the file, and no file left behind.

mod common;

use common::{Folder, csv_of, shared, sphere_csv};

/// Runs words that must fail with one message that holds all these fragments, and must leave the folder as it was.
fn refuse(folder: &Folder, words: &str, fragments: &[&str]) {
    let before = folder.listing();
    let ran = folder.run(words);
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{words}: {}", ran.stderr);
    let message = ran.stderr.strip_prefix("footpoint: ").unwrap_or_else(|| panic!("{words}: {}", ran.stderr));
    assert_eq!(message.trim_end().lines().count(), 1, "{words}: one message, not {message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "{words}: no `{fragment}` in {message}");
    }
    // What Rust prints for its own types is no language for users.
    for debug in ["Some(", "Err(", "Error {", "{ ", "kind:", "CentredCovariance", "AveragedNormals"] {
        assert!(!message.contains(debug), "{words}: `{debug}` in {message}");
    }
    assert_eq!(folder.listing(), before, "{words} left something behind");
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("sphere.csv", sphere_csv(500));
    folder.write("bare.csv", "x,y,z,label\n0,0,0,a\n1,0,0,b\n0,1,0,c\n1,1,0,d\n0.5,0.5,0.1,e\n");
    folder.write("flat.csv", "x,y\n0,0\n1,0\n2,0.1\n");
    folder
}

#[test]
fn files_that_are_absent_or_empty() {
    let folder = folder();
    folder.write("empty.xyz", "");
    folder.write("empty.ply", "");
    folder.write("words.txt", "once upon a time\nthere was a cloud\n");
    folder.write("header.csv", "x,y,z\n");
    folder.write(
        "none.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
    );
    folder.write("noxyz.csv", "a,b,c\n1,2,3\n");
    std::fs::create_dir(folder.path("dir.ply")).unwrap();
    for (file, fragments) in [
        ("missing.ply", vec!["cannot read", "No such file"]),
        ("missing/cloud.xyz", vec!["cannot read"]),
        ("empty.xyz", vec!["is empty"]),
        ("empty.ply", vec!["is empty"]),
        ("dir.ply", vec!["is a folder", "name a file"]),
        ("words.txt", vec!["no row of numbers"]),
        ("header.csv", vec!["no points"]),
        ("none.ply", vec!["no points"]),
        ("noxyz.csv", vec!["no column `x`", "a, b, c"]),
    ] {
        let named: Vec<&str> = [file].into_iter().chain(fragments).collect();
        for verb in ["normals", "project"] {
            refuse(&folder, &format!("{verb} {file} -o out.csv"), &named);
        }
        refuse(&folder, &format!("evaluate {file} --at sphere.csv -o out.csv"), &named);
        refuse(&folder, &format!("project sphere.csv --onto {file} -o out.csv"), &named);
        if !["none.ply", "header.csv"].contains(&file) {
            refuse(&folder, &format!("evaluate sphere.csv --at {file} -o out.csv"), &named);
            refuse(&folder, &format!("info {file}"), &named);
        }
    }
}

#[test]
fn clouds_without_a_surface() {
    let folder = folder();
    folder.write("one.csv", "x,y,z\n1,2,3\n");
    folder.write("same.csv", "x,y,z\n".to_owned() + &"1,2,3\n".repeat(7));
    folder.write("nan.csv", "x,y,z\n1,nan,3\n1,inf,3\n");
    refuse(&folder, "normals one.csv -o out.csv", &["one.csv", "coincide", "give a radius"]);
    refuse(&folder, "project same.csv -o out.csv", &["same.csv", "all 7 usable samples coincide"]);
    refuse(&folder, "normals same.csv -o out.csv --per-sample 8", &["same.csv", "coincide"]);
    refuse(&folder, "normals nan.csv -o out.csv", &["nan.csv", "no usable sample among 2"]);
    // With a radius the answer is a status for each point.
    for (file, count) in [("one.csv", 1), ("same.csv", 7)] {
        let ran = folder.done(&format!("normals {file} -o out.csv --force --radius 1"));
        assert!(ran.stderr.contains(&format!("normals: {count} degenerate")), "{}", ran.stderr);
        assert_eq!(folder.csv("out.csv").words("status"), vec!["degenerate"; count]);
    }
    // `info` says what stands against a surface, and what it can.
    let ran = folder.run("info same.csv");
    assert_eq!((ran.code, ran.stderr.as_str()), (0, ""));
    assert!(ran.stdout.contains("exact repeats: 6") && ran.stdout.contains("coincide"), "{}", ran.stdout);
}

#[test]
fn numbers_that_are_none() {
    let folder = folder();
    let rows = footpoint::samples::sphere(1.0, 300, 4).points.into_iter().enumerate().map(|(i, p)| {
        let [x, y, z] = p;
        match i {
            10 => vec![f64::NAN, y, z],
            20 => vec![x, f64::INFINITY, z],
            30 => vec![x, y, f64::NEG_INFINITY],
            _ => vec![x, y, z],
        }
    });
    folder.write("holes.csv", csv_of("x,y,z", rows));
    for (verb, kind) in [("normals", "csv"), ("project", "csv"), ("normals", "ply")] {
        let words = format!("{verb} holes.csv -o out.{kind} --force");
        let ran = folder.done(&words);
        assert!(ran.stderr.contains("3 points not finite"), "{}", ran.stderr);
        assert!(ran.stderr.contains("297 ok, 3 invalid"), "{}", ran.stderr);
        if kind == "csv" {
            let (before, after) = (folder.csv("holes.csv"), folder.csv("out.csv"));
            let invalid: Vec<usize> = (0..300).filter(|&i| after.words("status")[i] == "invalid").collect();
            assert_eq!(invalid, [10, 20, 30], "{verb}");
            let kept = |i: usize| ["x", "y", "z"].map(|axis| before.words(axis)[i].to_lowercase());
            for i in invalid {
                assert_eq!(["x", "y", "z"].map(|axis| after.words(axis)[i].to_owned()), kept(i), "{verb}");
                assert_eq!(after.words("surface_normal_x")[i], "nan");
            }
        }
    }
    let report = folder.report("normals holes.csv -o out.csv --force");
    assert_eq!(
        (&report["inputs"][0]["not_finite"], &report["surface"]["samples_absent"]),
        (&3.into(), &3.into())
    );
}

#[test]
fn options_that_make_no_sense() {
    let folder = folder();
    for (option, fragments) in [
        ("--radius=-1", vec!["sphere.csv", "support radius -1", "positive"]),
        ("--radius 0", vec!["sphere.csv", "support radius 0", "positive"]),
        ("--radius nan", vec!["sphere.csv", "radius NaN", "positive"]),
        ("--radius inf", vec!["sphere.csv", "radius inf", "finite"]),
        ("--auto 0", vec!["0 effective neighbours", "between 1 and"]),
        ("--per-sample nan", vec!["NaN effective neighbours"]),
        ("--domain-ratio 0", vec!["domain ratio 0", "above 0"]),
        ("--domain-ratio 1.5", vec!["domain ratio 1.5", "at most 1"]),
        ("--weight gaussian --cut 0", vec!["cut 0", "between"]),
        ("--weight gaussian --cut nan", vec!["cut NaN"]),
        ("--cut 1e-6", vec!["--cut", "--weight gaussian"]),
        ("--accept-gap nan", vec!["acceptance", "NaN"]),
        ("--support-column reach", vec!["sphere.csv", "`reach`", "x y z nx ny nz"]),
        ("--factor-column area", vec!["sphere.csv", "`area`", "x y z nx ny nz"]),
        ("--support-column nx", vec!["sphere.csv", "must be positive"]),
        ("--definition missing.json", vec!["missing.json", "No such file"]),
        ("--definition sphere.csv", vec!["sphere.csv", "not a report to replay"]),
        ("--definition empty.json", vec!["empty.json", "not a report to replay"]),
        ("--definition other.json", vec!["other.json", "footpoint-report/9", "footpoint-report/1"]),
        ("--definition broken.json", vec!["broken.json", "not a report to replay", "poly9"]),
    ] {
        folder.write("empty.json", "{}");
        folder.write("other.json", r#"{"schema": "footpoint-report/9", "definition": {}}"#);
        folder.write("broken.json", r#"{"schema": "footpoint-report/1", "definition": {"weight": "poly9"}}"#);
        refuse(&folder, &format!("normals sphere.csv -o out.csv {option}"), &fragments);
    }
    refuse(&folder, "normals bare.csv -o out.csv --field averaged", &["bare.csv", "needs normals"]);
    refuse(&folder, "project bare.csv -o out.csv --field axes", &["bare.csv", "needs normals"]);
    refuse(&folder, "normals bare.csv -o out.csv --support-column label", &["bare.csv", "`label`"]);
    refuse(&folder, "evaluate sphere.csv --at flat.csv -o out.csv", &["sphere.csv", "flat.csv", "agree"]);
    refuse(&folder, "project flat.csv --onto sphere.csv -o out.csv", &["2-D", "3-D", "agree"]);
    // A demo of nothing does not even make its folder.
    for plan in ["--rays 0", "--range-noise=-0.1", "--range-noise nan", "--range-noise inf"] {
        refuse(&folder, &format!("demo -o demo {plan}"), &[]);
    }
}

#[test]
fn a_support_without_neighbours_gives_statuses() {
    let folder = folder();
    let report = folder.report("normals sphere.csv -o out.csv --radius 1e-9");
    assert_eq!(report["statuses"][0]["status"], "degenerate");
    assert_eq!(report["statuses"][0]["points"], 500);
    // Work that came to nothing is counted all the same.
    let report = folder.report("project sphere.csv -o out.csv --force --accept-gap 2");
    assert_eq!(report["statuses"][0]["status"], "degenerate");
    assert!(report["moved"]["mean_evaluations"].as_f64().unwrap() >= 1.0, "{report}");
    folder.write("far.csv", "x,y,z\n5,5,5\n");
    for verb in ["evaluate sphere.csv --at far.csv", "project far.csv --onto sphere.csv"] {
        let report = folder.report(&format!("{verb} -o out.csv --force"));
        assert_eq!(report["statuses"][0]["status"], "outside", "{verb}");
    }
    assert_eq!(folder.csv("out.csv").points::<3>(), [[5.0; 3]], "it stays where it was");
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = folder();
    folder.write("there.csv", "mine");
    std::fs::create_dir(folder.path("dir.csv")).unwrap();
    for (output, fragments) in [
        ("nowhere/out.csv", vec!["nowhere", "does not exist"]),
        ("dir.csv", vec!["dir.csv", "is a folder"]),
        ("there.csv", vec!["there.csv", "exists already", "--force"]),
        ("out.doc", vec!["out.doc", "ply las laz"]),
        ("out", vec!["out", "ply las laz"]),
        ("there.csv/out.csv", vec!["there.csv"]),
    ] {
        for verb in ["normals sphere.csv", "project sphere.csv", "evaluate sphere.csv --at sphere.csv"] {
            refuse(&folder, &format!("{verb} -o {output}"), &fragments);
        }
    }
    refuse(&folder, "normals sphere.csv -o dir.csv --force", &["is a folder"]);
    refuse(&folder, "demo --rays 100 -o there.csv", &["there.csv"]);
    refuse(&folder, "normals bare.csv -o out.ply", &["out.ply", "`label` holds text"]);
    assert_eq!(folder.text("there.csv"), "mine");
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_write_protected() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let locked = folder.path("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        println!("skipped: this user may write anywhere");
        return;
    }
    refuse(&folder, "normals sphere.csv -o locked/out.csv", &["locked/out.csv", "cannot write here"]);
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Broken files of the shared folder that give no points at all, and what is said of them.
const REFUSED: [(&str, &str); 9] = [
    ("cut.laz", "the table of packed chunks"),
    ("cut.e57", "cut"),
    ("corrupt_crc.e57", ""),
    ("rs_corrupt_compressed.pcd", ""),
    ("cut_binary_be.ply", "want"),
    ("huge_count.ply", "want"),
    ("unknown_type.ply", ""),
    ("pdal_no_vertex.obj", ""),
    ("pdal_badheader.txt", ""),
];

#[test]
fn malformed_files_are_refused_by_name_or_read_with_a_note() {
    let Some(data) = shared("data/malformed") else { return };
    let (mut refused, mut read) = (Vec::new(), 0);
    let mut entries: Vec<_> = std::fs::read_dir(data).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let folder = folder();
        let name = folder.copy(&path);
        let ran = folder.run(&format!("info {name}"));
        if ran.code == 2 {
            assert!(ran.stdout.is_empty() && ran.stderr.contains(&name), "{name}: {ran:?}");
            refuse(&folder, &format!("normals {name} -o out.csv"), &[&name]);
            refuse(&folder, &format!("evaluate sphere.csv --at {name} -o out.csv"), &[&name]);
            refused.push((name, ran.stderr));
        } else {
            assert_eq!(ran.code, 0, "{name}: {ran:?}");
            read += 1;
        }
    }
    assert!(refused.len() >= REFUSED.len() && read > 0, "{} refused, {read} read", refused.len());
    for (name, words) in REFUSED {
        let found = refused.iter().find(|(file, _)| file == name);
        assert!(found.is_some_and(|(_, said)| said.contains(words)), "{name}: {found:?}");
    }
}

#[test]
fn points_that_a_file_states_and_does_not_hold_are_told_and_are_not_strict() {
    let folder = Folder::new();
    folder.write("cut.pts", "4\n0 0 0\n1 0 0\n0 1 0\n");
    let ran = folder.run("info cut.pts");
    assert_eq!(ran.code, 0);
    assert!(ran.stdout.contains("1 point missing: the file states more"), "{}", ran.stdout);
    let strict = folder.run("info cut.pts --strict=100%");
    assert_eq!(strict.code, 1, "{strict:?}");
    assert!(strict.stderr.contains("strict: cut.pts: 1 point missing"), "{strict:?}");
}
