//! Damaged LAS and LAZ files make the readers neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_las`; guided by coverage: `cargo bolero test -p footpoint-io --test fuzz_las TARGET`.
//! COPC is not among them, as it is not written; `las_broken.rs` damages a real file of it.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use std::io::Cursor;

use bolero::check;
use common::f64_table;
use footpoint_io::{Column, Data, Frame, Table, Unit, WriteOptions};
use fuzz::{Damage, Target};
use las::{Builder, Color, Point, Writer, point};

/// Points on a grid, times, colours, classes and extra bytes of several types; with a reference system it becomes
/// point format 3, without one 7.
fn rich(crs: Option<&str>) -> Table {
    let mut table = f64_table(&[
        ("x", &[0.5, 1.25, 9.0]),
        ("y", &[-7.0, 8.5, 1e4]),
        ("z", &[0.0, 0.001, -3.0]),
        ("gps_time", &[1.0, 2.0, 3.5]),
        ("distance", &[0.1, -0.2, f64::NAN]),
    ]);
    for name in ["red", "green", "blue"] {
        table.set(Column::new(name, Data::U16(vec![1, 65535, 300])));
    }
    table.set(Column::new("classification", Data::U8(vec![2, 3, 200])));
    table.set(Column::new("status", Data::I8(vec![-1, 0, 1])));
    table.set(Column::new("number", Data::I64(vec![i64::MIN, 0, i64::MAX])));
    table.frame = Frame { crs: crs.map(str::to_owned), unit: Some(Unit::Metre) };
    table
}

/// A file of an old version, as the crate `las` writes it.
fn old(format: u8, is_packed: bool) -> Vec<u8> {
    let mut builder = Builder::from((1, 2));
    builder.point_format = point::Format::new(format).unwrap();
    builder.point_format.is_compressed = is_packed;
    builder.point_format.extra_bytes = 2;
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for step in 0..5_u16 {
        let place = f64::from(step);
        let point = Point {
            x: place,
            y: -place,
            z: 0.25,
            intensity: step,
            gps_time: (format & 1 == 1).then_some(place),
            color: (format > 1).then(|| Color::new(step, 2, 3)),
            extra_bytes: vec![1, 2],
            ..Point::default()
        };
        writer.write_point(point).unwrap();
    }
    writer.into_inner().unwrap().into_inner()
}

#[test]
fn las() {
    let plain = f64_table(&[("x", &[0.5, 1.25]), ("y", &[-7.0, 8.5]), ("z", &[0.0, 0.001])]);
    let options = WriteOptions::default();
    let target = Target::new()
        .written("a.las", &plain, &options)
        .written("a.las", &rich(Some("EPSG:25832")), &options)
        .written("a.las", &rich(None), &options)
        .file("a.las", old(3, false));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn laz() {
    let plain = f64_table(&[("x", &[0.5, 1.25]), ("y", &[-7.0, 8.5]), ("z", &[0.0, 0.001])]);
    let options = WriteOptions::default();
    let target = Target::new()
        .written("a.laz", &plain, &options)
        .written("a.laz", &rich(Some("EPSG:25832")), &options)
        .written("a.laz", &rich(None), &options)
        .file("a.laz", old(0, true))
        .file("a.laz", old(3, true));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
