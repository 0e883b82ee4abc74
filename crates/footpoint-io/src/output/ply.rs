//! Writing PLY: one element `vertex` with all columns.

use std::borrow::Cow;
use std::io::{self, Write};

use super::number::write_value;
use super::{Steps, WriteProblem, comment_lines};
use crate::rows::{self, Order};
use crate::scalar::Scalar;
use crate::{Column, Data, Encoding, Table};

/// Checks that a column can be a property.
pub(super) fn check(column: &Column) -> Result<(), WriteProblem> {
    if Scalar::of(&column.data).is_none() {
        return Err(WriteProblem::TextInPly(column.name.clone()));
    }
    let most = 1_u64 << 53;
    let too_wide = match &column.data {
        Data::I64(values) => values.iter().any(|n| n.unsigned_abs() > most),
        Data::U64(values) => values.iter().any(|&n| n > most),
        _ => false,
    };
    if too_wide {
        return Err(WriteProblem::WideInPly(column.name.clone()));
    }
    if column.name.is_empty() || column.name.contains(|c: char| c.is_whitespace() || c.is_control()) {
        return Err(WriteProblem::Name(column.name.clone()));
    }
    Ok(())
}

pub(super) fn write(
    out: &mut impl Write,
    table: &Table,
    encoding: Encoding,
    steps: &Steps<'_>,
) -> io::Result<()> {
    write_header(out, table, encoding)?;
    match encoding {
        Encoding::Ascii => write_ascii(out, table, steps),
        Encoding::LittleEndian => write_binary(out, table, Order::Little, steps),
        Encoding::BigEndian => write_binary(out, table, Order::Big, steps),
    }
}

fn write_header(out: &mut impl Write, table: &Table, encoding: Encoding) -> io::Result<()> {
    let format = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::LittleEndian => "binary_little_endian",
        Encoding::BigEndian => "binary_big_endian",
    };
    writeln!(out, "ply\nformat {format} 1.0")?;
    for line in comment_lines(table) {
        if line.split_ascii_whitespace().next() == Some("obj_info") {
            writeln!(out, "{}", line.trim())?;
        } else {
            writeln!(out, "comment {line}")?;
        }
    }
    writeln!(out, "element vertex {}", table.rows())?;
    for column in &table.columns {
        let kind = Scalar::of(&column.data).map(Scalar::ply_name).unwrap_or_default();
        writeln!(out, "property {kind} {}", column.name)?;
    }
    writeln!(out, "end_header")
}

fn write_ascii(out: &mut impl Write, table: &Table, steps: &Steps<'_>) -> io::Result<()> {
    for row in 0..table.rows() {
        for (index, column) in table.columns.iter().enumerate() {
            if index > 0 {
                out.write_all(b" ")?;
            }
            write_value(out, &column.data, row)?;
        }
        out.write_all(b"\n")?;
        steps.at(row)?;
    }
    Ok(())
}

fn write_binary(out: &mut impl Write, table: &Table, order: Order, steps: &Steps<'_>) -> io::Result<()> {
    let columns = table.columns.iter().map(|column| match &column.data {
        wide @ (Data::I64(_) | Data::U64(_)) => Cow::Owned(Data::F64(wide.to_f64().unwrap_or_default())),
        data => Cow::Borrowed(data),
    });
    let columns: Vec<Cow<'_, Data>> = columns.collect();
    rows::write(out, &columns, order, |row| steps.at(row))
}
