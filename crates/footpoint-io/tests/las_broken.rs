//! Broken LAS, LAZ and COPC files: an error that names the place, or what can be read with a note; never a panic.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::time::{Duration, Instant};

use common::{Sample, real_files, refusal};
use footpoint_io::{Bounds, ReadOptions, read, read_with};

/// Files of the folder `malformed`: refused with this reason, or read with so many points and this note.
const MALFORMED: [(&str, Result<(usize, &str), &str>); 10] = [
    ("cut.las", Ok((0, "its header says 1 points, 0 are there"))),
    ("cut.laz", Err("the table of packed chunks")),
    ("cut.copc.laz", Err("the table of packed chunks")),
    ("laspy_append-bug.laz", Ok((37_805, ""))),
    ("pdal_bad-geotiff-keys.las", Ok((10, "some of the GeoTIFF keys are empty"))),
    ("pdal_bad_vlr_count.las", Ok((10, "variable length records"))),
    ("pdal_garbage_nVariableLength.las", Err("")),
    ("pdal_gps-time-nan.las", Ok((1, ""))),
    ("pdal_lots_of_vlr.las", Ok((1, ""))),
    ("pdal_spurious.las", Ok((1065, ""))),
];

#[test]
fn malformed_files() {
    let Some(data) = real_files() else { return };
    for (file, wanted) in MALFORMED {
        let start = Instant::now();
        match (read(&data.join("malformed").join(file)), wanted) {
            (Ok(input), Ok((rows, note))) => {
                assert_eq!(input.table.rows(), rows, "{file}");
                let notes = input.report.notes.join("; ");
                assert_eq!(notes.is_empty(), note.is_empty(), "{file}: {notes}");
                assert!(notes.contains(note), "{file}: {notes}");
            }
            (Err(error), Err(reason)) => assert!(error.to_string().contains(reason), "{error}"),
            (found, wanted) => {
                panic!(
                    "{file}: {:?} {:?}, {wanted:?}",
                    found.as_ref().map(|f| (f.table.rows(), f.report.clone())),
                    found.as_ref().err().map(|e| e.to_string())
                )
            }
        }
        assert!(start.elapsed() < Duration::from_secs(1), "{file} is slow");
    }
}
