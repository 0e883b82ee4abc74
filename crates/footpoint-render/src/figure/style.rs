//! The one style of all figures: colours, line widths, sizes. Lengths are in pixels of a figure as wide as a column.

/// Width of every figure.
pub(super) const WIDTH: f64 = 360.0;
/// Size of the letters.
pub(super) const LETTERS: f64 = 14.0;
/// Size of remarks.
pub(super) const REMARKS: f64 = 11.5;
/// Serifs, as in formulas; the first that the reader has.
pub(super) const FONT: &str = "'STIX Two Text','Times New Roman',Times,'Liberation Serif',serif";
/// Radius of a sample, and of a point that the text speaks of.
pub(super) const SAMPLE: f64 = 1.7;
pub(super) const POINT: f64 = 3.0;
/// Length and half width of an arrow's head.
pub(super) const HEAD: (f64, f64) = (8.0, 2.9);
/// Side of the mark of a right angle.
pub(super) const CORNER: f64 = 7.0;

/// Colours that differ in lightness too, for prints without colour and eyes that do not tell all colours apart.
pub(super) mod colour {
    pub(crate) const INK: &str = "#1b1b1b";
    pub(crate) const SAMPLES: &str = "#9a9a9a";
    pub(crate) const SUPPORT: &str = "#f1f1ec";
    /// What belongs to n and a.
    pub(crate) const FRAME: &str = "#0067a5";
    /// What belongs to ∇f.
    pub(crate) const GRADIENT: &str = "#d1491b";
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) colour: &'static str,
    pub(super) width: f64,
    /// Lengths of dashes and gaps; empty is a solid line.
    pub(super) dashes: &'static str,
}

/// The contour f = 0.
pub(super) const CONTOUR: Pen = Pen { colour: colour::INK, width: 1.7, dashes: "" };
/// The line through a orthogonal to n.
pub(super) const TANGENT: Pen = Pen { colour: colour::FRAME, width: 1.0, dashes: "5 3" };
/// The frame normal.
pub(super) const NORMAL: Pen = Pen { colour: colour::FRAME, width: 1.6, dashes: "" };
/// The gradient.
pub(super) const GRADIENT: Pen = Pen { colour: colour::GRADIENT, width: 1.6, dashes: "" };
/// A step of a projection, and distances.
pub(super) const STEP: Pen = Pen { colour: colour::INK, width: 1.1, dashes: "" };
/// What only guides the eye.
pub(super) const GUIDE: Pen = Pen { colour: colour::INK, width: 0.8, dashes: "1.5 2.5" };
