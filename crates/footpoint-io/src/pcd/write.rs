//! Writing PCD 0.7: all columns as fields, `red green blue` (`alpha`) of bytes packed into one, as its readers want it.

use std::borrow::Cow;
use std::io::{self, Write};

use super::header::type_letter;
use super::{PcdEncoding, PcdKept, colour, lzf};
use crate::output::number::write_value;
use crate::output::{Steps, WriteProblem};
use crate::scalar::Scalar;
use crate::{Column, Data, Kept, Table};

/// Rows put together at a time.
const BLOCK: usize = 1 << 14;

/// A field with the columns of its values.
struct Field<'a> {
    name: String,
    scalar: Scalar,
    columns: Vec<Cow<'a, Data>>,
}

/// Checks that a column can be a field.
pub(crate) fn check(column: &Column) -> Result<(), WriteProblem> {
    let name = &column.name;
    if Scalar::of(&column.data).is_none() {
        return Err(WriteProblem::Text { name: name.clone(), format: "PCD" });
    }
    if name.is_empty() || name == "_" || name.contains(|c: char| c.is_whitespace() || c.is_control()) {
        return Err(WriteProblem::Name(name.clone()));
    }
    Ok(())
}

/// Writes the table. Width, height, viewpoint, the packing of colours and fields of several values are as they were
/// read; width and height only if the number of points is what it was.
pub(crate) fn write(
    out: &mut impl Write,
    table: &Table,
    encoding: PcdEncoding,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let kept = match &table.kept {
        Some(Kept::Pcd(kept)) => Some(kept),
        _ => None,
    };
    let fields = fields(table, kept, encoding);
    write_header(out, table, (&fields, kept), encoding)?;
    match encoding {
        PcdEncoding::Ascii => write_ascii(out, &fields, table.rows(), steps),
        PcdEncoding::Binary => write_binary(out, &fields, table.rows(), steps),
        PcdEncoding::Compressed => write_compressed(out, &fields, table.rows(), steps),
    }
}

fn fields<'a>(table: &'a Table, kept: Option<&PcdKept>, encoding: PcdEncoding) -> Vec<Field<'a>> {
    let mut fields = Vec::new();
    let mut columns = table.columns.as_slice();
    while let Some(first) = columns.first() {
        let channels = colour::channels(columns);
        let group = kept.and_then(|kept| group(columns, kept));
        let taken = if channels > 0 { channels } else { group.as_ref().map_or(1, |(_, count)| *count) };
        let (these, rest) = columns.split_at_checked(taken).unwrap_or((columns, &[]));
        columns = rest;
        if channels > 0 {
            fields.push(packed_colour(these, kept, encoding));
            continue;
        }
        let name = group.map_or_else(|| first.name.clone(), |(name, _)| name);
        let Some(scalar) = Scalar::of(&first.data) else { continue };
        fields.push(Field {
            name,
            scalar,
            columns: these.iter().map(|column| Cow::Borrowed(&column.data)).collect(),
        });
    }
    fields
}

/// The field of several values that the first columns are, if they still are one.
fn group(columns: &[Column], kept: &PcdKept) -> Option<(String, usize)> {
    let first = columns.first()?;
    kept.groups.iter().find_map(|(name, count)| {
        let count = usize::try_from(*count).ok()?;
        let these = columns.get(..count)?;
        let fits = |(index, column): (usize, &Column)| {
            column.name == format!("{name}_{index}") && Scalar::of(&column.data) == Scalar::of(&first.data)
        };
        these.iter().enumerate().all(fits).then(|| (name.clone(), count))
    })
}

fn packed_colour<'a>(channels: &[Column], kept: Option<&PcdKept>, encoding: PcdEncoding) -> Field<'a> {
    let packed = colour::pack(channels);
    let was = kept.and_then(|kept| kept.colour.as_ref());
    // A reader gives `alpha` of `rgb` only where it is used.
    let alpha_shows = packed.iter().any(|value| value >> 24 != 0);
    let is_rgba = channels.len() == 4 && (was.is_none_or(|was| was.is_rgba) || !alpha_shows);
    let data = match was.map(|was| was.scalar) {
        // Text has one word for all numbers that are none, and would lose the bits of those.
        Some(Scalar::F32) if encoding != PcdEncoding::Ascii => {
            Data::F32(packed.into_iter().map(f32::from_bits).collect())
        }
        Some(Scalar::I32) => Data::I32(packed.into_iter().map(u32::cast_signed).collect()),
        _ => Data::U32(packed),
    };
    let name = if is_rgba { "rgba" } else { "rgb" }.to_owned();
    Field { name, scalar: Scalar::of(&data).unwrap_or(Scalar::U32), columns: vec![Cow::Owned(data)] }
}

