//! What can be wrong with a NumPy file.

use std::io;

use thiserror::Error;
use zip::result::ZipError;

/// Why a NumPy file cannot be read as columns.
#[derive(Debug, Error)]
pub enum NpyError {
    /// The operating system or a decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The header of an array breaks the rules.
    #[error("the header of the array is broken: {0}")]
    Header(String),
    /// An array of Python objects.
    #[error("an array of Python objects; save numbers, or records of numbers")]
    Pickled,
    /// An array without dimensions.
    #[error("a single value, no rows; save an array of shape (n, 3)")]
    Single,
    /// A row of numbers that says nothing of points.
    #[error(
        "one dimension of {rows} numbers; save shape (n, 2) or (n, 3), records with fields x y z, or an .npz \
         with arrays x y z"
    )]
    OneDimensional {
        /// Its length.
        rows: u64,
    },
    /// More than two dimensions in Fortran's order.
    #[error("more than two dimensions in Fortran's order; save numpy.ascontiguousarray of it")]
    FortranGrid,
    /// Rows of no bytes, or of more than there can be.
    #[error("rows without any bytes, or of more than this machine can count; save fields of numbers")]
    NoFields,
    /// More columns than any table has.
    #[error("more than {most} columns; save the wanted ones alone")]
    Columns {
        /// The most that is read.
        most: usize,
    },
    /// Values that are no numbers and no text.
    #[error("column `{column}` is of the type {kind}, which is not read; convert it by astype to a number")]
    Type {
        /// The column.
        column: String,
        /// The type in NumPy's letters.
        kind: String,
    },
    /// The rows want more bytes than there are.
    #[error(
        "unexpected end of file: the rows of the array want {wanted} bytes, found {found}; get the whole file again"
    )]
    EndInRows {
        /// The bytes the shape needs.
        wanted: u128,
        /// The bytes there are.
        found: u64,
    },
    /// Two columns of one name.
    #[error("a second column `{name}`; rename one")]
    Duplicate {
        /// The name.
        name: String,
    },
    /// Arrays that are not columns of one table.
    #[error("{found} rows, but array `{first}` has {wanted}; save arrays of one length alone")]
    Lengths {
        /// The rows of this array.
        found: u64,
        /// The first array.
        first: String,
        /// Its rows.
        wanted: u64,
    },
    /// A zip archive without arrays.
    #[error("a zip archive without a NumPy array of rows; unpack it and read the files in it")]
    NoArray,
    /// The archive breaks the rules of zip.
    #[error("cannot read the archive: {0}")]
    Archive(ZipError),
    /// What is wrong with one array of an archive.
    #[error("array `{array}`: {problem}")]
    In {
        /// The array.
        array: String,
        /// What is wrong with it.
        problem: Box<Self>,
    },
}

impl NpyError {
    /// The error, with the array of an archive that it is about.
    pub(super) fn of(self, array: &str) -> Self {
        let array = crate::excerpt::excerpt(array.as_bytes());
        Self::In { array, problem: Box::new(self) }
    }
}
