//! Damaged E57 and PCD files make the readers neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_e57_pcd`; guided by coverage: `cargo bolero test -p footpoint-io --test
//! fuzz_e57_pcd TARGET`.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use std::io::Write;

use bolero::check;
use common::{Sample, extremes, f64_table, paged, unpaged};
use e57::{E57Writer, Quaternion, Record, RecordDataType, RecordName, RecordValue, Transform, Translation};
use flate2::{Compression, write::GzEncoder};
use footpoint_io::{Column, Data, PcdEncoding, Table, WriteOptions, write};
use fuzz::{Damage, Target};

/// The bytes before the first section of an E57 file.
const HEADER: usize = 48;

/// Columns with standard attributes and others, of every number type, and a point without coordinates.
fn scan() -> Table {
    let mut table = extremes();
    table.set(Column::new("z", Data::F64(vec![1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0])));
    for name in ["red", "green", "blue"] {
        table.set(Column::new(name, Data::U8(vec![0, 255, 7, 8, 9, 10])));
    }
    table.set(Column::new("intensity", Data::F32(vec![0.5; 6])));
    table
}

/// Two scans with poses: spherical coordinates with states and scaled integers, and integers as coordinates.
fn stations() -> Vec<u8> {
    let sample = Sample::new("a.e57", b"");
    let mut writer = E57Writer::from_file(&sample.path, "file").unwrap();
    let record = |name, data_type| Record { name, data_type };
    let scaled = RecordDataType::ScaledInteger { min: -1000, max: 1000, scale: 0.001, offset: 0.5 };
    let spherical = vec![
        record(RecordName::SphericalRange, RecordDataType::F64),
        record(RecordName::SphericalAzimuth, RecordDataType::F32),
        record(RecordName::SphericalElevation, scaled.clone()),
        record(RecordName::SphericalInvalidState, RecordDataType::Integer { min: 0, max: 2 }),
    ];
    let axes = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
    let cartesian = axes.map(|name| record(name, scaled.clone())).to_vec();
    let pose = Transform {
        rotation: Quaternion { w: 0.6, x: 0.0, y: 0.8, z: 0.0 },
        translation: Translation { x: 1.0, y: 2.0, z: 3.0 },
    };
    for (name, prototype) in [("one", spherical), ("two", cartesian)] {
        let mut cloud = writer.add_pointcloud(name, prototype.clone()).unwrap();
        cloud.set_transform(Some(pose.clone()));
        for row in 0..5 {
            let value = |record: &Record| match record.data_type {
                RecordDataType::Double { .. } => RecordValue::Double(f64::from(row)),
                RecordDataType::Single { .. } => RecordValue::Single(0.5),
                RecordDataType::ScaledInteger { .. } => RecordValue::ScaledInteger(i64::from(row) * 100),
                RecordDataType::Integer { .. } => RecordValue::Integer(i64::from(row) % 3),
            };
            cloud.add_point(prototype.iter().map(value).collect()).unwrap();
        }
        cloud.finalize().unwrap();
    }
    writer.finalize().unwrap();
    drop(writer);
    std::fs::read(&sample.path).unwrap()
}

/// The pages of a damaged file. Where its length has changed, the header tells the new one and the new place of the
/// XML section: otherwise no such file would get past the first look.
fn seal(good: &[u8], mut content: Vec<u8>) -> Vec<u8> {
    let find = |word: &[u8]| content.windows(word.len()).position(|window| window == word);
    if let (Some(start), Some(end)) = (find(b"<?xml"), find(b"</e57Root>"))
        && content.len() != good.len()
        && start < end
    {
        content.resize(content.len().next_multiple_of(1020), 0);
        let length = content.len() / 1020 * 1024;
        let place = start + start / 1020 * 4;
        for (at, number) in [(16, length), (24, place), (32, end + b"</e57Root>".len() - start)] {
            content[at..at + 8].copy_from_slice(&(number as u64).to_le_bytes());
        }
    }
    paged(&content)
}

#[test]
fn e57() {
    let folder = tempfile::tempdir().unwrap();
    let written = |table: &Table| {
        let path = folder.path().join(format!("{}.e57", table.columns.len()));
        write(&path, table, &WriteOptions::default()).unwrap();
        unpaged(&std::fs::read(&path).unwrap())
    };
    let plain = f64_table(&[("x", &[1.0, 2.0]), ("y", &[1.0, 2.0]), ("z", &[1.0, 2.0])]);
    let target = Target::new()
        .sealed(seal)
        .behind(|_| HEADER)
        .file("a.e57", written(&plain))
        .file("a.e57", written(&scan()))
        .file("a.e57", unpaged(&stations()));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn pcd() {
    let organised = "# .PCD v.7\nVERSION .7\nFIELDS x y z rgb n _\nSIZE 4 4 4 4 8 1\nTYPE F F F F I U\n\
                     COUNT 1 1 1 1 2 3\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n\
                     1 2 3 4e6 5 6 0 0 0\nnan nan nan 1 2 3 0 0 0\n1 2 3 4 5 6 0 0 0\n1 2 3 4 5 6 0 0 0\n";
    let mut binary = organised.split_inclusive("DATA ").next().unwrap().as_bytes().to_vec();
    binary.extend(b"binary\n");
    binary.extend([1; 4 * 35]);
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(&binary).unwrap();
    let body = |file: &[u8]| file.windows(5).position(|window| window == b"DATA ").unwrap_or(0);
    let mut target = Target::new()
        .behind(body)
        .file("a.pcd", organised)
        .file("a.pcd", &binary)
        .file("a.pcd.gz", packer.finish().unwrap());
    for pcd in [PcdEncoding::Ascii, PcdEncoding::Binary, PcdEncoding::Compressed] {
        target = target.written("a.pcd", &scan(), &WriteOptions { pcd, ..WriteOptions::default() });
    }
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
