//! E57 files of several scans, poses, invalid points and mixed types, made with the crate `e57`.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use common::{Sample, f64_table, names, numbers, paged, parse, refusal, unpaged};
use e57::{
    E57Writer, Extension, Quaternion, Record, RecordDataType, RecordName, RecordValue, Transform, Translation,
};
use footpoint_io::{
    Column, Data, E57Kept, Format, Kept, Table, Unit, WriteOptions, check_table, read, write,
};

fn record(name: RecordName, data_type: RecordDataType) -> Record {
    Record { name, data_type }
}

fn cartesian(kind: &RecordDataType) -> Vec<Record> {
    let names = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
    names.into_iter().map(|name| record(name, kind.clone())).collect()
}

fn doubles<const N: usize>(values: [f64; N]) -> Vec<RecordValue> {
    values.into_iter().map(RecordValue::Double).collect()
}

type Scan = (Vec<Record>, Vec<Vec<RecordValue>>, Option<Transform>);

/// A file of these scans.
fn file(scans: Vec<Scan>) -> Sample {
    let sample = Sample::new("a.e57", b"");
    let mut writer = E57Writer::from_file(&sample.path, "file").unwrap();
    writer.set_coordinate_metadata(Some("EPSG:25832".to_owned()));
    writer
        .register_extension(Extension::new("nor", "http://www.libe57.org/E57_NOR_surface_normals.txt"))
        .unwrap();
    writer.register_extension(Extension::new("las", "urn:las")).unwrap();
    for (number, (prototype, points, pose)) in scans.into_iter().enumerate() {
        let mut scan = writer.add_pointcloud(&format!("scan {number}"), prototype).unwrap();
        scan.set_name(Some(format!("station {number}")));
        scan.set_transform(pose);
        points.into_iter().for_each(|point| scan.add_point(point).unwrap());
        scan.finalize().unwrap();
    }
    writer.finalize().unwrap();
    drop(writer);
    sample
}

fn kept(table: &Table) -> &E57Kept {
    match &table.kept {
        Some(Kept::E57(kept)) => kept,
        other => panic!("{other:?}"),
    }
}

/// A quarter turn about z, then a step of (10, 20, 30).
fn pose() -> Transform {
    let half = std::f64::consts::FRAC_PI_4;
    Transform {
        rotation: Quaternion { w: half.cos(), x: 0.0, y: 0.0, z: half.sin() },
        translation: Translation { x: 10.0, y: 20.0, z: 30.0 },
    }
}

/// Two scans: doubles with a pose and an intensity, singles with a flag.
fn two() -> Sample {
    let mut first = cartesian(&RecordDataType::F64);
    first.push(record(RecordName::Intensity, RecordDataType::U16));
    let second = vec![
        record(RecordName::ReturnIndex, RecordDataType::U8),
        record(RecordName::ReturnCount, RecordDataType::U8),
    ];
    let mut one = doubles([1.0, 2.0, 3.0]);
    one.push(RecordValue::Integer(700));
    let single = |x| RecordValue::Single(x);
    let other = vec![single(4.5), single(5.5), single(6.5), RecordValue::Integer(1), RecordValue::Integer(2)];
    let second = [cartesian(&RecordDataType::F32), second].concat();
    file(vec![(first, vec![one], Some(pose())), (second, vec![other.clone(), other], None)])
}

#[test]
fn scans_stand_in_the_common_frame_and_are_told_apart() {
    let sample = two();
    let input = read(&sample.path).unwrap();
    let table = &input.table;
    assert_eq!(input.format, Format::E57);
    assert_eq!(names(table), ["x", "y", "z", "intensity", "return_index", "return_count", "scan"]);
    let placed = ["x", "y", "z"].map(|name| numbers(table, name)[0]);
    for (found, wanted) in placed.into_iter().zip([8.0, 21.0, 33.0]) {
        assert!((found - wanted).abs() < 1e-14, "{placed:?}");
    }
    assert_eq!(numbers(table, "x")[1..], [4.5, 4.5]);
    assert_eq!(table.column("scan").unwrap().data, Data::U16(vec![0, 1, 1]));
    assert_eq!(table.column("intensity").unwrap().data, Data::U16(vec![700, 0, 0]));
    assert_eq!(
        input.report.notes,
        ["scan 1 has no return_index, return_count; it is 0 there", "scan 2 has no intensity; it is 0 there"]
    );
    assert_eq!((table.frame.crs.as_deref(), table.frame.unit), (Some("EPSG:25832"), Some(Unit::Metre)));
    let scans = kept(table).scans();
    assert_eq!((scans[1].name.as_deref(), scans[1].guid.as_deref()), (Some("station 1"), Some("scan 1")));
    assert_eq!((scans[0].rows, scans[1].rows, scans[1].pose), (1, 2, None));
    let own = scans[0].pose.unwrap().undo(placed);
    assert!(own.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-14), "{own:?}");
}

