//! The sensitivity of f to one sample: for a query that is a sample itself.

use super::{Extra, Local};
use crate::definition::Definition;
use crate::engine::{Frame, Position, Weighted, sensitivity_to};
use crate::grid::Grid;
use crate::weight::{Kernel, with_kernel};

/// ∂f/∂p at a position, for the sample p (in units of the grid) at this place of the grid.
pub(crate) fn own_sensitivity<const D: usize>(
    (grid, definition): (&Grid<D>, &Definition),
    (p, place): ([f64; D], u32),
    position: &Position<D>,
    (local, extra): (&Local<D>, &Extra<D>),
) -> [f64; D] {
    let place = place as usize;
    let scale = grid.scales.get(place).copied().unwrap_or(grid.uniform_scale);
    let factor = grid.factors.get(place).copied().unwrap_or(1.0);
    let d: [f64; D] = std::array::from_fn(|k| (p[k] - position.anchor[k]) - position.offset[k]);
    let s2 = d.iter().map(|c| (c / scale) * (c / scale)).sum::<f64>();
    let (theta, psi) = with_kernel!(definition.weight(), kernel => {
        let closeness = kernel.closeness(s2);
        (kernel.theta(closeness), kernel.psi(closeness) / (scale * scale))
    });
    let normal = std::array::from_fn(|k| grid.normals[k].get(place).copied().unwrap_or(0.0));
    let sample = Weighted { d, theta: factor * theta, psi: factor * psi, normal };
    let frame = Frame { normal: local.normal, aside: local.aside, turn: extra.turn };
    sensitivity_to(definition.field(), &frame, extra.weight_sum, &sample)
}
