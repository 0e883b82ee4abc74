//! The grid that LAS rounds coordinates to: `integer · scale + offset`, with integers of 32 bits.

/// The scale and offset of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    pub(super) scale: f64,
    pub(super) offset: f64,
}

const MOST: f64 = i32::MAX as f64;

impl Grid {
    /// The integer nearest to a coordinate; one out of reach is cut off.
    pub(super) fn integer(self, value: f64) -> i32 {
        ((value - self.offset) / self.scale).round() as i32
    }

    pub(super) fn value(self, integer: i32) -> f64 {
        f64::from(integer) * self.scale + self.offset
    }

    /// Whether every coordinate is read back to the same bits.
    pub(super) fn is_exact(self, values: &[f64]) -> bool {
        values.iter().all(|&value| self.value(self.integer(value)) == value)
    }

    /// A grid for finite coordinates: the offset is the least one, rounded down to the power of ten below
    /// the extent. The scale is the coarsest power of ten, from 1 down, that loses no more of any coordinate
    /// than arithmetic in doubles does; if there is none, the finest that 32 bits hold, which rounds by less
    /// than 5e-9 of the extent.
    pub(super) fn for_values(values: &[f64]) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if values.is_empty() {
            return Self { scale: 0.001, offset: 0.0 };
        }
        let extent = high - low;
        let below = if extent > 0.0 { extent.log10().floor() as i32 } else { 0 };
        let offset = round_down(low, below);
        let finest = ((high - offset).max(f64::MIN_POSITIVE) / MOST).log10().ceil() as i32;
        let finest = (finest..).find(|&power| (high - offset) / ten_to(power) <= MOST).unwrap_or(finest);
        // Steps below those of the doubles themselves would gain nothing.
        let size = low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
        let finest = finest.max((size * f64::EPSILON).log10().floor() as i32);
        let loses_nothing = |grid: &Self| {
            values.iter().all(|&value| {
                let size = value.abs().max(offset.abs());
                (grid.value(grid.integer(value)) - value).abs() <= 2.0 * f64::EPSILON * size
            })
        };
        let grids = (finest..=finest.max(0)).rev().map(|power| Self { scale: ten_to(power), offset });
        grids.into_iter().find(loses_nothing).unwrap_or(Self { scale: ten_to(finest), offset })
    }
}

/// The double nearest to a power of ten, which repeated multiplication misses.
fn ten_to(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(f64::MIN_POSITIVE)
}

fn round_down(value: f64, power: i32) -> f64 {
    let rounded = if power < 0 {
        (value * ten_to(-power)).floor() / ten_to(-power)
    } else {
        (value / ten_to(power)).floor() * ten_to(power)
    };
    if rounded.is_finite() { rounded } else { value }
}
