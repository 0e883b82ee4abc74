//! E57 and PCD there and back: real files, all types, damage, and the watch.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use common::{Lcg, Sample, bits, extremes, f64_table, names, paged, real_files, unpaged};
use footpoint_io::{
    Bounds, Column, Data, Kept, Overwrite, PcdEncoding, ReadOptions, ReadProblem, Table, Watch, WriteOptions,
    check_table, read, read_with, write,
};

const ENCODINGS: [PcdEncoding; 3] = [PcdEncoding::Ascii, PcdEncoding::Binary, PcdEncoding::Compressed];

fn options(pcd: PcdEncoding) -> WriteOptions {
    WriteOptions { pcd, overwrite: Overwrite::Replace, ..WriteOptions::default() }
}

fn same(old: &Table, new: &Table, what: &str) {
    assert_eq!(names(old), names(new), "{what}");
    for (old, new) in old.columns.iter().zip(&new.columns) {
        let same_type = std::mem::discriminant(&old.data) == std::mem::discriminant(&new.data);
        assert!(same_type, "{what} {}", old.name);
        assert!(bits(&old.data) == bits(&new.data), "{what} {}", old.name);
    }
}

fn files_of(data: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["e57", "pcd", "curve", "malformed"] {
        let entries = std::fs::read_dir(data.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        found.extend(entries.filter(|path| path.extension().is_some_and(|e| e == extension)));
    }
    found.sort();
    found
}

#[test]
fn real_files_come_back_as_they_were() {
    let Some(data) = real_files() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut done = 0;
    for path in files_of(&data, "pcd") {
        let Ok(first) = read(&path) else { continue };
        for encoding in ENCODINGS {
            let copy = folder.path().join("copy.pcd");
            write(&copy, &first.table, &options(encoding)).unwrap();
            let again = read(&copy).unwrap();
            let what = format!("{} {encoding:?}", path.display());
            assert!(again.report.notes.is_empty(), "{what}: {:?}", again.report);
            same(&first.table, &again.table, &what);
            done += 1;
        }
    }
    for path in files_of(&data, "e57") {
        let Ok(first) = read(&path) else { continue };
        let copy = folder.path().join("copy.e57");
        write(&copy, &first.table, &options(PcdEncoding::Binary)).unwrap();
        let again = read(&copy).unwrap();
        same(&first.table, &again.table, &path.display().to_string());
        assert_eq!(again.table.frame, first.table.frame);
        let (Some(Kept::E57(old)), Some(Kept::E57(new))) = (&first.table.kept, &again.table.kept) else {
            panic!("nothing kept")
        };
        for (old, new) in old.scans().iter().zip(new.scans()) {
            assert_eq!(
                (&old.name, &old.guid, old.rows),
                (&new.name, &new.guid, new.rows),
                "{}",
                path.display()
            );
            assert_eq!(old.description, new.description, "{}", path.display());
        }
        assert_eq!(old.scans().len(), new.scans().len());
        assert_eq!(old.stated(), new.stated(), "{}", path.display());
        done += 1;
    }
    assert!(done > 120, "{done}");
}

#[test]
fn pcd_keeps_types_bits_names_and_comments() {
    let mut table = extremes();
    table.set(Column::new("w", Data::I64(vec![i64::MIN, i64::MAX, 0, 1, -1, 2])));
    table.set(Column::new("v", Data::U64(vec![u64::MIN, u64::MAX, 0, 1, 2, 3])));
    let folder = tempfile::tempdir().unwrap();
    for encoding in ENCODINGS {
        let path = folder.path().join("t.pcd");
        write(&path, &table, &options(encoding)).unwrap();
        let back = read(&path).unwrap();
        assert_eq!(back.format, footpoint_io::Format::Pcd(encoding));
        same(&table, &back.table, &format!("{encoding:?}"));
        assert_eq!(back.table.comments, table.comments);
    }
}

#[test]
fn a_long_compressed_block_unpacks_to_itself() {
    // Repeats from near and far, of all lengths, and stretches without any.
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 20
    };
    let values: Vec<u32> =
        (0..300_000).map(|i| if i % 5000 < 2000 { random() } else { i / 97 % 7 }).collect();
    let mut table = Table::default();
    table.set(Column::new("a", Data::U32(values)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.pcd");
    write(&path, &table, &options(PcdEncoding::Compressed)).unwrap();
    assert!(path.metadata().unwrap().len() < 600_000, "{}", path.metadata().unwrap().len());
    assert_eq!(read(&path).unwrap().table.columns, table.columns);
}

#[test]
fn what_only_pcd_holds_is_written_back() {
    let head = |packed: &str| {
        format!(
            "VERSION 0.7\nFIELDS x rgba f\nSIZE 4 4 2\nTYPE F {packed} I\nCOUNT 1 1 2\nWIDTH 1\nHEIGHT 2\n\
             VIEWPOINT 1 2.5 3 0 1 0 0\nPOINTS 2\nDATA ascii\n"
        )
    };
    for packed in ["U", "I", "F"] {
        let sample = Sample::new("a.pcd", head(packed) + "1 1 3 4\n2 3 5 6\n");
        let first = read(&sample.path).unwrap().table;
        let copy = sample.path.with_file_name("b.pcd");
        write(&copy, &first, &options(PcdEncoding::Binary)).unwrap();
        let again = read(&copy).unwrap().table;
        assert_eq!(again, first);
        let text = String::from_utf8_lossy(&std::fs::read(&copy).unwrap()).into_owned();
        for line in [
            "FIELDS x rgba f",
            &format!("TYPE F {packed} I"),
            "COUNT 1 1 2",
            "WIDTH 1\nHEIGHT 2\nVIEWPOINT 1 2.5 3 0 1 0 0",
        ] {
            assert!(text.contains(line), "no {line} in {text}");
        }
        // Fewer points are no longer organised.
        let within = Some(Bounds { low: [0.0; 3], high: [1.5; 3] });
        let mut fewer = first.clone();
        fewer.set(Column::new("y", Data::F32(vec![0.0; 2])));
        write(&copy, &fewer, &options(PcdEncoding::Binary)).unwrap();
        let fewer = read_with(&copy, &ReadOptions { within, watch: None }).unwrap().table;
        write(&copy, &fewer, &options(PcdEncoding::Binary)).unwrap();
        let text = String::from_utf8_lossy(&std::fs::read(&copy).unwrap()).into_owned();
        assert!(text.contains("WIDTH 1\nHEIGHT 1\n"), "{text}");
    }
}

#[test]
fn tables_that_pcd_cannot_hold_are_refused() {
    let mut table = f64_table(&[("x", &[1.0])]);
    table.set(Column::new("t", Data::Text(vec!["a".into()])));
    let message = check_table(Path::new("a.pcd"), &table).unwrap_err().to_string();
    assert!(message.contains("column `t` holds text, which PCD cannot"), "{message}");
    for name in ["_", "a b", ""] {
        let message = check_table(Path::new("a.pcd"), &f64_table(&[(name, &[1.0])])).unwrap_err().to_string();
        assert!(message.contains("cannot stand in the header"), "{message}");
    }
}

/// Stops after so many words.
struct Stop(std::sync::atomic::AtomicU64, u64);

impl Watch for Stop {
    fn at(&self, done: u64, all: u64) -> ControlFlow<()> {
        assert!(done <= all, "{done} of {all}");
        let said = self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        if said < self.1 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

#[test]
fn the_watch_hears_and_stops() {
    let column: Vec<f64> = (0..200_000).map(f64::from).collect();
    let table = f64_table(&[("x", &column), ("y", &column), ("z", &column)]);
    let folder = tempfile::tempdir().unwrap();
    for (name, encoding) in [
        ("a.e57", PcdEncoding::Binary),
        ("a.pcd", PcdEncoding::Ascii),
        ("a.pcd", PcdEncoding::Binary),
        ("a.pcd", PcdEncoding::Compressed),
    ] {
        let path = folder.path().join(name);
        write(&path, &table, &options(encoding)).unwrap();
        let hears = Stop(0.into(), u64::MAX);
        read_with(&path, &ReadOptions { within: None, watch: Some(&hears) }).unwrap();
        assert!(hears.0.into_inner() >= path.metadata().unwrap().len() >> 20, "{name} {encoding:?}");
        let stop = Stop(0.into(), 2);
        let stopped = read_with(&path, &ReadOptions { within: None, watch: Some(&stop) }).unwrap_err();
        assert!(matches!(*stopped.problem, ReadProblem::Stopped), "{stopped}");
        assert_eq!(stop.0.into_inner(), 2, "{name} {encoding:?}");
    }
}

/// Reads the bytes; any result will do, as long as all columns are of one length.
fn survives(name: &str, bytes: &[u8]) {
    let sample = Sample::new(name, bytes);
    if let Ok(input) = read(&sample.path) {
        let rows = input.table.rows();
        assert!(input.table.columns.iter().all(|column| column.data.len() == rows));
        assert!(rows <= bytes.len() * 8, "{rows} rows from {} bytes", bytes.len());
    }
}

#[test]
fn no_damage_makes_reading_panic_or_hang() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Lcg(42);
    let mut table = extremes();
    table.set(Column::new("z", Data::U8(vec![0; 6])));
    table.set(Column::new("red", Data::U8(vec![0; 6])));
    table.set(Column::new("green", Data::U8(vec![0; 6])));
    table.set(Column::new("blue", Data::U8(vec![0; 6])));
    for (name, encoding) in [
        ("a.e57", PcdEncoding::Binary),
        ("a.pcd", PcdEncoding::Ascii),
        ("a.pcd", PcdEncoding::Binary),
        ("a.pcd", PcdEncoding::Compressed),
    ] {
        let path = folder.path().join(name);
        write(&path, &table, &options(encoding)).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..bytes.len() {
            survives(name, &bytes[..cut]);
        }
        for _ in 0..600 {
            let mut broken = bytes.clone();
            for _ in 0..=random.below(4) {
                let at = random.below(broken.len());
                broken[at] = match random.below(3) {
                    0 => b"0123456789-.,;\" \r\n\t#"[random.below(20)],
                    1 => broken[at] ^ (1 << random.below(8)),
                    _ => random.below(256) as u8,
                };
            }
            if name == "a.e57" {
                // With right checksums, damage gets further than those.
                broken = paged(&unpaged(&broken));
            }
            survives(name, &broken);
        }
    }
}

#[test]
fn attributes_of_unequal_length_end_early() {
    // One point in each packet for z, thousands for x: unpacked, x would be far larger than the file.
    let message = common::refusal("a.e57", lopsided());
    assert!(message.contains("its attributes hold different numbers of points"), "{message}");
}

/// An E57 file in whose packets one attribute has 400,000 values of one bit, the others one value each.
fn lopsided() -> Vec<u8> {
    let table = {
        let mut table = f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("z", &[0.0])]);
        table.set(Column::new("intensity", Data::F32(vec![0.0])));
        table.set(Column::new("intensity_invalid", Data::U8(vec![0])));
        table
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.e57");
    write(&path, &table, &WriteOptions::default()).unwrap();
    let payload = unpaged(&std::fs::read(path).unwrap());
    let xml_at = payload.windows(5).position(|window| window == b"<?xml").unwrap();
    let xml = String::from_utf8_lossy(&payload[xml_at..]).trim_end_matches('\0').to_owned();
    let xml = xml.replace("recordCount=\"1\"", "recordCount=\"1000\"");
    let mut file = payload[..48 + 32].to_vec();
    let sizes = [8_u16, 8, 8, 4, 50_000];
    for _ in 0..200 {
        let length = (6 + 10 + sizes.iter().map(|&s| usize::from(s)).sum::<usize>()).next_multiple_of(4);
        let start = file.len();
        file.extend([1, 0]);
        file.extend((length as u16 - 1).to_le_bytes());
        file.extend(5_u16.to_le_bytes());
        sizes.iter().for_each(|size| file.extend(size.to_le_bytes()));
        file.resize(start + length, 0);
    }
    let physical = |logical: usize| (logical + logical / 1020 * 4) as u64;
    let xml_at = file.len();
    file.extend(xml.as_bytes());
    file.resize(file.len().next_multiple_of(1020), 0);
    let pages = file.len() / 1020;
    file[16..24].copy_from_slice(&(pages as u64 * 1024).to_le_bytes());
    file[24..32].copy_from_slice(&physical(xml_at).to_le_bytes());
    file[32..40].copy_from_slice(&(xml.len() as u64).to_le_bytes());
    paged(&file)
}
