//! Point-cloud files as tables of columns.
//!
//! This crate turns the bytes of a file into a [`Table`] of named columns and back; what the columns
//! mean (coordinates, normals) is the business of [`roles`] alone. Every column of a file is kept in its
//! own type and in its own place, so a job can add columns and write the rest back untouched.
//!
//! Reading: PLY (ascii, little and big endian), PCD (ascii, binary, compressed), text (`xyz csv txt pts pwn
//! xy`, with or without a header), OBJ, PTX and NumPy arrays (`npy`), each also gzipped; LAS 1.0 to 1.4, LAZ
//! and COPC; E57 (all scans, in their common frame); NumPy archives (`npz`). Writing: the same formats but
//! COPC and PTX, not gzipped, never half a file. Points that an E57 file calls invalid stay as rows, with
//! coordinates that are no numbers. Packed files are unpacked to 256 MiB in any case, and beyond that to a hundred
//! times their size, which points do not reach: a small file cannot fill the memory.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("points.xyz");
//! # std::fs::write(&path, "0 0 0\n1 0 0.5\n")?;
//! use footpoint_io::{Column, Data, WriteOptions, read, roles::Roles, write};
//!
//! let mut input = read(&path)?;
//! let roles = Roles::find(&input.table)?;
//! assert_eq!(roles.dimension(), 3);
//! input.table.set(Column::new("distance", Data::F64(vec![0.0; input.table.rows()])));
//! write(&folder.path().join("points.ply"), &input.table, &WriteOptions::default())?;
//! # Ok(())
//! # }
//! ```

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod e57;
mod excerpt;
mod format;
mod input;
mod las;
mod npy;
mod obj;
mod options;
mod output;
mod pcd;
mod ply;
mod ptx;
pub mod roles;
mod rows;
mod scalar;
mod source;
mod table;
mod text;

pub use e57::{E57Error, E57Kept, E57Scan, Pose};
pub use format::{Encoding, Format};
pub use input::{Input, OtherElement, ReadError, ReadProblem, ReadReport, read, read_with};
pub use las::{LasError, LasKept, LasMisfit, UNPACKING};
pub use npy::NpyError;
pub use obj::ObjError;
pub use options::{Bounds, ReadOptions, Watch};
pub use output::{
    Overwrite, WriteError, WriteOptions, WriteProblem, check_file, check_table, check_writable, write,
    write_file, write_with,
};
pub use pcd::{PcdEncoding, PcdError, PcdKept};
pub use ply::PlyError;
pub use ptx::PtxError;
pub use table::{Column, Data, Frame, Kept, Table, Unit};
pub use text::TextError;
