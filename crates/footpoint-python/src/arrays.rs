//! NumPy arrays as slices and columns as NumPy arrays, neither with a copy.

use footpoint::Status;
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A contiguous array of doubles, as the package hands them over.
pub(crate) type Doubles<'py> = PyReadonlyArrayDyn<'py, f64>;

/// Numbers one behind the other.
pub(crate) fn numbers<'a>(array: &'a Doubles<'_>) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| PyTypeError::new_err("an array that is not contiguous"))
}

/// Rows of `W` numbers.
pub(crate) fn rows<'a, const W: usize>(array: &'a Doubles<'_>) -> PyResult<&'a [[f64; W]]> {
    match (array.shape(), numbers(array)?.as_chunks::<W>()) {
        ([_, width], (rows, [])) if *width == W => Ok(rows),
        (shape, _) => Err(PyValueError::new_err(format!("an array of shape {shape:?} for rows of {W}"))),
    }
}

/// One matrix of `W` rows and columns a row.
pub(crate) fn matrices<const W: usize>(array: &Doubles<'_>) -> PyResult<Vec<[[f64; W]; W]>> {
    let (rows, _) = numbers(array)?.as_chunks::<W>();
    Ok(rows.as_chunks::<W>().0.to_vec())
}

/// Columns by name, as they become the fields of a result.
pub(crate) struct Answers<'py>(pub(crate) Bound<'py, PyDict>);

impl<'py> Answers<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    /// One value a row.
    pub(crate) fn put<T: Element>(&self, name: &str, values: Vec<T>) -> PyResult<()> {
        self.0.set_item(name, PyArray1::from_vec(self.0.py(), values))
    }

    /// One vector a row.
    pub(crate) fn put_rows<T: Element, const W: usize>(
        &self,
        name: &str,
        values: Vec<[T; W]>,
    ) -> PyResult<()> {
        let rows = values.len();
        let flat = PyArray1::from_vec(self.0.py(), values.into_flattened());
        self.0.set_item(name, flat.reshape([rows, W])?)
    }

    /// One matrix, or several vectors, a row.
    pub(crate) fn put_matrices<const W: usize, const R: usize>(
        &self,
        name: &str,
        values: Vec<[[f64; W]; R]>,
    ) -> PyResult<()> {
        let rows = values.len();
        let flat = PyArray1::from_vec(self.0.py(), values.into_flattened().into_flattened());
        self.0.set_item(name, flat.reshape([rows, R, W])?)
    }

    /// Statuses as their numbers.
    pub(crate) fn put_status(&self, status: Vec<Status>) -> PyResult<()> {
        self.put("status", status.into_iter().map(|status| status as u8).collect::<Vec<u8>>())
    }
}
