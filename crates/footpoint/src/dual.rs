//! Dual numbers: values with their derivative along one direction. What they run through comes out with its exact derivative.

use crate::lane::Lane;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One value and its derivative in every lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<L> {
    pub(crate) value: L,
    pub(crate) slope: L,
}

impl<L: Lane> Dual<L> {
    /// A value that stays the same along the direction.
    #[inline(always)]
    pub(crate) fn constant(value: L) -> Self {
        Self { value, slope: value.like(0.0) }
    }
}

impl<L: Lane> Add for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<L: Lane> Sub for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<L: Lane> Mul for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let slope = self.slope.mul_add(other.value, self.value * other.slope);
        Self { value: self.value * other.value, slope }
    }
}

impl<L: Lane> Div for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = self.value.like(1.0) / other.value;
        let value = self.value / other.value;
        Self { value, slope: (-value).mul_add(other.slope, self.slope) * inverse }
    }
}

impl<L: Lane> Neg for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<L: Lane> Lane for Dual<L> {
    type Mask = L::Mask;
    type Token = L::Token;
    type Number = L::Number;
    type Slot = [L::Slot; 2];
    const WIDTH: usize = L::WIDTH;

    #[inline(always)]
    fn splat(token: L::Token, value: f64) -> Self {
        Self::constant(L::splat(token, value))
    }

    #[inline(always)]
    fn broadcast(token: L::Token, value: L::Number) -> Self {
        Self::constant(L::broadcast(token, value))
    }

    #[inline(always)]
    fn load(token: L::Token, slot: &Self::Slot) -> Self {
        Self { value: L::load(token, &slot[0]), slope: L::load(token, &slot[1]) }
    }

    #[inline(always)]
    fn store(self, slot: &mut Self::Slot) {
        self.value.store(&mut slot[0]);
        self.slope.store(&mut slot[1]);
    }

    #[inline(always)]
    fn token(self) -> L::Token {
        self.value.token()
    }

    #[inline(always)]
    fn get(self, lane: usize) -> f64 {
        self.value.get(lane)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self {
            value: self.value.mul_add(factor.value, addend.value),
            slope: self.slope.mul_add(factor.value, self.value.mul_add(factor.slope, addend.slope)),
        }
    }

    /// The derivative at zero, which is infinite, counts as zero: it only ever meets factors that vanish there.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let zero = value.like(0.0);
        let slope = self.slope / (value + value);
        Self { value, slope: L::select(zero.less(value), slope, zero) }
    }

    #[inline(always)]
    fn round(self) -> Self {
        Self::constant(self.value.round())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::constant(self.value.power_of_two())
    }

    #[inline(always)]
    fn less(self, other: Self) -> L::Mask {
        self.value.less(other.value)
    }

    #[inline(always)]
    fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self { value: L::select(mask, yes.value, no.value), slope: L::select(mask, yes.slope, no.slope) }
    }

    #[inline(always)]
    fn none(mask: L::Mask) -> bool {
        L::none(mask)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::exp_of_negative;

    fn at(x: f64) -> Dual<f64> {
        Dual { value: x, slope: 1.0 }
    }

    #[test]
    fn the_exponential_of_a_dual_number_has_its_own_value_as_slope() {
        let e = exp_of_negative(at(-3.7));
        assert!((e.slope - e.value).abs() <= 1e-15 * e.value);
    }

    #[test]
    fn every_operation_carries_its_derivative() {
        let (x, two) = (at(1.7), at(1.7).like(2.0));
        let close = |found: Dual<f64>, slope: f64| assert!((found.slope - slope).abs() < 4e-15, "{found:?}");
        close(x * x * x, 3.0 * 1.7 * 1.7);
        close(two / x, -2.0 / (1.7 * 1.7));
        close(x.sqrt(), 0.5 / 1.7_f64.sqrt());
        close(x.mul_add(x, -x), 2.0 * 1.7 - 1.0);
        close((two - x).max(x), 1.0);
        close((x - two).abs(), -1.0);
        assert_eq!((x - x).sqrt().slope, 0.0);
    }
}
