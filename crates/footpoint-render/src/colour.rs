//! Colours: linear light and sRGB, and maps from numbers to colours.

use colorgrad::{Gradient, preset};

/// Linear light, red green blue, 0 to 1.
pub(crate) type Colour = [f32; 3];

/// What has no number: none of the maps has it.
pub(crate) const NO_NUMBER: Colour = [0.62, 0.02, 0.55];

/// A share of a colour from sRGB to linear light, both from 0 to 1.
pub fn to_linear(v: f32) -> f32 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Linear light to sRGB.
pub(crate) fn to_srgb(v: f32) -> f32 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light to a byte of sRGB.
pub(crate) fn to_byte(v: f32) -> u8 {
    (255.0 * to_srgb(v.clamp(0.0, 1.0))).round() as u8
}

/// A byte of sRGB to linear light.
pub(crate) fn from_byte(v: u8) -> f32 {
    to_linear(f32::from(v) / 255.0)
}

/// What lies behind the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Background {
    /// One colour, red green blue in sRGB.
    Colour([u8; 3]),
    /// Nothing: the picture has an alpha channel that says how much of each pixel is surface.
    Transparent,
}

/// A word that is no background.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must be white, black, transparent, or a colour such as #1f2933")]
pub struct BackgroundError;

impl std::str::FromStr for Background {
    type Err = BackgroundError;

    /// `white`, `black`, `transparent` or `#rrggbb`.
    fn from_str(text: &str) -> Result<Self, BackgroundError> {
        let colour = |digits: &str| {
            let byte = |i: usize| u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok();
            (digits.len() == 6).then(|| Some([byte(0)?, byte(1)?, byte(2)?])).flatten()
        };
        match text {
            "transparent" => Ok(Self::Transparent),
            "white" => Ok(Self::Colour([255; 3])),
            "black" => Ok(Self::Colour([0; 3])),
            _ => text.strip_prefix('#').and_then(colour).map(Self::Colour).ok_or(BackgroundError),
        }
    }
}

impl Default for Background {
    /// White.
    fn default() -> Self {
        Self::Colour([255; 3])
    }
}

impl Background {
    /// A colour that is legible upon it, in linear light.
    pub(crate) fn ink(self) -> Colour {
        let bright = match self {
            Self::Colour(rgb) => {
                let [r, g, b] = rgb.map(from_byte);
                0.2126 * r + 0.7152 * g + 0.0722 * b > 0.2
            }
            Self::Transparent => true,
        };
        if bright { [0.015; 3] } else { [0.85; 3] }
    }
}

/// Which colours stand for numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Map {
    /// From dark to bright (viridis), for what has no middle.
    Sequential,
    /// Blue, pale, red, for what has a sign.
    Diverging,
    /// From dark red to nearly white, for what is nearly 1 where all is well.
    Agreement,
}

/// So many colours stand for a map: more than a byte tells apart.
const STEPS: usize = 1024;

/// A map made ready: a table of linear colours.
#[derive(Clone, Debug)]
pub struct Colours {
    table: Vec<Colour>,
    range: [f64; 2],
}

impl Colours {
    /// The colours of the numbers from `range[0]` to `range[1]`; those beyond have the colour of the end.
    pub fn new(map: Map, range: [f64; 2]) -> Self {
        let table = |gradient: &dyn Fn(f32) -> colorgrad::Color| {
            (0..STEPS)
                .map(|i| {
                    let colour = gradient(i as f32 / (STEPS - 1) as f32);
                    [colour.r, colour.g, colour.b].map(|c| to_linear(c.clamp(0.0, 1.0)))
                })
                .collect()
        };
        let table = match map {
            Map::Sequential => table(&|t| preset::viridis().at(t)),
            Map::Diverging => table(&|t| preset::rd_bu().at(1.0 - t)),
            Map::Agreement => table(&|t| preset::yl_or_rd().at(1.0 - t)),
        };
        Self { table, range }
    }

    /// The colour of a number.
    pub(crate) fn of(&self, value: f64) -> Colour {
        let [low, high] = self.range;
        let share = (value - low) / (high - low);
        if value.is_nan() {
            return NO_NUMBER;
        }
        // A range without width has one colour: 0/0 counts as its middle.
        let share = if share.is_nan() { 0.5 } else { share.clamp(0.0, 1.0) };
        self.table[(share * (STEPS - 1) as f64).round() as usize]
    }

    /// The colour of a number as bytes of sRGB, red green blue; purple, which no map has, for NaN.
    pub fn bytes(&self, value: f64) -> [u8; 3] {
        self.of(value).map(to_byte)
    }

    pub(crate) fn range(&self) -> [f64; 2] {
        self.range
    }
}
