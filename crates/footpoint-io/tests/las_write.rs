//! LAS and LAZ files that we wrote: every column reads back, in the same format where the table was LAS.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::{Path, PathBuf};

use common::{Sample, bits, extremes, f64_table, names, numbers, parse, real_files};
use footpoint_io::{
    Bounds, Column, Data, Format, Frame, Kept, Overwrite, ReadOptions, Table, Unit, WriteOptions,
    check_table, check_writable, read, read_with, write,
};

fn options() -> WriteOptions {
    WriteOptions { overwrite: Overwrite::Replace, ..WriteOptions::default() }
}

fn written(path: &Path, table: &Table) -> Table {
    write(path, table, &options()).unwrap();
    let input = read(path).unwrap();
    let mut notes = input.report.notes;
    // Broken keys are kept as they are.
    notes.retain(|note| !note.contains("GeoTIFF keys"));
    assert!(notes.is_empty(), "{}: {notes:?}", path.display());
    input.table
}

fn assert_same(found: &Table, wanted: &Table, what: &str) {
    assert_eq!(names(found), names(wanted), "{what}");
    for (found, wanted) in found.columns.iter().zip(&wanted.columns) {
        assert_eq!(std::mem::discriminant(&found.data), std::mem::discriminant(&wanted.data), "{what}");
        assert!(bits(&found.data) == bits(&wanted.data), "{what}: column {} differs", found.name);
    }
    assert_eq!(found.frame, wanted.frame, "{what}");
}

/// The real files of LAS, LAZ and COPC.
fn files(data: &Path) -> Vec<PathBuf> {
    let folders = ["las", "copc", "photo", "malformed"].map(|folder| data.join(folder).read_dir().unwrap());
    let paths = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
    let is_las = |path: &PathBuf| path.extension().is_some_and(|e| e == "las" || e == "laz");
    // The largest takes long to pack and is like the others.
    paths.filter(is_las).filter(|path| !path.ends_with("autzen_south6.laz") && read(path).is_ok()).collect()
}

#[test]
fn every_column_of_every_file_survives() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    let files = files(&data);
    assert!(files.len() > 40);
    for file in files {
        let what = file.display().to_string();
        let first = read(&file).unwrap().table;
        // What is broken in a file is mended by writing; from then on nothing may change.
        let las = written(&folder.path().join("a.las"), &first);
        assert_same(&las, &first, &what);
        let again = written(&folder.path().join("b.las"), &las);
        assert!(
            bytes(&folder, "a.las") == bytes(&folder, "b.las"),
            "{what}: {}",
            first_difference(&bytes(&folder, "a.las"), &bytes(&folder, "b.las"))
        );
        let laz = written(&folder.path().join("a.laz"), &again);
        assert_same(&laz, &first, &what);
        assert_same(&written(&folder.path().join("c.las"), &laz), &first, &what);
        assert!(
            bytes(&folder, "c.las") == bytes(&folder, "a.las"),
            "{what}: {}",
            first_difference(&bytes(&folder, "a.las"), &bytes(&folder, "c.las"))
        );
    }
}

fn first_difference(a: &[u8], b: &[u8]) -> String {
    let at = a.iter().zip(b).position(|(a, b)| a != b);
    format!("{} and {} bytes, first difference at {at:?}", a.len(), b.len())
}

fn bytes(folder: &tempfile::TempDir, name: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(name)).unwrap()
}

/// The bytes of an unpacked file from `at` on.
fn at<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes[at..at + N].try_into().unwrap()
}

#[test]
fn point_format_grid_header_and_records_stay() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    for file in [
        "laspy_1_4_w_evlr.las",
        "laspy_extrabytes.las",
        "pdal_4_6_crop.las",
        "perm_1.0_1.las",
        "laspy_simple1_1.las",
    ] {
        let old = std::fs::read(data.join("las").join(file)).unwrap();
        let path = folder.path().join(file);
        written(&path, &read(&data.join("las").join(file)).unwrap().table);
        let new = std::fs::read(&path).unwrap();
        // Up to the day: identifier, encoding, GUID, version, system, software, date, header size.
        assert_eq!(new[..96], old[..96], "{file}");
        // Format and length of the points, then scales and offsets.
        assert_eq!(new[104..107], old[104..107], "{file}");
        assert_eq!(new[131..179], old[131..179], "{file}");
        let [start, old_start] = [&new, &old].map(|bytes| u32::from_le_bytes(at(bytes, 96)) as usize);
        let length = usize::from(u16::from_le_bytes(at(&new, 105)));
        let points = read(&path).unwrap().table.rows() * length;
        // The very points, integer by integer.
        assert!(new[start..start + points] == old[old_start..old_start + points], "{file}");
        if file == "laspy_1_4_w_evlr.las" {
            let [evlr, old_evlr] = [&new, &old].map(|bytes| u64::from_le_bytes(at(bytes, 235)) as usize);
            assert_eq!(new[evlr..], old[old_evlr..], "{file}");
        }
    }
}

