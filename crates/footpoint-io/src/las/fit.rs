//! Which columns a field can hold without losing anything, and putting their values into records.

use std::borrow::Cow;

use super::fields::{Field, Kind};
use super::grid::Grid;
use crate::Data;
use crate::scalar::Scalar;

/// The values of a column as a field holds them; `None` if it cannot hold each of them.
pub(super) fn fit<'t>(data: &'t Data, kind: Kind) -> Option<Cow<'t, Data>> {
    let data = as_type(data, kind.column())?;
    let fits = match (kind, data.as_ref()) {
        (Kind::Bits { width, .. }, Data::U8(values)) => {
            values.iter().all(|&value| u32::from(value) < 1 << width)
        }
        (Kind::Scaled { raw, scale, offset }, Data::F64(values)) => {
            let scaled = Scaled { raw, grid: Grid { scale, offset } };
            values.iter().all(|&value| scaled.back(value) == value)
        }
        _ => true,
    };
    fits.then_some(data)
}

/// A column of one of the types, if each value is one of it.
fn as_type(data: &Data, wanted: Scalar) -> Option<Cow<'_, Data>> {
    let scalar = Scalar::of(data)?;
    if scalar == wanted {
        return Some(Cow::Borrowed(data));
    }
    // Wide integers are not told apart by doubles.
    if matches!(scalar, Scalar::I64 | Scalar::U64) && wanted.size() == 8 {
        return None;
    }
    let values = data.to_f64()?;
    let whole = |low: f64, high: f64| values.iter().all(|&v| v.trunc() == v && low <= v && v <= high);
    Some(Cow::Owned(match wanted {
        Scalar::I8 if whole(-128.0, 127.0) => Data::I8(values.iter().map(|&v| v as i8).collect()),
        Scalar::U8 if whole(0.0, 255.0) => Data::U8(values.iter().map(|&v| v as u8).collect()),
        Scalar::I16 if whole(-32_768.0, 32_767.0) => Data::I16(values.iter().map(|&v| v as i16).collect()),
        Scalar::U16 if whole(0.0, 65_535.0) => Data::U16(values.iter().map(|&v| v as u16).collect()),
        Scalar::U32 if whole(0.0, f64::from(u32::MAX)) => {
            Data::U32(values.iter().map(|&v| v as u32).collect())
        }
        Scalar::U64 if whole(0.0, 9e15) => Data::U64(values.iter().map(|&v| v as u64).collect()),
        Scalar::F32 if values.iter().all(|&v| v.is_nan() || f64::from(v as f32) == v) => {
            Data::F32(values.iter().map(|&v| v as f32).collect())
        }
        Scalar::F64 => Data::F64(values),
        _ => return None,
    }))
}

/// Colours of 8 bits spread over the 16 that LAS wants (LAS 1.4 R15, section 2.6.3): 255 becomes 65,535.
pub(super) fn widened(data: &Data) -> Option<Data> {
    match data {
        Data::U8(values) => Some(Data::U16(values.iter().map(|&v| u16::from(v) * 257).collect())),
        _ => None,
    }
}

/// Puts the values of some rows into their places in zeroed records of `stride` bytes.
pub(super) fn put(data: &Data, first: usize, field: &Field, block: &mut [u8], stride: usize) {
    let mut rows = Rows { block, stride, at: field.at };
    match (field.kind, data) {
        (Kind::Bits { shift, .. }, Data::U8(v)) => {
            for (row, value) in rows.block.chunks_exact_mut(stride).zip(v.get(first..).unwrap_or_default()) {
                if let Some(byte) = row.get_mut(field.at) {
                    *byte |= value << shift;
                }
            }
        }
        (Kind::Scaled { raw, scale, offset }, Data::F64(v)) => {
            let scaled = Scaled { raw, grid: Grid { scale, offset } };
            match raw {
                Scalar::I8 | Scalar::U8 => rows.put(v, first, |v| scaled.bytes::<1>(v)),
                Scalar::I16 | Scalar::U16 => rows.put(v, first, |v| scaled.bytes::<2>(v)),
                Scalar::I32 | Scalar::U32 | Scalar::F32 => rows.put(v, first, |v| scaled.bytes::<4>(v)),
                Scalar::I64 | Scalar::U64 | Scalar::F64 => rows.put(v, first, |v| scaled.bytes::<8>(v)),
            }
        }
        (_, Data::I8(v)) => rows.put(v, first, i8::to_le_bytes),
        (_, Data::U8(v)) => rows.put(v, first, u8::to_le_bytes),
        (_, Data::I16(v)) => rows.put(v, first, i16::to_le_bytes),
        (_, Data::U16(v)) => rows.put(v, first, u16::to_le_bytes),
        (_, Data::I32(v)) => rows.put(v, first, i32::to_le_bytes),
        (_, Data::U32(v)) => rows.put(v, first, u32::to_le_bytes),
        (_, Data::I64(v)) => rows.put(v, first, i64::to_le_bytes),
        (_, Data::U64(v)) => rows.put(v, first, u64::to_le_bytes),
        (_, Data::F32(v)) => rows.put(v, first, f32::to_le_bytes),
        (_, Data::F64(v)) => rows.put(v, first, f64::to_le_bytes),
        (_, Data::Text(_)) => {}
    }
}

/// A number stored as another one, on a grid.
#[derive(Clone, Copy)]
struct Scaled {
    raw: Scalar,
    grid: Grid,
}

impl Scaled {
    /// The stored number, its first `N` bytes.
    fn bytes<const N: usize>(self, value: f64) -> [u8; N] {
        let number = (value - self.grid.offset) / self.grid.scale;
        let wide = match self.raw {
            Scalar::F32 => u64::from((number as f32).to_bits()),
            Scalar::F64 => number.to_bits(),
            Scalar::U64 => number.round() as u64,
            Scalar::I32 => i64::from(self.grid.integer(value)) as u64,
            _ => number.round() as i64 as u64,
        };
        wide.to_le_bytes().first_chunk().copied().unwrap_or([0; N])
    }

    /// The value that will be read; another one if the number is not one of its type.
    fn back(self, value: f64) -> f64 {
        let wide = u64::from_le_bytes(self.bytes(value));
        let number = match self.raw {
            Scalar::I8 => (wide as i8).into(),
            Scalar::U8 => (wide as u8).into(),
            Scalar::I16 => (wide as i16).into(),
            Scalar::U16 => (wide as u16).into(),
            Scalar::I32 => (wide as i32).into(),
            Scalar::U32 => (wide as u32).into(),
            Scalar::I64 => wide as i64 as f64,
            Scalar::U64 => wide as f64,
            Scalar::F32 => f32::from_bits(wide as u32).into(),
            Scalar::F64 => f64::from_bits(wide),
        };
        number * self.grid.scale + self.grid.offset
    }
}

/// One field of all records of a block.
struct Rows<'b> {
    block: &'b mut [u8],
    stride: usize,
    at: usize,
}

impl Rows<'_> {
    fn put<T: Copy, const N: usize>(&mut self, values: &[T], first: usize, bytes: impl Fn(T) -> [u8; N]) {
        let values = values.get(first..).unwrap_or_default();
        for (row, value) in self.block.chunks_exact_mut(self.stride).zip(values) {
            if let Some(place) = row.get_mut(self.at..self.at + N) {
                place.copy_from_slice(&bytes(*value));
            }
        }
    }
}
