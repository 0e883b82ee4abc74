//! A gzipped file reads as the file in it.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::io::Write;

use common::{Sample, numbers, parse, refusal};
use flate2::{Compression, write::GzEncoder};
use footpoint_io::Format;

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn text_and_ply_are_unpacked() {
    let text = parse("a.pts.gz", packed(b"1 2 3 4\n"));
    assert_eq!(text.format, Format::Text);
    assert_eq!(numbers(&text.table, "intensity"), [4.0]);
    let mut ply =
        b"ply\nformat binary_big_endian 1.0\nelement vertex 300000\nproperty ushort x\nend_header\n".to_vec();
    ply.extend((0..300_000_u32).flat_map(|i| (i as u16).to_be_bytes()));
    let wanted: Vec<f64> = (0..300_000_u32).map(|i| f64::from(i as u16)).collect();
    assert_eq!(numbers(&parse("a.ply.gz", packed(&ply)).table, "x"), wanted);
}

#[test]
fn a_cut_or_short_file_is_refused() {
    let ply = b"ply\nformat binary_big_endian 1.0\nelement vertex 4000000000000\nproperty uint x\nend_header\n1234567";
    let message = refusal("a.ply.gz", packed(ply));
    assert!(message.contains("want 16000000000000 bytes, found 7"), "{message}");
    let whole = packed(&b"1 2 3\n".repeat(1000));
    let message = refusal("a.xyz.gz", &whole[..whole.len() / 2]);
    assert!(message.contains("cannot read"), "{message}");
}

#[test]
fn a_wrong_checksum_is_refused_even_behind_the_vertices() {
    let faces = "element face 2\nproperty uchar a\n";
    for (faces, rows) in [("", ""), (faces, "1\n2\n")] {
        let header = format!("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\n{faces}end_header\n");
        let mut bytes = packed(format!("{header}7\n{rows}").as_bytes());
        assert_eq!(parse("a.ply.gz", &bytes).table.rows(), 1);
        let checksum = bytes.len() - 8;
        bytes[checksum] ^= 1;
        let message = refusal("a.ply.gz", bytes);
        assert!(message.contains("checksum"), "{message}");
    }
}

#[test]
fn other_formats_are_named_inside_too() {
    let sample = Sample::new("a.las.gz", packed(b"LASF"));
    let message = footpoint_io::read(&sample.path).unwrap_err().to_string();
    assert!(message.contains("unpack it into a file first"), "{message}");
}

/// A gzip file that unpacks to `head` and then `mebibytes` times the same byte.
fn bomb(head: &[u8], byte: u8, mebibytes: usize) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(head).unwrap();
    let block = vec![byte; 1 << 20];
    (0..mebibytes).for_each(|_| encoder.write_all(&block).unwrap());
    encoder.finish().unwrap()
}

#[test]
fn a_file_that_unpacks_without_end_is_refused() {
    let ply = b"ply\nformat binary_little_endian 1.0\nelement filler 4000000000\nproperty uchar a\n\
                element vertex 1\nproperty uchar x\nend_header\n";
    for (name, bytes) in [("a.xyz.gz", bomb(b"1 2 3\n", b'\n', 300)), ("a.ply.gz", bomb(ply, 0, 300))] {
        let message = refusal(name, bytes);
        assert!(message.contains("cannot read") && message.contains("over 100 times as many"), "{message}");
        assert!(message.contains("unpack it and read the result"), "{message}");
    }
}

#[test]
fn much_repetition_alone_is_no_reason_to_refuse() {
    let input = parse("a.xyz.gz", bomb(b"1 2 3\n", b'\n', 200));
    assert_eq!(input.table.rows(), 1);
}

#[test]
fn other_text_and_arrays_are_unpacked_too() {
    assert_eq!(parse("a.obj.gz", packed(b"v 1 2 3\n")).format, Format::Obj);
    let ptx = b"1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n";
    assert_eq!(parse("a.ptx.gz", packed(ptx)).format, Format::Ptx);
}
