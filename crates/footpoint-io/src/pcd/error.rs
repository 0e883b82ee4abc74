//! What can be wrong with a PCD file.

use std::io;

use thiserror::Error;

/// Why a PCD file cannot be read.
#[derive(Debug, Error)]
pub enum PcdError {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// A header line that is not PCD.
    #[error("line {line}: {what}: `{content}`")]
    Header {
        /// The line, from 1.
        line: u64,
        /// What is wrong with it.
        what: &'static str,
        /// The line itself, shortened.
        content: String,
    },
    /// The file ends inside the header.
    #[error("unexpected end of file in the header, after line {line}: no line `DATA`")]
    HeaderEnd {
        /// The last line there is.
        line: u64,
    },
    /// A header line that every PCD file needs is missing.
    #[error("the header has no line `{0}`")]
    Missing(&'static str),
    /// Header lines that do not describe the same number of fields.
    #[error("the header has {found} values in `{key}`, but names {wanted} fields")]
    Lengths {
        /// The line's key.
        key: &'static str,
        /// Its values.
        found: usize,
        /// The names in `FIELDS`.
        wanted: usize,
    },
    /// Two columns of one name.
    #[error("the header names field `{0}` twice; rename one")]
    DuplicateName(String),
    /// A type and size that no number has.
    #[error("field `{name}`: a number of type {kind} and size {size}; PCD has I and U of 1 2 4 8, F of 4 8")]
    Type {
        /// The field.
        name: String,
        /// The letter.
        kind: String,
        /// The bytes.
        size: u64,
    },
    /// More columns than any file has use for.
    #[error("the header asks for {columns} columns; at most {most} are read")]
    TooWide {
        /// The sum of all counts.
        columns: u64,
        /// The limit.
        most: u64,
    },
    /// An ascii row of too few or too many values.
    #[error("line {line}: row {row} has {found} values, the header wants {wanted}")]
    RowLength {
        /// The line, from 1.
        line: u64,
        /// The row, from 1.
        row: u64,
        /// The values of the line.
        found: u64,
        /// The values that the header wants.
        wanted: u64,
    },
    /// A value that is not a number of its field's type.
    #[error("line {line}: row {row}, field {field}: `{content}` is no number of type {kind}")]
    Value {
        /// The line, from 1.
        line: u64,
        /// The row, from 1.
        row: u64,
        /// The field.
        field: String,
        /// The value as written, shortened.
        content: String,
        /// The type the header states.
        kind: &'static str,
    },
    /// The compressed block is shorter than it says.
    #[error(
        "unexpected end of file: the compressed block wants {wanted} bytes, found {found}; get the whole file again"
    )]
    EndInBlock {
        /// The bytes it states, with its two sizes.
        wanted: u64,
        /// The bytes there are.
        found: u64,
    },
    /// The compressed block holds something else than the header says.
    #[error("the compressed block unpacks to {found} bytes, but {rows} points want {wanted}")]
    BlockSize {
        /// The bytes it states.
        found: u64,
        /// The points of the header.
        rows: u64,
        /// The bytes they need.
        wanted: u128,
    },
    /// The compressed block is damaged.
    #[error("the compressed block is damaged; get the file again")]
    Damaged,
}