#[test]
fn what_was_read_is_written_and_read_again() {
    let sample = two();
    let first = read(&sample.path).unwrap().table;
    let path = sample.path.with_file_name("b.e57");
    write(&path, &first, &WriteOptions::default()).unwrap();
    let again = read(&path).unwrap().table;
    assert_eq!(again.columns, first.columns);
    assert_eq!(again.frame, first.frame);
    let (old, new) = (kept(&first).scans(), kept(&again).scans());
    assert_eq!((new.len(), new[1].rows, &new[1].name, &new[1].guid), (2, 2, &old[1].name, &old[1].guid));
    // The points are in the common frame now.
    assert_eq!(new[0].pose, None);

    // Rows of the scans in another order are one scan, whose order is kept.
    let mut mixed = first.clone();
    mixed.set(Column::new("scan", Data::U16(vec![1, 0, 1])));
    let path = sample.path.with_file_name("c.e57");
    write(&path, &mixed, &WriteOptions::default()).unwrap();
    let again = read(&path).unwrap().table;
    assert_eq!(again.columns, mixed.columns);
    assert_eq!(kept(&again).scans().len(), 1);

    // A scan that has lost its points keeps its place.
    let mut rest = first;
    rest.columns.iter_mut().for_each(|column| match &mut column.data {
        Data::F64(values) => drop(values.remove(0)),
        Data::U16(values) => drop(values.remove(0)),
        Data::U8(values) => drop(values.remove(0)),
        other => panic!("{other:?}"),
    });
    let path = sample.path.with_file_name("d.e57");
    write(&path, &rest, &WriteOptions::default()).unwrap();
    assert_eq!(numbers(&read(&path).unwrap().table, "scan"), [1.0, 1.0]);
}

#[test]
fn single_coordinates_stay_single_without_a_pose() {
    let scan = |pose| {
        let values = [0.1, 0.2, 0.3].map(RecordValue::Single).to_vec();
        let table =
            read(&file(vec![(cartesian(&RecordDataType::F32), vec![values], pose)]).path).unwrap().table;
        table.column("x").unwrap().data.clone()
    };
    assert_eq!(scan(None), Data::F32(vec![0.1]));
    assert_eq!(scan(Some(Transform::default())), Data::F32(vec![0.1]));
    let Data::F64(turned) = scan(Some(pose())) else { panic!("singles") };
    assert!((turned[0] - (10.0 - f64::from(0.2_f32))).abs() < 1e-14);
}

#[test]
fn invalid_points_are_no_points_but_stay() {
    let mut prototype = cartesian(&RecordDataType::F64);
    prototype.push(record(RecordName::CartesianInvalidState, RecordDataType::Integer { min: 0, max: 2 }));
    let point = |xyz, state| [doubles(xyz), vec![RecordValue::Integer(state)]].concat();
    let points = vec![point([1.0, 2.0, 3.0], 0), point([0.0, 1.0, 0.0], 1), point([7.0, 8.0, 9.0], 2)];
    let sample = file(vec![(prototype, points, Some(pose()))]);
    let table = read(&sample.path).unwrap().table;
    assert_eq!(table.column("invalid_state").unwrap().data, Data::U8(vec![0, 1, 2]));
    let x = numbers(&table, "x");
    assert!(x[0].is_finite() && x[1].is_nan() && x[2].is_nan(), "{x:?}");
    let stated = kept(&table).stated();
    assert_eq!((stated[0].0, stated[1].0), (1, 2));
    assert!(stated[0].1.iter().zip([-1.0, 0.0, 0.0]).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-15));
    let path = sample.path.with_file_name("b.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    let again = read(&path).unwrap().table;
    assert_eq!(kept(&again).stated(), stated);
    assert_eq!(common::bits(&again.columns[0].data), common::bits(&table.columns[0].data));
}

