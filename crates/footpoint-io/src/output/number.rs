//! Numbers as decimal text that reads back to the same bits.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};

use crate::Data;

/// Writes one number of a column; nothing for text, which has its own writer.
pub(crate) fn write_value(out: &mut impl Write, data: &Data, row: usize) -> io::Result<()> {
    match data {
        Data::I8(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::U8(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::I16(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::U16(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::I32(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::U32(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::I64(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::U64(v) => v.get(row).map_or(Ok(()), |n| write_integer(out, *n)),
        Data::F32(v) => v.get(row).map_or(Ok(()), |n| write_real(out, *n)),
        Data::F64(v) => v.get(row).map_or(Ok(()), |n| write_real(out, *n)),
        Data::Text(_) => Ok(()),
    }
}

fn write_integer(out: &mut impl Write, value: impl Display) -> io::Result<()> {
    write!(out, "{value}")
}

/// Writes the shortest digits that mean this very number: plain in the usual range, with an exponent
/// where plain digits would run to hundreds, `nan`, `inf` or `-inf`.
pub(super) fn write_real<T>(out: &mut impl Write, value: T) -> io::Result<()>
where
    T: Copy + Display + LowerExp + Into<f64>,
{
    let wide: f64 = value.into();
    let size = wide.abs();
    if wide.is_nan() {
        out.write_all(b"nan")
    } else if wide.is_infinite() {
        out.write_all(if wide > 0.0 { b"inf" } else { b"-inf" })
    } else if size == 0.0 || (1e-5..1e16).contains(&size) {
        write!(out, "{value}")
    } else {
        write!(out, "{value:e}")
    }
}
