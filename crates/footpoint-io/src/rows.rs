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
    let big = order == Order::Big;
    match column {
        Data::I8(v) => decode(v, rows, stride, offset, i8::from_le_bytes),
        Data::U8(v) => decode(v, rows, stride, offset, u8::from_le_bytes),
        Data::I16(v) if big => decode(v, rows, stride, offset, i16::from_be_bytes),
        Data::I16(v) => decode(v, rows, stride, offset, i16::from_le_bytes),
        Data::U16(v) if big => decode(v, rows, stride, offset, u16::from_be_bytes),
        Data::U16(v) => decode(v, rows, stride, offset, u16::from_le_bytes),
        Data::I32(v) if big => decode(v, rows, stride, offset, i32::from_be_bytes),
        Data::I32(v) => decode(v, rows, stride, offset, i32::from_le_bytes),
        Data::U32(v) if big => decode(v, rows, stride, offset, u32::from_be_bytes),
        Data::U32(v) => decode(v, rows, stride, offset, u32::from_le_bytes),
        Data::I64(v) if big => decode(v, rows, stride, offset, i64::from_be_bytes),
        Data::I64(v) => decode(v, rows, stride, offset, i64::from_le_bytes),
        Data::U64(v) if big => decode(v, rows, stride, offset, u64::from_be_bytes),
        Data::U64(v) => decode(v, rows, stride, offset, u64::from_le_bytes),
        Data::F32(v) if big => decode(v, rows, stride, offset, f32::from_be_bytes),
        Data::F32(v) => decode(v, rows, stride, offset, f32::from_le_bytes),
        Data::F64(v) if big => decode(v, rows, stride, offset, f64::from_be_bytes),
        Data::F64(v) => decode(v, rows, stride, offset, f64::from_le_bytes),
        Data::Text(_) => {}
    }
}

fn decode<T, const N: usize>(
    out: &mut Vec<T>,
    rows: &[u8],
    stride: usize,
    offset: usize,
    number: impl Fn([u8; N]) -> T,
) {
    let field = |row: &[u8]| row.get(offset..).and_then(|rest| rest.first_chunk::<N>().copied());
    out.extend(rows.chunks_exact(stride).filter_map(field).map(number));
}

/// Writes the rows of columns of equal length; text is left out.
pub(crate) fn write(out: &mut impl Write, columns: &[Cow<'_, Data>], order: Order) -> io::Result<()> {
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
    }
    Ok(())
}

type Rows = std::ops::Range<usize>;

/// Puts `rows` of one column into their places in a block of rows.
fn scatter(data: &Data, rows: Rows, block: &mut [u8], place: (usize, usize), order: Order) {
    let big = order == Order::Big;
    match data {
        Data::I8(v) => encode(v.get(rows), block, place, i8::to_le_bytes),
        Data::U8(v) => encode(v.get(rows), block, place, u8::to_le_bytes),
        Data::I16(v) if big => encode(v.get(rows), block, place, i16::to_be_bytes),
        Data::I16(v) => encode(v.get(rows), block, place, i16::to_le_bytes),
        Data::U16(v) if big => encode(v.get(rows), block, place, u16::to_be_bytes),
        Data::U16(v) => encode(v.get(rows), block, place, u16::to_le_bytes),
        Data::I32(v) if big => encode(v.get(rows), block, place, i32::to_be_bytes),
        Data::I32(v) => encode(v.get(rows), block, place, i32::to_le_bytes),
        Data::U32(v) if big => encode(v.get(rows), block, place, u32::to_be_bytes),
        Data::U32(v) => encode(v.get(rows), block, place, u32::to_le_bytes),
        Data::I64(v) if big => encode(v.get(rows), block, place, i64::to_be_bytes),
        Data::I64(v) => encode(v.get(rows), block, place, i64::to_le_bytes),
        Data::U64(v) if big => encode(v.get(rows), block, place, u64::to_be_bytes),
        Data::U64(v) => encode(v.get(rows), block, place, u64::to_le_bytes),
        Data::F32(v) if big => encode(v.get(rows), block, place, f32::to_be_bytes),
        Data::F32(v) => encode(v.get(rows), block, place, f32::to_le_bytes),
        Data::F64(v) if big => encode(v.get(rows), block, place, f64::to_be_bytes),
        Data::F64(v) => encode(v.get(rows), block, place, f64::to_le_bytes),
        Data::Text(_) => {}
    }
}

fn encode<T: Copy, const N: usize>(
    values: Option<&[T]>,
    block: &mut [u8],
    (stride, offset): (usize, usize),
    bytes: impl Fn(T) -> [u8; N],
) {
    for (value, row) in values.unwrap_or_default().iter().zip(block.chunks_exact_mut(stride)) {
        if let Some(place) = row.get_mut(offset..offset + N) {
            place.copy_from_slice(&bytes(*value));
        }
    }
}
