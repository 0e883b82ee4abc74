//! Real files read as the independent readers of the manifest read them, or are refused with a reason.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use common::real_files;
use footpoint_io::roles::Roles;
use footpoint_io::{Data, Input, read};
use serde_json::Value;

/// Files that are refused, and what the message must say.
const REFUSED: [(&str, &str); 19] = [
    ("malformed/cut_ascii.ply", "unexpected end of file in element vertex, row 877 of 1889"),
    ("malformed/cut_binary_be.ply", "its 6789 rows want 108624 bytes, found 99758"),
    ("malformed/huge_count.ply", "its 4000000000000 rows want 48000000000000 bytes, found 100"),
    (
        "malformed/pasture_10_points_ascii_parsing_errors.txt",
        "line 3, column 1 (`x`): `2.0.0` is not a number",
    ),
    ("malformed/pdal_badheader.txt", "line 1: the header names column `X` twice"),
    ("malformed/pdal_no_vertex.obj", "no line `v x y z`, so no points"),
    ("malformed/pdal_no_vertex.ply", "elements found: none"),
    ("malformed/rs_single_elements_err_ascii.ply", "unexpected end of file in element point, row 2 of 2"),
    ("malformed/unknown_type.ply", "line 8: unknown type `quux`"),
    ("ply/rs_all_atomic_types_ok_ascii.ply", "elements found: point"),
    ("ply/rs_exponent_values_ok_ascii.ply", "elements found: point"),
    ("ply/rs_header_min_ok_ascii.ply", "elements found: none"),
    ("ply/rs_leading_spaces_ok_ascii.ply", "elements found: point"),
    ("ply/rs_single_elements_ok_ascii.ply", "elements found: point"),
    ("range/bun.conf", "line 1, column 1 (`x`): `camera` is not a number"),
    ("text/bunny16k_expe.pts", "binary content"),
    ("text/pdal_text.txt", "no row of numbers"),
    // One row of eleven has a fourth value: dropping it, or the row, would lose something in silence.
    ("text/pdal_utm17_3.txt", "line 5: 4 fields, but the header in line 1 names 3 columns"),
    ("photo/outcrop_sfm.laz", "LAS/LAZ files are not supported yet"),
];

const FOLDERS: [&str; 11] =
    ["2d", "cloud", "mesh", "obj", "ply", "range", "photo", "rgbd", "robot", "text", "malformed"];
const OTHER_FORMATS: [&str; 4] = ["pcd", "las", "laz", "e57"];

/// Grids in PTX: the manifest counts lines of matrices as points, and takes cells without a return for points
/// at the origin; so the points (columns times rows of all scans) and those with a return are given here.
const GRIDS: [(&str, usize, usize); 4] = [
    ("text/pdal_1.2-with-color.ptx", 1065, 1065),
    ("text/pdal_complex-transform.ptx", 12, 4),
    ("text/pdal_multiple-and-transform.ptx", 8, 8),
    ("text/pdal_no-color.ptx", 15, 15),
];