#[test]
fn points_that_are_not_finite_are_written_as_invalid() {
    let table = f64_table(&[("x", &[1.0, f64::NAN]), ("y", &[1.0, 5.0]), ("z", &[1.0, f64::INFINITY])]);
    let sample = Sample::new("x", b"");
    let path = sample.path.with_file_name("b.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    let again = read(&path).unwrap().table;
    assert_eq!(again.column("invalid_state").unwrap().data, Data::U8(vec![0, 2]));
    for (old, new) in table.columns.iter().zip(&again.columns) {
        assert_eq!(common::bits(&old.data), common::bits(&new.data));
    }
}

#[test]
fn spherical_coordinates_become_cartesian_ones() {
    let angle = RecordDataType::F64;
    let prototype = vec![
        record(RecordName::SphericalAzimuth, angle.clone()),
        record(RecordName::SphericalRange, angle.clone()),
        record(RecordName::SphericalElevation, angle.clone()),
    ];
    let points = vec![doubles([FRAC_PI_2, 2.0, 0.0]), doubles([0.0, 3.0, FRAC_PI_2])];
    let table = read(&file(vec![(prototype.clone(), points, None)]).path).unwrap().table;
    assert_eq!(names(&table), ["x", "y", "z"]);
    for (name, wanted) in [("x", [0.0, 0.0]), ("y", [2.0, 0.0]), ("z", [0.0, 3.0])] {
        let found = numbers(&table, name);
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15), "{name} {found:?}");
    }
    // Beside Cartesian ones they count where those are invalid, and stay.
    let state = record(RecordName::CartesianInvalidState, RecordDataType::Integer { min: 0, max: 2 });
    let both = [cartesian(&angle), vec![state], prototype].concat();
    let point = |state| {
        [doubles([1.0, 1.0, 1.0]), vec![RecordValue::Integer(state)], doubles([FRAC_PI_2, 2.0, 0.0])].concat()
    };
    let table = read(&file(vec![(both, vec![point(0), point(2)], None)]).path).unwrap().table;
    assert_eq!(
        names(&table),
        ["x", "y", "z", "invalid_state", "spherical_azimuth", "spherical_range", "spherical_elevation"]
    );
    assert_eq!((numbers(&table, "y"), numbers(&table, "invalid_state")), (vec![1.0, 2.0], vec![0.0, 0.0]));
}

