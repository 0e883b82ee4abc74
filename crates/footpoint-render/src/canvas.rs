//! The size of a picture: as given, or in the shape of what it shows.

use crate::camera::{Camera, CameraError, Projection};
use crate::scale_bar;
use crate::shading::Shading;
use crate::upright::Upright;
use crate::vector::{Vector, add_scaled, length, sub};
use crate::view::{Extent, Sight, Wish};

/// How large a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Canvas {
    /// Pixels in a row, and rows.
    Given([usize; 2]),
    /// About so many pixels in the shape of what is seen, at most 2.5 times as wide as high or as high as
    /// wide; four wide to three high where the eye's place is given.
    Shaped(usize),
}

/// A camera with the picture that it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// From where.
    pub camera: Camera,
    /// Pixels in a row, and rows, those of the scale bar included.
    pub size: [usize; 2],
    /// What is up in the cloud.
    pub upright: Upright,
}

/// Width over height, or height over width, of a shaped canvas is at most this.
const LONGEST: f64 = 2.5;
/// Width over height where nothing says another.
const USUAL: f64 = 4.0 / 3.0;
/// In supports, how far a surface reaches beyond its samples as a rule.
const BEYOND: f64 = 0.5;
/// The shape depends on the distance, which depends on the shape: each round gets some tenfold nearer.
const ROUNDS: usize = 4;

impl Extent {
    /// The camera that was wished for, at the distance or height at which the cloud fills the canvas.
    pub fn aim(&self, wish: &Wish, canvas: Canvas, shading: &Shading<'_>) -> Result<Aim, CameraError> {
        let sight = self.sight(wish)?;
        let upright = sight.upright;
        let pixels = match canvas {
            Canvas::Given(size) => {
                let [width, height] = crate::picture::view_size(size, shading).map(|side| side.max(1));
                let camera = self.placed(wish, &sight, width as f64 / height as f64)?;
                return Ok(Aim { camera, size, upright });
            }
            Canvas::Shaped(pixels) => pixels as f64,
        };
        let wider = self.grown();
        let (wish, ratio) = if wish.from.is_some() { (*wish, USUAL) } else { wider.shaped(wish, &sight)? };
        let side = |length: f64| (length.round() as usize).max(1);
        let width = side((pixels * ratio).sqrt());
        let height = side(pixels / width as f64);
        let camera = wider.placed(&wish, &sight, width as f64 / height as f64)?;
        let rows = if shading.has_numbers() { scale_bar::rows_around([width, height]) } else { height };
        Ok(Aim { camera, size: [width, rows], upright })
    }

    /// As far as the surface may reach beyond the samples at its rim: a shaped canvas has no room to spare.
    fn grown(&self) -> Self {
        let outward = |p: &Vector| {
            let away = sub(*p, self.middle);
            add_scaled(*p, away, BEYOND * self.support / length(away).max(self.support))
        };
        let mut grown = self.clone();
        grown.points = self.points.iter().map(outward).collect();
        grown
    }

    /// The shape of what is seen, and the wish with its middle.
    fn shaped(&self, wish: &Wish, sight: &Sight) -> Result<(Wish, f64), CameraError> {
        let (mut shaped, mut ratio) = (*wish, USUAL);
        for _ in 0..ROUNDS {
            let camera = self.placed(&shaped, sight, ratio)?;
            let [x, y] = self.reach(&camera);
            let half = if wish.at.is_some() {
                [x, y].map(|[low, high]| high.max(-low))
            } else {
                let axes = camera.axes();
                let [right, up] = [x, y].map(|[low, high]| 0.5 * (low + high));
                shaped.at = Some(add_scaled(add_scaled(camera.at, axes.right, right), axes.up, up));
                [x, y].map(|[low, high]| 0.5 * (high - low))
            };
            let found = half[0] / half[1];
            ratio = if found.is_nan() { USUAL } else { found.clamp(1.0 / LONGEST, LONGEST) };
        }
        Ok((shaped, ratio))
    }

    /// How far the cloud reaches to the left and right, down and up from the middle of the picture: lengths
    /// where the camera looks at.
    fn reach(&self, camera: &Camera) -> [[f64; 2]; 2] {
        let axes = camera.axes();
        let [_, _, far] = axes.of(sub(camera.from, camera.at));
        let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in &self.points {
            let [x, y, z] = axes.of(sub(*p, camera.at));
            let scale = match camera.projection {
                Projection::Perspective { .. } => far / (far - z).max(1e-9 * far),
                Projection::Orthographic { .. } => 1.0,
            };
            for (side, along) in reach.iter_mut().zip([x, y]) {
                *side = [side[0].min(scale * along), side[1].max(scale * along)];
            }
        }
        reach
    }
}
