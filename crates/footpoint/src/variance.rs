//! The variance of f that the noise of the samples causes (SPEC § 10).

use crate::algebra::add;
use crate::evaluator::{Extra, Local, Position, own_sensitivity};
use crate::noise::Noise;
use crate::surface::Surface;

/// Σ G_iᵀ C_i G_i at a position, the square of a length; NaN where the noise is not known or f does not exist.
///
/// `own` is the sample that the position belongs to, by its number and its place in the grid: it moves the position
/// with it, so that ∇f joins its G before squaring.
pub(crate) fn variance<const D: usize>(
    surface: &Surface<D>,
    own: Option<(usize, u32)>,
    position: &Position<D>,
    answers: (&Local<D>, &Extra<D>),
) -> f64 {
    surface.cloud.noise().map_or(f64::NAN, |noise| variance_by((surface, noise), own, position, answers))
}

/// The same for this noise, which is the cloud's or one figure.
pub(crate) fn variance_by<const D: usize>(
    (surface, noise): (&Surface<D>, &Noise<D>),
    own: Option<(usize, u32)>,
    position: &Position<D>,
    (local, extra): (&Local<D>, &Extra<D>),
) -> f64 {
    let unit = surface.grid.unit;
    let from_samples = match noise {
        Noise::Uniform(sigma) => sigma * sigma * extra.sensitivity,
        _ => extra.variance * unit * unit,
    };
    let Some((sample, place)) = own else { return from_samples };
    let p = surface.cloud.points()[sample].map(|c| c / unit);
    let alone = own_sensitivity((&surface.grid, &surface.definition), (p, place), position, (local, extra));
    let together = noise.variance(sample, add(alone, local.gradient));
    // A difference of sums of squares may fall below zero by rounding.
    let variance = from_samples - noise.variance(sample, alone) + together;
    if variance < 0.0 { 0.0 } else { variance }
}
