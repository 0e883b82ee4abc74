//! Every E57 and PCD file of the manifest: count, bounds and fields as an independent reader found them, or a reason.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::Path;
use std::time::{Duration, Instant};

use common::real_files;
use footpoint_io::{Input, Kept, Table, read};
use serde_json::Value;

/// What becomes of the files that the manifest's readers did not load: refused with these words, or read.
const REFUSED: [(&str, &str); 8] = [
    ("malformed/corrupt_crc.e57", "invalid checksum"),
    ("malformed/cut.e57", "the header states 34816 bytes, found 20000"),
    ("malformed/cut_compressed.pcd", "the compressed block wants 88844 bytes, found 49817"),
    ("malformed/pdal_missingheader.pcd", "line 1: not a line of a PCD header"),
    (
        "malformed/rs_corrupt_compressed.pcd",
        "the compressed block unpacks to 200 bytes, but 3 points want 36",
    ),
    ("pcd/rs_header_only_compressed.pcd", "the compressed block wants 8 bytes, found 0"),
    ("pcd/rs_v05_binary_compressed.pcd", "the compressed block wants 8 bytes, found 0"),
    ("pcd/rs_v06_binary_compressed.pcd", "the compressed block wants 8 bytes, found 0"),
];

/// The entries for E57 and PCD files.
fn entries(data: &Path) -> Vec<(String, Value)> {
    let text = std::fs::read_to_string(data.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let files = manifest["files"].as_array().unwrap().iter();
    let named = files.map(|entry| (entry["file"].as_str().unwrap().to_owned(), entry.clone()));
    named.filter(|(file, _)| file.ends_with(".e57") || file.ends_with(".pcd")).collect()
}

/// The coordinates as the file has them: each scan in its own frame, invalid points as stated.
fn own_frame(table: &Table) -> Vec<[f64; 3]> {
    let axis = |name: &str| {
        let find = |name: &str| table.columns.iter().find(|c| c.name.eq_ignore_ascii_case(name));
        // The columns of a field of several values; the manifest has the first.
        find(name).or_else(|| find(&format!("{name}_0"))).unwrap().data.to_f64().unwrap()
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    let mut points: Vec<[f64; 3]> = (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect();
    let Some(Kept::E57(kept)) = &table.kept else { return points };
    let mut rows = points.iter_mut();
    for scan in kept.scans() {
        for point in rows.by_ref().take(scan.rows) {
            *point = scan.pose.map_or(*point, |pose| pose.undo(*point));
        }
    }
    for (row, stated) in kept.stated() {
        points[*row] = *stated;
    }
    points
}

fn corner(entry: &Value, key: &str) -> Vec<f64> {
    entry[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// The columns that a field of the manifest is.
fn columns_of(field: &str) -> Vec<&str> {
    match field {
        "cartesianX" | "sphericalRange" => vec!["x"],
        "cartesianY" | "sphericalAzimuth" => vec!["y"],
        "cartesianZ" | "sphericalElevation" => vec!["z"],
        "cartesianInvalidState" | "sphericalInvalidState" => vec!["invalid_state"],
        "colorRed" => vec!["red"],
        "colorGreen" => vec!["green"],
        "colorBlue" => vec!["blue"],
        "rowIndex" => vec!["row_index"],
        "columnIndex" => vec!["column_index"],
        "returnIndex" => vec!["return_index"],
        "returnCount" => vec!["return_count"],
        "las:pointSourceId" => vec!["pointSourceId"],
        "nor:normalX" => vec!["nx"],
        "nor:normalY" => vec!["ny"],
        "nor:normalZ" => vec!["nz"],
        "rgb" => vec!["red", "green", "blue"],
        "_" => vec![],
        plain => vec![plain],
    }
}

fn check_fields(file: &str, entry: &Value, input: &Input) {
    let fields: Vec<&str> = match entry["scan_headers"].as_array() {
        Some(scans) => scans[0]["fields"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect(),
        None => entry["pcd_fields"].as_str().unwrap().split(' ').collect(),
    };
    let mut wanted: Vec<&str> = fields.iter().flat_map(|field| columns_of(field)).collect();
    let mut found: Vec<&str> = input.table.columns.iter().map(|column| column.name.as_str()).collect();
    // Not fields of the file, but of what it packs: alpha, and three values under one name.
    found.retain(|name| *name != "alpha");
    if file.ends_with("rs_dump_ascii_untyped.pcd") {
        wanted = vec!["x", "y_0", "y_1", "y_2", "z"];
    }
    if file.ends_with(".e57") {
        wanted.sort_unstable();
        found.sort_unstable();
    }
    assert_eq!(found, wanted, "{file}");
}

#[test]
fn counts_bounds_and_fields_agree() {
    let Some(data) = real_files() else { return };
    let mut agreed = 0;
    for (file, entry) in entries(&data) {
        if entry["loads"] != true {
            continue;
        }
        let input = read(&data.join(&file)).unwrap();
        let points = own_frame(&input.table);
        assert_eq!(Some(points.len() as u64), entry["points"].as_u64(), "{file}");
        check_fields(&file, &entry, &input);
        agreed += 1;
        // Its counts are zero, and the manifest's reader then took x for all three.
        if entry.get("min").is_none() || file == "pcd/rs_count_zero.pcd" {
            continue;
        }
        let single = file.ends_with(".pcd");
        // Of ascii numbers, the manifest has some in more digits than their fields have.
        let rounded = |value: f64| if single { f64::from(value as f32) } else { value };
        for (axis, (least, most)) in corner(&entry, "min").into_iter().zip(corner(&entry, "max")).enumerate()
        {
            let along = || points.iter().map(|point| point[axis]).filter(|c| c.is_finite());
            let (low, high) =
                (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
            let tolerance = if file == "e57/tiny_spherical.e57" { 1e-15 } else { 0.0 };
            assert!((low - rounded(least)).abs() <= tolerance, "{file}: {low} {least}");
            assert!((high - rounded(most)).abs() <= tolerance, "{file}: {high} {most}");
        }
    }
    assert!(agreed >= 50, "only {agreed}");
    println!("{agreed} files agree");
}

#[test]
fn the_others_are_read_or_refused_with_a_reason() {
    let Some(data) = real_files() else { return };
    for (file, entry) in entries(&data) {
        let start = Instant::now();
        let result = read(&data.join(&file));
        assert!(start.elapsed() < Duration::from_secs(5), "{file} is slow");
        match (result, REFUSED.iter().find(|(refused, _)| *refused == file)) {
            (Err(error), Some((_, reason))) => {
                let message = error.to_string();
                assert!(message.contains(reason), "wanted `{reason}` in: {message}");
            }
            (Ok(_), None) => {}
            (result, _) => {
                panic!("{file} (loads: {}): {:?}", entry["loads"], result.map(|input| input.report))
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_noted() {
    let Some(data) = real_files() else { return };
    let notes = |file: &str| read(&data.join(file)).unwrap().report.notes;
    for (file, wanted) in [
        ("e57/tiny_pc_and_images.e57", &["4 images were passed over"][..]),
        (
            "malformed/cut_ascii.pcd",
            &[
                "row 248 is cut: its last value and what is missing are NaN",
                "POINTS says 397, the file has 248 rows",
            ],
        ),
        (
            "malformed/huge_width.pcd",
            &["POINTS is 13704, WIDTH x HEIGHT is 4000000000 x 1; POINTS was taken"],
        ),
        (
            "malformed/points_ne_width_height.pcd",
            &[
                "POINTS is 999, WIDTH x HEIGHT is 397 x 1; POINTS was taken",
                "POINTS says 999, the file has 397 rows",
            ],
        ),
        ("malformed/rs_unsupported_v04.pcd", &["PCD version `.4` is unknown; read like 0.7"]),
        (
            "pcd/rs_unknown_entries.pcd",
            &["header line `SENSOR_ORIGIN` was passed over", "header line `CUSTOM_FIELD` was passed over"],
        ),
        ("pcd/table_scene_mug_stereo_textured.pcd", &[]),
        ("e57/las2e57_ColourRepresentation.e57", &[]),
    ] {
        assert_eq!(notes(file), wanted, "{file}");
    }
}
