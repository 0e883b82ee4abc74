//! Surfaces of higher degree: one claim a file.

use crate::common;

mod accuracy;
mod choice;
mod conditioning;
mod convergence;
mod precision;
mod second_derivatives;
mod uncertainty;

/// A torus of radii 1 and 0.4: the foot of a point, and the outward normal there.
fn on_torus(x: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let around = x[0].hypot(x[1]);
    let centre = [x[0] / around, x[1] / around, 0.0];
    let away = common::sub(x, centre);
    let normal = common::scale(away, 1.0 / common::length(away));
    (common::add(centre, common::scale(normal, 0.4)), normal)
}

/// Angle between two axes, exact for small ones.
fn angle<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let along = common::dot(a, b);
    common::length(common::sub(a, common::scale(b, along))).atan2(along.abs())
}
