//! The points of a PCD file: rows of text, rows of bytes, or a compressed block field by field.

use super::header::{Field, Header};
use super::{PcdEncoding, PcdError, lzf};
use crate::Data;
use crate::excerpt::excerpt;
use crate::ply::push;
use crate::rows::{Order, append};
use crate::scalar::Scalar;
use crate::source::Source;

/// Bytes of rows held at a time.
const BLOCK: u64 = 128 * 1024;
/// Rows to make room for where the size of the file does not bound them.
const BLIND_ROOM: u64 = 1 << 16;

/// Reads all points, one column for each value of a field with a meaning, and notes what does not fit the header.
pub(super) fn read(source: &mut Source<'_>, header: &mut Header) -> Result<Vec<Data>, PcdError> {
    match header.encoding {
        PcdEncoding::Ascii => read_ascii(source, header),
        PcdEncoding::Binary => read_binary(source, header),
        PcdEncoding::Compressed => read_compressed(source, header),
    }
}

/// Empty columns with room for the header's points, but no more than the bytes left can hold.
fn columns(source: &Source<'_>, header: &Header, least_row: u64) -> Vec<Data> {
    let bound = source.remaining().map_or(BLIND_ROOM, |bytes| bytes / least_row.max(1) + 1);
    let room = usize::try_from(header.points.min(bound)).unwrap_or(0);
    let of_field = |field: &Field| {
        let scalar = field.scalar;
        (0..field.count).filter_map(move |_| scalar.map(|scalar| scalar.column(room)))
    };
    header.fields.iter().flat_map(of_field).collect()
}

fn read_ascii(source: &mut Source<'_>, header: &mut Header) -> Result<Vec<Data>, PcdError> {
    let wanted: u64 = header.fields.iter().map(|field| field.count).sum();
    let mut columns = columns(source, header, 2 * wanted);
    let mut line = Vec::new();
    let mut row = 0;
    while source.read_line(b'\n', &mut line)? {
        let is_between = |b: &u8| b.is_ascii_whitespace() || *b == b',';
        let found = line.split(is_between).filter(|value| !value.is_empty()).count() as u64;
        if found == 0 {
            continue;
        }
        row += 1;
        let line_number = source.line_number();
        // The row that a cut file ends in: its last value may be cut too.
        let is_cut = found < wanted && row < header.points && source.at_end()?;
        if is_cut && header.fields.iter().any(|field| field.scalar.is_some_and(Scalar::is_integer)) {
            header.notes.push(format!("row {row} is cut and was left out"));
            row -= 1;
            break;
        }
        if found != wanted && !is_cut {
            return Err(PcdError::RowLength { line: line_number, row, found, wanted });
        }
        let whole = if is_cut { found.saturating_sub(1) } else { found };
        let mut values = line.split(is_between).filter(|value| !value.is_empty()).take(whole as usize);
        let mut column = columns.iter_mut();
        for field in &header.fields {
            for index in 0..field.count {
                let value = values.next().unwrap_or(b"nan");
                let Some(scalar) = field.scalar else { continue };
                let data = column.next();
                data.and_then(|data| put(data, value)).ok_or_else(|| PcdError::Value {
                    line: line_number,
                    row,
                    field: field.column_name(index),
                    content: excerpt(value),
                    kind: scalar.ply_name(),
                })?;
            }
        }
        if is_cut {
            header.notes.push(format!("row {row} is cut: its last value and what is missing are NaN"));
        }
    }
    if row != header.points {
        header.notes.push(format!("POINTS says {}, the file has {row} rows", header.points));
    }
    Ok(columns)
}

/// Appends a written value, `None` if it is not of the column's type.
fn put(data: &mut Data, value: &[u8]) -> Option<()> {
    match data {
        // The reader of PLY, which has no wide integers, takes them up to 2⁶³ only.
        Data::U64(values) => values.push(str::from_utf8(value).ok()?.parse().ok()?),
        _ => push(data, value)?,
    }
    Some(())
}