fn write_header(
    out: &mut impl Write,
    table: &Table,
    (fields, kept): (&[Field<'_>], Option<&PcdKept>),
    encoding: PcdEncoding,
) -> io::Result<()> {
    let rows = table.rows() as u64;
    writeln!(out, "# .PCD v0.7 - Point Cloud Data file format")?;
    for line in table.comments.iter().flat_map(|comment| comment.lines()) {
        writeln!(out, "# {line}")?;
    }
    let list = |word: &dyn Fn(&Field<'_>) -> String| {
        fields.iter().fold(String::new(), |line, field| line + " " + &word(field))
    };
    writeln!(out, "VERSION 0.7\nFIELDS{}", list(&|field| field.name.clone()))?;
    writeln!(out, "SIZE{}", list(&|field| field.scalar.size().to_string()))?;
    writeln!(out, "TYPE{}", list(&|field| type_letter(field.scalar).to_owned()))?;
    writeln!(out, "COUNT{}", list(&|field| field.columns.len().to_string()))?;
    let organised = kept.filter(|kept| kept.width.checked_mul(kept.height) == Some(rows));
    let (width, height) = organised.map_or((rows, 1), |kept| (kept.width, kept.height));
    writeln!(out, "WIDTH {width}\nHEIGHT {height}")?;
    let viewpoint = kept.and_then(|kept| kept.viewpoint).unwrap_or([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    writeln!(
        out,
        "VIEWPOINT{}",
        viewpoint.iter().fold(String::new(), |line, number| format!("{line} {number}"))
    )?;
    let data = match encoding {
        PcdEncoding::Ascii => "ascii",
        PcdEncoding::Binary => "binary",
        PcdEncoding::Compressed => "binary_compressed",
    };
    writeln!(out, "POINTS {rows}\nDATA {data}")
}

fn write_ascii(out: &mut impl Write, fields: &[Field<'_>], rows: usize, steps: &Steps<'_>) -> io::Result<()> {
    for row in 0..rows {
        for (index, data) in fields.iter().flat_map(|field| &field.columns).enumerate() {
            if index > 0 {
                out.write_all(b" ")?;
            }
            write_value(out, data, row)?;
        }
        out.write_all(b"\n")?;
        steps.at(row)?;
    }
    Ok(())
}

fn write_binary(
    out: &mut impl Write,
    fields: &[Field<'_>],
    rows: usize,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let columns: Vec<&Data> = fields.iter().flat_map(|field| &field.columns).map(AsRef::as_ref).collect();
    let mut block = Vec::new();
    let mut start = 0;
    while start < rows {
        let end = rows.min(start + BLOCK);
        block.clear();
        for row in start..end {
            columns.iter().for_each(|data| put(&mut block, data, row));
        }
        out.write_all(&block)?;
        start = end;
        steps.at(start)?;
    }
    Ok(())
}

fn write_compressed(
    out: &mut impl Write,
    fields: &[Field<'_>],
    rows: usize,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let mut block = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        for row in 0..rows {
            field.columns.iter().for_each(|data| put(&mut block, data, row));
        }
        steps.at_column(rows, index, fields.len())?;
    }
    let packed = lzf::pack(&block);
    let (Ok(packed_size), Ok(size)) = (u32::try_from(packed.len()), u32::try_from(block.len())) else {
        return Err(io::Error::other("more than 4 GiB, which compressed PCD cannot hold; write binary"));
    };
    out.write_all(&packed_size.to_le_bytes())?;
    out.write_all(&size.to_le_bytes())?;
    out.write_all(&packed)
}

/// Appends the bytes of one value, least significant first.
fn put(block: &mut Vec<u8>, data: &Data, row: usize) {
    fn bytes<T: Copy, const N: usize>(block: &mut Vec<u8>, value: Option<&T>, bytes: impl Fn(T) -> [u8; N]) {
        block.extend(value.map(|value| bytes(*value)).into_iter().flatten());
    }
    match data {
        Data::I8(v) => bytes(block, v.get(row), i8::to_le_bytes),
        Data::U8(v) => bytes(block, v.get(row), u8::to_le_bytes),
        Data::I16(v) => bytes(block, v.get(row), i16::to_le_bytes),
        Data::U16(v) => bytes(block, v.get(row), u16::to_le_bytes),
        Data::I32(v) => bytes(block, v.get(row), i32::to_le_bytes),
        Data::U32(v) => bytes(block, v.get(row), u32::to_le_bytes),
        Data::I64(v) => bytes(block, v.get(row), i64::to_le_bytes),
        Data::U64(v) => bytes(block, v.get(row), u64::to_le_bytes),
        Data::F32(v) => bytes(block, v.get(row), f32::to_le_bytes),
        Data::F64(v) => bytes(block, v.get(row), f64::to_le_bytes),
        Data::Text(_) => {}
    }
}
