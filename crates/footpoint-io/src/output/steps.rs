//! How far writing has come, for whoever watches it and may end it.

use std::cell::Cell;
use std::io;
use std::ops::ControlFlow;

use crate::Watch;

/// Rows between two words.
const APART: usize = 1 << 16;

/// Tells how many rows have been written.
pub(crate) struct Steps<'w> {
    watch: Option<&'w dyn Watch>,
    rows: usize,
    /// The row at which to speak again.
    next: Cell<usize>,
    is_stopped: Cell<bool>,
}

impl<'w> Steps<'w> {
    pub(super) fn new(watch: Option<&'w dyn Watch>, rows: usize) -> Self {
        Self { watch, rows, next: Cell::new(APART), is_stopped: Cell::new(false) }
    }

    /// So many rows are written; fails if the work is to end.
    pub(crate) fn at(&self, row: usize) -> io::Result<()> {
        let Some(watch) = self.watch.filter(|_| row >= self.next.get()) else { return Ok(()) };
        self.next.set(row + APART);
        match watch.at(row.min(self.rows) as u64, self.rows as u64) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => {
                self.is_stopped.set(true);
                Err(io::Error::other("stopped"))
            }
        }
    }

    /// The same where a format writes column after column: so many rows of column `index` of `columns`.
    pub(crate) fn at_column(&self, row: usize, index: usize, columns: usize) -> io::Result<()> {
        self.at((index * self.rows + row) / columns.max(1))
    }

    /// Whether it was ended.
    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }
}
