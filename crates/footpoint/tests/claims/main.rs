//! What the library promises: one claim a file, compiled together, because each crate of tests compiles the library's generic code anew.

#[path = "../common/mod.rs"]
mod common;

mod acceptance;
mod averages;
mod contour;
mod convergence;
mod degrees;
mod errors;
mod foot_points;
mod gradient;
mod levin;
mod nearest;
mod options;
mod orient;
mod rays;
mod same_bits;
mod same_bits_large;
mod same_bits_moved;
mod sensitivity;
mod statuses;
mod surfaces;
