//! The engine: weighted sums over the samples around a block of positions. All else is closed algebra on them.

mod candidates;
mod heights;
mod levin;
#[cfg(test)]
pub(crate) mod oracle;
mod scatter;
mod sums;

pub(crate) use candidates::{Candidates, Culled, Extent};
pub(crate) use heights::{
    HeightSums, Heights, height_sums, height_weights, heights_second_pass, heights_sensitivity, heights_share,
};
pub(crate) use levin::{LevinSums, levin_second_pass, levin_sensitivity, levin_share, levin_sums};
pub(crate) use scatter::{Regression, Scatter, scatter};
pub(crate) use sums::{
    Frame, FrameSums, General, List, Mode, Moments, Moved, Place, Plain, Position, Resting, Statistics,
    Weighted, first_pass, second_pass, sensitivity, sensitivity_to, statistics,
};
