//! What can be wrong with a PTX file.

use std::io;

use thiserror::Error;

/// Why a PTX file cannot be read; scans count from 0.
#[derive(Debug, Error)]
pub enum PtxError {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// There is nothing but blank lines.
    #[error("no scan; a PTX file begins with its numbers of columns and rows")]
    NoScan,
    /// A value that is no number.
    #[error("line {line}: `{content}` is not a number")]
    NotANumber {
        /// The line, from 1.
        line: u64,
        /// The value, shortened.
        content: String,
    },
    /// A line of a scan's head of another length than PTX has there.
    #[error("line {line}: {found} values, but line {part} of the head of scan {scan} has {wanted}")]
    HeadLine {
        /// The line, from 1.
        line: u64,
        /// The scan.
        scan: usize,
        /// The line of the head, from 1.
        part: usize,
        /// The values of the line.
        found: usize,
        /// The values it should have.
        wanted: usize,
    },
    /// A number of columns or rows that is none.
    #[error("line {line} or the next: {value} is no number of grid columns or rows")]
    Count {
        /// The first line of the head, from 1.
        line: u64,
        /// The number.
        value: f64,
    },
    /// A matrix that is no pose.
    #[error(
        "line {line}: the matrix of scan {scan} is no pose: its last column is not 0 0 0 1, or a number is not finite"
    )]
    Matrix {
        /// The matrix' last line, from 1.
        line: u64,
        /// The scan.
        scan: usize,
    },
    /// The file ends inside a scan's head.
    #[error("unexpected end of file in the head of scan {scan}, after line {line}; get the whole file again")]
    EndInHead {
        /// The scan.
        scan: usize,
        /// The last line there is.
        line: u64,
    },
    /// The file ends before a scan's last cell.
    #[error("unexpected end of file in scan {scan}, cell {cell} of {cells}; get the whole file again")]
    EndInCells {
        /// The scan.
        scan: usize,
        /// The missing cell, from 1.
        cell: u64,
        /// The cells of the scan.
        cells: u64,
    },
    /// A cell of a number of values that has no meaning.
    #[error("line {line}: a cell of {found} values; PTX has x y z intensity, with or without red green blue")]
    Cell {
        /// The line, from 1.
        line: u64,
        /// The values of the line.
        found: usize,
    },
    /// A cell of another length than the first of its scan.
    #[error("line {line}: {found} values, but the first cell of the scan, line {first}, has {wanted}")]
    Width {
        /// The line, from 1.
        line: u64,
        /// The values of the line.
        found: usize,
        /// The first cell's line, from 1.
        first: u64,
        /// Its values.
        wanted: usize,
    },
}
