//! E57 (ASTM E2807): all scans of a file as one table, through the crate `e57`.
//!
//! Coordinates are those of the file's common frame: poses applied, spherical ones converted. Where a scan has both,
//! the Cartesian ones count if valid, and the spherical ones are columns besides. Points without valid coordinates
//! stay as rows: their `x y z` are NaN, so that nothing downstream takes them for points, `invalid_state` says why
//! (1: a direction only, 2: nothing), and what stands in the file is kept for writing. Integers come in the smallest
//! type that holds their stated range, scaled integers as `F64`. Of several scans, the column `scan` counts from 0.
//! Colours and intensities are as stored; a note says so where the declared limits are not those of their type.
//!
//! Written are points in the common frame, without poses: undoing those would change the last bits.

mod error;
mod file;
mod pose;
mod read;
mod records;
mod write;

pub use error::E57Error;
pub use pose::Pose;
pub(crate) use read::read;
pub(crate) use write::{check, check_table, write};

/// What only an E57 file can hold: its scans, and the coordinates of invalid points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct E57Kept {
    scans: Vec<E57Scan>,
    /// Row and coordinates as stated, turned by the pose and not moved.
    stated: Vec<(usize, [f64; 3])>,
    extensions: Vec<records::Extended>,
}

/// A scan of an E57 file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct E57Scan {
    /// Its name.
    pub name: Option<String>,
    /// What tells it from all other scans.
    pub guid: Option<String>,
    /// Its description.
    pub description: Option<String>,
    /// Its points: that many rows of the table, behind those of the scans before it.
    pub rows: usize,
    /// From its own frame to the common one, where they differ.
    pub pose: Option<Pose>,
    /// Least and largest red, green and blue.
    colour_limits: Option<[f64; 6]>,
    /// Least and largest intensity.
    intensity_limits: Option<[f64; 2]>,
}

impl E57Kept {
    /// The scans in the file's order.
    pub fn scans(&self) -> &[E57Scan] {
        &self.scans
    }

    /// The coordinates that the file states for invalid points, with their rows: turned by the scan's pose, not moved.
    pub fn stated(&self) -> &[(usize, [f64; 3])] {
        &self.stated
    }
}

/// Whether a file of these first bytes claims to be E57.
pub(crate) fn is_e57(head: &[u8]) -> bool {
    head.starts_with(b"ASTM-E57")
}
