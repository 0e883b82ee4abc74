//! What columns mean: which are the coordinates of the points, and which their normals.

use thiserror::Error;

use crate::{Data, Table};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Names of normals, the first family that is complete wins. The last is our own output: a table that we
/// wrote has its input's normals still under their own names.
const NORMALS: [[&str; 3]; 4] = [
    ["nx", "ny", "nz"],
    ["normal_x", "normal_y", "normal_z"],
    ["normalx", "normaly", "normalz"],
    ["surface_normal_x", "surface_normal_y", "surface_normal_z"],
];

/// The columns of a table that have a meaning, as indices into [`Table::columns`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Roles {
    /// The coordinates `x y` or `x y z`: two or three columns of numbers.
    pub coordinates: Vec<usize>,
    /// The normals in the order of the coordinates, if the table has one for each.
    pub normals: Option<Vec<usize>>,
}

/// Why a table has no points.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
pub enum RolesError {
    /// There is no column `x` or no column `y`.
    #[error("no column `{missing}`; a point needs x y (and z); columns found: {found}")]
    Missing {
        /// The coordinate that is missing.
        missing: &'static str,
        /// The names of all columns, or `none`.
        found: String,
    },
    /// A coordinate that holds text.
    #[error("column `{name}` holds text; coordinates are numbers")]
    Text {
        /// The column.
        name: String,
    },
}

impl Roles {
    /// Finds coordinates and normals by name, upper and lower case alike (the exact lower-case name first).
    ///
    /// Without a column `z` the points are 2-D. Normals are `nx ny nz`, `normal_x ..`, `normalx ..`, or,
    /// where none of these is there, `surface_normal_x ..`; a set with a missing or textual column is none.
    /// Fails if `x` or `y` is missing or a coordinate holds text.
    pub fn find(table: &Table) -> Result<Self, RolesError> {
        let mut coordinates = Vec::new();
        for axis in AXES {
            match position(table, axis) {
                Some(index) => coordinates.push(index),
                None if axis == "z" => {}
                None => return Err(RolesError::Missing { missing: axis, found: names(table) }),
            }
        }
        let is_text = |i: &&usize| !is_numeric(table, **i);
        if let Some(column) = coordinates.iter().find(is_text).and_then(|i| table.columns.get(*i)) {
            return Err(RolesError::Text { name: column.name.clone() });
        }
        let dimension = coordinates.len();
        let normals = NORMALS.iter().find_map(|family| {
            let axes = family.iter().take(dimension);
            axes.map(|name| position(table, name).filter(|i| is_numeric(table, *i))).collect()
        });
        Ok(Self { coordinates, normals })
    }

    /// The dimension of the points, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.coordinates.len()
    }

    /// The points of `table`, one array per row; `None` if they are not of dimension `D`.
    pub fn points<const D: usize>(&self, table: &Table) -> Option<Vec<[f64; D]>> {
        gather(table, &self.coordinates)
    }

    /// The normals of `table` as they are, of any length; `None` without normals of dimension `D`.
    pub fn normals<const D: usize>(&self, table: &Table) -> Option<Vec<[f64; D]>> {
        gather(table, self.normals.as_deref()?)
    }
}

/// Whether a column of this name would be taken for a coordinate.
pub(crate) fn is_coordinate(name: &str) -> bool {
    AXES.iter().any(|axis| name.eq_ignore_ascii_case(axis))
}

fn position(table: &Table, name: &str) -> Option<usize> {
    let exact = table.columns.iter().position(|column| column.name == name);
    exact.or_else(|| table.columns.iter().position(|column| column.name.eq_ignore_ascii_case(name)))
}

fn is_numeric(table: &Table, index: usize) -> bool {
    table.columns.get(index).is_some_and(|column| !matches!(column.data, Data::Text(_)))
}

fn names(table: &Table) -> String {
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn gather<const D: usize>(table: &Table, indices: &[usize]) -> Option<Vec<[f64; D]>> {
    if indices.len() != D {
        return None;
    }
    let mut rows = vec![[0.0; D]; table.rows()];
    for (axis, index) in indices.iter().enumerate() {
        let values = table.columns.get(*index)?.data.to_f64()?;
        for (row, value) in rows.iter_mut().zip(values) {
            *row.get_mut(axis)? = value;
        }
    }
    Some(rows)
}
