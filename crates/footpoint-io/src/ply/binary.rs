//! The rows of a binary PLY element.

use super::PlyError;
use super::header::{Element, Kind};
use crate::Data;
use crate::rows::{Order, append};
use crate::scalar::Scalar;
use crate::source::Source;

/// Bytes of rows held at a time; they should stay in the processor's cache.
const BLOCK: u64 = 128 * 1024;
/// Rows to make room for where the size of the file does not bound them.
const BLIND_ROOM: u64 = 1 << 16;

/// Reads the scalar properties of all rows, one column each in the header's order.
pub(super) fn read(source: &mut Source<'_>, order: Order, element: &Element) -> Result<Vec<Data>, PlyError> {
    let wanted = u128::from(element.rows) * u128::from(element.least_row_bytes());
    if let Some(found) = source.remaining().filter(|&found| u128::from(found) < wanted) {
        return Err(end_in_bytes(element, found));
    }
    let scalars: Vec<Scalar> = element
        .properties
        .iter()
        .filter_map(|p| match p.kind {
            Kind::Scalar(scalar) => Some(scalar),
            Kind::List { .. } => None,
        })
        .collect();
    let rows = if element.properties.is_empty() { 0 } else { element.rows };
    let room = if source.remaining().is_some() { rows } else { rows.min(BLIND_ROOM) };
    let room = usize::try_from(room).unwrap_or(0);
    let mut columns: Vec<Data> = scalars.iter().map(|scalar| scalar.column(room)).collect();
    let stride: u64 = scalars.iter().map(|scalar| scalar.size()).sum();
    let rows_per_block = (BLOCK / stride.max(1)).max(1);
    let mut block = Vec::new();
    let mut done = 0;
    while done < rows {
        let now = rows_per_block.min(rows - done);
        if element.has_lists() {
            read_rows_with_lists(source, order, element, done..done + now, &mut block)?;
        } else {
            block.resize((now * stride) as usize, 0);
            let filled = source.fill(&mut block)?;
            if filled < block.len() {
                return Err(end_in_bytes(element, done * stride + filled as u64));
            }
        }
        let mut offset = 0;
        for (column, scalar) in columns.iter_mut().zip(&scalars) {
            append(column, &block, stride as usize, offset, order);
            offset += scalar.size() as usize;
        }
        done += now;
    }
    Ok(columns)
}

/// Passes over the rows, lists by their lengths.
pub(super) fn pass_over(source: &mut Source<'_>, order: Order, element: &Element) -> Result<(), PlyError> {
    let stride = element.least_row_bytes();
    if !element.has_lists() {
        let bytes = element.rows.saturating_mul(stride);
        let skipped = source.skip(bytes)?;
        return if skipped == bytes { Ok(()) } else { Err(element.end_in_row(skipped / stride.max(1) + 1)) };
    }
    for row in 1..=element.rows {
        for property in &element.properties {
            let bytes = match property.kind {
                Kind::Scalar(scalar) => scalar.size(),
                Kind::List { count, value } => {
                    let length = list_length(source, order, count)?.ok_or_else(|| element.end_in_row(row))?;
                    list_bytes(element, &property.name, row, length, value)?
                }
            };
            if source.skip(bytes)? < bytes {
                return Err(element.end_in_row(row));
            }
        }
    }
    Ok(())
}

/// Gathers the scalars of `rows` into `block`, as if the lists were not there.
fn read_rows_with_lists(
    source: &mut Source<'_>,
    order: Order,
    element: &Element,
    rows: std::ops::Range<u64>,
    block: &mut Vec<u8>,
) -> Result<(), PlyError> {
    block.clear();
    for row in rows.start + 1..=rows.end {
        for property in &element.properties {
            match property.kind {
                Kind::Scalar(scalar) => {
                    let bytes = number_bytes(source, scalar)?.ok_or_else(|| element.end_in_row(row))?;
                    block.extend_from_slice(bytes.get(..scalar.size() as usize).unwrap_or_default());
                }
                Kind::List { count, value } => {
                    let length = list_length(source, order, count)?.ok_or_else(|| element.end_in_row(row))?;
                    let bytes = list_bytes(element, &property.name, row, length, value)?;
                    if source.skip(bytes)? < bytes {
                        return Err(element.end_in_row(row));
                    }
                }
            }
        }
    }
    Ok(())
}

/// The bytes of one number in front; `None` at the end of the file.
fn number_bytes(source: &mut Source<'_>, scalar: Scalar) -> Result<Option<[u8; 8]>, PlyError> {
    let size = scalar.size() as usize;
    let mut bytes = [0; 8];
    let filled = source.fill(bytes.get_mut(..size).unwrap_or_default())?;
    Ok((filled == size).then_some(bytes))
}

/// The number of values of a list; `None` at the end of the file.
fn list_length(source: &mut Source<'_>, order: Order, count: Scalar) -> Result<Option<i64>, PlyError> {
    let Some(mut bytes) = number_bytes(source, count)? else { return Ok(None) };
    let size = count.size() as usize;
    if order == Order::Big {
        bytes.get_mut(..size).unwrap_or_default().reverse();
    }
    let wide = i64::from_le_bytes(bytes);
    Ok(Some(match count {
        Scalar::I8 => i64::from(wide as i8),
        Scalar::I16 => i64::from(wide as i16),
        Scalar::I32 => i64::from(wide as i32),
        _ => wide,
    }))
}

fn list_bytes(
    element: &Element,
    property: &str,
    row: u64,
    length: i64,
    value: Scalar,
) -> Result<u64, PlyError> {
    match u64::try_from(length) {
        Ok(values) => Ok(values * value.size()),
        Err(_) => {
            let (element, property) = (element.name.clone(), property.to_owned());
            Err(PlyError::ListLength { element, row, property, length })
        }
    }
}

fn end_in_bytes(element: &Element, found: u64) -> PlyError {
    PlyError::EndInBytes {
        element: element.name.clone(),
        rows: element.rows,
        wanted: u128::from(element.rows) * u128::from(element.least_row_bytes()),
        found,
    }
}
