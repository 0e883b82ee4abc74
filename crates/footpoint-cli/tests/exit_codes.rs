//! The exit code is 0 for done, 1 for more points not ok than `--strict` allows, 2 for nothing done.

mod common;

use common::{Folder, csv_of};
use footpoint::samples::sphere;

/// A sphere of 990 samples with ten lonely ones: 1 % have no surface.
fn folder() -> Folder {
    let folder = Folder::new();
    let lonely = (0..10).map(|i| vec![50.0 + 20.0 * f64::from(i), 0.0, 0.0]);
    let rows = sphere(1.0, 990, 2).points.into_iter().map(Vec::from).chain(lonely);
    folder.write("cloud.csv", csv_of("x,y,z", rows));
    folder
}

#[test]
fn strictness() {
    let folder = folder();
    let mut outputs = Vec::new();
    for verb in ["normals", "project"] {
        for (option, code) in [
            ("", 0),
            ("--strict", 1),
            ("--strict 0", 1),
            ("--strict=0.9%", 1),
            ("--strict 0.009", 1),
            ("--strict 1%", 0),
            ("--strict=1.1%", 0),
            ("--strict 100%", 0),
        ] {
            let ran = folder.run(&format!("{verb} cloud.csv -o out.csv --force {option}"));
            assert_eq!((ran.code, ran.stdout.as_str()), (code, ""), "{verb} {option}: {}", ran.stderr);
            assert_eq!(ran.stderr.contains("strict: 10 of 1000 points not ok"), code == 1, "{option}");
            assert!(ran.stderr.contains("990 ok, 10 degenerate"), "{}", ran.stderr);
            outputs.push((verb, folder.bytes("out.csv")));
        }
    }
    assert!(outputs.chunk_by(|a, b| a.0 == b.0).all(|same| same.iter().all(|o| *o == same[0])));
    for share in ["2", "-1%", "x", "nan", "101%", "%"] {
        let ran = folder.run(&format!("normals cloud.csv -o out.csv --force --strict={share}"));
        assert_eq!(ran.code, 2, "{share}");
    }
    let quiet = folder.run("normals cloud.csv -o out.csv --force --quiet --strict");
    assert_eq!(quiet.code, 1);
}

#[test]
fn an_existing_file_is_kept_unless_forced() {
    let folder = folder();
    folder.write("out.csv", "mine");
    let ran = folder.run("normals cloud.csv -o out.csv");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    assert!(ran.stderr.contains("out.csv: exists already") && ran.stderr.contains("--force"), "{ran:?}");
    assert_eq!(folder.text("out.csv"), "mine");
    folder.done("normals cloud.csv -o out.csv --force");
    assert_eq!(folder.csv("out.csv").len(), 1000);
    // A cloud may replace itself: it has been read before.
    folder.done("normals cloud.csv -o cloud.csv --force");
    assert_eq!(folder.bytes("cloud.csv"), folder.bytes("out.csv"));
}

#[test]
fn wrong_usage() {
    let folder = folder();
    let before = folder.listing();
    for words in [
        "",
        "nirmals cloud.csv -o out.csv",
        "normals",
        "normals cloud.csv",
        "normals cloud.csv -o out.csv --radios 1",
        "normals cloud.csv -o out.csv --radius one",
        "normals cloud.csv -o out.csv --radius 1 --auto 16",
        "normals cloud.csv -o out.csv --weight poly5",
        "normals cloud.csv -o out.csv --threads=-1",
        "normals cloud.csv -o out.csv --cut 1e-6",
        "evaluate cloud.csv -o out.csv",
        "evaluate cloud.csv --at cloud.csv -o out.csv --with everything",
        "project cloud.csv -o out.csv --operator sideways",
        "project cloud.csv -o out.csv --tolerance 0",
        "project cloud.csv -o out.csv --tolerance -1e-6",
        "project cloud.csv -o out.csv --tolerance nan",
        "demo --rays x",
    ] {
        let ran = folder.run(words);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{words}");
        assert!(!ran.stderr.trim().is_empty(), "{words} without a word");
    }
    assert_eq!(folder.listing(), before);
}

#[test]
fn help_and_version_are_results() {
    let folder = Folder::new();
    for words in ["--help", "--version", "help normals", "project --help", "demo -h"] {
        let ran = folder.run(words);
        assert_eq!((ran.code, ran.stderr.as_str()), (0, ""), "{words}");
        assert!(ran.stdout.contains("footpoint"), "{words}: {}", ran.stdout);
    }
}
