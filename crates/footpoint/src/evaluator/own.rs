//! The sensitivity of f to one sample: for a query that is a sample itself.

use super::{Extra, Local};
use crate::algebra::scale;
use crate::definition::{Definition, Kind};
use crate::engine::{Frame, Position, Weighted, heights_share, levin_share, sensitivity_to};
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
    let h = grid.scales.get(place).copied().unwrap_or(grid.uniform_scale);
    let factor = grid.factors.get(place).copied().unwrap_or(1.0);
    let d: [f64; D] = std::array::from_fn(|k| (p[k] - position.anchor[k]) - position.offset[k]);
    let s2 = d.iter().map(|c| (c / h) * (c / h)).sum::<f64>();
    let [theta, psi, chi] = with_kernel!(definition.weight(), kernel => {
        let closeness = kernel.closeness(s2);
        [kernel.theta(closeness), kernel.psi(closeness) / (h * h), kernel.chi(closeness) / (h * h * h * h)]
    });
    let normal = std::array::from_fn(|k| grid.normals[k].get(place).copied().unwrap_or(0.0));
    if let Some(heights) = &extra.heights {
        let share = heights_share((definition.field(), heights), (d, normal), [factor * theta, factor * psi]);
        return scale(share, -1.0 / extra.weight_sum);
    }
    let frame = Frame { normal: local.normal, aside: local.aside, turn: extra.turn };
    if definition.kind() == Kind::Levin {
        let share = levin_share((&frame, local.value), d, [theta, psi, chi]);
        return scale(share, -factor / extra.weight_sum);
    }
    let sample = Weighted { d, theta: factor * theta, psi: factor * psi, normal };
    sensitivity_to(definition.field(), &frame, extra.weight_sum, &sample)
}
