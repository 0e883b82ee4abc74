//! The readers of others find in our files what we wrote: laspy, pye57, pypcd4, plyfile and numpy.
//!
//! They are those of `python3`, or of the Python that FOOTPOINT_PYTHON names; a test whose reader is absent skips.
//! All of them: `pip install laspy lazrs pye57 pypcd4 plyfile numpy`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::Path;
use std::process::Command;

use common::{extremes, f64_table, numbers, parse, real_files};
use footpoint_io::{Column, Data, Encoding, Overwrite, PcdEncoding, Table, WriteOptions, read, write};
use serde_json::{Value, json};

const REPLACE: WriteOptions =
    WriteOptions { overwrite: Overwrite::Replace, ply: Encoding::Ascii, pcd: PcdEncoding::Ascii };

/// A reader of others: a Python with its modules, and the script that tells what it reads.
struct Peer {
    python: String,
    script: &'static str,
}

impl Peer {
    fn find(script: &'static str, modules: &str) -> Option<Self> {
        let python = std::env::var("FOOTPOINT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let found = Command::new(&python).args(["-c", &format!("import {modules}")]).output();
        if found.is_ok_and(|output| output.status.success()) {
            return Some(Self { python, script });
        }
        println!("skipped: no {python} with {modules}");
        None
    }

    fn read(&self, path: &Path) -> Value {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers").join(self.script);
        // Without -B, Python would leave files of its own among the scripts.
        let output = Command::new(&self.python).arg("-B").arg(script).arg(path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Writes the table and has it read: every column must be found, in its type and with its values, and no other.
    fn agrees(&self, path: &Path, table: &Table, options: &WriteOptions) -> Value {
        write(path, table, options).unwrap();
        let found = self.read(path);
        assert_eq!(found["columns"].as_object().unwrap().len(), table.columns.len());
        for Column { name, data } in &table.columns {
            assert_eq!(found["columns"][name]["type"], type_name(data), "{name}");
            assert_same(&found, name, data);
        }
        found
    }
}

/// The name of a type in NumPy.
fn type_name(data: &Data) -> &'static str {
    match data {
        Data::I8(_) => "i1",
        Data::U8(_) => "u1",
        Data::I16(_) => "i2",
        Data::U16(_) => "u2",
        Data::I32(_) => "i4",
        Data::U32(_) => "u4",
        Data::I64(_) => "i8",
        Data::U64(_) => "u8",
        Data::F32(_) => "f4",
        Data::F64(_) => "f8",
        Data::Text(_) => "text",
    }
}

/// That the column was found with these values: the same integers, or the same floats but for the kind of NaN.
fn assert_same(found: &Value, name: &str, data: &Data) {
    let found = found["columns"][name]["values"].as_array();
    let found = found.unwrap_or_else(|| panic!("{name} was not found"));
    let found: Vec<&str> = found.iter().map(|value| value.as_str().unwrap()).collect();
    let is_same = match data {
        Data::I64(wanted) => wanted.iter().map(i64::to_string).eq(found.iter().copied()),
        Data::U64(wanted) => wanted.iter().map(u64::to_string).eq(found.iter().copied()),
        other => {
            let canonical = |v: f64| if v.is_nan() { f64::NAN.to_bits() } else { v.to_bits() };
            let found = found.iter().map(|value| canonical(value.parse().unwrap()));
            other.to_f64().unwrap().into_iter().map(canonical).eq(found)
        }
    };
    assert!(is_same, "{name}: {found:?} instead of {data:?}");
}

fn assert_laspy_agrees(peer: &Peer, table: &Table, name: &str) {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["las", "laz"] {
        let path = folder.path().join("a").with_extension(extension);
        write(&path, table, &REPLACE).unwrap();
        let found = peer.read(&path);
        assert_eq!(found["points"].as_u64(), Some(table.rows() as u64), "{name}");
        // Where the table was LAS, its columns are all that there is.
        let back = read(&path).unwrap().table;
        assert_eq!(found["columns"].as_object().unwrap().len(), back.columns.len(), "{name}");
        for column in &back.columns {
            assert_same(&found, &column.name, &column.data);
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
fn laspy_reads_what_we_write() {
    let Some(peer) = Peer::find("las.py", "laspy, lazrs") else { return };
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n\
                property float nx\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                property int label\nproperty float intensity\nend_header\n\
                0.5 -2 7 0 255 0 1 -70000 0.25\n1.25 3 1e3 1 1 2 3 5 300\n";
    let mut table = parse("a.ply", text).table;
    table.set(Column::new("least", Data::I64(vec![i64::MIN, i64::MAX])));
    table.set(Column::new("largest", Data::U64(vec![u64::MAX, 0])));
    assert_laspy_agrees(&peer, &table, "ply");
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
        assert_laspy_agrees(&peer, &table, file);
        let rows = table.rows();
        table.set(Column::new("distance", Data::F64((0..rows).map(|i| i as f64 / 3.0).collect())));
        table.set(Column::new("status", Data::I16((0..rows).map(|i| -(i as i16)).collect())));
        assert_laspy_agrees(&peer, &table, file);
    }
}

#[test]
fn pypcd4_reads_what_we_write() {
    let Some(peer) = Peer::find("pcd.py", "pypcd4") else { return };
    let mut table = extremes();
    table.set(Column::new("z", Data::F64(vec![1.0; 6])));
    let folder = tempfile::tempdir().unwrap();
    for pcd in [PcdEncoding::Ascii, PcdEncoding::Binary, PcdEncoding::Compressed] {
        peer.agrees(&folder.path().join("a.pcd"), &table, &WriteOptions { pcd, ..REPLACE });
    }
}

#[test]
fn pye57_reads_what_we_write() {
    let Some(peer) = Peer::find("e57.py", "pye57") else { return };
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
    let found = peer.read(&path);
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
        assert_same(&found, name, &table.column(ours).unwrap().data);
    }
}

#[test]
fn plyfile_reads_what_we_write() {
    let Some(peer) = Peer::find("ply.py", "plyfile") else { return };
    let folder = tempfile::tempdir().unwrap();
    for (ply, is_text, order) in [
        (Encoding::Ascii, true, "="),
        (Encoding::LittleEndian, false, "<"),
        (Encoding::BigEndian, false, ">"),
    ] {
        let found = peer.agrees(&folder.path().join("a.ply"), &extremes(), &WriteOptions { ply, ..REPLACE });
        assert_eq!((&found["text"], &found["order"]), (&json!(is_text), &json!(order)));
        assert_eq!((&found["comments"], &found["obj_info"]), (&json!(["by a test"]), &json!(["grid 2"])));
    }
}

#[test]
fn numpy_reads_what_we_write() {
    let Some(peer) = Peer::find("npy.py", "numpy") else { return };
    let mut table = extremes();
    table.set(Column::new("h", Data::I64(vec![i64::MIN, i64::MAX, 0, 1, -1, 2])));
    table.set(Column::new("i", Data::U64(vec![u64::MIN, u64::MAX, 0, 1, 2, 3])));
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.npy", "a.npz"] {
        peer.agrees(&folder.path().join(name), &table, &REPLACE);
    }
}
