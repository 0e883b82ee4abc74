//! How to read: which part of a file, and who is told how far it has come.

use std::ops::ControlFlow;

/// How to read a file.
#[derive(Clone, Copy, Default)]
pub struct ReadOptions<'w> {
    /// Only the points inside this box, its faces included. COPC files are read no further than that.
    pub within: Option<Bounds>,
    /// Is told how far reading has come, and may end it.
    pub watch: Option<&'w dyn Watch>,
}

/// A box with sides along the axes, in the unit of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub low: [f64; 3],
    /// The opposite corner.
    pub high: [f64; 3],
}

/// Is told how far reading or writing has come.
pub trait Watch: Sync {
    /// So many of `all` are done: bytes or points; of a file that is written as many as there are so far. [`ControlFlow::Break`] ends the work.
    fn at(&self, done: u64, all: u64) -> ControlFlow<()>;
}

impl Bounds {
    /// Whether a point lies inside; NaN does not.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|k| self.low[k] <= point[k] && point[k] <= self.high[k])
    }
}
