//! Output columns that several threads fill in any order, each row once.
//!
//! Queries are answered in the order of space, and rows are in the order of the input: where that is random, every cell is
//! far from the last, and waiting for memory costs as much as the sums. So a thread collects the answers for a range of
//! rows, and writes them out together once there are many.

use crate::status::Status;
use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};
use zerocopy::{FromBytes, IntoBytes};

/// The columns while threads fill them. Relaxed atomic stores are ordinary stores to the processor; they make it safe to
/// fill rows from all threads without a lock or a second copy.
pub(crate) struct Table<'c> {
    statuses: &'c Statuses,
    columns: Vec<Cells<'c>>,
    /// Words of an answer: its row and status, then what the columns take.
    words: usize,
}

enum Cells<'c> {
    /// So many numbers a row.
    Numbers(&'c [AtomicU64], usize),
    Counts(&'c [AtomicU32]),
}

/// The column with this many rows, or none if it is not wanted. Memory that it has is used again; rows hold anything.
fn sized<T: Copy>(column: &mut Vec<T>, rows: usize, wanted: bool, zero: T) {
    let rows = if wanted { rows } else { 0 };
    if column.capacity() < rows {
        // Fresh memory that is zero costs nothing until it is filled.
        *column = vec![zero; rows];
    } else {
        column.resize(rows, zero);
    }
}

impl<'c> Table<'c> {
    pub(crate) fn new(statuses: &'c Statuses) -> Self {
        Self { statuses, columns: Vec::new(), words: 1 }
    }

    fn rows(&self) -> usize {
        self.statuses.0.len()
    }

    /// Adds a column of vectors. Answers must give the wanted columns in the order in which they were added.
    pub(crate) fn add_vectors<const W: usize>(&mut self, column: &'c mut Vec<[f64; W]>, wanted: bool) {
        sized(column, self.rows(), wanted, [0.0; W]);
        self.add_numbers(column.as_flattened_mut(), W, wanted);
    }

    pub(crate) fn add_values(&mut self, column: &'c mut Vec<f64>, wanted: bool) {
        sized(column, self.rows(), wanted, 0.0);
        self.add_numbers(column, 1, wanted);
    }

    fn add_numbers(&mut self, numbers: &'c mut [f64], width: usize, wanted: bool) {
        if wanted {
            let cells = <[AtomicU64]>::mut_from_bytes(numbers.as_mut_bytes()).unwrap_or_default();
            self.columns.push(Cells::Numbers(cells, width));
            self.words += width;
        }
    }

    pub(crate) fn add_counts(&mut self, column: &'c mut Vec<u32>, wanted: bool) {
        sized(column, self.rows(), wanted, 0);
        if wanted {
            let cells = <[AtomicU32]>::mut_from_bytes(column.as_mut_bytes()).unwrap_or_default();
            self.columns.push(Cells::Counts(cells));
            self.words += 1;
        }
    }

    /// A writer for one thread.
    pub(crate) fn writer(&self) -> Writer<'_> {
        let shift = (self.rows() / RANGES + 1).next_power_of_two().trailing_zeros();
        let ranges = (self.rows() >> shift) + 1;
        let most_words = (COLLECTED / ranges / self.words).max(16) * self.words;
        Writer { table: self, shift, most_words, ranges: vec![Vec::new(); ranges] }
    }

    /// Writes answers to their rows, column by column.
    fn write(&self, answers: &[u64]) {
        let each = || answers.chunks_exact(self.words);
        for answer in each() {
            self.statuses.put(answer[0] as u32 as usize, Status::from_number((answer[0] >> 32) as u8));
        }
        let mut first = 1;
        for column in &self.columns {
            match column {
                Cells::Numbers(cells, width) => {
                    for answer in each() {
                        let row = answer[0] as u32 as usize * width;
                        for (cell, word) in cells[row..row + width].iter().zip(&answer[first..first + width])
                        {
                            cell.store(*word, Relaxed);
                        }
                    }
                    first += width;
                }
                Cells::Counts(cells) => {
                    for answer in each() {
                        cells[answer[0] as u32 as usize].store(answer[first] as u32, Relaxed);
                    }
                    first += 1;
                }
            }
        }
    }
}

