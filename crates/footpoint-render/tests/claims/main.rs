//! What pictures promise: one claim a file, compiled together.

mod background;
mod camera;
mod golden;
mod light;
mod numbers;
mod planes;
mod shapes;
mod views;
