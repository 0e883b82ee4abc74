//! The scalar that kernels and algebra compute with: one number, several lanes, or a dual number.

use fearless_simd::prelude::*;
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The numbers that the sums are computed in.
///
/// `Double`: relative accuracy 1e-11 where the gap exceeds 0.1. `Single`: f within 4e-7 of the support's radius (5e-7 for
/// Levin's surface), n and ∇f/|∇f| within 2e-5 rad (for the Gaussian 2e-5 radii over its h) where the gap exceeds 0.1 and |∇f| 0.3;
/// at degrees 2 and 3, with 24 effective neighbours, f within 3e-6 and 1e-5 and angles within 1e-4. Samples lie on
/// a lattice of some 5e-7 supports there, of the largest if they differ; coordinates may be 2^29 supports.
///
/// In both, errors grow with the samples of a support beyond a hundred, with (|a − x|/size)² where these crowd in a small
/// part of it far from x, and with √Σ|∂f/∂p_i|² where that exceeds a half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Precision {
    /// 64 bits.
    #[default]
    Double,
    /// 32 bits.
    Single,
}

/// What columns hold: numbers of 64 or of 32 bits.
pub(crate) trait Number: Copy + Send + Sync + 'static {
    /// One number for every lane of a block.
    type Slot: Copy + Send + Sync + std::fmt::Debug + 'static;
    /// Positions of a block: the lanes of the widest vector.
    const BLOCK: usize;
    /// The spacing of numbers near one.
    const EPSILON: f64;
    const ZERO_SLOT: Self::Slot;

    /// The vector of a processor level.
    type Lanes<S: Simd>: Lane<Token = S, Number = Self, Slot = Self::Slot>;

    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
    fn lanes(slot: &mut Self::Slot) -> &mut [Self];
}

/// The lanes of a block, where a vector is loaded in one go.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Aligned<A>(pub(crate) A);

impl Number for f64 {
    type Slot = Aligned<[f64; 8]>;
    const BLOCK: usize = 8;
    const EPSILON: f64 = f64::EPSILON;
    const ZERO_SLOT: Self::Slot = Aligned([0.0; 8]);

    type Lanes<S: Simd> = Lanes<S, S::f64s>;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }

    #[inline(always)]
    fn lanes(slot: &mut Self::Slot) -> &mut [Self] {
        &mut slot.0
    }
}

impl Number for f32 {
    type Slot = Aligned<[f32; 16]>;
    const BLOCK: usize = 16;
    const EPSILON: f64 = f32::EPSILON as f64;
    const ZERO_SLOT: Self::Slot = Aligned([0.0; 16]);

    type Lanes<S: Simd> = Lanes<S, S::f32s>;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn lanes(slot: &mut Self::Slot) -> &mut [Self] {
        &mut slot.0
    }
}

/// One value in every lane of a vector.
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
    /// What columns hold.
    type Number: Number;
    /// What a vector is kept in between the passes.
    type Slot: Copy;
    /// Number of lanes.
    const WIDTH: usize;

    fn splat(token: Self::Token, value: f64) -> Self;
    /// A number of a column in every lane.
    fn broadcast(token: Self::Token, value: Self::Number) -> Self;
    fn load(token: Self::Token, slot: &Self::Slot) -> Self;
    fn store(self, slot: &mut Self::Slot);
    fn token(self) -> Self::Token;
    /// The value of one lane.
    fn get(self, lane: usize) -> f64;
    /// `self · factor + addend` in one rounding, where the processor can; everywhere else in two. Machines of either
    /// kind agree among themselves.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    fn sqrt(self) -> Self;
    /// The nearest integer; a dual number keeps no derivative of it.
    fn round(self) -> Self;
    /// 2 to the power of `self`, which holds an integer in the range of exponents.
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

    /// The larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.less(self), self, other)
    }

    /// Every lane into `out`, which has as many places.
    #[inline(always)]
    fn write(self, out: &mut [f64]) {
        for (lane, out) in out.iter_mut().enumerate() {
            *out = self.get(lane);
        }
    }
}

