//! Pictures of point set surfaces: ray tracing to PNG, and figures in the plane to SVG.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod camera;
mod canvas;
mod colour;
mod encode;
pub mod figure;
mod font;
mod image;
mod light;
mod occlusion;
mod picture;
mod scale_bar;
mod shading;
mod triptych;
mod upright;
mod vector;
mod view;

pub use camera::{Camera, CameraError, Projection, Rays};
pub use canvas::{Aim, Canvas};
pub use colour::{Background, BackgroundError, Colours, Map, to_linear as linear};
pub use encode::{write_depth, write_image, write_mask, write_normals};
pub use image::Image;
pub use occlusion::Occlusion;
pub use picture::{Keep, Picture, Plan, Planes, RenderError, render, view_size};
pub use shading::{Relief, Shading};
pub use triptych::{Triptych, triptych};
pub use upright::{Origin, Upright, Why};
pub use view::{Extent, View, Wish};
