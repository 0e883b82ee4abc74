//! Levin's surface and Levin's projection: one claim a file, compiled together.

#[path = "../common/mod.rs"]
mod common;

mod bits;
mod convergence;
mod gradient;
mod orthogonality;
mod statuses;
mod step_one;