impl Lane for f64 {
    type Mask = bool;
    type Token = ();
    type Number = f64;
    type Slot = f64;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn broadcast((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn load((): (), slot: &f64) -> Self {
        *slot
    }

    #[inline(always)]
    fn store(self, slot: &mut f64) {
        *slot = self;
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

/// A vector of the processor level S.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S, V>(V, PhantomData<S>);

impl<S, V> Lanes<S, V> {
    #[inline(always)]
    fn of(vector: V) -> Self {
        Self(vector, PhantomData)
    }
}

macro_rules! operator {
    ($name:ident, $method:ident) => {
        impl<S: Simd, V: SimdFloat<S>> $name for Lanes<S, V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::of($name::$method(self.0, other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<S: Simd, V: SimdFloat<S>> Neg for Lanes<S, V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::of(-self.0)
    }
}

impl<S: Simd, V: SimdFloat<S>> Lane for Lanes<S, V>
where
    V::Element: Number,
{
    type Mask = V::Mask;
    type Token = S;
    type Number = V::Element;
    type Slot = <V::Element as Number>::Slot;
    const WIDTH: usize = V::LEN;

    #[inline(always)]
    fn splat(token: S, value: f64) -> Self {
        Self::of(V::splat(token, V::Element::of(value)))
    }

    #[inline(always)]
    fn broadcast(token: S, value: V::Element) -> Self {
        Self::of(V::splat(token, value))
    }

    #[inline(always)]
    fn load(token: S, slot: &Self::Slot) -> Self {
        let mut slot = *slot;
        Self::of(V::from_slice(token, &V::Element::lanes(&mut slot)[..V::LEN]))
    }

    #[inline(always)]
    fn store(self, slot: &mut Self::Slot) {
        self.0.store_slice(&mut V::Element::lanes(slot)[..V::LEN]);
    }

    #[inline(always)]
    fn token(self) -> S {
        self.0.token()
    }

    #[inline(always)]
    fn get(self, lane: usize) -> f64 {
        self.0.as_slice()[lane].wide()
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self::of(self.0.mul_add(factor.0, addend.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::of(self.0.sqrt())
    }

    #[inline(always)]
    fn round(self) -> Self {
        Self::of(self.0.round_ties_even())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let token = self.token();
        Self::of(V::from_fn(token, |lane| V::Element::of(self.get(lane).power_of_two())))
    }

    #[inline(always)]
    fn less(self, other: Self) -> V::Mask {
        self.0.simd_lt(other.0)
    }

    #[inline(always)]
    fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        Self::of(mask.select(yes.0, no.0))
    }

    #[inline(always)]
    fn none(mask: V::Mask) -> bool {
        mask.all_false()
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::of(self.0.abs())
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::of(self.0.max(other.0))
    }
}

/// Asks the processor to have this memory at hand soon, for writing.
#[allow(unsafe_code)]
#[inline(always)]
pub(crate) fn prefetch<T>(target: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_ET0, _mm_prefetch};
        // SAFETY: a prefetch neither reads nor writes; the reference points to memory that is there.
        unsafe { _mm_prefetch::<_MM_HINT_ET0>(std::ptr::from_ref(target).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = target;
}

/// Runs `$body` with `$simd` bound to the proof of the level: AVX-512, AVX2, NEON, or what every processor of the kind has.
/// Everything below it must be inlined, so that it is compiled for the level.
macro_rules! vectorized {
    ($level:expr, $simd:ident => $body:expr) => {{
        #[allow(unused_imports)]
        use fearless_simd::Simd as _;
        let level = $level;
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            // Levels between the baseline and AVX2 compute as the baseline: nobody has them any more, and they are compiled for all.
            if let Some($simd) = level.as_avx512() {
                $simd.vectorize(
                    #[inline(always)]
                    || $body,
                )
            } else if let Some($simd) = level.as_avx2() {
                $simd.vectorize(
                    #[inline(always)]
                    || $body,
                )
            } else if let Some($simd) = level.as_sse2() {
                $simd.vectorize(
                    #[inline(always)]
                    || $body,
                )
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        fearless_simd::dispatch!(level, $simd => $body);
    }};
}
pub(crate) use vectorized;

/// The same without AVX-512, whose bits AVX2 gives too: for code that is long and seldom runs.
macro_rules! vectorized_narrow {
    ($level:expr, $simd:ident => $body:expr) => {{
        #[allow(unused_imports)]
        use fearless_simd::Simd as _;
        let level = $level;
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            if let Some($simd) = level.as_avx2() {
                $simd.vectorize(
                    #[inline(always)]
                    || $body,
                )
            } else if let Some($simd) = level.as_sse2() {
                $simd.vectorize(
                    #[inline(always)]
                    || $body,
                )
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        fearless_simd::dispatch!(level, $simd => $body);
    }};
}
pub(crate) use vectorized_narrow;

#[cfg(test)]
mod tests {
    use super::*;

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
}
