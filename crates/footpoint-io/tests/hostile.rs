//! No cut, no flipped byte and no garbage makes reading panic, hang or reserve absurd memory.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use common::{Lcg, Sample, extremes, real_files};
use footpoint_io::{Encoding, Overwrite, WriteOptions, read, write};

/// Reads the bytes; any result will do, as long as all columns are of one length.
fn survives(name: &str, bytes: &[u8]) {
    let sample = Sample::new(name, bytes);
    if let Ok(input) = read(&sample.path) {
        let rows = input.table.rows();
        assert!(input.table.columns.iter().all(|column| column.data.len() == rows));
        assert!(rows <= bytes.len() * 1100, "{rows} rows from {} bytes", bytes.len());
    }
}

fn torture(name: &str, bytes: &[u8]) {
    let mut random = Lcg(42);
    let cuts = (0..bytes.len()).step_by((bytes.len() / 150).max(1));
    for cut in cuts {
        survives(name, &bytes[..cut]);
    }
    for _ in 0..300 {
        let mut broken = bytes.to_vec();
        // Most damage goes to the first bytes, where headers are.
        let reach = if random.below(3) == 0 { broken.len() } else { broken.len().min(400) };
        for _ in 0..=random.below(4) {
            let at = random.below(reach);
            broken[at] = match random.below(3) {
                0 => b"0123456789-.,;\" \r\n\t#"[random.below(20)],
                1 => broken[at] ^ (1 << random.below(8)),
                _ => random.below(256) as u8,
            };
        }
        survives(name, &broken);
    }
}

#[test]
fn our_own_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, ply) in [
        ("a.ply", Encoding::Ascii),
        ("a.ply", Encoding::LittleEndian),
        ("a.ply", Encoding::BigEndian),
        ("a.csv", Encoding::Ascii),
        ("a.xyz", Encoding::Ascii),
        ("a.npy", Encoding::Ascii),
        ("a.npz", Encoding::Ascii),
    ] {
        let path = folder.path().join(name);
        write(
            &path,
            &extremes(),
            &WriteOptions { overwrite: Overwrite::Replace, ply, ..WriteOptions::default() },
        )
        .unwrap();
        torture(name, &std::fs::read(&path).unwrap());
    }
}

#[test]
fn lists_in_vertices() {
    let header = "ply\nformat binary_little_endian 1.0\nelement a 2\nproperty list uint double l\n\
                  element vertex 3\nproperty list int uchar l\nproperty short x\nelement f 1\n\
                  property list uchar int i\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend([0; 8]);
    for i in 0..3_u8 {
        bytes.extend([i, 0, 0, 0]);
        bytes.extend(vec![7; usize::from(i)]);
        bytes.extend([1, 0]);
    }
    bytes.extend([1, 0, 0, 0, 0]);
    assert_eq!(common::parse("a.ply", &bytes).table.rows(), 3);
    torture("a.ply", &bytes);
}

#[test]
fn real_small_files() {
    let Some(data) = real_files() else { return };
    for file in [
        "ply/draco_Box_CR_header.ply",
        "ply/rs_greg_turk_example2_ok_ascii.ply",
        "ply/rs_tetrahedron_big_endian.ply",
        "ply/pdal_sized_dims.ply",
        "text/pdal_autzen.pts",
        "text/pdal_quoted.txt",
        "text/pasture_10_points_ascii.txt",
        "text/pdal_multiple-and-transform.ptx",
        "obj/pdal_box.obj",
        "malformed/pdal_simple_binary.obj",
        "mesh/dragon_vrip_res3.ply.gz",
    ] {
        let name = file.rsplit('/').next().unwrap();
        torture(name, &std::fs::read(data.join(file)).unwrap());
    }
}

#[test]
fn garbage() {
    let mut random = Lcg(7);
    for size in [1, 2, 10, 1000] {
        for _ in 0..100 {
            let mut bytes: Vec<u8> = (0..size).map(|_| random.below(256) as u8).collect();
            survives("a.xyz", &bytes);
            let mut ply = b"ply\n".to_vec();
            ply.append(&mut bytes);
            survives("a.ply", &ply);
        }
    }
}
