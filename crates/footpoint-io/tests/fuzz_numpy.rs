//! Damaged NumPy files make the readers neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_numpy`; guided by coverage: `cargo bolero test -p footpoint-io --test fuzz_numpy TARGET`.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use std::io::{Cursor, Write};

use bolero::check;
use common::{extremes, f64_table};
use footpoint_io::WriteOptions;
use fuzz::{Damage, Target};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn array(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

fn plain(order: &str, shape: &str) -> Vec<u8> {
    array(1, &format!("{{'descr': '<f4', 'fortran_order': {order}, 'shape': {shape}, }}\n"), &[1; 24])
}

#[test]
fn npy() {
    let records = "{'descr': [('x', '>f8'), ('', '|V2'), ('c', '|u1', (2, 2)), ('n', [('a', '<i2'), ('b', '|S3')]), \
                   ('t', '<U2')], 'fortran_order': False, 'shape': (2,), }\n";
    let target = Target::new()
        .file("a.npy", plain("False", "(2, 3)"))
        .file("a.npy", plain("True", "(2, 3)"))
        .file("a.npy", plain("False", "(1, 2, 3)"))
        .file("a.npy", array(3, records, &[65; 54]))
        .written("a.npy", &extremes(), &WriteOptions::default());
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn npz() {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in [("points.npy", plain("False", "(2, 3)")), ("uv.npy", plain("True", "(2, 3)"))] {
        archive.start_file(name, SimpleFileOptions::default()).unwrap();
        archive.write_all(&bytes).unwrap();
    }
    let target = Target::new().file("a.npz", archive.finish().unwrap().into_inner()).written(
        "a.npz",
        &f64_table(&[("x", &[1.0]), ("y", &[2.0])]),
        &WriteOptions::default(),
    );
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
