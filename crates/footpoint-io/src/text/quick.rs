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
            let (number, length) = fast_float2::parse_partial::<f64, _>(rest).ok()?;
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
