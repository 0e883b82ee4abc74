//! Broken LAS, LAZ and COPC files: an error that names the place, or what can be read with a note; never a panic.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::{Sample, f64_table, parse, real_files, refusal};
use footpoint_io::{Bounds, Column, Data, Overwrite, ReadOptions, WriteOptions, read, read_with, write};

/// Refused with this reason, or read with so many points and this note.
type Wanted = Result<(usize, &'static str), &'static str>;

const MALFORMED: [(&str, Wanted); 10] = [
    ("cut.las", Ok((0, "its header says 1 points, 0 are there"))),
    ("cut.laz", Err("the table of packed chunks")),
    ("cut.copc.laz", Err("the table of packed chunks")),
    ("laspy_append-bug.laz", Ok((37_805, ""))),
    ("pdal_bad-geotiff-keys.las", Ok((10, "some of the GeoTIFF keys are empty"))),
    ("pdal_bad_vlr_count.las", Ok((10, "variable length records"))),
    ("pdal_garbage_nVariableLength.las", Ok((718, "counts 1069128089 variable length records"))),
    ("pdal_gps-time-nan.las", Ok((1, ""))),
    ("pdal_lots_of_vlr.las", Ok((1, ""))),
    ("pdal_spurious.las", Ok((1065, ""))),
];

#[test]
fn malformed_files() {
    let Some(data) = real_files() else { return };
    for (file, wanted) in MALFORMED {
        let start = Instant::now();
        let found = read(&data.join("malformed").join(file));
        match wanted {
            Ok((rows, note)) => {
                let input = found.unwrap();
                assert_eq!(input.table.rows(), rows, "{file}");
                let notes = input.report.notes.join("; ");
                assert!(notes.contains(note) && notes.is_empty() == note.is_empty(), "{file}: {notes}");
            }
            Err(reason) => {
                let message = found.unwrap_err().to_string();
                assert!(message.contains(file) && message.contains(reason), "{message}");
            }
        }
        assert!(start.elapsed() < Duration::from_secs(1), "{file} is slow");
    }
}

/// The first value, fifty times with small changes.
fn repeated(data: &Data) -> Data {
    match data {
        Data::F64(v) => Data::F64((0..50).map(|i| v[0] + f64::from(i) * 0.25).collect()),
        Data::U16(v) => Data::U16((0..50).map(|i| v[0] ^ i).collect()),
        Data::I8(v) => Data::I8(vec![v[0]; 50]),
        Data::U8(v) => Data::U8(vec![v[0]; 50]),
        other => other.clone(),
    }
}

/// Small files of each kind, some of them ours.
fn samples(data: &Path) -> Vec<(&'static str, Vec<u8>)> {
    let mut samples = Vec::new();
    for file in ["perm_1.2_3.las", "lidr_dbh.laz"] {
        samples.push((file, std::fs::read(data.join("las").join(file)).unwrap()));
    }
    samples.push(("page.copc.laz", std::fs::read(data.join("copc/simple_with_page.copc.laz")).unwrap()));
    let folder = tempfile::tempdir().unwrap();
    let mut tiny = read(&data.join("las/perm_1.2_3.las")).unwrap().table;
    tiny.columns.iter_mut().for_each(|column| column.data = repeated(&column.data));
    write(&folder.path().join("tiny.laz"), &tiny, &WriteOptions::default()).unwrap();
    samples.push(("tiny.laz", std::fs::read(folder.path().join("tiny.laz")).unwrap()));
    let within = Some(Bounds { low: [0.0; 3], high: [194_270.0, 1e9, 1e9] });
    for (name, file) in [("wave.laz", "laspy_fullwave.laz"), ("extra.las", "laspy_extra.laz")] {
        let mut table =
            read_with(&data.join("las").join(file), &ReadOptions { within, watch: None }).unwrap().table;
        if table.rows() == 0 {
            table = read(&data.join("las").join(file)).unwrap().table;
        }
        table.set(Column::new("more", Data::F32(vec![1.5; table.rows()])));
        let path = folder.path().join(name);
        write(&path, &table, &WriteOptions::default()).unwrap();
        samples.push((name, std::fs::read(&path).unwrap()));
    }
    samples
}

/// Reads the bytes, also within a box; any result will do, as long as it is soon there and even.
fn survives(name: &str, bytes: &[u8]) -> Option<usize> {
    let sample = Sample::new(name, bytes);
    let start = Instant::now();
    let within = Some(Bounds { low: [0.0; 3], high: [637_000.0, 851_000.0, 600.0] });
    let part = read_with(&sample.path, &ReadOptions { within, watch: None });
    let whole = read(&sample.path);
    assert!(start.elapsed() < Duration::from_secs(5), "{name}: slow");
    for input in part.iter().chain(&whole) {
        let rows = input.table.rows();
        assert!(input.table.columns.iter().all(|column| column.data.len() == rows));
    }
    whole.ok().map(|input| input.table.rows())
}

#[test]
fn cut_anywhere() {
    let Some(data) = real_files() else { return };
    for (name, bytes) in samples(&data) {
        let whole = survives(name, &bytes).unwrap();
        // At every byte of the smallest, at some of the others.
        let cuts = (0..bytes.len()).step_by(if bytes.len() < 3000 { 1 } else { bytes.len() / 80 });
        for cut in cuts {
            let rows = survives(name, &bytes[..cut]);
            assert!(rows.is_none_or(|rows| rows <= whole), "{name} cut at {cut}");
            // A packed file that is cut before what stands behind the points has lost its table of chunks.
            assert!(
                name.ends_with("las") || rows.is_none() || cut + 4000 > bytes.len().max(7000),
                "{name} cut at {cut}"
            );
        }
    }
}

#[test]
fn flipped_bytes() {
    let Some(data) = real_files() else { return };
    let mut state = 42_u64;
    let mut below = |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % limit
    };
    for (name, bytes) in samples(&data) {
        for round in 0..60 {
            let mut broken = bytes.clone();
            // Half of the damage goes to the head.
            let reach = if round % 2 == 0 { broken.len() } else { broken.len().min(700) };
            for _ in 0..=below(4) {
                let at = below(reach);
                broken[at] = if below(2) == 0 {
                    broken[at] ^ (1 << below(8))
                } else {
                    [0, 0x7f, 0x80, 0xff][below(4)]
                };
            }
            survives(name, &broken);
        }
    }
}

