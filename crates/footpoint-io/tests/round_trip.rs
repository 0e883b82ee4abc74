//! A table that is written and read again holds the same numbers, to the bit, in the same order.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use common::{bits, extremes, f64_table, names};
use footpoint_io::{Column, Data, Encoding, Format, Input, Table, WriteOptions, read, write};

fn there_and_back(table: &Table, name: &str, ply: Encoding) -> Input {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(&path, table, &WriteOptions { ply, ..WriteOptions::default() }).unwrap();
    read(&path).unwrap()
}

#[test]
fn ply_keeps_types_bits_names_and_comments() {
    let table = extremes();
    for encoding in [Encoding::Ascii, Encoding::LittleEndian, Encoding::BigEndian] {
        let back = there_and_back(&table, "t.ply", encoding);
        assert_eq!(back.format, Format::Ply(encoding));
        assert_eq!(back.table.comments, table.comments);
        assert_eq!(names(&back.table), names(&table));
        assert!(back.report.notes.is_empty(), "{:?}", back.report);
        for (old, new) in table.columns.iter().zip(&back.table.columns) {
            let same_type = std::mem::discriminant(&old.data) == std::mem::discriminant(&new.data);
            assert!(same_type, "{encoding:?} {}", old.name);
            assert_eq!(bits(&old.data), bits(&new.data), "{encoding:?} {}", old.name);
        }
    }
}

#[test]
fn binary_ply_keeps_the_bits_of_a_nan() {
    let odd = f64::from_bits(0x7ff8_0000_0000_1234);
    for encoding in [Encoding::LittleEndian, Encoding::BigEndian] {
        let back = there_and_back(&f64_table(&[("x", &[odd])]), "t.ply", encoding);
        assert_eq!(bits(&back.table.columns[0].data), [odd.to_bits()]);
    }
}

#[test]
fn text_keeps_numbers_and_names() {
    let table = extremes();
    for name in ["t.csv", "t.txt", "t.xyz", "t.pwn", "t.xy"] {
        let back = there_and_back(&table, name, Encoding::Ascii);
        assert_eq!(back.format, Format::Text);
        assert_eq!(names(&back.table), names(&table), "{name}");
        assert!(back.report.notes.is_empty(), "{name} {:?}", back.report);
        for (old, new) in table.columns.iter().zip(&back.table.columns) {
            let new = match (&old.data, &new.data) {
                // A 32-bit number reads back as the same decimal, so as the same 32-bit number.
                (Data::F32(_), Data::F64(v)) => Data::F32(v.iter().map(|v| *v as f32).collect()),
                (_, new) => new.clone(),
            };
            assert_eq!(bits(&old.data), bits(&new), "{name} {}", old.name);
        }
        let comments = if name == "t.csv" { &[] } else { table.comments.as_slice() };
        assert_eq!(back.table.comments, comments, "{name}");
    }
}

#[test]
fn pts_keeps_numbers_and_their_places() {
    let table = f64_table(&[("x", &[1.0, 2.5]), ("y", &[0.0, -0.0]), ("z", &[7.0, 8.0]), ("w", &[1.0, 2.0])]);
    let back = there_and_back(&table, "t.pts", Encoding::Ascii);
    assert_eq!(names(&back.table), ["x", "y", "z", "intensity"]);
    for (old, new) in table.columns.iter().zip(&back.table.columns) {
        assert_eq!(bits(&old.data), bits(&new.data));
    }
}

#[test]
fn many_blocks_of_rows_stay_in_order() {
    let rows = 100_000;
    let mut table = f64_table(&[("x", &(0..rows).map(f64::from).collect::<Vec<_>>())]);
    table.set(Column::new("odd", Data::U8((0..rows).map(|i| (i % 251) as u8).collect())));
    for encoding in [Encoding::Ascii, Encoding::LittleEndian, Encoding::BigEndian] {
        assert_eq!(there_and_back(&table, "t.ply", encoding).table, table);
    }
    for name in ["t.npy", "t.npz"] {
        assert!(there_and_back(&table, name, Encoding::Ascii).table == table, "{name}");
    }
}

#[test]
fn empty_comments_and_those_of_two_lines_are_kept_as_lines() {
    let mut table = f64_table(&[("x", &[1.0]), ("y", &[2.0]), ("z", &[3.0])]);
    table.comments = ["", "one\ntwo", ""].map(str::to_owned).to_vec();
    for name in ["t.ply", "t.txt", "t.xyz", "t.obj"] {
        let back = there_and_back(&table, name, Encoding::Ascii).table;
        assert_eq!(back.comments, ["", "one", "two", ""], "{name}");
    }
}

#[test]
fn numpy_files_keep_types_bits_and_names() {
    let mut table = extremes();
    table.set(Column::new("h", Data::I64(vec![i64::MIN, i64::MAX, 0, 1, -1, 2])));
    table.set(Column::new("i'\\ü/j", Data::U64(vec![u64::MIN, u64::MAX, 0, 1, 2, 3])));
    for (name, format) in [("t.npy", Format::Npy), ("t.npz", Format::Npz)] {
        let back = there_and_back(&table, name, Encoding::Ascii);
        assert_eq!(back.format, format);
        assert!(back.report.notes.is_empty(), "{:?}", back.report);
        assert_eq!(names(&back.table), names(&table));
        for (old, new) in table.columns.iter().zip(&back.table.columns) {
            match (&old.data, &new.data) {
                (Data::I64(old), Data::I64(new)) => assert_eq!(old, new),
                (Data::U64(old), Data::U64(new)) => assert_eq!(old, new),
                (old_data, new_data) => {
                    assert_eq!(
                        std::mem::discriminant(old_data),
                        std::mem::discriminant(new_data),
                        "{}",
                        old.name
                    );
                    assert_eq!(bits(old_data), bits(new_data), "{name} {}", old.name);
                }
            }
        }
    }
}

#[test]
fn an_empty_table_keeps_its_columns() {
    let table = f64_table(&[("x", &[]), ("y", &[]), ("label", &[])]);
    for name in ["t.ply", "t.csv", "t.txt", "t.xyz", "t.npy", "t.npz"] {
        assert_eq!(there_and_back(&table, name, Encoding::LittleEndian).table, table, "{name}");
    }
    assert_eq!(there_and_back(&table, "t.pts", Encoding::LittleEndian).table.rows(), 0);
}

#[test]
fn text_values_and_odd_names_are_quoted() {
    let mut table = f64_table(&[("# no comment", &[1.0, 2.0, 3.0]), ("x", &[1.0; 3]), ("y", &[1.0; 3])]);
    let values = ["a, b; c", "say \"so\"", "", "plain"];
    table.set(Column::new("what, where", Data::Text(values[..3].iter().map(ToString::to_string).collect())));
    for name in ["t.csv", "t.txt", "t.xyz"] {
        assert_eq!(there_and_back(&table, name, Encoding::Ascii).table, table, "{name}");
    }
}

#[test]
fn usual_numbers_are_written_plainly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.xyz");
    let table =
        f64_table(&[("x", &[1.0, 1e300]), ("y", &[0.5, f64::NAN]), ("z", &[-2e6, f64::NEG_INFINITY])]);
    write(&path, &table, &WriteOptions::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text, "# x y z\n1 0.5 -2000000\n1e300 nan -inf\n");
}
