//! The rows of an ascii PLY element: one line each, blank lines aside.

use super::PlyError;
use super::header::{Element, Kind};
use crate::Data;
use crate::excerpt::excerpt;
use crate::scalar::Scalar;
use crate::source::Source;

/// Reads the scalar properties of all rows, one column each in the header's order.
pub(super) fn read(source: &mut Source<'_>, line_end: u8, element: &Element) -> Result<Vec<Data>, PlyError> {
    let room = room(source, element);
    let mut slots: Vec<Slot> = element.properties.iter().map(|p| Slot::new(p.kind, room)).collect();
    let mut line = Vec::new();
    let rows = if element.properties.is_empty() { 0 } else { element.rows };
    for row in 1..=rows {
        if !next_row(source, line_end, &mut line)? {
            return Err(element.end_in_row(row));
        }
        let mut values = values(&line);
        for (slot, property) in slots.iter_mut().zip(&element.properties) {
            let stop = match slot.take(&mut values) {
                Ok(()) => continue,
                Err(stop) => stop,
            };
            let (content, kind) = match stop {
                Stop::Missing if source.at_end()? => return Err(element.end_in_row(row)),
                Stop::Missing => return Err(row_length(source, element, row, &line)),
                Stop::Wrong(content, kind) => (excerpt(content), kind.ply_name()),
            };
            let (element, property) = (element.name.clone(), property.name.clone());
            let line = source.line_number();
            return Err(PlyError::Value { line, element, row, property, content, kind });
        }
        if values.next().is_some() {
            return Err(row_length(source, element, row, &line));
        }
    }
    Ok(slots.into_iter().filter_map(Slot::into_column).collect())
}

/// Passes over the rows without looking into them.
pub(super) fn pass_over(source: &mut Source<'_>, line_end: u8, element: &Element) -> Result<(), PlyError> {
    let mut line = Vec::new();
    let rows = if element.properties.is_empty() { 0 } else { element.rows };
    for row in 1..=rows {
        if !next_row(source, line_end, &mut line)? {
            return Err(element.end_in_row(row));
        }
    }
    Ok(())
}

/// The next line that is not blank.
pub(super) fn next_row(source: &mut Source<'_>, line_end: u8, line: &mut Vec<u8>) -> Result<bool, PlyError> {
    while source.read_line(line_end, line)? {
        if !line.trim_ascii().is_empty() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Rows to make room for: what the header states, but no more than the bytes left can hold.
fn room(source: &Source<'_>, element: &Element) -> usize {
    let least_line = 2 * element.properties.len().max(1) as u64;
    let rows = element.rows.min(source.remaining().unwrap_or(0) / least_line + 1);
    usize::try_from(rows).unwrap_or(0)
}

fn values(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|value| !value.is_empty())
}

/// Where the values of one property go.
enum Slot {
    Column(Data, Scalar),
    List,
}

/// Why a row stopped.
enum Stop<'a> {
    Missing,
    Wrong(&'a [u8], Scalar),
}

impl Slot {
    fn new(kind: Kind, room: usize) -> Self {
        match kind {
            Kind::Scalar(scalar) => Self::Column(scalar.column(room), scalar),
            Kind::List { .. } => Self::List,
        }
    }

    fn take<'a>(&mut self, values: &mut impl Iterator<Item = &'a [u8]>) -> Result<(), Stop<'a>> {
        let value = values.next().ok_or(Stop::Missing)?;
        match self {
            Self::Column(data, scalar) => push(data, value).ok_or(Stop::Wrong(value, *scalar)),
            Self::List => {
                let length: u64 = integer(value).ok_or(Stop::Wrong(value, Scalar::U32))?;
                for _ in 0..length {
                    values.next().ok_or(Stop::Missing)?;
                }
                Ok(())
            }
        }
    }

    fn into_column(self) -> Option<Data> {
        match self {
            Self::Column(data, _) => Some(data),
            Self::List => None,
        }
    }
}

/// Appends a written value, `None` if it is not of the column's type.
pub(crate) fn push(data: &mut Data, value: &[u8]) -> Option<()> {
    match data {
        Data::I8(v) => v.push(integer(value)?),
        Data::U8(v) => v.push(integer(value)?),
        Data::I16(v) => v.push(integer(value)?),
        Data::U16(v) => v.push(integer(value)?),
        Data::I32(v) => v.push(integer(value)?),
        Data::U32(v) => v.push(integer(value)?),
        Data::I64(v) => v.push(integer(value)?),
        Data::U64(v) => v.push(integer(value)?),
        Data::F32(v) => v.push(fast_float2::parse(value).ok()?),
        Data::F64(v) => v.push(fast_float2::parse(value).ok()?),
        Data::Text(_) => return None,
    }
    Some(())
}

/// A whole number; some tools write `255.0` or `1e3`, which is taken if nothing is lost.
fn integer<T: TryFrom<i64>>(value: &[u8]) -> Option<T> {
    let whole = match str::from_utf8(value).ok()?.parse::<i64>() {
        Ok(whole) => whole,
        Err(_) => {
            let number: f64 = fast_float2::parse(value).ok()?;
            (number.trunc() == number && number.abs() <= f64::from(u32::MAX)).then_some(number as i64)?
        }
    };
    T::try_from(whole).ok()
}

fn row_length(source: &Source<'_>, element: &Element, row: u64, line: &[u8]) -> PlyError {
    PlyError::RowLength {
        line: source.line_number(),
        element: element.name.clone(),
        row,
        found: values(line).count() as u64,
        wanted: wanted(element, line),
    }
}

/// The values a row should have, with its lists as long as they say.
fn wanted(element: &Element, line: &[u8]) -> u64 {
    let mut values = values(line);
    let mut wanted = 0_u64;
    for property in &element.properties {
        let first = values.next();
        let length = match property.kind {
            Kind::Scalar(_) => 0,
            Kind::List { .. } => first.and_then(integer).unwrap_or(0),
        };
        wanted = wanted.saturating_add(length).saturating_add(1);
        (0..length).try_for_each(|_| values.next().map(drop));
    }
    wanted
}