/// A small packed file with `value` put in at `at`.
fn changed(at: usize, value: &[u8]) -> Option<(PathBuf, Vec<u8>)> {
    let path = real_files()?.join("las/laspy_simple.laz");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[at..at + value.len()].copy_from_slice(value);
    Some((path, bytes))
}

#[test]
fn each_lie_is_named() {
    for (at, value, reason) in [
        (0, &b"LASX"[..], "its first four bytes are not `LASF`"),
        (24, &[1, 7], "LAS version 1.7 is not supported"),
        (104, &[0x80 | 11], "unknown point format 11"),
        (105, &[10, 0], "point records of 10 bytes, but point format 3 wants at least 34"),
        (107, &[0xff; 4], "says 4294967295 points, which"),
        (107, &[0x00, 0x00, 0x01, 0x00], "holds 50000 of 65536 points"),
        (131, &[0; 8], "scale 0 and offset"),
        (100, &[0; 4], "no record `laszip encoded`"),
    ] {
        let Some((_, bytes)) = changed(at, value) else { return };
        let message = refusal("a.laz", &bytes);
        assert!(message.contains(reason), "wanted `{reason}` in: {message}");
    }
    assert!(refusal("a.las", "x").contains("not a LAS file"));
    assert!(refusal("a.las", "LASF").contains("the header wants 227 bytes, the file has 4"));
}

