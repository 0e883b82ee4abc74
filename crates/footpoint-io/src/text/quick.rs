//! The short way for lines of plain numbers, which are nearly all lines of nearly all files.

use crate::{Column, Data};

/// Values gathered before they go to their columns; they should stay in the processor's cache.
const GATHERED: usize = 4096;

/// Rows of numbers that have not gone to their columns yet.
pub(super) struct Quick {
    /// Row after row.
    values: Vec<f64>,
    width: usize,
}

impl Quick {
    /// For rows of these columns, if all of them are numbers.
    pub(super) fn new(columns: &[Column]) -> Option<Self> {
        let plain = columns.iter().all(|column| matches!(column.data, Data::F64(_)));
        plain.then(|| Self { values: Vec::with_capacity(GATHERED + columns.len()), width: columns.len() })
    }

    /// Takes a line of as many numbers as there are columns, with one separator between each two; of any other
    /// line it takes nothing and returns `false`, whatever may be right or wrong with it.
    pub(super) fn take(&mut self, line: &[u8], columns: &mut [Column]) -> bool {
        let before = self.values.len();
        if self.numbers(line).is_none() {
            self.values.truncate(before);
            return false;
        }
        if self.values.len() >= GATHERED {
            self.flush(columns);
        }
        true
    }

    fn numbers(&mut self, line: &[u8]) -> Option<()> {
        let mut rest = blanks(line);
        for index in 0..self.width {
            if index > 0 {
                rest = separator(rest)?;
            }
            let (number, length) = match decimal(rest) {
                Some(short) => short,
                None => fast_float2::parse_partial(rest).ok()?,
            };
            self.values.push(number);
            rest = rest.get(length..)?;
        }
        blanks(rest).is_empty().then_some(())
    }

    /// Moves the values to their columns.
    pub(super) fn flush(&mut self, columns: &mut [Column]) {
        for (index, column) in columns.iter_mut().enumerate() {
            if let Data::F64(values) = &mut column.data {
                values.extend(self.values.iter().skip(index).step_by(self.width));
            }
        }
        self.values.clear();
    }
}

/// A number of few digits without an exponent, and its length; `None` if that is not what stands in front.
///
/// An integer up to 2⁵³ divided by a power of ten up to 10²², both exact as doubles, is rounded once, so correctly
/// (Clinger 1990). `fast-float2` does the same behind more questions, which take longer than so few digits.
fn decimal(bytes: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let (mut mantissa, mut length, mut whole) = (0_u64, 0, None);
    let rest = bytes.get(sign..)?;
    for byte in rest {
        match byte.wrapping_sub(b'0') {
            digit @ 0..=9 => mantissa = mantissa * 10 + u64::from(digit),
            _ if *byte == b'.' && whole.is_none() => whole = Some(length + 1),
            _ => break,
        }
        length += 1;
        if length > LONGEST {
            return None;
        }
    }
    let decimals = whole.map_or(0, |whole| length - whole);
    let digits = length - usize::from(whole.is_some());
    let ends = rest.get(length).is_none_or(|byte| matches!(byte, b' ' | b',' | b';' | b'\t' | b'\r'));
    if !ends || digits == 0 || mantissa > 1 << 53 {
        return None;
    }
    let number = mantissa as f64 / POWERS.get(decimals)?;
    Some((if sign == 1 { -number } else { number }, sign + length))
}

/// Digits and a point that stay far below 2⁶⁴.
const LONGEST: usize = 18;
/// Powers of ten that are exact.
const POWERS: [f64; LONGEST + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18];

/// The bytes behind blanks.
fn blanks(line: &[u8]) -> &[u8] {
    match line.first() {
        Some(byte) if byte.is_ascii_whitespace() => line.trim_ascii_start(),
        _ => line,
    }
}

/// The bytes behind one separator: blanks, or a mark with or without blanks around it.
fn separator(line: &[u8]) -> Option<&[u8]> {
    let rest = blanks(line);
    match rest.split_first()? {
        (b',' | b';', behind) => Some(blanks(behind)),
        _ => (rest.len() < line.len()).then_some(rest),
    }
}
