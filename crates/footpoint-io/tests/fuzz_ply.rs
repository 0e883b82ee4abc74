//! Damaged PLY files make the reader neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_ply`; guided by coverage: `cargo bolero test -p footpoint-io --test fuzz_ply TARGET`.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use std::io::Write;

use bolero::check;
use common::extremes;
use flate2::{Compression, write::GzEncoder};
use footpoint_io::{Encoding, WriteOptions};
use fuzz::{Damage, Target};

const LISTS: &str = "ply\nformat ascii 1.0\ncomment a\nobj_info b\nelement range_grid 2\nproperty list uchar int i\n\
                     element vertex 2\nproperty list int uchar l\nproperty short x\nelement face 1\n\
                     property list uchar int i\nend_header\n0\n2 7 8\n1 9 4\n0 5\n3 1 2 3\n";

#[test]
fn ply() {
    let mut target = Target::new().file("a.ply", LISTS);
    for ply in [Encoding::Ascii, Encoding::LittleEndian, Encoding::BigEndian] {
        target = target.written("a.ply", &extremes(), &WriteOptions { ply, ..WriteOptions::default() });
    }
    let mut lists = LISTS.replace("ascii", "binary_big_endian").into_bytes();
    lists.truncate(lists.iter().rposition(|byte| *byte == b'r').unwrap() + 2);
    lists.extend([0, 2, 0, 0, 0, 7, 0, 0, 0, 8, 0, 0, 0, 1, 9, 0, 4, 0, 0, 0, 0, 0, 5, 1, 0, 0, 0, 3]);
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(LISTS.as_bytes()).unwrap();
    let target = target.file("a.ply", lists).file("a.ply.gz", packer.finish().unwrap());
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
