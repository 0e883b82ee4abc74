//! Point files as columns, each an array of the file's own type.

use crate::errors::{of_file, wrong};
use crate::work::How;
use footpoint_io::roles::Roles;
use footpoint_io::{Column, Data, Frame, Kept, Overwrite, Table, Unit};
use footpoint_jobs::{Context, JobError, Recipe, format_name, missing_points, notes, unit_name};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;

/// What a file says beside its columns, and what only a file of its format can hold.
#[pyclass(frozen, module = "footpoint._footpoint")]
#[derive(Clone, Default)]
pub(crate) struct Origin {
    frame: Frame,
    comments: Vec<String>,
    kept: Option<Kept>,
}

#[pymethods]
impl Origin {
    /// Of points that come from no file.
    #[new]
    #[pyo3(signature = (crs, unit, comments))]
    fn new(crs: Option<String>, unit: Option<&str>, comments: Vec<String>) -> PyResult<Self> {
        let unit = unit.map(unit_of).transpose()?;
        Ok(Self { frame: Frame { crs, unit }, comments, kept: None })
    }

    #[getter]
    fn crs(&self) -> Option<&str> {
        self.frame.crs.as_deref()
    }

    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.frame.unit.map(unit_name)
    }

    #[getter]
    fn comments(&self) -> Vec<String> {
        self.comments.clone()
    }
}

fn unit_of(name: &str) -> PyResult<Unit> {
    let units = [Unit::Metre, Unit::Foot, Unit::UsSurveyFoot, Unit::Degree];
    units.into_iter().find(|&unit| unit_name(unit) == name).ok_or_else(|| {
        let known = units.map(unit_name).join(", ");
        wrong("unit", format!("\"{name}\" is none of {known}"))
    })
}

/// Reads a file: its columns by name, which of them are coordinates and normals, and what else it says.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    within: Option<[[f64; 3]; 2]>,
    how: How,
) -> PyResult<Bound<'py, PyDict>> {
    let input = how.run_owned(py, move |run| {
        let context =
            Context { recipe: Recipe { within, ..Recipe::default() }, run: *run, ..Context::default() };
        let input = context.read(&path)?;
        let roles = Roles::find(&input.table);
        roles.map(|roles| (input, roles)).map_err(|problem| JobError::Roles { path, problem })
    })?;
    let (input, roles) = input.map_err(of_file)?;
    let found = PyDict::new(py);
    found.set_item("format", format_name(input.format))?;
    found.set_item("notes", notes(&input.report))?;
    found.set_item("missing_points", missing_points(&input))?;
    let Table { columns, comments, frame, kept } = input.table;
    let names = |indices: &[usize]| indices.iter().map(|&i| columns[i].name.clone()).collect::<Vec<String>>();
    found.set_item("coordinates", names(&roles.coordinates))?;
    found.set_item("normals", roles.normals.as_deref().map(names))?;
    let arrays = PyDict::new(py);
    for Column { name, data } in columns {
        arrays.set_item(name, array(py, data)?)?;
    }
    found.set_item("columns", arrays)?;
    found.set_item("origin", Origin { frame, comments, kept })?;
    Ok(found)
}

/// Writes columns to a file, in the format of its extension.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    columns: &Bound<'_, PyDict>,
    origin: &Origin,
    overwrite: bool,
    how: How,
) -> PyResult<()> {
    let mut table = Table {
        frame: origin.frame.clone(),
        comments: origin.comments.clone(),
        kept: origin.kept.clone(),
        ..Table::default()
    };
    for (name, values) in columns {
        let name: String = name.extract()?;
        let data = data(&name, &values)?;
        table.columns.push(Column { name, data });
    }
    let written = how.run(py, usize::MAX, |run| {
        let overwrite = if overwrite { Overwrite::Replace } else { Overwrite::Refuse };
        let context = Context { overwrite, run: *run, ..Context::default() };
        context.write(&path, &table)
    })?;
    written.map_err(of_file)
}

/// An array of the column's type; text as a list.
fn array(py: Python<'_>, data: Data) -> PyResult<Bound<'_, PyAny>> {
    Ok(match data {
        Data::I8(v) => PyArray1::from_vec(py, v).into_any(),
        Data::U8(v) => PyArray1::from_vec(py, v).into_any(),
        Data::I16(v) => PyArray1::from_vec(py, v).into_any(),
        Data::U16(v) => PyArray1::from_vec(py, v).into_any(),
        Data::I32(v) => PyArray1::from_vec(py, v).into_any(),
        Data::U32(v) => PyArray1::from_vec(py, v).into_any(),
        Data::I64(v) => PyArray1::from_vec(py, v).into_any(),
        Data::U64(v) => PyArray1::from_vec(py, v).into_any(),
        Data::F32(v) => PyArray1::from_vec(py, v).into_any(),
        Data::F64(v) => PyArray1::from_vec(py, v).into_any(),
        Data::Text(v) => PyList::new(py, v)?.into_any(),
    })
}

/// The column of an array, which is contiguous, or of a list of text.
fn data(name: &str, values: &Bound<'_, PyAny>) -> PyResult<Data> {
    macro_rules! first_of {
        ($($kind:ident $element:ty),*) => {
            $(if let Ok(array) = values.extract::<PyReadonlyArray1<'_, $element>>() {
                let contiguous = |_| wrong(name, "an array that is not contiguous");
                return Ok(Data::$kind(array.as_slice().map_err(contiguous)?.to_vec()));
            })*
        };
    }
    first_of!(F64 f64, F32 f32, U8 u8, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, I16 i16, I8 i8);
    let text = values.extract::<Vec<String>>().map(Data::Text);
    text.map_err(|_| PyTypeError::new_err(format!("column {name:?}: neither numbers nor text")))
}