#[test]
fn chunk_tables_and_points_that_lie() {
    let Some((path, bytes)) = changed(0, b"LASF") else { return };
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let table = i64::from_le_bytes(bytes[start..start + 8].try_into().unwrap()) as usize;
    let with = |at: usize, value: &[u8]| {
        let mut bytes = bytes.clone();
        bytes[at..at + value.len()].copy_from_slice(value);
        refusal("a.laz", bytes)
    };
    let message = with(table + 4, &[0xff; 4]);
    assert!(message.contains("counts 4294967295 chunks, which the file cannot hold"), "{message}");
    let message = with(start, &i64::MAX.to_le_bytes());
    assert!(message.contains("lies beyond the end of the file"), "{message}");
    // The place of the table may stand at the end of the file instead.
    let mut moved = bytes.clone();
    moved[start..start + 8].copy_from_slice(&(-1_i64).to_le_bytes());
    moved.extend((table as i64).to_le_bytes());
    let sample = Sample::new("a.laz", moved);
    assert_eq!(read(&sample.path).unwrap().table.columns, read(&path).unwrap().table.columns);
}

#[test]
fn layers_longer_than_their_chunk() {
    let Some(data) = real_files() else { return };
    let mut bytes = std::fs::read(data.join("las/laspy_1_4_w_evlr.laz")).unwrap();
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    // Behind the place of the table, the first point and the number of points.
    let size = start + 8 + 30 + 4;
    bytes[size..size + 4].copy_from_slice(&[0xff; 4]);
    let message = refusal("a.laz", bytes);
    assert!(
        message.contains("packed points from point 1 on") && message.contains("its fields want 4294"),
        "{message}"
    );
}

#[test]
fn broken_keys_and_octrees_are_noted() {
    let Some(data) = real_files() else { return };
    let path = data.join("las/pdal_test_utm17.las");
    let mut bytes = std::fs::read(&path).unwrap();
    let header = usize::from(u16::from_le_bytes(bytes[94..96].try_into().unwrap()));
    bytes[header + 54] = 9;
    let sample = Sample::new("a.las", &bytes);
    let input = read(&sample.path).unwrap();
    assert!(input.report.notes[0].contains("its GeoTIFF keys are broken"), "{:?}", input.report);
    assert_eq!((&input.table.frame.crs, input.table.rows()), (&None, 10));

    let within = Some(Bounds { low: [636_000.0, 849_000.0, 0.0], high: [637_000.0, 851_000.0, 600.0] });
    let options = ReadOptions { within, watch: None };
    let path = data.join("copc/simple_with_page.copc.laz");
    let whole = read_with(&path, &options).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    // The place of the root page, its size, and the half width of the octree.
    for (at, value) in [(40, u64::MAX), (48, u64::MAX), (48, 32), (24, f64::NAN.to_bits())] {
        let mut bytes = bytes.clone();
        let at = 375 + 54 + at;
        bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        let sample = Sample::new("a.copc.laz", &bytes);
        let input = read_with(&sample.path, &options).unwrap();
        assert!(
            input.report.notes[0].contains("the octree of this COPC file is broken"),
            "{:?}",
            input.report
        );
        assert_eq!(input.table.columns, whole.table.columns);
    }
}

#[test]
fn records_beyond_all_files_are_noted() {
    let sample = Sample::new("a.las", b"");
    let table = f64_table(&[("x", &[1.0]), ("y", &[2.0]), ("z", &[3.0])]);
    let options = WriteOptions { overwrite: Overwrite::Replace, ..WriteOptions::default() };
    write(&sample.path, &table, &options).unwrap();
    let mut bytes = std::fs::read(&sample.path).unwrap();
    // Where the extended records start, and how many there are.
    bytes[235..243].fill(0xff);
    bytes[243] = 1;
    let input = parse("a.las", &bytes);
    assert_eq!(input.table.rows(), 1);
    assert_eq!(input.report.notes, ["the header counts 1 extended records behind the points, 0 are whole"]);
}
