//! What can be wrong with an E57 file.

use std::io;

use thiserror::Error;

/// Why an E57 file cannot be read. Scans and points are counted from 1.
#[derive(Debug, Error)]
pub enum E57Error {
    /// The operating system failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// There is no E57 file.
    #[error("not an E57 file, it does not begin with `ASTM-E57`; get the file again")]
    NotE57,
    /// An E57 file inside a gzipped one.
    #[error("a gzipped E57 file; unpack it first (gunzip)")]
    Gzipped,
    /// The file is shorter than its header says.
    #[error(
        "unexpected end of file: the header states {stated} bytes, found {found}; get the whole file again"
    )]
    Cut {
        /// The length in the header.
        stated: u64,
        /// The length of the file.
        found: u64,
    },
    /// The description of the scans is damaged.
    #[error("the header or its XML section cannot be read: {0}")]
    Description(String),
    /// A scan names an attribute twice.
    #[error("scan {scan} has two attributes that make column `{name}`")]
    DuplicateName {
        /// The scan.
        scan: usize,
        /// The column.
        name: String,
    },
    /// A scan has points without coordinates.
    #[error("scan {scan} has neither Cartesian nor spherical coordinates")]
    NoCoordinates {
        /// The scan.
        scan: usize,
    },
    /// A scan whose points take no bytes: their number is only a claim.
    #[error("scan {scan} states {points} points, but no attribute of them takes a byte of the file")]
    NoBytes {
        /// The scan.
        scan: usize,
        /// The points it states.
        points: u64,
    },
    /// More points than the file has bytes for.
    #[error("the scans state {points} points, which want {wanted} bytes at the least; the file has {found}")]
    TooManyPoints {
        /// The points of all scans.
        points: u128,
        /// The bytes that so many take.
        wanted: u128,
        /// The length of the file.
        found: u64,
    },
    /// More columns than any file has use for.
    #[error("the scans have {found} different attributes; at most {most} are read")]
    TooWide {
        /// The attributes of all scans.
        found: usize,
        /// The limit.
        most: usize,
    },
    /// A pose that turns nothing into something.
    #[error("the pose of scan {scan} has no rotation: its quaternion is zero or not finite")]
    Pose {
        /// The scan.
        scan: usize,
    },
    /// The points cannot be read on.
    #[error("scan {scan}, point {point} of {points}: {what}; get the whole file again")]
    Points {
        /// The scan.
        scan: usize,
        /// The point that could not be read.
        point: u64,
        /// The points the scan states.
        points: u64,
        /// What stopped the reader.
        what: String,
    },
    /// A value outside the range that the scan states.
    #[error("scan {scan}, point {point}: a value of `{name}` outside the range that the scan states")]
    Value {
        /// The scan.
        scan: usize,
        /// The point.
        point: u64,
        /// The column.
        name: String,
    },
}