#[test]
fn copc_becomes_laz_without_its_octree() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    let table = read(&data.join("copc/1.2-with-color.copc.laz")).unwrap().table;
    let path = folder.path().join("a.laz");
    written(&path, &table);
    assert_eq!(read(&path).unwrap().format, Format::Laz);
    let bytes = std::fs::read(&path).unwrap();
    assert!(!bytes.windows(5).any(|window| window == b"copc\0"));
    let refused = check_writable(&folder.path().join("b.copc.laz"), Overwrite::Refuse).unwrap_err();
    assert!(refused.to_string().contains("COPC files are read, but not written"), "{refused}");
}

#[test]
fn new_columns_become_extra_bytes_of_their_own_type() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    for file in [
        "las/laspy_simple.laz",
        "las/laspy_extra.laz",
        "malformed/laspy_append-bug.laz",
        "las/laspy_fullwave.laz",
    ] {
        let mut table = read(&data.join(file)).unwrap().table;
        let rows = table.rows();
        table.set(Column::new("distance", Data::F64((0..rows).map(|i| i as f64 / 3.0).collect())));
        table.set(Column::new("nx", Data::F32((0..rows).map(|i| i as f32 / 7.0).collect())));
        table.set(Column::new("status", Data::U8((0..rows).map(|i| i as u8).collect())));
        table.set(Column::new("wide", Data::I64((0..rows).map(|i| i64::MIN + i as i64).collect())));
        let back = written(&folder.path().join("a.laz"), &table);
        assert_same(&back, &table, file);
        assert_eq!(back.column("wide"), table.column("wide"));
    }
}

#[test]
fn a_part_of_the_points_stays_on_its_grid() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    let bounds = Bounds { low: [636_000.0, 849_000.0, 0.0], high: [637_000.0, 851_000.0, 600.0] };
    let part =
        read_with(&data.join("las/laspy_simple.laz"), &ReadOptions { within: Some(bounds), watch: None });
    let table = part.unwrap().table;
    let path = folder.path().join("a.las");
    assert_same(&written(&path, &table), &table, "part");
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(f64::from_le_bytes(at(&bytes, 131)), 0.01);
    assert_eq!(
        f64::from_le_bytes(at(&bytes, 187)),
        numbers(&table, "x").into_iter().fold(f64::INFINITY, f64::min)
    );
}

#[test]
fn moved_points_get_a_finer_grid() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut table = read(&data.join("las/laspy_simple.laz")).unwrap().table;
    let moved: Vec<f64> = numbers(&table, "x").iter().map(|x| x + 1.0 / 3.0).collect();
    table.set(Column::new("x", Data::F64(moved.clone())));
    let path = folder.path().join("a.las");
    let back = written(&path, &table);
    let extent = 3400.0;
    let worst = numbers(&back, "x").iter().zip(&moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst > 0.0 && worst < 5e-9 * extent, "{worst}");
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(f64::from_le_bytes(at(&bytes, 139)), 0.01, "y did not move");
}

