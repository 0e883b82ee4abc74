//! The camera: from a place in the picture to a ray.

use crate::vector::{Vector, add_scaled, cross, dot, length, scale, sub, unit};
use footpoint::Ray;
use serde::{Deserialize, Serialize};

/// How points come to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Projection {
    /// All rays through the eye.
    Perspective {
        /// Angle of view from the lower to the upper edge, in degrees, between 0 and 180.
        fov_degrees: f64,
    },
    /// All rays parallel.
    Orthographic {
        /// What fits between the lower and the upper edge, in the unit of the cloud.
        height: f64,
    },
}

/// Where to look from and to. What is behind the eye is not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The eye.
    pub from: [f64; 3],
    /// What is in the middle of the picture.
    pub at: [f64; 3],
    /// What is up in the picture; need not be a unit vector, nor across the line of sight.
    pub up: [f64; 3],
    /// Perspective or orthographic.
    pub projection: Projection,
}

/// Why a camera sees nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// No line of sight.
    #[error("the camera looks from {from:?} at {at:?}: these must be finite and not the same")]
    NoSight {
        /// The eye.
        from: [f64; 3],
        /// What is looked at.
        at: [f64; 3],
    },
    /// No direction is up.
    #[error("up is {0:?}: it must be finite and not zero")]
    NoUp([f64; 3]),
    /// An angle of view that is none.
    #[error("the angle of view is {0} degrees: it must be above 0 and below 180")]
    Fov(f64),
    /// A height that is none.
    #[error("the picture is {0} high: its height in the unit of the file must be finite and above 0")]
    Height(f64),
}

/// The camera's own axes, unit vectors: to the right, up, and back towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axes {
    pub(crate) right: Vector,
    pub(crate) up: Vector,
    pub(crate) back: Vector,
}

impl Axes {
    /// `back` and `up` need not be unit vectors; where they are parallel some other direction is up.
    pub(crate) fn new(back: Vector, up: Vector) -> Self {
        let back = unit(back);
        let across = |up: Vector| cross(up, back);
        let given = across(unit(up));
        let right = if length(given) > 1e-6 {
            given
        } else {
            across(if back[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] })
        };
        let right = unit(right);
        Self { right, up: cross(back, right), back }
    }

    /// Coordinates along the axes.
    pub(crate) fn of(&self, v: Vector) -> Vector {
        [dot(v, self.right), dot(v, self.up), dot(v, self.back)]
    }

    /// The vector with these coordinates.
    pub(crate) fn vector(&self, [x, y, z]: Vector) -> Vector {
        add_scaled(add_scaled(scale(self.right, x), self.up, y), self.back, z)
    }
}

impl Camera {
    /// Fails where the camera sees nothing.
    pub fn check(&self) -> Result<(), CameraError> {
        let sight = length(sub(self.at, self.from));
        if !(sight.is_finite() && sight > 0.0) {
            return Err(CameraError::NoSight { from: self.from, at: self.at });
        }
        if !(length(self.up).is_finite() && length(self.up) > 0.0) {
            return Err(CameraError::NoUp(self.up));
        }
        match self.projection {
            Projection::Perspective { fov_degrees: fov } if !(fov > 0.0 && fov < 180.0) => {
                Err(CameraError::Fov(fov))
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                Err(CameraError::Height(height))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn axes(&self) -> Axes {
        Axes::new(sub(self.from, self.at), self.up)
    }

    /// The rays of a picture of so many pixels.
    pub fn view(&self, width: usize, height: usize) -> Rays {
        let axes = self.axes();
        let (span, perspective) = match self.projection {
            Projection::Perspective { fov_degrees } => (2.0 * (0.5 * fov_degrees).to_radians().tan(), true),
            Projection::Orthographic { height } => (height, false),
        };
        Rays {
            from: self.from,
            axes,
            perspective,
            pixel: span / height as f64,
            middle: [0.5 * width as f64, 0.5 * height as f64],
        }
    }
}

/// The rays of a picture. Their t is the depth: the distance from the eye's plane along the line of sight.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    from: Vector,
    axes: Axes,
    perspective: bool,
    /// Side of a pixel, at depth 1 for perspective.
    pixel: f64,
    middle: [f64; 2],
}

impl Rays {
    /// The ray at a place in pixels, from the upper left corner to the right and down: pixel (i, j) is centred at (i + ½, j + ½).
    pub fn ray(&self, x: f64, y: f64) -> Ray<3> {
        let (right, up) = (self.pixel * (x - self.middle[0]), self.pixel * (self.middle[1] - y));
        let ahead = scale(self.axes.back, -1.0);
        if self.perspective {
            Ray { origin: self.from, direction: self.axes.vector([right, up, -1.0]) }
        } else {
            Ray { origin: add_scaled(self.from, self.axes.vector([right, up, 0.0]), 1.0), direction: ahead }
        }
    }

    pub(crate) fn axes(&self) -> &Axes {
        &self.axes
    }
}
