//! What jobs write: the names of the columns that they add, which depend on the format of the output, and the table itself.

use crate::clock::timed;
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::Status;
use footpoint_io::roles::Roles;
use footpoint_io::{Column, Data, Table, check_writable};
use std::path::Path;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Extensions of text files.
const TEXT: [&str; 6] = ["xyz", "csv", "txt", "pts", "pwn", "xy"];

/// How columns are named and statuses written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Naming {
    /// PLY, LAS and all that is not text: `nx`, `frame_nx`, statuses as numbers.
    Ply,
    /// Text: `surface_normal_x`, `frame_normal_x`, statuses as words.
    Text,
}

impl Naming {
    pub(crate) fn of(output: &Path) -> Self {
        match output.extension() {
            Some(extension) if TEXT.iter().any(|text| extension.eq_ignore_ascii_case(text)) => Self::Text,
            _ => Self::Ply,
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

    /// Of the surface normal at a foot point, in a file whose coordinates are not those of the foot point:
    /// `foot_normal_x`, or `foot_nx`.
    pub(crate) fn foot_normal(self, axis: usize) -> String {
        match self {
            Self::Ply => format!("foot_n{}", AXES[axis]),
            Self::Text => format!("foot_normal_{}", AXES[axis]),
        }
    }

    pub(crate) fn status(self, statuses: &[Status]) -> Column {
        let data = match self {
            Self::Ply => Data::U8(statuses.iter().map(|&s| s as u8).collect()),
            Self::Text => Data::Text(statuses.iter().map(|s| s.name().to_owned()).collect()),
        };
        Column::new("status", data)
    }
}

/// `nx`, in every format: the name that readers of given normals look for first.
pub(crate) fn oriented_normal(axis: usize) -> String {
    Naming::Ply.surface_normal(axis)
}

/// Writes a job's table, and says so in its report.
pub(crate) fn put_table(
    output: &Path,
    table: &Table,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), JobError> {
    // OBJ has no place for statuses; the report counts them.
    let status = table.columns.iter().position(|column| column.name == "status");
    let without = status.filter(|_| is_obj(output)).map(|status| {
        let mut table = table.clone();
        table.columns.remove(status);
        table
    });
    timed(&mut report.times.write, || context.write(output, without.as_ref().unwrap_or(table)))?;
    report.wrote(output);
    Ok(())
}

/// Fails, before any work is done, where no table with columns of numbers could be put at `path`.
pub(crate) fn check_output(path: &Path, context: &Context<'_>) -> Result<(), JobError> {
    if is_obj(path) {
        return Err(JobError::NotForObj(path.display().to_string()));
    }
    Ok(check_writable(path, context.overwrite)?)
}

fn is_obj(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"))
}

/// Drops the statuses that an earlier job wrote as words: this job writes its own, and PLY holds no words.
pub(crate) fn drop_own_status(table: &mut Table) {
    let ours = |words: &[String]| words.iter().all(|w| Status::ALL.iter().any(|s| s.name() == w));
    table.columns.retain(|column| match &column.data {
        Data::Text(words) => column.name != "status" || !ours(words),
        _ => true,
    });
}

/// Adds computed columns to a table. Those named like a coordinate replace it; any other column that has a computed
/// one's name is kept as `given_…`. Where that name is taken too a job has been here before, and the first is kept.
pub(crate) fn merge(table: &mut Table, roles: &Roles, computed: Table) {
    let coordinates: Vec<String> = roles.coordinates.iter().map(|&i| table.columns[i].name.clone()).collect();
    for column in &computed.columns {
        let same = |other: &Column| other.name.eq_ignore_ascii_case(&column.name);
        let Some(i) = table.columns.iter().position(same) else { continue };
        let kept = format!("given_{}", table.columns[i].name);
        if !coordinates.contains(&column.name) && table.column(&kept).is_none() {
            table.columns[i].name = kept;
        }
    }
    for column in computed.columns {
        table.set(column);
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
