//! Figures in the plane, as SVG: what the paper's figures 1, 2, 4, 5 and 6 show, computed by the library.

mod almost_orthogonal;
mod basic;
mod canvas;
mod definition;
mod normals;
mod orthogonal;
mod scene;
mod style;

use footpoint::{Cancelled, Error, Run, Status};

/// Numbers of the figures drawn here, which are those of the paper.
pub const NUMBERS: [u8; 5] = [1, 2, 4, 5, 6];

/// Why a figure cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// No figure in the plane has this number.
    #[error("figure {0}: those in the plane are 1, 2, 4, 5 and 6")]
    Number(u8),
    /// There is no surface.
    #[error(transparent)]
    Surface(#[from] Error),
    /// A point that the figure shows has no answer.
    #[error("a point of the figure is {0}")]
    Point(Status),
    /// The computation was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Draws the figure of this number as an SVG file of its own, the same bytes every time on one kind of processor; others
/// differ in the last digit of some coordinates.
pub fn figure(number: u8, run: &Run<'_>) -> Result<String, FigureError> {
    match number {
        1 => definition::draw(run),
        2 => normals::draw(run),
        4 => basic::draw(run),
        5 => almost_orthogonal::draw(run),
        6 => orthogonal::draw(run),
        other => Err(FigureError::Number(other)),
    }
}
