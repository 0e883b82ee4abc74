//! Output columns that several threads fill in any order, each row once.

use crate::lane::prefetch;
use crate::status::Status;
use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};
use zerocopy::{FromBytes, IntoBytes};

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

/// Rows of `W` numbers. Relaxed atomic stores are ordinary stores to the processor; they make it safe to fill rows
/// from all threads without a lock or a second copy.
pub(crate) struct Numbers<'c, const W: usize>(&'c [[AtomicU64; W]]);

impl<'c, const W: usize> Numbers<'c, W> {
    pub(crate) fn rows(column: &'c mut Vec<[f64; W]>, rows: usize, wanted: bool) -> Self {
        sized(column, rows, wanted, [0.0; W]);
        Self(<[[AtomicU64; W]]>::mut_from_bytes(column.as_mut_bytes()).unwrap_or_default())
    }

    /// Rows of matrices: D rows of numbers each.
    pub(crate) fn matrices<const R: usize>(
        column: &'c mut Vec<[[f64; W]; R]>,
        rows: usize,
        wanted: bool,
    ) -> Self {
        sized(column, rows, wanted, [[0.0; W]; R]);
        Self(<[[AtomicU64; W]]>::mut_from_bytes(column.as_mut_bytes()).unwrap_or_default())
    }

    pub(crate) fn is_wanted(&self) -> bool {
        !self.0.is_empty()
    }

    /// The row will be filled soon.
    #[inline(always)]
    pub(crate) fn expect(&self, row: usize) {
        if let Some(cell) = self.0.get(row) {
            prefetch(cell);
        }
    }

    /// Fills a row; does nothing where the column is not wanted.
    #[inline(always)]
    pub(crate) fn put(&self, row: usize, values: [f64; W]) {
        if let Some(cells) = self.0.get(row) {
            for k in 0..W {
                cells[k].store(values[k].to_bits(), Relaxed);
            }
        }
    }
}

impl<const W: usize> Numbers<'_, W> {
    /// Fills a row of matrices.
    #[inline(always)]
    pub(crate) fn put_matrix<const R: usize>(&self, row: usize, matrix: [[f64; W]; R]) {
        for (i, values) in matrix.into_iter().enumerate() {
            self.put(row * R + i, values);
        }
    }
}

impl<'c> Numbers<'c, 1> {
    pub(crate) fn values(column: &'c mut Vec<f64>, rows: usize, wanted: bool) -> Self {
        sized(column, rows, wanted, 0.0);
        Self(<[[AtomicU64; 1]]>::mut_from_bytes(column.as_mut_bytes()).unwrap_or_default())
    }
}

/// Counts.
pub(crate) struct Counts<'c>(&'c [AtomicU32]);

impl<'c> Counts<'c> {
    pub(crate) fn values(column: &'c mut Vec<u32>, rows: usize, wanted: bool) -> Self {
        sized(column, rows, wanted, 0);
        Self(<[AtomicU32]>::mut_from_bytes(column.as_mut_bytes()).unwrap_or_default())
    }

    #[inline(always)]
    pub(crate) fn expect(&self, row: usize) {
        if let Some(cell) = self.0.get(row) {
            prefetch(cell);
        }
    }

    #[inline(always)]
    pub(crate) fn put(&self, row: usize, count: u32) {
        if let Some(cell) = self.0.get(row) {
            cell.store(count, Relaxed);
        }
    }
}

/// Statuses, *invalid* until filled.
pub(crate) struct Statuses(Vec<AtomicU8>);

impl Statuses {
    pub(crate) fn new(rows: usize) -> Self {
        Self((0..rows).map(|_| AtomicU8::new(Status::Invalid as u8)).collect())
    }

    #[inline(always)]
    pub(crate) fn expect(&self, row: usize) {
        if let Some(cell) = self.0.get(row) {
            prefetch(cell);
        }
    }

    #[inline(always)]
    pub(crate) fn put(&self, row: usize, status: Status) {
        self.0[row].store(status as u8, Relaxed);
    }

    pub(crate) fn finish(self, column: &mut Vec<Status>) {
        column.clear();
        column.extend(self.0.into_iter().map(|cell| Status::from_number(cell.into_inner())));
    }
}