#[test]
fn types_are_those_that_hold_the_stated_range() {
    let ranges = [
        (0, 255, Data::U8(vec![0])),
        (-128, 127, Data::I8(vec![-128])),
        (0, 256, Data::U16(vec![0])),
        (-1, 200, Data::I16(vec![-1])),
        (0, 70_000, Data::U32(vec![0])),
        (-40_000, 0, Data::I32(vec![-40_000])),
        (0, 1 << 40, Data::U64(vec![0])),
        (-(1 << 40), 0, Data::I64(vec![-(1 << 40)])),
        (7, 7, Data::U8(vec![7])),
    ];
    let mut prototype = cartesian(&RecordDataType::F64);
    let mut values = doubles([0.0; 3]);
    for (index, (min, max, _)) in ranges.iter().enumerate() {
        let name = RecordName::Unknown { namespace: "las".to_owned(), name: format!("n{index}") };
        prototype.push(record(name, RecordDataType::Integer { min: *min, max: *max }));
        values.push(RecordValue::Integer(*min));
    }
    let scaled = RecordDataType::ScaledInteger { min: -100, max: 100, scale: 0.25, offset: 3.0 };
    prototype.push(record(RecordName::Intensity, scaled));
    values.push(RecordValue::ScaledInteger(-5));
    let sample = file(vec![(prototype, vec![values], None)]);
    let table = read(&sample.path).unwrap().table;
    for (column, (_, _, wanted)) in table.columns[3..].iter().zip(&ranges) {
        assert_eq!(column.data, *wanted, "{}", column.name);
    }
    assert_eq!(table.column("intensity").unwrap().data, Data::F64(vec![1.75]));
    // The attributes of an extension go back there.
    let path = sample.path.with_file_name("b.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    assert_eq!(read(&path).unwrap().table.columns, table.columns);
    let again = e57::E57Reader::from_file(&path).unwrap();
    assert!(again.extensions().iter().any(|e| e.namespace == "las" && e.url == "urn:las"));
    let is_las =
        |record: &Record| matches!(&record.name, RecordName::Unknown { namespace, .. } if namespace == "las");
    assert_eq!(again.pointclouds()[0].prototype.iter().filter(|r| is_las(r)).count(), ranges.len());
}

/// A column of each type and of each attribute that has a name of its own.
fn everything() -> Table {
    let mut table = f64_table(&[("x", &[0.1, -0.0]), ("y", &[1e300, 5e-324]), ("z", &[3.0, 4.0])]);
    for (name, data) in [
        ("intensity", Data::F32(vec![0.1, f32::NAN])),
        ("intensity_invalid", Data::U8(vec![0, 1])),
        ("red", Data::U16(vec![0, 65535])),
        ("green", Data::U16(vec![1, 2])),
        ("blue", Data::U16(vec![1, 2])),
        ("color_invalid", Data::U8(vec![0, 1])),
        ("row_index", Data::I32(vec![i32::MIN, i32::MAX])),
        ("column_index", Data::U32(vec![0, u32::MAX])),
        ("return_index", Data::I8(vec![-128, 127])),
        ("return_count", Data::U8(vec![0, 255])),
        ("time_stamp", Data::F64(vec![f64::NAN, 1e-9])),
        ("time_stamp_invalid", Data::U8(vec![1, 0])),
        ("nx", Data::F32(vec![0.0, 1.0])),
        ("ny", Data::F32(vec![0.0, 1.0])),
        ("nz", Data::F32(vec![0.0, 1.0])),
        ("classification", Data::I16(vec![i16::MIN, i16::MAX])),
        ("far", Data::I64(vec![-(1 << 62), (1 << 62) - 1])),
        ("farther", Data::I64(vec![i64::MIN, -1])),
        ("high", Data::I64(vec![0, i64::MAX - 1])),
        ("count", Data::U64(vec![0, i64::MAX as u64])),
        ("scan", Data::U16(vec![3, 1])),
    ] {
        table.set(Column::new(name, data));
    }
    table
}

#[test]
fn all_columns_come_back_in_their_types() {
    let sample = Sample::new("x", b"");
    let path = sample.path.with_file_name("b.e57");
    let table = everything();
    write(&path, &table, &WriteOptions::default()).unwrap();
    let input = read(&path).unwrap();
    assert!(input.report.notes.iter().all(|note| note.starts_with("colours")), "{:?}", input.report);
    assert_eq!(names(&input.table), names(&table));
    for (old, new) in table.columns.iter().zip(&input.table.columns) {
        assert_eq!(std::mem::discriminant(&old.data), std::mem::discriminant(&new.data), "{}", old.name);
        assert_eq!(common::bits(&old.data), common::bits(&new.data), "{}", old.name);
    }
    let written = e57::E57Reader::from_file(&path).unwrap().pointclouds().remove(0);
    assert!(
        written.has_color() && written.has_intensity() && written.has_row_column() && written.has_return()
    );
    let ours =
        |record: &&Record| matches!(&record.name, RecordName::Unknown { namespace, .. } if namespace == "fp");
    assert_eq!(written.prototype.iter().filter(ours).count(), 6);
}

#[test]
fn attributes_that_the_standard_would_refuse_are_extensions() {
    let mut table = f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("z", &[0.0])]);
    table.set(Column::new("red", Data::U8(vec![1])));
    table.set(Column::new("row_index", Data::F32(vec![0.5])));
    table.set(Column::new("return_index", Data::U8(vec![1])));
    table.set(Column::new("invalid_state", Data::U8(vec![3])));
    table.set(Column::new("nx", Data::F32(vec![0.5])));
    let sample = Sample::new("x", b"");
    let path = sample.path.with_file_name("b.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    let written = e57::E57Reader::from_file(&path).unwrap().pointclouds().remove(0);
    let is_extension = |record: &Record| matches!(record.name, RecordName::Unknown { .. });
    assert_eq!(written.prototype.iter().filter(|r| is_extension(r)).count(), 5);
}

