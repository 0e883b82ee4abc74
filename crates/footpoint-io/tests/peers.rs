//! The readers of others find in our files what we wrote; skipped where they are not installed.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::Path;
use std::process::Command;

use common::{extremes, f64_table, numbers};
use footpoint_io::{Column, Data, Overwrite, PcdEncoding, WriteOptions, write};

/// A Python with the readers of others: `FOOTPOINT_PEERS` names it, or `python3`.
fn python(modules: &str) -> Option<String> {
    let python = std::env::var("FOOTPOINT_PEERS").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python).args(["-c", &format!("import {modules}")]).output();
    if found.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    println!("skipped: no {python} with {modules}");
    None
}

/// What the peer reads of a file: lines of a name and numbers.
fn peer(python: &str, path: &Path) -> Vec<(String, Vec<f64>)> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/columns.py");
    let output = Command::new(python).arg(script).arg(path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let line = |line: &str| {
        let mut words = line.split(' ');
        let name = words.next().unwrap().to_owned();
        (name, words.map(|word| word.parse().unwrap()).collect())
    };
    text.lines().map(line).collect()
}

fn agrees(found: &[(String, Vec<f64>)], name: &str, wanted: &[f64]) {
    let values = &found.iter().find(|(found, _)| found == name).unwrap_or_else(|| panic!("no {name}")).1;
    let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
    assert!(
        values.len() == wanted.len() && values.iter().zip(wanted).all(same),
        "{name} {values:?} {wanted:?}"
    );
}

#[test]
fn pypcd4_reads_what_we_write() {
    let Some(python) = python("pypcd4") else { return };
    let mut table = extremes();
    table.set(Column::new("z", Data::F64(vec![1.0; 6])));
    let folder = tempfile::tempdir().unwrap();
    for pcd in [PcdEncoding::Ascii, PcdEncoding::Binary, PcdEncoding::Compressed] {
        let path = folder.path().join("a.pcd");
        write(&path, &table, &WriteOptions { pcd, overwrite: Overwrite::Replace, ..WriteOptions::default() })
            .unwrap();
        let found = peer(&python, &path);
        assert_eq!(found.len(), table.columns.len());
        for column in &table.columns {
            agrees(&found, &column.name, &numbers(&table, &column.name));
        }
    }
}

#[test]
fn pye57_reads_what_we_write() {
    let Some(python) = python("pye57") else { return };
    let count = 20_000;
    let column = |step: f64| (0..count).map(|i| f64::from(i) * step).collect::<Vec<_>>();
    let mut table = f64_table(&[("x", &column(0.1)), ("y", &column(-1e5)), ("z", &column(1e-9))]);
    let bytes = |by: i32| Data::U8((0..count).map(|i| (i * by) as u8).collect());
    table.set(Column::new("red", bytes(1)));
    table.set(Column::new("green", bytes(3)));
    table.set(Column::new("blue", bytes(5)));
    table.set(Column::new("intensity", Data::F32((0..count).map(|i| i as f32 / 7.0).collect())));
    table.set(Column::new("row_index", Data::I32((0..count).collect())));
    table.set(Column::new("column_index", Data::I32((0..count).rev().collect())));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    let found = peer(&python, &path);
    for (name, ours) in [
        ("cartesianX", "x"),
        ("cartesianY", "y"),
        ("cartesianZ", "z"),
        ("colorRed", "red"),
        ("colorGreen", "green"),
        ("colorBlue", "blue"),
        ("intensity", "intensity"),
        ("rowIndex", "row_index"),
        ("columnIndex", "column_index"),
    ] {
        agrees(&found, name, &numbers(&table, ours));
    }
}
