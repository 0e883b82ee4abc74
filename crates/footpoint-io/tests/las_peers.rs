//! laspy reads what we write, with the same values.
//!
//! Python with `laspy` and `lazrs` is `python3`, or what FOOTPOINT_PYTHON names; without them the test skips.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::Path;
use std::process::Command;

use common::{numbers, parse, real_files};
use footpoint_io::{Column, Data, Overwrite, Table, WriteOptions, read, write};
use serde_json::Value;

fn python() -> Option<String> {
    let python = std::env::var("FOOTPOINT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import laspy, lazrs"]).output();
    if has.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    println!("skipped: no python with laspy and lazrs");
    None
}

/// What laspy says of a file.
fn laspy(python: &str, path: &Path) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/las.py");
    let output = Command::new(python).arg(script).arg(path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn assert_agrees(python: &str, table: &Table, name: &str) {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["las", "laz"] {
        let path = folder.path().join("a").with_extension(extension);
        let options = WriteOptions { overwrite: Overwrite::Replace, ..WriteOptions::default() };
        write(&path, table, &options).unwrap();
        let found = laspy(python, &path);
        assert_eq!(found["points"].as_u64(), Some(table.rows() as u64), "{name}");
        // Where the table was LAS, its columns are all that there is.
        let back = read(&path).unwrap().table;
        assert_eq!(found["columns"].as_object().unwrap().len(), back.columns.len(), "{name}");
        for column in &back.columns {
            let values = found["columns"][&column.name].as_array();
            let values = values.unwrap_or_else(|| panic!("{name}: laspy has no {}", column.name));
            let values: Vec<f64> = values.iter().map(|value| value.as_f64().unwrap()).collect();
            assert!(values == numbers(&back, &column.name), "{name}.{extension}: {}", column.name);
        }
        for (axis, column) in ["x", "y", "z"].into_iter().enumerate() {
            let values = numbers(&back, column);
            let (low, high) = (found["min"][axis].as_f64(), found["max"][axis].as_f64());
            assert_eq!(low, values.iter().copied().reduce(f64::min), "{name}");
            assert_eq!(high, values.iter().copied().reduce(f64::max), "{name}");
        }
    }
}

#[test]
fn laspy_reads_the_same() {
    let Some(python) = python() else { return };
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n\
                property float nx\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                property int label\nproperty float intensity\nend_header\n\
                0.5 -2 7 0 255 0 1 -70000 0.25\n1.25 3 1e3 1 1 2 3 5 300\n";
    assert_agrees(&python, &parse("a.ply", text).table, "ply");
    let Some(data) = real_files() else { return };
    for file in [
        "las/laspy_simple.laz",
        "las/laspy_extrabytes.las",
        "las/laspy_1_4_w_evlr.las",
        "las/laspy_simple1_3.las",
        "las/perm_1.0_1.las",
        "las/laspy_fullwave.laz",
        "las/lidr_dbh.laz",
        "copc/1.2-with-color.copc.laz",
    ] {
        let mut table = read(&data.join(file)).unwrap().table;
        assert_agrees(&python, &table, file);
        let rows = table.rows();
        table.set(Column::new("distance", Data::F64((0..rows).map(|i| i as f64 / 3.0).collect())));
        table.set(Column::new("status", Data::I16((0..rows).map(|i| -(i as i16)).collect())));
        assert_agrees(&python, &table, file);
    }
}