#[test]
fn a_table_of_another_format() {
    let folder = tempfile::tempdir().unwrap();
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
                property uchar blue\nproperty int label\nproperty float intensity\nend_header\n\
                0.5 -2 7 0 0 1 255 0 1 -70000 0.25\n1.25 3 1e3 0 1 0 1 2 3 5 300\n";
    let mut table = parse("a.ply", text).table;
    for name in ["a.las", "a.laz"] {
        let back = written(&folder.path().join(name), &table);
        for same in ["x", "y", "z", "nx", "ny", "nz", "label"] {
            assert_eq!(numbers(&back, same), numbers(&table, same), "{same}");
        }
        assert!(matches!(back.column("nx").unwrap().data, Data::F32(_)));
        assert_eq!(back.column("red").unwrap().data, Data::U16(vec![65_535, 257]));
        // 0.25 is no intensity of LAS, which counts in integers.
        assert_eq!(back.column("intensity").unwrap().data, Data::U16(vec![0, 0]));
        assert_eq!(back.column("intensity_1").unwrap().data, Data::F32(vec![0.25, 300.0]));
        assert_eq!(back.column("return_number").unwrap().data, Data::U8(vec![1, 1]));
    }
    // Point formats by columns and reference system.
    let format = |table: &Table| {
        let path = folder.path().join("b.las");
        write(&path, table, &options()).unwrap();
        std::fs::read(&path).unwrap()[104]
    };
    assert_eq!(format(&table), 7);
    table.set(Column::new("nir", Data::U16(vec![1, 2])));
    assert_eq!(format(&table), 8);
    table.frame = Frame { crs: Some("EPSG:25832".into()), unit: Some(Unit::Metre) };
    assert_eq!(format(&table), 2);
    assert_eq!(read(&folder.path().join("b.las")).unwrap().table.frame, table.frame);
    table.set(Column::new("gps_time", Data::F64(vec![1.5, 2.5])));
    assert_eq!(format(&table), 3);
    table.frame = Frame { crs: Some("LOCAL_CS[\"a\",UNIT[\"foot\",0.3048]]".into()), unit: Some(Unit::Foot) };
    assert_eq!(format(&table), 8);
    assert_eq!(read(&folder.path().join("b.las")).unwrap().table.frame, table.frame);
    // A file that was LAS gets the system that its table says.
    let mut moved = read(&folder.path().join("b.las")).unwrap().table;
    moved.frame = Frame { crs: Some("LOCAL_CS[\"b\",UNIT[\"metre\",1]]".into()), unit: Some(Unit::Metre) };
    assert_eq!(written(&folder.path().join("c.las"), &moved).frame, moved.frame);
    assert_eq!(format(&f64_table(&[("x", &[0.0]), ("y", &[0.0])])), 6);
}

#[test]
fn a_file_that_gets_colours_gets_a_point_format_with_colours() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (file, format) in
        [("las/perm_1.0_1.las", 3), ("las/laspy_1_4_w_evlr.las", 7), ("las/laspy_simple1_3.las", 5)]
    {
        let mut table = read(&data.join(file)).unwrap().table;
        for name in ["red", "green", "blue"] {
            table.set(Column::new(name, Data::U8(vec![7; table.rows()])));
        }
        let path = folder.path().join("a.las");
        write(&path, &table, &options()).unwrap();
        assert_eq!(std::fs::read(&path).unwrap()[104], format, "{file}");
        assert_eq!(numbers(&read(&path).unwrap().table, "blue"), vec![1799.0; table.rows()]);
    }
}

#[test]
fn the_grid_is_the_coarsest_that_loses_nothing() {
    let scale = |values: &[f64]| {
        let sample = Sample::new("a.las", "");
        let table = f64_table(&[("x", values), ("y", values)]);
        let back = written(&sample.path, &table);
        let worst = numbers(&back, "x").iter().zip(values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert_eq!(numbers(&back, "z"), vec![0.0; values.len()]);
        (f64::from_le_bytes(at(&std::fs::read(&sample.path).unwrap(), 131)), worst)
    };
    assert_eq!(scale(&[0.0, 5.0, -7.0]), (1.0, 0.0));
    assert_eq!(scale(&[0.01, 636_001.25]).0, 0.01);
    assert_eq!(scale(&[4_918_340.001, 4_918_341.0]).0, 0.001);
    let (fine, worst) = scale(&[1.0 / 3.0, 100.0]);
    assert!(fine == 1e-7 && worst < 5e-9 * 100.0, "{fine} {worst}");
    assert_eq!(scale(&[2.5; 3]), (0.1, 0.0));
    assert_eq!(scale(&[1e12, -1e12, 0.3]).0, 1e3);
    assert_eq!(scale(&[0.1 + 0.2]).1, 0.0);
    assert_eq!(scale(&[]).1, 0.0);
}

#[test]
fn what_las_cannot_hold_is_refused() {
    let path = Path::new("a.las");
    let refused = |table: &Table| check_table(path, table).unwrap_err().to_string();
    let mut table = f64_table(&[("x", &[1.0, f64::NAN]), ("y", &[0.0, 0.0])]);
    assert!(refused(&table).contains("column `x`, row 2: NaN is no coordinate"), "{}", refused(&table));
    table.set(Column::new("x", Data::F64(vec![0.0; 2])));
    check_table(path, &table).unwrap();
    table.set(Column::new("who", Data::Text(vec![String::new(); 2])));
    assert!(refused(&table).contains("column `who` holds text"));
    table.columns.pop();
    table.set(Column::new("n".repeat(33), Data::U8(vec![0; 2])));
    assert!(refused(&table).contains("longer than the 32 bytes"));
    table.columns.pop();
    (0..342).for_each(|i| table.set(Column::new(format!("c{i}"), Data::U8(vec![0; 2]))));
    assert!(refused(&table).contains("too many for LAS"));
    assert!(refused(&f64_table(&[("x", &[1.0])])).contains("no column `y`"));
}

#[test]
fn numbers_of_every_type_survive() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = extremes();
    for name in ["x", "y"] {
        let old = table.column(name).unwrap().data.clone();
        table.set(Column::new(format!("{name}_old"), old));
        table.set(Column::new(name, Data::F64(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])));
    }
    table.set(Column::new("h", Data::I64(vec![i64::MIN, i64::MAX, 0, 1, -1, 2])));
    table.set(Column::new("i", Data::U64(vec![u64::MIN, u64::MAX, 0, 1, 2, 3])));
    let back = written(&folder.path().join("a.laz"), &table);
    for column in &table.columns {
        let found = &back.column(&column.name).unwrap().data;
        assert_eq!(std::mem::discriminant(found), std::mem::discriminant(&column.data), "{}", column.name);
        assert_eq!(bits(found), bits(&column.data), "{}", column.name);
    }
    assert_eq!(back.column("i"), table.column("i"));
    assert!(matches!(back.kept, Some(Kept::Las(_))));
}