#[test]
fn tables_that_do_not_fit_are_refused_before_the_work() {
    let with = |name: &str, data: Data| {
        let mut table = f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("z", &[0.0])]);
        table.set(Column::new(name, data));
        table
    };
    for (table, reason) in [
        (f64_table(&[("x", &[0.0]), ("y", &[0.0])]), "E57 needs columns x, y and z of numbers"),
        (with("t", Data::Text(vec!["a".into()])), "column `t` holds text, which E57 cannot"),
        (with("t", Data::U64(vec![u64::MAX])), "column `t` holds integers beyond what E57 can"),
        (with("t", Data::I64(vec![i64::MAX])), "column `t` holds integers beyond what E57 can"),
        (with("a b", Data::U8(vec![1])), "column name \"a b\" cannot stand"),
        (with("1a", Data::U8(vec![1])), "column name \"1a\" cannot stand"),
        (with("xmlish", Data::U8(vec![1])), "column name \"xmlish\" cannot stand"),
        (with("colorRed", Data::U8(vec![1])), "column name \"colorRed\" cannot stand"),
    ] {
        let message = check_table(Path::new("a.e57"), &table).unwrap_err().to_string();
        assert!(message.contains(reason), "wanted `{reason}` in: {message}");
    }
    let mut wide = f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("z", &[0.0])]);
    (0..1000).for_each(|i| wide.set(Column::new(format!("c{i}"), Data::U8(vec![1]))));
    let message = check_table(Path::new("a.e57"), &wide).unwrap_err().to_string();
    assert!(message.contains("1003 columns, but E57 holds 1000"), "{message}");
}

#[test]
fn strings_cannot_break_the_file() {
    let mut table = f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("z", &[0.0])]);
    let crs = "]]> <a> & \"b\" ]]>";
    table.frame.crs = Some(format!("{crs}\u{1}"));
    let sample = Sample::new("x", b"");
    let path = sample.path.with_file_name("b.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    assert_eq!(read(&path).unwrap().table.frame.crs.as_deref(), Some(crs));
}

#[test]
fn what_is_no_scan_is_refused() {
    assert!(refusal("a.e57", "x").contains("not an E57 file, it does not begin with `ASTM-E57`"));
    assert!(refusal("a.xyz", "ASTM-E57").contains("the header states 24 bytes, found 8"));
    let constant = cartesian(&RecordDataType::Integer { min: 1, max: 1 });
    let mut prototype = constant;
    prototype.push(record(RecordName::Intensity, RecordDataType::U8));
    let points = vec![[1; 4].map(RecordValue::Integer).to_vec()];
    let sample = file(vec![(prototype, points, None)]);
    assert_eq!(numbers(&read(&sample.path).unwrap().table, "x"), [1.0]);
    // Points of no bytes, as many as one likes to state.
    let bytes = std::fs::read(&sample.path).unwrap();
    let lie = |from: &str, to: &str| resealed(&bytes, from, to);
    let none = lie("maximum=\"255\"", "maximum=\"000\"");
    assert!(
        refusal("a.e57", &none).contains("scan 1 states 1 points, but no attribute of them takes a byte")
    );
    let many = lie("recordCount=\"1\"", "recordCount=\"9\"");
    assert!(refusal("a.e57", &many).contains("scan 1, point 2 of 9: "));
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let (name, count) = ("<![CDATA[station 0]]>", "recordCount=\"1\"");
    let old = &text[text.find(name).unwrap()..text.find(count).unwrap() + count.len()];
    let lie_at_length =
        old.replace(name, "   ").replace(count, &format!("recordCount=\"1{}\"", "0".repeat(18)));
    let absurd = refusal("a.e57", lie(old, &lie_at_length));
    assert!(absurd.contains("the scans state 1000000000000000000 points, which want"), "{absurd}");
    let lost = lie("cartesianX", "cartesianQ");
    assert!(refusal("a.e57", &lost).contains("scan 1 has neither Cartesian nor spherical coordinates"));
    assert_eq!(parse("a.xyz", &bytes).format, Format::E57);
}

/// The file with other words of the same length in its XML, and right checksums.
fn resealed(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let mut payload = unpaged(bytes);
    assert_eq!(from.len(), to.len());
    while let Some(at) = payload.windows(from.len()).position(|window| window == from.as_bytes()) {
        payload[at..at + to.len()].copy_from_slice(to.as_bytes());
    }
    paged(&payload)
}
