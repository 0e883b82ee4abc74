//! What pictures promise: one claim a file, compiled together.

mod background;
mod camera;
mod canvas;
mod golden;
mod light;
mod numbers;
mod planes;
mod shapes;
mod upright;
mod views;
