//! What can be wrong with a text file.

use std::io;

use thiserror::Error;

/// Why a text file cannot be read as a table.
#[derive(Debug, Error)]
pub enum TextError {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The bytes are not text.
    #[error("byte {byte}: binary content, neither a format that is known nor UTF-8 text")]
    Binary {
        /// Where the text stops, from 0.
        byte: usize,
    },
    /// A line that is not text, in a file that began as text.
    #[error("line {line}: not UTF-8 text: `{content}`")]
    NotText {
        /// The line, from 1.
        line: u64,
        /// The piece, shortened.
        content: String,
    },
    /// There is no row of numbers.
    #[error("no row of numbers; the first line is `{first}`")]
    NoRows {
        /// The first line that is not a comment, shortened.
        first: String,
    },
    /// Two columns of one name.
    #[error("line {line}: the header names column `{name}` twice; rename one")]
    DuplicateName {
        /// The header's line, from 1.
        line: u64,
        /// The name.
        name: String,
    },
    /// A header that does not fit its rows.
    #[error("line {line}: {found} fields, but the header in line {header} names {wanted} columns")]
    HeaderLength {
        /// The row's line, from 1.
        line: u64,
        /// The fields of the row.
        found: usize,
        /// The header's line, from 1.
        header: u64,
        /// The names of the header.
        wanted: usize,
    },
    /// A row of another length than the first.
    #[error("line {line}: {found} fields, but the first row, line {first}, has {wanted}")]
    RowLength {
        /// The row's line, from 1.
        line: u64,
        /// The fields of the row.
        found: usize,
        /// The first row's line, from 1.
        first: u64,
        /// The fields of the first row.
        wanted: usize,
    },
    /// A field of a numeric column that is no number.
    #[error("line {line}, column {column} (`{name}`): `{content}` is not a number")]
    NotANumber {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The column's name.
        name: String,
        /// The field, shortened.
        content: String,
    },
    /// Numbers such as `1,5`, which would fall apart into two columns.
    #[error(
        "line {line}: commas stand between digits beside another separator; decimal commas are not \
         supported, write 1.5 for 1,5"
    )]
    DecimalComma {
        /// The line, from 1.
        line: u64,
    },
}
