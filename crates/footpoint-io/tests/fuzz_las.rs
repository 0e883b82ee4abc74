//! Damaged LAS and LAZ files make the readers neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_las`; guided by coverage: `cargo bolero test -p footpoint-io --test fuzz_las TARGET`.
//! COPC is not written by us: its file is a packed one with the records of an octree of two pages.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use std::io::Cursor;

use bolero::check;
use common::f64_table;
use footpoint_io::{Bounds, Column, Data, Frame, ReadOptions, Table, Unit, WriteOptions, read_with};
use fuzz::{Damage, Target};
use las::{Builder, Color, Point, Vlr, Writer, point};

/// Enough for the packing to come into its models of the points, few enough to be quick.
const ROWS: u16 = 100;

/// Points on a grid, times, colours, classes and extra bytes of several types; with a reference system it becomes
/// point format 3, without one 7.
fn rich(crs: Option<&str>) -> Table {
    let rows = || (0..ROWS).map(f64::from);
    let mut table = f64_table(&[
        ("x", &rows().map(|i| i / 4.0).collect::<Vec<_>>()),
        ("y", &rows().map(|i| i * i - 7.0).collect::<Vec<_>>()),
        ("z", &rows().map(|i| (i % 7.0) / 8.0).collect::<Vec<_>>()),
        ("gps_time", &rows().map(|i| i * 0.1).collect::<Vec<_>>()),
        ("distance", &rows().map(f64::ln).collect::<Vec<_>>()),
    ]);
    for (name, step) in [("red", 1), ("green", 700), ("blue", 9000)] {
        table.set(Column::new(name, Data::U16((0..ROWS).map(|i| i.wrapping_mul(step)).collect())));
    }
    table.set(Column::new("classification", Data::U8((0..ROWS).map(|i| (i % 5) as u8).collect())));
    table.set(Column::new("status", Data::I8((0..ROWS).map(|i| -(i as i8)).collect())));
    table.set(Column::new("number", Data::I64((0..ROWS).map(|i| i64::MAX - i64::from(i)).collect())));
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
    for step in 0..ROWS {
        let place = f64::from(step);
        let point = Point {
            x: place,
            y: -place,
            z: 0.25,
            intensity: step % 9,
            gps_time: (format & 1 == 1).then_some(place),
            color: (format > 1).then(|| Color::new(step, 2, 3)),
            extra_bytes: vec![1, step as u8],
            ..Point::default()
        };
        writer.write_point(point).unwrap();
    }
    writer.into_inner().unwrap().into_inner()
}

/// Where the points of a file start.
fn points(file: &[u8]) -> usize {
    u32::from_le_bytes(file[96..100].try_into().unwrap()) as usize
}

/// Where the length of a damaged LAZ file has changed, the place of its table of chunks moves along: otherwise no such
/// file would be unpacked.
fn seal(good: &[u8], mut file: Vec<u8>) -> Vec<u8> {
    let start = points(good);
    if let Some(place) = file.get_mut(start..start + 8) {
        let old = &good[start..start + 8];
        let behind = good.len() as u64 - u64::from_le_bytes(old.try_into().unwrap());
        if place == old {
            let length = file.len() as u64;
            file[start..start + 8].copy_from_slice(&length.saturating_sub(behind).to_le_bytes());
        }
    }
    file
}

#[test]
fn las() {
    let plain = f64_table(&[("x", &[0.5, 1.25]), ("y", &[-7.0, 8.5]), ("z", &[0.0, 0.001])]);
    let options = WriteOptions::default();
    let target = Target::new()
        .behind(points)
        .written("a.las", &plain, &options)
        .written("a.las", &rich(Some("EPSG:25832")), &options)
        .written("a.las", &rich(None), &options)
        .file("a.las", old(3, false));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

/// The first eight bytes of the points are the place of the table of chunks.
fn packed() -> Target {
    Target::new().sealed(seal).behind(|file| points(file) + 8)
}

#[test]
fn laz() {
    let target = packed()
        .written("a.laz", &rich(Some("EPSG:25832")), &WriteOptions::default())
        .file("a.laz", old(0, true))
        .file("a.laz", old(3, true));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn laz_layers() {
    let plain = f64_table(&[("x", &[0.5, 1.25]), ("y", &[-7.0, 8.5]), ("z", &[0.0, 0.001])]);
    let options = WriteOptions::default();
    let target = packed().written("a.laz", &plain, &options).written("a.laz", &rich(None), &options);
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

/// The whole of `octree`, or a part of it.
const BOX: Bounds = Bounds { low: [10.0, -60.0, 0.0], high: [60.0, 0.0, 1.0] };

/// A COPC file: one chunk below a page that the first page names.
fn octree() -> Vec<u8> {
    let record = |id: u16, bytes: usize| Vlr {
        user_id: "copc".to_owned(),
        record_id: id,
        data: vec![0; bytes],
        ..Vlr::default()
    };
    let mut builder = Builder::from((1, 4));
    builder.point_format = point::Format::new(7).unwrap();
    builder.point_format.is_compressed = true;
    builder.vlrs.push(record(1, 160));
    builder.evlrs.push(record(1000, 64));
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for step in 0..ROWS {
        let (x, gps_time) = (f64::from(step), Some(f64::from(step) * 0.1));
        let color = Some(Color::new(step, 2, 3));
        writer.write_point(Point { x, y: -x, z: 0.25, gps_time, color, ..Point::default() }).unwrap();
    }
    let mut file = writer.into_inner().unwrap().into_inner();
    let names: Vec<usize> = (0..file.len() - 5).filter(|&i| file[i..].starts_with(b"copc\0")).collect();
    let [info, pages] = names[..] else { panic!("{names:?}") };
    // Behind the names: number, length of 2 or 8 bytes, description.
    let (info, pages) = (info + 52, pages + 58);
    let chunk = points(&file) + 8;
    let table = u64::from_le_bytes(file[chunk - 8..chunk].try_into().unwrap());
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(info + 24, &1000_f64.to_le_bytes());
    put(info + 40, &(pages as u64).to_le_bytes());
    put(info + 48, &32_u64.to_le_bytes());
    let entries =
        [(0, pages as u64 + 32, 32, -1), (1, chunk as u64, table as i32 - chunk as i32, i32::from(ROWS))];
    for (i, (level, start, bytes, count)) in entries.into_iter().enumerate() {
        let at = pages + 32 * i;
        // The second cell of each axis but y holds all points.
        let key = [level, level, 0, level];
        key.iter().enumerate().for_each(|(k, number)| put(at + 4 * k, &i32::to_le_bytes(*number)));
        put(at + 16, &u64::to_le_bytes(start));
        put(at + 24, &i32::to_le_bytes(bytes));
        put(at + 28, &i32::to_le_bytes(count));
    }
    file
}

#[test]
fn the_octree_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    std::fs::write(&path, octree()).unwrap();
    for (within, rows) in [(BOX, 51), (Bounds { low: [-9.0; 3], high: [-1.0; 3] }, 0)] {
        let input = read_with(&path, &ReadOptions { within: Some(within), watch: None }).unwrap();
        assert_eq!((input.table.rows(), &input.report.notes[..]), (rows, &[][..]));
    }
}

#[test]
fn copc() {
    let target = packed().within(BOX).file("a.copc.laz", octree());
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn copc_records() {
    let target = Target::new().within(BOX).file("a.copc.laz", octree());
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
