//! The header of an array: a Python dictionary, read by `npyz` after a look that it is safe to.

use npyz::{DType, NpyHeader, Order};
use py_literal::Value;

use super::{MAGIC, NpyError};
use crate::source::Source;

/// Bytes of a header that are read; NumPy itself refuses more than 10,000.
const LONGEST: usize = 64 * 1024;
/// Brackets within brackets: a dictionary, records, records in these, and their shapes. The parser takes twice
/// as long for each.
const DEEPEST: usize = 7;

pub(super) struct Header {
    pub(super) shape: Vec<u64>,
    pub(super) dtype: DType,
    pub(super) fortran: bool,
}

impl Header {
    pub(super) fn read(source: &mut Source<'_>) -> Result<Self, NpyError> {
        let mut bytes = Vec::new();
        let start = read_more(source, &mut bytes, MAGIC.len() + 2)?;
        if !start.starts_with(MAGIC) {
            return Err(NpyError::Header("it does not begin with \\x93NUMPY".to_owned()));
        }
        // The length has two bytes in version 1, and four since.
        let size = if start.ends_with(&[1, 0]) { 2 } else { 4 };
        let length = read_more(source, &mut bytes, size)?.iter().rev();
        let length = length.fold(0_usize, |length, byte| length << 8 | usize::from(*byte));
        if length > LONGEST {
            return Err(NpyError::Header(format!("it has {length} bytes, more than {LONGEST} are not read")));
        }
        let text = read_more(source, &mut bytes, length)?;
        check(text).map_err(|what| NpyError::Header(what.to_owned()))?;
        let header = NpyHeader::from_reader(bytes.as_slice()).map_err(|e| NpyError::Header(e.to_string()))?;
        let (shape, fortran) = (header.shape().to_vec(), header.order() == Order::Fortran);
        Ok(Self { shape, dtype: header.dtype(), fortran })
    }
}

/// Appends so many bytes of the source and returns them.
fn read_more<'b>(source: &mut Source<'_>, bytes: &'b mut Vec<u8>, more: usize) -> Result<&'b [u8], NpyError> {
    let start = bytes.len();
    bytes.resize(start + more, 0);
    let filled = source.fill(bytes.get_mut(start..).unwrap_or_default())?;
    if filled < more {
        return Err(NpyError::Header("the file ends in it".to_owned()));
    }
    Ok(bytes.get(start..).unwrap_or_default())
}

/// Refuses what `npyz` would take long for, or multiply beyond all numbers.
fn check(text: &[u8]) -> Result<(), &'static str> {
    let mut depth = 0_usize;
    for byte in text {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEEPEST {
            return Err("its brackets stand too deep in each other");
        }
    }
    let text = str::from_utf8(text).map_err(|_| "it is not text")?;
    let Ok(Value::Dict(entries)) = text.trim().parse::<Value>() else {
        return Err("it is no Python dictionary");
    };
    let is_shape = |(key, _): &&(Value, Value)| key.as_string().is_some_and(|key| key == "shape");
    for (_, shape) in entries.iter().filter(is_shape) {
        let Some(Value::Tuple(lengths) | Value::List(lengths)) = Some(shape) else {
            return Err("its shape is no tuple");
        };
        let mut all = 1_u64;
        for length in lengths {
            let length =
                length.as_integer().and_then(|n| u64::try_from(n).ok()).ok_or("its shape has no lengths")?;
            all = all.checked_mul(length.max(1)).ok_or("its shape is beyond all files")?;
        }
    }
    Ok(())
}
