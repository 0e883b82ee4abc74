//! How fast files of 200 MB are read, in bytes a second of CPU time; `scripts/bench files` runs it.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use footpoint_io::read;
use rustix::time::{ClockId, clock_gettime};

const SIZE: usize = 200_000_000;

/// A file in the target folder, made once.
fn file(name: &str, make: impl FnOnce() -> Vec<u8>) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if !path.exists() {
        std::fs::write(&path, make()).unwrap();
    }
    path
}

fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Reads a file four times and takes the fastest; the first warms the cache of the system.
fn measure(name: &str, path: &Path, least: f64) {
    let size = path.metadata().unwrap().len() as f64;
    let seconds = || {
        let start = cpu_seconds();
        let rows = read(path).unwrap().table.rows();
        assert!(rows > 1_000_000);
        cpu_seconds() - start
    };
    let fastest = (0..4).map(|_| seconds()).fold(f64::INFINITY, f64::min);
    let speed = 1e-6 * size / fastest;
    println!("{name}: {speed:.0} MB/s of {:.0} MB", 1e-6 * size);
    assert!(speed >= least, "{name}: {speed:.0} MB/s, {least} wanted");
}

/// Coordinates as scanners give them, the same in each run.
fn coordinate(index: usize, axis: usize) -> f64 {
    let bits = (index as u64 * 3 + axis as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
    [596_000.0, 243_000.0, 70.0][axis] + bits as f64 * 1e-5
}

fn text(row: impl Fn(&mut String, usize)) -> Vec<u8> {
    let mut text = String::with_capacity(SIZE + 200);
    for index in 0.. {
        if text.len() >= SIZE {
            break;
        }
        row(&mut text, index);
    }
    text.into_bytes()
}

#[test]
#[ignore = "measures; wants a release build"]
fn binary_ply() {
    let rows = SIZE / 27;
    let path = file("speed.ply", || {
        let mut bytes = format!("ply\nformat binary_little_endian 1.0\nelement vertex {rows}\n").into_bytes();
        bytes.extend(b"property double x\nproperty double y\nproperty double z\n");
        bytes.extend(b"property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n");
        for index in 0..rows {
            (0..3).for_each(|axis| bytes.extend(coordinate(index, axis).to_le_bytes()));
            bytes.extend([index as u8, 7, 9]);
        }
        bytes
    });
    measure("binary PLY", &path, 500.0);
}

#[test]
#[ignore = "measures; wants a release build"]
fn ascii_ply() {
    let path = file("speed_ascii.ply", || {
        let rows = SIZE / 34;
        text(|line, index| {
            if index == 0 {
                write!(line, "ply\nformat ascii 1.0\nelement vertex {rows}\n").unwrap();
                line.push_str("property double x\nproperty double y\nproperty double z\nend_header\n");
            }
            let [x, y, z] = [0, 1, 2].map(|axis| coordinate(index, axis));
            writeln!(line, "{x:.3} {y:.3} {z:.3}").unwrap();
        })
    });
    measure("ascii PLY, x y z to the millimetre", &path, 300.0);
}

#[test]
#[ignore = "measures; wants a release build"]
fn text_of_millimetres() {
    let path = file("speed_mm.xyz", || {
        text(|line, index| {
            let [x, y, z] = [0, 1, 2].map(|axis| coordinate(index, axis));
            writeln!(line, "{x:.3} {y:.3} {z:.3}").unwrap();
        })
    });
    measure("text, x y z to the millimetre", &path, 300.0);
}

#[test]
#[ignore = "measures; wants a release build"]
fn text_of_full_doubles() {
    let path = file("speed_full.xyz", || {
        text(|line, index| {
            let [x, y, z] = [0, 1, 2].map(|axis| coordinate(index, axis) / 3.0);
            writeln!(line, "{x} {y} {z}").unwrap();
        })
    });
    measure("text, x y z to the last digit", &path, 300.0);
}

#[test]
#[ignore = "measures; wants a release build"]
fn csv_with_colours() {
    let path = file("speed.csv", || {
        text(|line, index| {
            let header = if index == 0 { "x,y,z,intensity,red,green,blue\n" } else { "" };
            let [x, y, z] = [0, 1, 2].map(|axis| coordinate(index, axis));
            let (i, r, g) = (index % 1000, index % 256, index / 256 % 256);
            writeln!(line, "{header}{x:.3},{y:.3},{z:.3},0.{i:03},{r},{g},17").unwrap();
        })
    });
    measure("csv with colours", &path, 300.0);
}
