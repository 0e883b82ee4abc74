//! The scalar that kernels and algebra compute with: one number, several lanes, or a dual number.

use fearless_simd::prelude::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One value in every lane of a block.
///
/// Sums use only what is here (`+ − × ÷ √`, comparison and selection, and a power of two for our own
/// exponential), so that every lane gives the same bits and a dual number gives exact derivatives.
pub(crate) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// One truth value a lane.
    type Mask: Copy;
    /// Proof that the processor has the lanes' instructions; nothing at run time.
    type Token: Copy;
    /// Number of lanes.
    const WIDTH: usize;

    fn splat(token: Self::Token, value: f64) -> Self;
    fn from_fn(token: Self::Token, value: impl FnMut(usize) -> f64) -> Self;
    fn token(self) -> Self::Token;
    /// The value of one lane.
    fn get(self, lane: usize) -> f64;
    /// `self · factor + addend` in one rounding, where the processor can; everywhere else in two. Machines of either
    /// kind agree among themselves.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    fn sqrt(self) -> Self;
    /// The nearest integer; a dual number keeps no derivative of it.
    fn round(self) -> Self;
    /// 2 to the power of `self`, which holds an integer between −1022 and 1023.
    fn power_of_two(self) -> Self;
    /// `self < other`; false where either is NaN.
    fn less(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn none(mask: Self::Mask) -> bool;

    /// `value` in as many lanes.
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::splat(self.token(), value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.less(self.like(0.0)), -self, self)
    }

    /// The larger of both; `other` where `self` is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.less(self), self, other)
    }
}

impl Lane for f64 {
    type Mask = bool;
    type Token = ();
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn from_fn((): (), mut value: impl FnMut(usize) -> f64) -> Self {
        value(0)
    }

    #[inline(always)]
    fn token(self) {}

    #[inline(always)]
    fn get(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // Fused only in the vector lanes: without the instruction it would be a slow call.
        self * factor + addend
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn round(self) -> Self {
        self.round_ties_even()
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits(((self as i64 + 1023) as u64) << 52)
    }

    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn none(mask: bool) -> bool {
        !mask
    }
}

/// exp(x) for −708 ≤ x ≤ 0, within 2 units in the last place.
///
/// Ours, because the platform's differs between machines: x = k ln 2 + r with |r| ≤ ln 2 / 2, then the Taylor
/// polynomial of degree 13 (remainder below 2e-17 relative) and a power of two.
#[inline(always)]
pub(crate) fn exp_of_negative<L: Lane>(x: L) -> L {
    // ln 2 in two parts: k times the first is exact for |k| < 2^11.
    const LN2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let k = (x * x.like(std::f64::consts::LOG2_E)).round();
    let r = (x - k * x.like(LN2_HIGH)) - k * x.like(LN2_LOW);
    let mut sum = x.like(1.0);
    for term in (1..=13).rev() {
        sum = (sum * x.like(1.0 / f64::from(term))).mul_add(r, x.like(1.0));
    }
    sum * k.power_of_two()
}

/// The native vector of a processor level.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd>(S::f64s);

macro_rules! operator {
    ($name:ident, $method:ident) => {
        impl<S: Simd> $name for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($name::$method(self.0, other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> Lane for Lanes<S> {
    type Mask = S::mask64s;
    type Token = S;
    const WIDTH: usize = S::f64s::LEN;

    #[inline(always)]
    fn splat(token: S, value: f64) -> Self {
        Self(S::f64s::splat(token, value))
    }

    #[inline(always)]
    fn from_fn(token: S, value: impl FnMut(usize) -> f64) -> Self {
        Self(S::f64s::from_fn(token, value))
    }

    #[inline(always)]
    fn token(self) -> S {
        self.0.token()
    }

    #[inline(always)]
    fn get(self, lane: usize) -> f64 {
        self.0.as_slice()[lane]
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.round_ties_even())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::from_fn(self.token(), |lane| self.get(lane).power_of_two())
    }

    #[inline(always)]
    fn less(self, other: Self) -> S::mask64s {
        self.0.simd_lt(other.0)
    }

    #[inline(always)]
    fn select(mask: S::mask64s, yes: Self, no: Self) -> Self {
        Self(mask.select(yes.0, no.0))
    }

    #[inline(always)]
    fn none(mask: S::mask64s) -> bool {
        mask.all_false()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A value with its derivative along one direction: what exact second derivatives will be computed with.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Dual {
        pub(crate) value: f64,
        pub(crate) slope: f64,
    }

    impl Add for Dual {
        type Output = Self;
        fn add(self, o: Self) -> Self {
            Self { value: self.value + o.value, slope: self.slope + o.slope }
        }
    }
    impl Sub for Dual {
        type Output = Self;
        fn sub(self, o: Self) -> Self {
            Self { value: self.value - o.value, slope: self.slope - o.slope }
        }
    }
    impl Mul for Dual {
        type Output = Self;
        fn mul(self, o: Self) -> Self {
            Self { value: self.value * o.value, slope: self.slope * o.value + self.value * o.slope }
        }
    }
    impl Div for Dual {
        type Output = Self;
        fn div(self, o: Self) -> Self {
            let value = self.value / o.value;
            Self { value, slope: (self.slope - value * o.slope) / o.value }
        }
    }
    impl Neg for Dual {
        type Output = Self;
        fn neg(self) -> Self {
            Self { value: -self.value, slope: -self.slope }
        }
    }
    impl Lane for Dual {
        type Mask = bool;
        type Token = ();
        const WIDTH: usize = 1;
        fn splat((): (), value: f64) -> Self {
            Self { value, slope: 0.0 }
        }
        fn from_fn((): (), mut value: impl FnMut(usize) -> f64) -> Self {
            Self::splat((), value(0))
        }
        fn token(self) {}
        fn get(self, _: usize) -> f64 {
            self.value
        }
        fn mul_add(self, factor: Self, addend: Self) -> Self {
            self * factor + addend
        }
        fn sqrt(self) -> Self {
            let value = self.value.sqrt();
            Self { value, slope: if value > 0.0 { self.slope / (2.0 * value) } else { 0.0 } }
        }
        fn round(self) -> Self {
            self.like(self.value.round_ties_even())
        }
        fn power_of_two(self) -> Self {
            self.like(self.value.power_of_two())
        }
        fn less(self, other: Self) -> bool {
            self.value < other.value
        }
        fn select(mask: bool, yes: Self, no: Self) -> Self {
            if mask { yes } else { no }
        }
        fn none(mask: bool) -> bool {
            !mask
        }
    }

    #[test]
    fn the_exponential_is_accurate_to_two_units_in_the_last_place() {
        for i in 0..=70_000 {
            let x = -f64::from(i) * 0.01;
            let (ours, reference) = (exp_of_negative(x), x.exp());
            assert!(
                (ours - reference).abs() <= 2.0 * f64::EPSILON * reference,
                "exp({x}): {ours} {reference}"
            );
        }
    }

    #[test]
    fn the_exponential_of_a_dual_number_has_its_own_value_as_slope() {
        let e = exp_of_negative(Dual { value: -3.7, slope: 1.0 });
        assert!((e.slope - e.value).abs() <= 1e-15 * e.value);
    }
}