fn read_binary(source: &mut Source<'_>, header: &mut Header) -> Result<Vec<Data>, PcdError> {
    let stride = header.fields.iter().fold(0_u64, |sum, field| sum.saturating_add(field.bytes()));
    let mut columns = columns(source, header, stride);
    let rows_per_block = (BLOCK / stride.max(1)).max(1);
    let mut block = Vec::new();
    let mut done = 0;
    // A row of absurd padding is never held: it is longer than the file.
    let rows = if source.remaining().is_some_and(|bytes| bytes < stride) { 0 } else { header.points };
    while done < rows && stride > 0 {
        let now = rows_per_block.min(rows - done);
        let wanted = usize::try_from(now * stride).unwrap_or(usize::MAX);
        let filled = fill(source, &mut block, wanted)?;
        let whole = filled - filled % stride as usize;
        let mut columns = columns.iter_mut();
        let mut offset = 0_u64;
        for field in &header.fields {
            for index in 0..field.count {
                if field.scalar.is_none() {
                    break;
                }
                let Some(column) = columns.next() else { break };
                let rows = block.get(..whole).unwrap_or_default();
                append(column, rows, stride as usize, (offset + index * field.size) as usize, Order::Little);
            }
            offset = offset.saturating_add(field.bytes());
        }
        done += whole as u64 / stride;
        if filled < wanted {
            break;
        }
    }
    if done < header.points {
        header.notes.push(format!("the file ends early: POINTS says {}, found {done}", header.points));
    } else if !source.at_end()? {
        header.notes.push("data behind the last point were not read".to_owned());
    }
    Ok(columns)
}

fn read_compressed(source: &mut Source<'_>, header: &Header) -> Result<Vec<Data>, PcdError> {
    let mut sizes = Vec::new();
    let found = fill(source, &mut sizes, 8)? as u64;
    let (Some(packed), Some(unpacked)) = (size_at(&sizes, 0), size_at(&sizes, 4)) else {
        return Err(PcdError::EndInBlock { wanted: 8, found });
    };
    // Padding is left out of the block by the point cloud library and kept by others.
    let padded =
        |field: &&Field| field.scalar.is_some() || wants(&header.fields, header.points) == unpacked.into();
    let fields: Vec<&Field> = header.fields.iter().filter(padded).collect();
    let wanted = wants(fields.iter().copied(), header.points);
    if u128::from(unpacked) != wanted {
        return Err(PcdError::BlockSize { found: unpacked, rows: header.points, wanted });
    }
    if !lzf::is_possible(packed, unpacked) {
        return Err(PcdError::Damaged);
    }
    let mut block = Vec::new();
    let found = fill(source, &mut block, packed as usize)? as u64;
    if found < packed {
        return Err(PcdError::EndInBlock { wanted: packed + 8, found: found + 8 });
    }
    let block = lzf::unpack(&block, unpacked as usize).ok_or(PcdError::Damaged)?;
    let mut columns = Vec::new();
    let mut rest = block.as_slice();
    for field in fields {
        let bytes = field.bytes().saturating_mul(header.points);
        let (values, behind) = rest.split_at_checked(bytes as usize).ok_or(PcdError::Damaged)?;
        rest = behind;
        let Some(scalar) = field.scalar else { continue };
        for index in 0..field.count {
            let mut column = scalar.column(header.points as usize);
            append(&mut column, values, field.bytes() as usize, (index * field.size) as usize, Order::Little);
            columns.push(column);
        }
    }
    // Behind the block stand some more bytes as a rule: the point cloud library makes files as long as it first guesses.
    Ok(columns)
}

/// The bytes that so many points take.
fn wants<'a>(fields: impl IntoIterator<Item = &'a Field>, points: u64) -> u128 {
    fields.into_iter().map(|field| u128::from(field.bytes())).sum::<u128>() * u128::from(points)
}

fn size_at(sizes: &[u8], at: usize) -> Option<u64> {
    let bytes = sizes.get(at..)?.first_chunk::<4>()?;
    Some(u64::from(u32::from_le_bytes(*bytes)))
}

/// Fills `block` with `wanted` bytes or what there is, growing no further than that.
fn fill(source: &mut Source<'_>, block: &mut Vec<u8>, wanted: usize) -> Result<usize, PcdError> {
    const STEP: usize = 1 << 20;
    let mut filled = 0;
    while filled < wanted {
        let step = STEP.min(wanted - filled);
        block.resize(filled + step, 0);
        let read = source.fill(block.get_mut(filled..).unwrap_or_default())?;
        filled += read;
        if read < step {
            break;
        }
    }
    block.truncate(filled);
    Ok(filled)
}
