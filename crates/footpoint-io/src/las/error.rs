//! What can be wrong with a LAS file, and what a LAS file cannot hold.

use std::io;

use thiserror::Error;

use crate::roles::RolesError;

/// Why a LAS, LAZ or COPC file cannot be read.
#[derive(Debug, Error)]
pub enum LasError {
    /// The operating system failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The name says LAS, the first bytes do not.
    #[error("byte 0: not a LAS file, its first four bytes are not `LASF`")]
    Signature,
    /// A LAS file inside a gzip file, or a pipe.
    #[error("LAS cannot be read from a packed file or a pipe; unpack it into a file first")]
    NotSeekable,
    /// The file ends within its header.
    #[error("the header wants {wanted} bytes, the file has {found}; get the whole file again")]
    Header {
        /// The bytes the header needs.
        wanted: u64,
        /// The bytes there are.
        found: u64,
    },
    /// A version that is not known.
    #[error("byte 24: LAS version {major}.{minor} is not supported; 1.0 to 1.4 are")]
    Version {
        /// The number before the dot.
        major: u8,
        /// The number behind it.
        minor: u8,
    },
    /// A point format that does not exist.
    #[error("byte 104: unknown point format {0}; LAS has 0 to 10")]
    PointFormat(u8),
    /// Point records too short for their format.
    #[error("byte 105: point records of {found} bytes, but point format {format} wants at least {least}")]
    RecordLength {
        /// The point format.
        format: u8,
        /// The length the header states.
        found: u16,
        /// The length of the format's own fields.
        least: usize,
    },
    /// A scale of coordinates that is zero or no number.
    #[error("byte 131: scale {scale} and offset {offset} of {axis} give no coordinates")]
    Scale {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// The scale.
        scale: f64,
        /// The offset.
        offset: f64,
    },
    /// More points than any real packed file of this size holds.
    #[error(
        "the header says {points} points, which {size} packed bytes can hardly hold; if the file is whole, \
         unpack it to .las first"
    )]
    TooMany {
        /// The points the header states.
        points: u64,
        /// The size of the file.
        size: u64,
    },
    /// The record that says how the points are packed is missing or does not fit the points.
    #[error("cannot unpack the points: {0}")]
    Packing(String),
    /// The table of packed chunks is missing, cut or contradicts the header.
    #[error("the table of packed chunks, at byte {at}, {what}; get the whole file again")]
    ChunkTable {
        /// Where the table should be.
        at: u64,
        /// What is wrong with it.
        what: String,
    },
    /// A packed chunk that does not unpack.
    #[error("the packed points from point {first} on, at byte {at}, are broken: {what}; get the file again")]
    Chunk {
        /// The first point of the chunk, from 1.
        first: u64,
        /// Where the chunk starts.
        at: u64,
        /// What the decoder says.
        what: String,
    },
    /// The watch ended reading.
    #[error("reading was stopped")]
    Stopped,
}

/// What stands against writing a table as LAS.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum LasMisfit {
    /// No coordinates.
    #[error("{0}")]
    Roles(#[from] RolesError),
    /// A column of text.
    #[error("column `{0}` holds text, which LAS cannot; write csv or txt, or leave the column out")]
    Text(String),
    /// A name longer than the 32 bytes there are.
    #[error("column name `{0}` is longer than the 32 bytes LAS has for it; rename it")]
    Name(String),
    /// A point without finite coordinates.
    #[error("column `{axis}`, row {row}: {value} is no coordinate that LAS can hold; leave the point out")]
    Coordinate {
        /// The column.
        axis: String,
        /// The row, from 1.
        row: usize,
        /// The value.
        value: f64,
    },
    /// More columns than a point record can have.
    #[error("the columns beside those of point format {format} are too many for LAS; leave some out")]
    TooWide {
        /// The point format.
        format: u8,
    },
    /// More points than old LAS can count.
    #[error("{0} points are more than LAS before 1.4 can count; write ply, or fewer points")]
    TooManyPoints(usize),
    /// The name of a format that is read only.
    #[error("COPC files are read, but not written; end the name in .laz without .copc")]
    Copc,
}
