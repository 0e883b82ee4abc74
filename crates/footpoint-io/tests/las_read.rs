//! LAS, LAZ and COPC files read as the independent readers of the manifest read them.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;

use common::{names, numbers, real_files};
use footpoint_io::{Bounds, Data, Format, Frame, ReadOptions, ReadProblem, Unit, Watch, read, read_with};
use serde_json::Value;

/// All LAS files of the manifest that load, with their entries.
fn loading(data: &Path) -> Vec<(String, Value)> {
    let text = std::fs::read_to_string(data.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let files = manifest["files"].as_array().unwrap().iter();
    let files = files.map(|entry| (entry["file"].as_str().unwrap().to_owned(), entry.clone()));
    let is_las = |file: &str| file.ends_with(".las") || file.ends_with(".laz");
    files.filter(|(file, entry)| is_las(file) && entry["loads"] == true).collect()
}

fn floats(entry: &Value, key: &str) -> Vec<f64> {
    entry[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn counts_bounds_and_fields_agree_with_the_manifest() {
    let Some(data) = real_files() else { return };
    let files = loading(&data);
    assert!(files.len() > 40);
    for (file, entry) in files {
        let input = read(&data.join(&file)).unwrap();
        assert_eq!(Some(input.table.rows() as u64), entry["points"].as_u64(), "{file}");
        // laspy gives the integers X Y Z, and arrays of extra bytes as one field.
        let mut found = names(&input.table);
        found.retain(|name| {
            !name.starts_with("Colors_") && !name.starts_with("Reserved_") && !name.starts_with("Flags_")
        });
        let arrays = ["Colors", "Reserved", "Flags"];
        let wanted = entry["fields"].as_array().unwrap().iter().map(|name| match name.as_str().unwrap() {
            "X" => "x",
            "Y" => "y",
            "Z" => "z",
            name => name,
        });
        let wanted: Vec<&str> = wanted.filter(|name| !arrays.contains(name)).collect();
        assert_eq!(found, wanted, "{file}");
        if input.table.rows() == 0 {
            continue;
        }
        let (least, most) = (floats(&entry, "min"), floats(&entry, "max"));
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let values = numbers(&input.table, name);
            assert_eq!(values.iter().copied().fold(f64::INFINITY, f64::min), least[axis], "{file} {name}");
            assert_eq!(values.iter().copied().fold(f64::NEG_INFINITY, f64::max), most[axis], "{file} {name}");
        }
    }
}

#[test]
fn each_column_has_its_own_type() {
    let Some(data) = real_files() else { return };
    let table = read(&data.join("las/laspy_extrabytes.las")).unwrap().table;
    let kind = |name: &str| std::mem::discriminant(&table.column(name).unwrap().data);
    let same = |name: &str, data: Data| assert_eq!(kind(name), std::mem::discriminant(&data), "{name}");
    same("x", Data::F64(Vec::new()));
    same("intensity", Data::U16(Vec::new()));
    same("scan_angle_rank", Data::I8(Vec::new()));
    same("gps_time", Data::F64(Vec::new()));
    same("Colors_0", Data::U16(Vec::new()));
    same("Colors_2", Data::U16(Vec::new()));
    same("Flags_1", Data::I8(Vec::new()));
    same("Intensity", Data::U32(Vec::new()));
    same("Time", Data::U64(Vec::new()));
    let table = read(&data.join("las/laspy_fullwave.laz")).unwrap().table;
    assert!(matches!(table.column("scan_angle").unwrap().data, Data::I16(_)));
    assert!(matches!(table.column("wavepacket_offset").unwrap().data, Data::U64(_)));
    assert!(matches!(table.column("x_t").unwrap().data, Data::F32(_)));
}

#[test]
fn formats_systems_and_units_are_told() {
    let Some(data) = real_files() else { return };
    for (file, format, crs, unit) in [
        ("las/laspy_autzen_trim.laz", Format::Laz, "PROJCS[\"NAD_1983_HARN_Lambert", Some(Unit::Foot)),
        ("las/las-rs_32-1-472-150-76.laz", Format::Laz, "EPSG:25832", Some(Unit::Metre)),
        ("las/pdal_test_utm17.las", Format::Las, "EPSG:32617", Some(Unit::Metre)),
        ("las/pdal_4_6_crop.las", Format::Las, "EPSG:2903", Some(Unit::UsSurveyFoot)),
        ("las/laspy_1_4_w_evlr.laz", Format::Laz, "PROJCS[\"NAD83(HARN)", Some(Unit::UsSurveyFoot)),
        ("malformed/pdal_spurious.las", Format::Las, "EPSG:4326", Some(Unit::Degree)),
        ("copc/lone-star.copc.laz", Format::Copc, "GEOCCS[", Some(Unit::Metre)),
    ] {
        let input = read(&data.join(file)).unwrap();
        assert_eq!(input.format, format, "{file}");
        let frame = &input.table.frame;
        assert!(frame.crs.as_ref().unwrap().starts_with(crs), "{file}: {frame:?}");
        assert_eq!(frame.unit, unit, "{file}");
        assert!(input.report.notes.is_empty(), "{file}: {:?}", input.report.notes);
    }
    let frame = read(&data.join("las/cgal_pig_points.las")).unwrap().table.frame;
    assert_eq!(frame, Frame::default());
}

/// Keeps what it is told and stops after so many words.
struct Words {
    said: Mutex<Vec<(u64, u64)>>,
    most: usize,
}

impl Words {
    fn new(most: usize) -> Self {
        Self { said: Mutex::default(), most }
    }
}

impl Watch for Words {
    fn at(&self, done: u64, all: u64) -> ControlFlow<()> {
        let mut said = self.said.lock().unwrap();
        said.push((done, all));
        if said.len() < self.most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

#[test]
fn a_box_of_a_copc_file_reads_few_points_and_gives_those_inside() {
    let Some(data) = real_files() else { return };
    for (file, low, high) in [
        ("copc/lone-star.copc.laz", [515_370.0, 4_918_345.0, 2300.0], [515_374.0, 4_918_350.0, 2400.0]),
        ("copc/1.2-with-color.copc.laz", [636_000.0, 849_000.0, 0.0], [637_000.0, 851_000.0, 600.0]),
        ("copc/simple_with_page.copc.laz", [636_000.0, 849_000.0, 0.0], [637_000.0, 851_000.0, 600.0]),
    ] {
        let bounds = Bounds { low, high };
        let words = Words::new(usize::MAX);
        let options = ReadOptions { within: Some(bounds), watch: Some(&words) };
        let part = read_with(&data.join(file), &options).unwrap();
        assert!(part.report.notes.is_empty(), "{:?}", part.report);
        let whole = read(&data.join(file)).unwrap();
        let [x, y, z] = ["x", "y", "z"].map(|name| numbers(&whole.table, name));
        let inside: Vec<usize> = (0..x.len()).filter(|&i| bounds.contains([x[i], y[i], z[i]])).collect();
        assert!(!inside.is_empty() && inside.len() < x.len() / 2, "{file}: {}", inside.len());
        for column in &whole.table.columns {
            let (all, found) = (column.data.to_f64().unwrap(), numbers(&part.table, &column.name));
            let wanted: Vec<f64> = inside.iter().map(|&i| all[i]).collect();
            assert_eq!(found, wanted, "{file} {}", column.name);
        }
        let (done, all) = *words.said.lock().unwrap().last().unwrap();
        assert_eq!(done, all);
        println!("{file}: {} of {} points inside, {all} unpacked", inside.len(), x.len());
        assert!(all < x.len() as u64 || file != "copc/lone-star.copc.laz", "all points were unpacked");
    }
}

#[test]
fn a_box_of_other_files_gives_the_points_inside() {
    let Some(data) = real_files() else { return };
    for file in ["las/laspy_simple.laz", "las/pdal_4_6_crop.las"] {
        let whole = read(&data.join(file)).unwrap().table;
        let [x, y, z] = ["x", "y", "z"].map(|name| numbers(&whole, name));
        let bounds = Bounds { low: [x[0] - 500.0, y[0] - 500.0, -1e9], high: [x[0], y[0], 1e9] };
        let inside = (0..x.len()).filter(|&i| bounds.contains([x[i], y[i], z[i]])).count();
        let part = read_with(&data.join(file), &ReadOptions { within: Some(bounds), watch: None }).unwrap();
        assert_eq!(part.table.rows(), inside, "{file}");
        assert!(inside > 0 && inside < x.len(), "{file}");
    }
}

#[test]
fn the_watch_hears_of_the_points_and_may_stop() {
    let Some(data) = real_files() else { return };
    let file = data.join("las/ahn3_cropped_2.laz");
    let words = Words::new(usize::MAX);
    read_with(&file, &ReadOptions { within: None, watch: Some(&words) }).unwrap();
    let said = words.said.into_inner().unwrap();
    assert!(said.is_sorted() && said.len() == 4 && said.last() == Some(&(208_432, 208_432)), "{said:?}");
    for file in [file, data.join("las/pdal_4_6_crop.las"), data.join("copc/lone-star.copc.laz")] {
        let once = Words::new(1);
        let stopped = read_with(&file, &ReadOptions { within: None, watch: Some(&once) }).unwrap_err();
        assert!(matches!(*stopped.problem, ReadProblem::Stopped), "{stopped}");
    }
}
