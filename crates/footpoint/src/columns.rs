//! Output columns that several threads fill in any order, each row once.

use crate::status::Status;
use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};

/// Rows of `W` numbers. Relaxed atomic stores are ordinary stores to the processor; they make it safe to fill rows
/// from all threads without a lock or a second copy.
pub(crate) struct Numbers<const W: usize>(Vec<[AtomicU64; W]>);

impl<const W: usize> Numbers<W> {
    /// `rows` rows of NaN; none if the column is not wanted.
    pub(crate) fn new(rows: usize, wanted: bool) -> Self {
        let nan = || std::array::from_fn(|_| AtomicU64::new(f64::NAN.to_bits()));
        Self((0..if wanted { rows } else { 0 }).map(|_| nan()).collect())
    }

    /// Fills a row; does nothing where the column is not wanted.
    pub(crate) fn put(&self, row: usize, values: [f64; W]) {
        if let Some(cells) = self.0.get(row) {
            for k in 0..W {
                cells[k].store(values[k].to_bits(), Relaxed);
            }
        }
    }

    pub(crate) fn rows(self) -> Vec<[f64; W]> {
        self.0.into_iter().map(|row| row.map(|cell| f64::from_bits(cell.into_inner()))).collect()
    }
}

impl Numbers<1> {
    pub(crate) fn values(self) -> Vec<f64> {
        self.0.into_iter().map(|[cell]| f64::from_bits(cell.into_inner())).collect()
    }
}

/// Counts, zero until filled.
pub(crate) struct Counts(Vec<AtomicU32>);

impl Counts {
    pub(crate) fn new(rows: usize, wanted: bool) -> Self {
        Self((0..if wanted { rows } else { 0 }).map(|_| AtomicU32::new(0)).collect())
    }

    pub(crate) fn put(&self, row: usize, count: u32) {
        if let Some(cell) = self.0.get(row) {
            cell.store(count, Relaxed);
        }
    }

    pub(crate) fn values(self) -> Vec<u32> {
        self.0.into_iter().map(AtomicU32::into_inner).collect()
    }
}

/// Statuses, *invalid* until filled.
pub(crate) struct Statuses(Vec<AtomicU8>);

impl Statuses {
    pub(crate) fn new(rows: usize) -> Self {
        Self((0..rows).map(|_| AtomicU8::new(Status::Invalid as u8)).collect())
    }

    pub(crate) fn put(&self, row: usize, status: Status) {
        self.0[row].store(status as u8, Relaxed);
    }

    pub(crate) fn values(self) -> Vec<Status> {
        self.0.into_iter().map(|cell| Status::from_number(cell.into_inner())).collect()
    }
}
