//! Writing OBJ: a line `v` for each row, with its colour, and a line `vn` where the table has normals.

use std::io::{self, Write};

use super::number::{write_real, write_value};
use super::{Steps, WriteProblem, comment_lines};
use crate::roles::Roles;
use crate::{Data, Table};

const COLOURS: [&str; 3] = ["red", "green", "blue"];

/// The columns that OBJ holds, as indices.
struct Places {
    coordinates: Vec<usize>,
    /// The fourth coordinate.
    weight: Option<usize>,
    colours: Option<Vec<usize>>,
    normals: Option<Vec<usize>>,
}

impl Places {
    fn find(table: &Table) -> Option<Self> {
        let roles = Roles::find(table).ok().filter(|roles| roles.dimension() == 3)?;
        let number = |name: &str| {
            let is = |column: &crate::Column| column.name == name && !matches!(column.data, Data::Text(_));
            table.columns.iter().position(is)
        };
        Some(Self {
            coordinates: roles.coordinates,
            weight: number("w"),
            colours: COLOURS.iter().map(|name| number(name)).collect(),
            normals: roles.normals,
        })
    }

    fn hold(&self, column: usize) -> bool {
        let groups = [Some(&self.coordinates), self.colours.as_ref(), self.normals.as_ref()];
        self.weight == Some(column) || groups.into_iter().flatten().any(|group| group.contains(&column))
    }
}

/// Checks that OBJ holds all columns: what it cannot hold must be left out by someone who knows.
pub(super) fn check(table: &Table) -> Result<(), WriteProblem> {
    let places = Places::find(table).ok_or(WriteProblem::NoPoints { format: "OBJ" })?;
    let lost = table.columns.iter().enumerate().filter(|(index, _)| !places.hold(*index));
    let lost: Vec<&str> = lost.map(|(_, column)| column.name.as_str()).collect();
    if lost.is_empty() { Ok(()) } else { Err(WriteProblem::NotInObj(lost.join(", "))) }
}

pub(super) fn write(out: &mut impl Write, table: &Table, steps: &Steps<'_>) -> io::Result<()> {
    let Some(places) = Places::find(table) else { return Ok(()) };
    for line in comment_lines(table) {
        writeln!(out, "# {line}")?;
    }
    let plain: Vec<&Data> =
        data(table, &places.coordinates).into_iter().chain(data(table, places.weight.as_slice())).collect();
    let colours = data(table, places.colours.as_deref().unwrap_or_default());
    let normals = data(table, places.normals.as_deref().unwrap_or_default());
    let white = colours.iter().map(|data| white(data)).fold(1.0, f64::max);
    for row in 0..table.rows() {
        if !normals.is_empty() {
            out.write_all(b"vn")?;
            normals.iter().try_for_each(|data| write_number(out, data, row))?;
            out.write_all(b"\n")?;
        }
        out.write_all(b"v")?;
        plain.iter().try_for_each(|data| write_number(out, data, row))?;
        for data in &colours {
            write_share(out, data, row, white)?;
        }
        out.write_all(b"\n")?;
        steps.at(row)?;
    }
    Ok(())
}

fn data<'t>(table: &'t Table, places: &[usize]) -> Vec<&'t Data> {
    places.iter().filter_map(|index| table.columns.get(*index)).map(|column| &column.data).collect()
}

/// The value of full light: OBJ wants colours from 0 to 1, most other formats have bytes.
fn white(data: &Data) -> f64 {
    match data {
        Data::U8(_) => 255.0,
        Data::U16(_) => 65_535.0,
        other => match other.to_f64().unwrap_or_default().into_iter().fold(0.0, f64::max) {
            ..=1.0 => 1.0,
            ..=255.0 => 255.0,
            _ => 65_535.0,
        },
    }
}

fn write_share(out: &mut impl Write, data: &Data, row: usize, white: f64) -> io::Result<()> {
    out.write_all(b" ")?;
    let value = match data {
        Data::I8(v) => v.get(row).copied().map(f64::from),
        Data::U8(v) => v.get(row).copied().map(f64::from),
        Data::I16(v) => v.get(row).copied().map(f64::from),
        Data::U16(v) => v.get(row).copied().map(f64::from),
        Data::I32(v) => v.get(row).copied().map(f64::from),
        Data::U32(v) => v.get(row).copied().map(f64::from),
        Data::I64(v) => v.get(row).map(|n| *n as f64),
        Data::U64(v) => v.get(row).map(|n| *n as f64),
        Data::F32(v) => v.get(row).copied().map(f64::from),
        Data::F64(v) => v.get(row).copied(),
        Data::Text(_) => None,
    };
    write_real(out, value.map_or(f64::NAN, |value| value / white))
}

/// Writes a number behind a blank, singles as the doubles they are read back as.
fn write_number(out: &mut impl Write, data: &Data, row: usize) -> io::Result<()> {
    out.write_all(b" ")?;
    match data {
        Data::F32(values) => write_real(out, values.get(row).copied().map_or(f64::NAN, f64::from)),
        numbers => write_value(out, numbers, row),
    }
}
