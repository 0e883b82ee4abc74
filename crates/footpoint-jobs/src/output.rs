//! Names of the columns that jobs add, which depend on the format of the output.

use footpoint::Status;
use footpoint_io::roles::Roles;
use footpoint_io::{Column, Data, Table};
use std::path::Path;

const AXES: [&str; 3] = ["x", "y", "z"];

/// How columns are named and statuses written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Naming {
    /// PLY: `nx`, `frame_nx`, statuses as numbers.
    Ply,
    /// Text: `surface_normal_x`, `frame_normal_x`, statuses as words.
    Text,
}

impl Naming {
    pub(crate) fn of(output: &Path) -> Self {
        match output.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("ply") => Self::Ply,
            _ => Self::Text,
        }
    }

    /// `surface_normal_x`, or `nx`.
    pub(crate) fn surface_normal(self, axis: usize) -> String {
        match self {
            Self::Ply => format!("n{}", AXES[axis]),
            Self::Text => format!("surface_normal_{}", AXES[axis]),
        }
    }

    /// `frame_normal_x`, or `frame_nx`.
    pub(crate) fn frame_normal(self, axis: usize) -> String {
        match self {
            Self::Ply => format!("frame_n{}", AXES[axis]),
            Self::Text => format!("frame_normal_{}", AXES[axis]),
        }
    }

    pub(crate) fn status(self, statuses: &[Status]) -> Column {
        let data = match self {
            Self::Ply => Data::U8(statuses.iter().map(|&s| s as u8).collect()),
            Self::Text => Data::Text(statuses.iter().map(|s| s.name().to_owned()).collect()),
        };
        Column::new("status", data)
    }

    /// Replaces the statuses of an earlier job by ones of the right type, which this job will overwrite: as words
    /// they could not stand in PLY.
    pub(crate) fn retype_status(self, table: &mut Table) {
        if table.column("status").is_some() {
            table.set(self.status(&vec![Status::Ok; table.rows()]));
        }
    }

    /// Keeps the input's own normals apart where surface normals take their name: `given_nx`, ….
    pub(crate) fn keep_given_normals(self, table: &mut Table, roles: &Roles) {
        let taken = |name: &str| (0..3).any(|axis| name.eq_ignore_ascii_case(&self.surface_normal(axis)));
        for &i in roles.normals.iter().flatten() {
            let kept = format!("given_{}", table.columns[i].name);
            // Where a job has been here before, the first normals are kept, not its own.
            if taken(&table.columns[i].name) && table.column(&kept).is_none() {
                table.columns[i].name = kept;
            }
        }
    }
}

/// `prefix_x`, `prefix_y`, ….
pub(crate) fn along(prefix: &str) -> impl Fn(usize) -> String + '_ {
    move |axis| format!("{prefix}_{}", AXES[axis])
}

/// Adds one column an axis.
pub(crate) fn set_vectors<const D: usize>(
    table: &mut Table,
    name: impl Fn(usize) -> String,
    rows: &[[f64; D]],
) {
    for axis in 0..D {
        let values = rows.iter().map(|row| row[axis]).collect();
        table.set(Column::new(name(axis), Data::F64(values)));
    }
}

pub(crate) fn set_numbers(table: &mut Table, name: &str, values: Vec<f64>) {
    table.set(Column::new(name, Data::F64(values)));
}

/// Counts as 32-bit integers.
pub(crate) fn set_counts(table: &mut Table, name: &str, values: Vec<u32>) {
    table.set(Column::new(name, Data::U32(values)));
}
