//! What can be wrong with an OBJ file.

use std::io;

use thiserror::Error;

/// Why an OBJ file cannot be read.
#[derive(Debug, Error)]
pub enum ObjError {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The bytes are not text.
    #[error("byte {byte}: binary content, which OBJ files do not have; get the file again or convert it")]
    Binary {
        /// Where the text stops, from 0.
        byte: usize,
    },
    /// There is no line `v x y z`.
    #[error("no line `v x y z`, so no points")]
    NoVertices,
    /// A line whose first word OBJ does not have.
    #[error("line {line}: not a line of an OBJ file: `{content}`; if it is text, rename it to .txt or .xyz")]
    Keyword {
        /// The line, from 1.
        line: u64,
        /// The line itself, shortened.
        content: String,
    },
    /// A vertex of a number of numbers that has no meaning.
    #[error("line {line}: a vertex of {found} numbers; OBJ has x y z, x y z w and both with r g b")]
    Vertex {
        /// The line, from 1.
        line: u64,
        /// The numbers of the line.
        found: usize,
    },
    /// A vertex of another length than the first.
    #[error("line {line}: a vertex of {found} numbers, but the first vertex, line {first}, has {wanted}")]
    Width {
        /// The line, from 1.
        line: u64,
        /// The numbers of the line.
        found: usize,
        /// The first vertex's line, from 1.
        first: u64,
        /// The numbers of the first vertex.
        wanted: usize,
    },
    /// A normal that has not three numbers.
    #[error("line {line}: a normal wants three numbers")]
    Normal {
        /// The line, from 1.
        line: u64,
    },
    /// A value that is no number.
    #[error("line {line}: `{content}` is not a number")]
    NotANumber {
        /// The line, from 1.
        line: u64,
        /// The value, shortened.
        content: String,
    },
}
