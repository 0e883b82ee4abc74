//! Light that shows relief: a key light from the upper left, a weaker fill from the right, one at the eye.

use crate::camera::Axes;
use crate::colour::Colour;
use crate::vector::{Vector, add_scaled, dot, unit};

/// Reflected without any map: a warm light grey.
pub(crate) const PLASTER: Colour = [0.74, 0.72, 0.68];

/// Directions along the camera's axes, right, up and back.
const KEY: Vector = [-0.62, 0.66, 0.42];
const FILL: Vector = [0.9, -0.25, 0.25];
/// Shares of the lights; those that are met full on by one normal together give about 1.
const KEY_LIGHT: f64 = 0.80;
const FILL_LIGHT: f64 = 0.32;
const HEAD_LIGHT: f64 = 0.08;
const SKY_LIGHT: f64 = 0.12;
/// Highlights of the key light.
const GLOSS: f64 = 0.10;
const SHARPNESS: i32 = 24;
/// Share of the light that shows relief where colours stand for numbers: more of it would change them too much to be read.
const RELIEF_OVER_COLOURS: f64 = 0.45;

/// The lights of one camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lights {
    key: Vector,
    fill: Vector,
    up: Vector,
}

impl Lights {
    pub(crate) fn new(axes: &Axes) -> Self {
        Self { key: unit(axes.vector(KEY)), fill: unit(axes.vector(FILL)), up: axes.up }
    }

    /// Light that a surface of this normal throws to the eye: diffuse, and highlight. `normal` faces the eye, `to_eye` is a
    /// unit vector; `open` is the share of the sky that nothing hides.
    fn reflected(&self, normal: Vector, to_eye: Vector, open: f64) -> (f64, f64) {
        let key = dot(normal, self.key).max(0.0);
        let fill = dot(normal, self.fill).max(0.0);
        let head = dot(normal, to_eye).max(0.0);
        let sky = 0.5 + 0.5 * dot(normal, self.up);
        let ambient = open * (SKY_LIGHT * sky + FILL_LIGHT * fill + HEAD_LIGHT * head);
        let half = unit(add_scaled(self.key, to_eye, 1.0));
        let gloss = if key > 0.0 { dot(normal, half).max(0.0).powi(SHARPNESS) } else { 0.0 };
        // Hollows get less of the key light too, though not as little.
        let key = (0.4 + 0.6 * open) * KEY_LIGHT * key;
        (key + ambient, open * GLOSS * gloss)
    }

    /// The picture of a matt surface of this colour.
    pub(crate) fn on_surface(&self, albedo: Colour, normal: Vector, to_eye: Vector, open: f64) -> Colour {
        let (diffuse, gloss) = self.reflected(normal, to_eye, open);
        albedo.map(|c| (f64::from(c) * diffuse + gloss).min(1.0) as f32)
    }

    /// A colour that stands for a number, under some light.
    pub(crate) fn on_number(&self, colour: Colour, normal: Vector, to_eye: Vector, open: f64) -> Colour {
        let (diffuse, _) = self.reflected(normal, to_eye, open);
        let light = 1.0 - RELIEF_OVER_COLOURS + RELIEF_OVER_COLOURS * diffuse.min(1.0);
        colour.map(|c| (f64::from(c) * light) as f32)
    }
}
