//! Damaged text, OBJ and PTX files make the readers neither panic nor hang nor reserve.
//!
//! `cargo test` tries for a second. Longer, and all that was found again: `BOLERO_RANDOM_TEST_TIME_MS=600000 cargo
//! test -p footpoint-io --test fuzz_text`; guided by coverage: `cargo bolero test -p footpoint-io --test fuzz_text TARGET`.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;
#[path = "common/fuzz.rs"]
mod fuzz;

use bolero::check;
use common::{extremes, f64_table};
use footpoint_io::WriteOptions;
use fuzz::{Damage, Target};

#[test]
fn text() {
    let mut target = Target::new()
        .file("a.txt", "# by a test\nx y z name\n1 2 3 \"a b\"\n4 5 6 c\n")
        .file("a.csv", "x;y;z;t\n1;2;;a\n-1e5;nan;7;b\n")
        .file("a.pts", "2\n1 2 3 -5 255 0 0\n4 5 6 7 0 255 0\n")
        .file("a.xy", "1\t2\r\n3\t4\r\n")
        .file("a.xyz", "1 2 3 4 5 6\r7 8 9 10 11 12\r");
    for name in ["a.csv", "a.txt", "a.xyz"] {
        target = target.written(name, &extremes(), &WriteOptions::default());
    }
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn obj() {
    let columns: Vec<(&str, &[f64])> = ["x", "y", "z", "w", "red", "green", "blue", "nx", "ny", "nz"]
        .into_iter()
        .map(|name| (name, [0.25, 0.5].as_slice()))
        .collect();
    let target = Target::new()
        .file("a.obj", "# a\no b\nmtllib c.mtl\nv 1 2 3\nv 4 5 6\nvt 0 0\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2//2 \\\n-1/1/-1\nl 1 2\n")
        .file("a.obj", "v 1 2 3 0.5\rv 1 2 3 0.5\r")
        .file("a", "vn 0 0 1\nv 1 2 3 0 0 1\ncurv 0 1 1 2\n")
        .written("a.obj", &f64_table(&columns), &WriteOptions::default());
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}

#[test]
fn ptx() {
    let head = "1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n";
    let target = Target::new()
        .file(
            "a.ptx",
            format!("2\n1\n0 0 0\n{head}1 2 3 0.5\n0 0 0 0.5\n\n1\n1\n1 2 3\n{head}1 2 3 0.5 7 8 9"),
        )
        .file("a", format!("1\n1\n0 0 0\n{head}1 2 3\n0\n9\n0 0 0\n{head}"));
    check!().with_type::<Damage>().for_each(|damage| target.survives(damage));
}
