//! The engine: weighted sums over the samples around a block of positions. All else is closed algebra on them.

mod block;
#[cfg(test)]
pub(crate) mod oracle;
mod sums;
#[cfg(test)]
mod tests;

pub(crate) use crate::grid::BLOCK;
pub(crate) use block::{Candidates, Position};
pub(crate) use sums::{Contraction, Frame, FrameSums, Needs, first_pass, second_pass};
