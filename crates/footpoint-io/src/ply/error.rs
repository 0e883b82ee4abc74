//! What can be wrong with a PLY file.

use std::io;

use thiserror::Error;

use crate::scalar::PLY_TYPE_NAMES;

/// Why a PLY file cannot be read.
#[derive(Debug, Error)]
pub enum PlyError {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// A header line that is not PLY.
    #[error("line {line}: {what}: `{content}`")]
    Header {
        /// The line, from 1.
        line: u64,
        /// What is wrong with it.
        what: &'static str,
        /// The line itself, shortened.
        content: String,
    },
    /// A property of a type that does not exist.
    #[error("line {line}: unknown type `{name}`; PLY has {PLY_TYPE_NAMES}")]
    UnknownType {
        /// The line, from 1.
        line: u64,
        /// The unknown word.
        name: String,
    },
    /// The file ends inside the header.
    #[error("unexpected end of file in the header, after line {line}: no `end_header`")]
    HeaderEnd {
        /// The last line there is.
        line: u64,
    },
    /// There is no `format` line.
    #[error("the header has no line `format ascii|binary_little_endian|binary_big_endian 1.0`")]
    NoFormat,
    /// There is no element `vertex`, so no points.
    #[error("no element named `vertex`, which holds the points; elements found: {found}")]
    NoVertex {
        /// The names found, or `none`.
        found: String,
    },
    /// An ascii file ends before its last row.
    #[error("unexpected end of file in element {element}, row {row} of {rows}; get the whole file again")]
    EndInRow {
        /// The element.
        element: String,
        /// The row cut or missing, from 1.
        row: u64,
        /// The rows the header states.
        rows: u64,
    },
    /// A binary file ends before its last row.
    #[error(
        "unexpected end of file in element {element}: its {rows} rows want {wanted} bytes, found {found}; \
         get the whole file again"
    )]
    EndInBytes {
        /// The element.
        element: String,
        /// The rows the header states.
        rows: u64,
        /// The bytes that many rows need, at the least.
        wanted: u128,
        /// The bytes there are.
        found: u64,
    },
    /// An ascii row of too few or too many values.
    #[error("line {line}: element {element}, row {row} has {found} values, the header wants {wanted}")]
    RowLength {
        /// The line, from 1.
        line: u64,
        /// The element.
        element: String,
        /// The row, from 1.
        row: u64,
        /// The values of the line.
        found: u64,
        /// The values the properties want.
        wanted: u64,
    },
    /// A value that is not a number of its property's type.
    #[error("line {line}: element {element}, row {row}, property {property}: `{content}` is not a {kind}")]
    Value {
        /// The line, from 1.
        line: u64,
        /// The element.
        element: String,
        /// The row, from 1.
        row: u64,
        /// The property.
        property: String,
        /// The value as written, shortened.
        content: String,
        /// The type the header states.
        kind: &'static str,
    },
    /// A list with a negative number of values.
    #[error("element {element}, row {row}, property {property}: a list of {length} values")]
    ListLength {
        /// The element.
        element: String,
        /// The row, from 1.
        row: u64,
        /// The list property.
        property: String,
        /// The number read.
        length: i64,
    },
}
