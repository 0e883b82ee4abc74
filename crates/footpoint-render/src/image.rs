//! The picture itself: bytes of sRGB with alpha.

use crate::colour::{Background, Colour, from_byte, to_byte};

/// Pixels in rows from the upper left corner, red green blue alpha; the colour is not multiplied by alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
}

impl Image {
    /// Nothing but background.
    pub fn new(width: usize, height: usize, background: Background) -> Self {
        let pixel = match background {
            Background::Colour([r, g, b]) => [r, g, b, 255],
            Background::Transparent => [0; 4],
        };
        Self { width, height, pixels: vec![pixel; width * height] }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// Puts a colour of linear light over a pixel, covering this share of it.
    pub(crate) fn paint(&mut self, x: usize, y: usize, colour: Colour, cover: f32) {
        if cover <= 0.0 {
            return;
        }
        let pixel = &mut self.pixels[y * self.width + x];
        let below = f32::from(pixel[3]) / 255.0;
        let alpha = cover + below * (1.0 - cover);
        let old = [pixel[0], pixel[1], pixel[2]].map(from_byte);
        for k in 0..3 {
            pixel[k] = to_byte((colour[k] * cover + old[k] * below * (1.0 - cover)) / alpha);
        }
        pixel[3] = (255.0 * alpha).round() as u8;
    }

    /// Puts another picture's rows, from `first` on, in place of the same rows of this one, from the column `left` on.
    pub(crate) fn put(&mut self, other: &Self, left: usize, first: usize) {
        let width = other.width.min(self.width.saturating_sub(left));
        for y in first..other.height.min(self.height) {
            let (to, from) = (y * self.width + left, y * other.width);
            self.pixels[to..to + width].copy_from_slice(&other.pixels[from..from + width]);
        }
    }
}
