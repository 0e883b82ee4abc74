//! Contours: the curve that samples in the plane describe, as polylines.

mod cells;
mod chains;
mod crossings;
mod judge;

use crate::run::{Cancelled, Run};
use crate::surface::{Running, Surface};
use chains::Chains;
use crossings::Net;

/// How to contour: width of the cells, how near to f = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Contour {
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    cell: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    tolerance: f64,
}

impl Default for Contour {
    fn default() -> Self {
        Self { cell: 0.125, tolerance: 1e-6 }
    }
}

/// Narrowest and widest cells, in supports.
const CELLS: (f64, f64) = (1e-3, 0.5);

impl Contour {
    /// Cells an eighth of a support wide at most, vertices to 1e-6 h.
    pub fn new() -> Self {
        Self::default()
    }

    /// Cells at most this share of the supports wide, 0.001 to 0.5; what lies outside of that is taken there, NaN as the default.
    /// A polyline has a vertex wherever it crosses a side of a cell, and strays from a curve of curvature κ by about
    /// κ (share · h)²/8. Evaluations grow with one over the square of the share.
    pub fn with_cell(mut self, share: f64) -> Self {
        self.cell = share;
        self
    }

    fn share(&self) -> f64 {
        if self.cell.is_nan() { Self::default().cell } else { self.cell.clamp(CELLS.0, CELLS.1) }
    }

    /// A vertex is a point where |f| is at most this many local supports. Reaches 1e-12; NaN counts as 0.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = if tolerance.is_nan() { 0.0 } else { tolerance };
        self
    }
}

/// A connected piece of a curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// Vertices, at least two, in order along the curve. A closed one does not repeat its first.
    pub points: Vec<[f64; 2]>,
    /// ∇f/|∇f| at the vertices, with signs that agree along the curve; the first has that of every evaluation.
    pub surface_normal: Vec<[f64; 2]>,
    /// Whether the last vertex is joined to the first.
    pub closed: bool,
}

impl Polyline {
    /// Sum of the lengths of its segments.
    pub fn length(&self) -> f64 {
        let points = &self.points;
        let first = points.first().filter(|_| self.closed);
        let ends = points.iter().skip(1).chain(first);
        points.iter().zip(ends).map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
    }
}

/// The curve, piece by piece.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contours {
    /// The pieces, none of which is part of a longer one; longest first.
    pub polylines: Vec<Polyline>,
    /// Evaluations of f spent.
    pub evaluations: usize,
}

impl Surface<2> {
    /// The zeros of f that belong to the curve (SPEC § 8), as polylines.
    ///
    /// Every vertex is such a zero. An open polyline ends where the rule of acceptance ends the curve, at a rim as a rule. Cells
    /// cover the supports and nothing else; they are halved, four times at most, where n turns or the curve bends too much for
    /// their width. What is smaller than such a cell may be missed.
    pub fn contour(&self, how: &Contour) -> Contours {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).contour(how).unwrap_or_default()
    }
}

impl Running<'_, 2> {
    /// [`Surface::contour`].
    pub fn contour(&self, how: &Contour) -> Result<Contours, Cancelled> {
        let run = self.run.silent();
        let mut net = Net::new(self.surface.with(&run), how);
        net.refine()?;
        let mut chains = Chains::of(&net);
        chains.find_rims(&mut net)?;
        Ok(Contours { polylines: chains.polylines(&net), evaluations: net.judge.evaluations })
    }
}
