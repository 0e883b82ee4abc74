//! Writing text: a header where the kind has one, then one line per row.

use std::io::{self, Write};

use super::number::{write_real, write_value};
use super::{Steps, WriteProblem, comment_lines};
use crate::format::TextKind;
use crate::text::needs_quotes;
use crate::{Column, Data, Table};

const LINE_BREAKS: [char; 2] = ['\n', '\r'];

/// Checks that a column can stand in lines of text.
pub(super) fn check(column: &Column) -> Result<(), WriteProblem> {
    let name = column.name.clone();
    if name.trim().is_empty() || name.contains(LINE_BREAKS) {
        return Err(WriteProblem::Name(name));
    }
    let Data::Text(values) = &column.data else { return Ok(()) };
    match values.iter().position(|value| value.contains(LINE_BREAKS)) {
        Some(row) => Err(WriteProblem::LineBreak { name, row: row + 1 }),
        None => Ok(()),
    }
}

pub(super) fn write(
    out: &mut impl Write,
    table: &Table,
    kind: TextKind,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let separator = if kind == TextKind::Csv { "," } else { " " };
    // A csv reader would take a comment for the header, a pts reader for a point.
    if !matches!(kind, TextKind::Csv | TextKind::Pts) {
        for line in comment_lines(table) {
            writeln!(out, "# {line}")?;
        }
    }
    match kind {
        TextKind::Pts => writeln!(out, "{}", table.rows())?,
        TextKind::Xyz | TextKind::Xy => {
            out.write_all(b"# ")?;
            write_header(out, table, separator)?;
        }
        TextKind::Csv | TextKind::Txt => write_header(out, table, separator)?,
    }
    for row in 0..table.rows() {
        for (index, column) in table.columns.iter().enumerate() {
            if index > 0 {
                out.write_all(separator.as_bytes())?;
            }
            match &column.data {
                Data::Text(values) => write_field(out, values.get(row).map_or("", String::as_str))?,
                // Text keeps no types: it is read back as doubles, so singles are written as the doubles they are.
                Data::F32(values) => write_real(out, values.get(row).copied().map_or(f64::NAN, f64::from))?,
                numbers => write_value(out, numbers, row)?,
            }
        }
        out.write_all(b"\n")?;
        steps.at(row)?;
    }
    Ok(())
}

fn write_header(out: &mut impl Write, table: &Table, separator: &str) -> io::Result<()> {
    for (index, column) in table.columns.iter().enumerate() {
        if index > 0 {
            out.write_all(separator.as_bytes())?;
        }
        write_field(out, &column.name)?;
    }
    out.write_all(b"\n")
}

fn write_field(out: &mut impl Write, field: &str) -> io::Result<()> {
    if needs_quotes(field) {
        write!(out, "\"{}\"", field.replace('"', "\"\""))
    } else {
        out.write_all(field.as_bytes())
    }
}
