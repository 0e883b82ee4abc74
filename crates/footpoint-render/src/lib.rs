//! Pictures of point set surfaces: ray tracing to PNG, and figures in the plane to SVG.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

pub mod figure;
