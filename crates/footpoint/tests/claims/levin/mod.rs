//! Levin's surface and Levin's projection: one claim a file.

mod bits;
mod convergence;
mod gradient;
mod orthogonality;
mod statuses;
mod step_one;