#[test]
fn points_that_pack_to_almost_nothing_are_read() {
    let sample = Sample::new("a.laz", "");
    let rows: Vec<f64> = (0..300_000).map(f64::from).collect();
    let table = f64_table(&[("x", &rows), ("y", &vec![0.0; rows.len()])]);
    assert_eq!(numbers(&written(&sample.path, &table), "x"), rows);
    assert!(sample.path.metadata().unwrap().len() < 30 * 300_000 / 300);
}

#[test]
fn units_of_wkt() {
    let geographic =
        "GEOGCS[\"WGS 84\",DATUM[\"d\",SPHEROID[\"s\",1,2]],UNIT[\"degree\",0.0174532925199433]]";
    let projected = |unit: &str| format!("PROJCS[\"a, [b]\",{geographic},PARAMETER[\"p\",1],UNIT[{unit}]]");
    let axes = "PROJCRS[\"p\",BASEGEOGCRS[\"g\",DATUM[\"d\",ELLIPSOID[\"e\",1,2,LENGTHUNIT[\"metre\",1]]]],\
                CONVERSION[\"c\",PARAMETER[\"x\",0,LENGTHUNIT[\"metre\",1]]],CS[Cartesian,2],\
                AXIS[\"e\",east,LENGTHUNIT[\"US survey foot\",0.304800609601219]]]";
    for (wkt, unit) in [
        (geographic.to_owned(), Some(Unit::Degree)),
        (projected("\"metre\",1"), Some(Unit::Metre)),
        (projected("\"foot\",0.3048"), Some(Unit::Foot)),
        (projected("\"US foot\",0.3048006"), Some(Unit::UsSurveyFoot)),
        (projected("\"chain\",20.1168"), None),
        (
            format!("COMPD_CS[\"c\",{},VERT_CS[\"v\",UNIT[\"m\",1]]]", projected("\"ft\",0.3048")),
            Some(Unit::Foot),
        ),
        (
            "GEOGCRS[\"g\",CS[ellipsoidal,2],AXIS[\"lat\",north],ANGLEUNIT[\"degree\",0.0174]]".into(),
            Some(Unit::Degree),
        ),
        (axes.to_owned(), Some(Unit::UsSurveyFoot)),
        ("VERT_CS[\"v\",UNIT[\"m\",1]]".into(), None),
        ("no system [at all".into(), None),
    ] {
        let sample = Sample::new("a.las", "");
        let mut table = f64_table(&[("x", &[0.0]), ("y", &[0.0])]);
        table.frame.crs = Some(wkt.clone());
        assert_eq!(written(&sample.path, &table).frame, Frame { crs: Some(wkt.clone()), unit }, "{wkt}");
    }
}