/// Ranges of rows that a thread collects answers for, and words that it collects, in all: 32 MiB.
const RANGES: usize = 64;
const COLLECTED: usize = 1 << 22;

/// One thread's answers on their way to the columns; all have arrived when it is dropped.
pub(crate) struct Writer<'t> {
    table: &'t Table<'t>,
    shift: u32,
    most_words: usize,
    ranges: Vec<Vec<u64>>,
}

/// One answer in the making.
pub(crate) struct Answer<'w>(&'w mut Vec<u64>);

impl Answer<'_> {
    #[inline(always)]
    pub(crate) fn numbers<const W: usize>(&mut self, values: [f64; W]) {
        self.0.extend_from_slice(&values.map(f64::to_bits));
    }

    #[inline(always)]
    pub(crate) fn count(&mut self, count: u32) {
        self.0.push(u64::from(count));
    }
}

impl Writer<'_> {
    /// Takes one row's answer: `fill` gives the wanted columns in order.
    #[inline(always)]
    pub(crate) fn put(&mut self, row: u32, status: Status, fill: impl FnOnce(&mut Answer<'_>)) {
        let range = &mut self.ranges[(row >> self.shift) as usize];
        range.reserve(self.table.words);
        range.push(u64::from(row) | (u64::from(status as u8) << 32));
        fill(&mut Answer(range));
        if range.len() >= self.most_words {
            self.table.write(range);
            range.clear();
        }
    }
}

impl Drop for Writer<'_> {
    fn drop(&mut self) {
        for range in &self.ranges {
            self.table.write(range);
        }
    }
}

/// Statuses, *invalid* until filled.
pub(crate) struct Statuses(Vec<AtomicU8>);

impl Statuses {
    pub(crate) fn new(rows: usize) -> Self {
        Self((0..rows).map(|_| AtomicU8::new(Status::Invalid as u8)).collect())
    }

    fn put(&self, row: usize, status: Status) {
        self.0[row].store(status as u8, Relaxed);
    }

    pub(crate) fn finish(self, column: &mut Vec<Status>) {
        column.clear();
        column.extend(self.0.into_iter().map(|cell| Status::from_number(cell.into_inner())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_gets_its_own_answer_in_every_column() {
        for rows in [1_u32, 100, 70_000] {
            let statuses = Statuses::new(rows as usize);
            let (mut points, mut values, mut counts, mut unwanted) =
                (vec![], vec![7.0; 3], vec![], vec![1.0]);
            let mut table = Table::new(&statuses);
            table.add_vectors(&mut points, true);
            table.add_values(&mut unwanted, false);
            table.add_counts(&mut counts, true);
            table.add_values(&mut values, true);
            {
                let mut writers = [table.writer(), table.writer()];
                for i in 0..rows {
                    // Another order than that of the rows.
                    let row = (u64::from(i) * 48_271 % u64::from(rows)) as u32;
                    writers[(i % 2) as usize].put(row, Status::Ok, |answer| {
                        answer.numbers([f64::from(row), -f64::from(row)]);
                        answer.count(row + 1);
                        answer.numbers([0.5 * f64::from(row)]);
                    });
                }
            }
            let mut status = Vec::new();
            statuses.finish(&mut status);
            assert!(unwanted.is_empty() && status.iter().all(|status| status.is_ok()));
            for row in 0..rows {
                let i = row as usize;
                assert_eq!(points[i], [f64::from(row), -f64::from(row)]);
                assert_eq!((counts[i], values[i]), (row + 1, 0.5 * f64::from(row)));
            }
        }
    }
}