/// The wanted files of the manifest with their entries.
fn manifest(data: &Path) -> BTreeMap<String, Value> {
    let text = std::fs::read_to_string(data.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let files = manifest["files"].as_array().unwrap().iter();
    files.map(|entry| (entry["file"].as_str().unwrap().to_owned(), entry.clone())).collect()
}

fn bounds(entry: &Value, key: &str) -> Vec<f64> {
    entry[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn counts_and_bounds_agree_with_the_manifest() {
    let Some(data) = real_files() else { return };
    let mut read_files = 0;
    for (file, entry) in manifest(&data) {
        let (folder, name) = file.split_once('/').unwrap();
        let other = name.rsplit('.').next().is_some_and(|e| OTHER_FORMATS.contains(&e));
        if !FOLDERS.contains(&folder) || other || REFUSED.iter().any(|(refused, _)| *refused == file) {
            continue;
        }
        let input = read(&data.join(&file)).unwrap();
        read_files += 1;
        if let Some((_, cells, returns)) = GRIDS.iter().find(|(grid, ..)| *grid == file) {
            let points = Roles::find(&input.table).unwrap().points::<3>(&input.table).unwrap();
            let found = points.iter().filter(|p| p.iter().all(|c| c.is_finite())).count();
            assert_eq!((points.len(), found), (*cells, *returns), "{file}");
            continue;
        }
        check_fields(&file, &entry, &input);
        // The manifest takes two files with coordinates of whole-number types for files without points.
        let (rows, Some(_)) = (input.table.rows() as u64, entry.get("min")) else {
            assert!(input.table.rows() <= 1, "{file}");
            continue;
        };
        assert_eq!(Some(rows), entry["points"].as_u64(), "{file}");
        let roles = Roles::find(&input.table).unwrap();
        let (least, most) = (bounds(&entry, "min"), bounds(&entry, "max"));
        for (axis, column) in roles.coordinates.iter().enumerate() {
            let values = input.table.columns[*column].data.to_f64().unwrap();
            assert_eq!(values.iter().copied().fold(f64::INFINITY, f64::min), least[axis], "{file} {axis}");
            assert_eq!(values.iter().copied().fold(f64::NEG_INFINITY, f64::max), most[axis], "{file} {axis}");
        }
        // The manifest knows no normals of OBJ files, but counts their lines.
        let normals = match entry.get("vn").and_then(Value::as_u64) {
            Some(lines) => lines == rows && rows > 0,
            None => entry["normals"]["present"].as_bool().unwrap(),
        };
        assert_eq!(roles.normals.is_some(), normals, "{file}: normals");
    }
    println!("{read_files} files agree");
    assert!(read_files > 80);
}

/// The names and types of a PLY file's properties, or the number of a text file's columns.
fn check_fields(file: &str, entry: &Value, input: &Input) {
    let mut columns = input.table.columns.iter();
    let properties = entry.pointer("/fields/vertex").and_then(Value::as_array);
    for property in properties.into_iter().flatten() {
        let words: Vec<&str> = property.as_str().unwrap().split(' ').collect();
        match words.as_slice() {
            ["property", "list", _, _, name] => {
                assert!(input.report.skipped_lists.iter().any(|list| list == name), "{file}");
            }
            ["property", kind, name] => {
                let column = columns.next().unwrap();
                assert_eq!((column.name.as_str(), ply_type(&column.data)), (*name, *kind), "{file}");
            }
            other => panic!("{file}: {other:?}"),
        }
    }
    let widths = entry.get("columns").and_then(Value::as_object);
    let most = widths.and_then(|widths| widths.iter().max_by_key(|(_, lines)| lines.as_u64()));
    if let Some((width, _)) = most {
        assert_eq!(input.table.columns.len().to_string(), *width, "{file}");
    }
    if let Some(extra) = entry.get("extra_vertex_columns").and_then(Value::as_u64) {
        let normals = if input.table.column("nx").is_some() { 3 } else { 0 };
        assert_eq!(input.table.columns.len() as u64, 3 + extra + normals, "{file}");
    }
}

fn ply_type(data: &Data) -> &'static str {
    match data {
        Data::I8(_) => "char",
        Data::U8(_) => "uchar",
        Data::I16(_) => "short",
        Data::U16(_) => "ushort",
        Data::I32(_) => "int",
        Data::U32(_) => "uint",
        Data::F32(_) => "float",
        Data::F64(_) => "double",
        _ => "",
    }
}

#[test]
fn malformed_files_are_refused_with_a_reason() {
    let Some(data) = real_files() else { return };
    for (file, reason) in REFUSED {
        let start = Instant::now();
        let message = read(&data.join(file)).unwrap_err().to_string();
        assert!(message.contains(reason), "wanted `{reason}` in: {message}");
        assert!(start.elapsed() < Duration::from_secs(1), "{file} is slow to refuse");
    }
}

#[test]
fn what_was_passed_over_is_reported() {
    let Some(data) = real_files() else { return };
    let report = read(&data.join("range/bun000.ply")).unwrap().report;
    assert_eq!(
        (report.other_elements[0].name.as_str(), report.other_elements[0].rows),
        ("range_grid", 204_800)
    );
    assert!(report.notes.is_empty(), "{report:?}");
    let report = read(&data.join("text/pdal_bunny_8.pts")).unwrap().report;
    assert_eq!(report.notes[0], "PTS count says 8, file has 9 rows");
}
