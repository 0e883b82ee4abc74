//! Rows of fixed-size numbers: from the bytes of a file into columns, and back.

use std::borrow::Cow;
use std::io::{self, Write};

use crate::Data;
use crate::scalar::Scalar;

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    Little,
    Big,
}

/// Bytes of rows put together at a time; they should stay in the processor's cache.
const BLOCK: usize = 128 * 1024;

/// Appends one field of a block of rows to its column.
pub(crate) fn append(column: &mut Data, rows: &[u8], stride: usize, offset: usize, order: Order) {
    match column {
        Data::I8(v) => decode(v, rows, (stride, offset), order, i8::from_le_bytes),
        Data::U8(v) => decode(v, rows, (stride, offset), order, u8::from_le_bytes),
        Data::I16(v) => decode(v, rows, (stride, offset), order, i16::from_le_bytes),
        Data::U16(v) => decode(v, rows, (stride, offset), order, u16::from_le_bytes),
        Data::I32(v) => decode(v, rows, (stride, offset), order, i32::from_le_bytes),
        Data::U32(v) => decode(v, rows, (stride, offset), order, u32::from_le_bytes),
        Data::I64(v) => decode(v, rows, (stride, offset), order, i64::from_le_bytes),
        Data::U64(v) => decode(v, rows, (stride, offset), order, u64::from_le_bytes),
        Data::F32(v) => decode(v, rows, (stride, offset), order, f32::from_le_bytes),
        Data::F64(v) => decode(v, rows, (stride, offset), order, f64::from_le_bytes),
        Data::Text(_) => {}
    }
}

fn decode<T, const N: usize>(
    out: &mut Vec<T>,
    rows: &[u8],
    (stride, offset): (usize, usize),
    order: Order,
    number: impl Fn([u8; N]) -> T,
) {
    let field = |row: &[u8]| row.get(offset..).and_then(|rest| rest.first_chunk::<N>().copied());
    let fields = rows.chunks_exact(stride).filter_map(field);
    match order {
        Order::Little => out.extend(fields.map(number)),
        Order::Big => out.extend(fields.map(reversed).map(number)),
    }
}

fn reversed<const N: usize>(mut bytes: [u8; N]) -> [u8; N] {
    bytes.reverse();
    bytes
}

/// Writes the rows of columns of equal length and tells how many; text is left out.
pub(crate) fn write(
    out: &mut impl Write,
    columns: &[Cow<'_, Data>],
    order: Order,
    written: impl Fn(usize) -> io::Result<()>,
) -> io::Result<()> {
    let size = |data: &Cow<'_, Data>| Scalar::of(data).map_or(0, |scalar| scalar.size() as usize);
    let stride: usize = columns.iter().map(size).sum();
    let rows = columns.first().map_or(0, |data| data.len());
    let rows_per_block = (BLOCK / stride.max(1)).max(1);
    let mut block = Vec::new();
    let mut start = 0;
    while start < rows {
        let end = rows.min(start + rows_per_block);
        block.resize((end - start) * stride, 0);
        let mut offset = 0;
        for data in columns {
            scatter(data, start..end, &mut block, (stride, offset), order);
            offset += size(data);
        }
        out.write_all(&block)?;
        start = end;
        written(start)?;
    }
    Ok(())
}

type Rows = std::ops::Range<usize>;

/// Puts `rows` of one column into their places in a block of rows.
fn scatter(data: &Data, rows: Rows, block: &mut [u8], place: (usize, usize), order: Order) {
    match data {
        Data::I8(v) => encode(v.get(rows), block, place, order, i8::to_le_bytes),
        Data::U8(v) => encode(v.get(rows), block, place, order, u8::to_le_bytes),
        Data::I16(v) => encode(v.get(rows), block, place, order, i16::to_le_bytes),
        Data::U16(v) => encode(v.get(rows), block, place, order, u16::to_le_bytes),
        Data::I32(v) => encode(v.get(rows), block, place, order, i32::to_le_bytes),
        Data::U32(v) => encode(v.get(rows), block, place, order, u32::to_le_bytes),
        Data::I64(v) => encode(v.get(rows), block, place, order, i64::to_le_bytes),
        Data::U64(v) => encode(v.get(rows), block, place, order, u64::to_le_bytes),
        Data::F32(v) => encode(v.get(rows), block, place, order, f32::to_le_bytes),
        Data::F64(v) => encode(v.get(rows), block, place, order, f64::to_le_bytes),
        Data::Text(_) => {}
    }
}

fn encode<T: Copy, const N: usize>(
    values: Option<&[T]>,
    block: &mut [u8],
    (stride, offset): (usize, usize),
    order: Order,
    bytes: impl Fn(T) -> [u8; N],
) {
    for (value, row) in values.unwrap_or_default().iter().zip(block.chunks_exact_mut(stride)) {
        if let Some(place) = row.get_mut(offset..offset + N) {
            let little = bytes(*value);
            place.copy_from_slice(&if order == Order::Big { reversed(little) } else { little });
        }
    }
}
