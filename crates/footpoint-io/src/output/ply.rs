//! Writing PLY: one element `vertex` with all columns.

use std::io::{self, Write};

use super::WriteProblem;
use super::number::write_value;
use crate::scalar::Scalar;
use crate::{Column, Data, Encoding, Table};

/// Bytes of binary rows put together at a time.
const BLOCK: usize = 128 * 1024;

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

pub(super) fn write(out: &mut impl Write, table: &Table, encoding: Encoding) -> io::Result<()> {
    write_header(out, table, encoding)?;
    match encoding {
        Encoding::Ascii => write_ascii(out, table),
        Encoding::LittleEndian | Encoding::BigEndian => {
            write_binary(out, table, encoding == Encoding::BigEndian)
        }
    }
}

fn write_header(out: &mut impl Write, table: &Table, encoding: Encoding) -> io::Result<()> {
    let format = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::LittleEndian => "binary_little_endian",
        Encoding::BigEndian => "binary_big_endian",
    };
    writeln!(out, "ply\nformat {format} 1.0")?;
    for line in table.comments.iter().flat_map(|comment| comment.lines()) {
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

fn write_ascii(out: &mut impl Write, table: &Table) -> io::Result<()> {
    for row in 0..table.rows() {
        for (index, column) in table.columns.iter().enumerate() {
            if index > 0 {
                out.write_all(b" ")?;
            }
            write_value(out, &column.data, row)?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

fn write_binary(out: &mut impl Write, table: &Table, big: bool) -> io::Result<()> {
    let sizes = table.columns.iter().filter_map(|column| Scalar::of(&column.data));
    let stride: usize = sizes.map(|scalar| scalar.size() as usize).sum();
    let rows_per_block = (BLOCK / stride.max(1)).max(1);
    let mut block = Vec::new();
    let mut start = 0;
    while start < table.rows() {
        let end = table.rows().min(start + rows_per_block);
        block.resize((end - start) * stride, 0);
        let mut offset = 0;
        for column in &table.columns {
            scatter(&column.data, start..end, &mut block, stride, offset, big);
            offset += Scalar::of(&column.data).map_or(0, |scalar| scalar.size() as usize);
        }
        out.write_all(&block)?;
        start = end;
    }
    Ok(())
}

type Rows = std::ops::Range<usize>;

/// Puts `rows` of one column into their places in a block of rows.
fn scatter(data: &Data, rows: Rows, block: &mut [u8], stride: usize, offset: usize, big: bool) {
    match data {
        Data::I8(v) => encode(v.get(rows), block, stride, offset, i8::to_le_bytes),
        Data::U8(v) => encode(v.get(rows), block, stride, offset, u8::to_le_bytes),
        Data::I16(v) if big => encode(v.get(rows), block, stride, offset, i16::to_be_bytes),
        Data::I16(v) => encode(v.get(rows), block, stride, offset, i16::to_le_bytes),
        Data::U16(v) if big => encode(v.get(rows), block, stride, offset, u16::to_be_bytes),
        Data::U16(v) => encode(v.get(rows), block, stride, offset, u16::to_le_bytes),
        Data::I32(v) if big => encode(v.get(rows), block, stride, offset, i32::to_be_bytes),
        Data::I32(v) => encode(v.get(rows), block, stride, offset, i32::to_le_bytes),
        Data::U32(v) if big => encode(v.get(rows), block, stride, offset, u32::to_be_bytes),
        Data::U32(v) => encode(v.get(rows), block, stride, offset, u32::to_le_bytes),
        Data::I64(v) if big => encode(v.get(rows), block, stride, offset, |n| (n as f64).to_be_bytes()),
        Data::I64(v) => encode(v.get(rows), block, stride, offset, |n| (n as f64).to_le_bytes()),
        Data::U64(v) if big => encode(v.get(rows), block, stride, offset, |n| (n as f64).to_be_bytes()),
        Data::U64(v) => encode(v.get(rows), block, stride, offset, |n| (n as f64).to_le_bytes()),
        Data::F32(v) if big => encode(v.get(rows), block, stride, offset, f32::to_be_bytes),
        Data::F32(v) => encode(v.get(rows), block, stride, offset, f32::to_le_bytes),
        Data::F64(v) if big => encode(v.get(rows), block, stride, offset, f64::to_be_bytes),
        Data::F64(v) => encode(v.get(rows), block, stride, offset, f64::to_le_bytes),
        Data::Text(_) => {}
    }
}

fn encode<T: Copy, const N: usize>(
    values: Option<&[T]>,
    block: &mut [u8],
    stride: usize,
    offset: usize,
    bytes: impl Fn(T) -> [u8; N],
) {
    for (value, row) in values.unwrap_or_default().iter().zip(block.chunks_exact_mut(stride)) {
        if let Some(place) = row.get_mut(offset..offset + N) {
            place.copy_from_slice(&bytes(*value));
        }
    }
}
