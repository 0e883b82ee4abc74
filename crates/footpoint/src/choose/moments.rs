//! Moments of the samples around a position over a plane through it: all that the fits of degree 0 to 3 and their
//! gradients need.
//!
//! They are sums, so that the moments of a cloud without a part of it are those of the whole less those of the part.

use crate::algebra::{Matrix, Vector, dot, mirror, scale, sub};
use crate::polynomial::monomials;
use crate::weight::Kernel;
use std::ops::AddAssign;

/// A sample near a probe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near<const D: usize> {
    /// Its way from the probe's sample.
    pub(super) way: [f64; D],
    /// The square of that.
    pub(super) square: f64,
    /// The factors of the samples there.
    pub(super) factor: f64,
}

/// Where sums over θ begin: plain up to degree 6, with z up to 5, with z² up to 2; over ψ: plain up to 7, with z
/// up to 6, with z² up to 3, with z³. Curves need fewer of each.
const HEIGHTS: usize = 28;
const SQUARES: usize = HEIGHTS + 21;
const SLOPES: usize = SQUARES + 6;
const SLOPE_HEIGHTS: usize = SLOPES + 36;
const SLOPE_SQUARES: usize = SLOPE_HEIGHTS + 28;
const SLOPE_CUBE: usize = SLOPE_SQUARES + 10;
const ALL: usize = SLOPE_CUBE + 1;

/// The monomials of degree 7 in two coordinates.
const HIGHEST: usize = 36;

/// Σθ sᵃtᵇzᶜ and Σψ sᵃtᵇzᶜ, lengths in units of the level's radius; s and t run along the plane and z across
/// it.
#[derive(Clone, Debug)]
pub(super) struct Moments([f64; ALL]);

impl Moments {
    pub(super) const NONE: Self = Self([0.0; ALL]);

    /// Σθ times the monomials.
    pub(super) fn plain(&self) -> &[f64] {
        &self.0[..HEIGHTS]
    }

    /// Σθ z times the monomials.
    pub(super) fn heights(&self) -> &[f64] {
        &self.0[HEIGHTS..SQUARES]
    }

    /// Σθ z² times the monomials.
    pub(super) fn squares(&self) -> &[f64] {
        &self.0[SQUARES..SLOPES]
    }

    /// Σψ zᶜ times the monomials.
    pub(super) fn slopes(&self, power: usize) -> &[f64] {
        match power {
            0 => &self.0[SLOPES..SLOPE_HEIGHTS],
            1 => &self.0[SLOPE_HEIGHTS..SLOPE_SQUARES],
            2 => &self.0[SLOPE_SQUARES..SLOPE_CUBE],
            _ => &self.0[SLOPE_CUBE..],
        }
    }

    /// These without a part of them.
    pub(super) fn without(&self, part: &Self) -> Self {
        let mut left = self.clone();
        left.0.iter_mut().zip(&part.0).for_each(|(left, part)| *left -= part);
        left
    }

    /// Sums over some samples around the place `at`, over the plane with these axes, the last of which is its normal.
    pub(super) fn over<K: Kernel, const D: usize>(
        kernel: K,
        near: &[Near<D>],
        (at, h): ([f64; D], f64),
        axes: &[[f64; D]; D],
    ) -> Self {
        let mut sums = Self::NONE;
        let inverse = 1.0 / h;
        for sample in near {
            let d: Vector<f64, D> = scale(sub(sample.way, at), inverse);
            let closeness: f64 = kernel.closeness(dot(d, d));
            if closeness <= 0.0 {
                continue;
            }
            let theta = sample.factor * kernel.theta(closeness);
            let psi = sample.factor * kernel.psi(closeness);
            let along = [dot(axes[0], d), if D == 2 { 0.0 } else { dot(axes[1], d) }];
            sums.add::<D>([theta, psi], along, dot(axes[D - 1], d));
        }
        sums
    }

    #[inline(always)]
    fn add<const D: usize>(&mut self, [theta, psi]: [f64; 2], along: [f64; 2], z: f64) {
        let powers = powers::<D>(along);
        let mut put = |begin: usize, degree: usize, factor: f64| {
            let count = monomials::<D>(degree);
            let into = &mut self.0[begin..begin + count];
            into.iter_mut().zip(&powers[..count]).for_each(|(sum, power)| *sum += factor * power);
        };
        put(0, 6, theta);
        put(HEIGHTS, 5, theta * z);
        put(SQUARES, 2, theta * z * z);
        put(SLOPES, 7, psi);
        put(SLOPE_HEIGHTS, 6, psi * z);
        put(SLOPE_SQUARES, 3, psi * z * z);
        put(SLOPE_CUBE, 0, psi * z * z * z);
    }
}

impl AddAssign<&Self> for Moments {
    fn add_assign(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(sum, other)| *sum += other);
    }
}

/// All monomials up to degree 7, by degree and falling power of the first coordinate.
#[inline(always)]
fn powers<const D: usize>([s, t]: [f64; 2]) -> [f64; HIGHEST] {
    let mut powers = [1.0; HIGHEST];
    for degree in 1..=7 {
        let (before, begin) = (monomials::<D>(degree - 1), monomials::<D>(degree));
        if D == 2 {
            powers[before] = powers[before - 1] * s;
        } else {
            let earlier = before - degree;
            for j in 0..degree {
                powers[before + j] = powers[earlier + j] * s;
            }
            powers[begin - 1] = powers[before - 1] * t;
        }
    }
    powers
}

/// S, m and W of SPEC § 1 about a place, lengths in units of the level's radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameMoments<const D: usize> {
    pub(super) weight: f64,
    pub(super) first: [f64; D],
    pub(super) second: Matrix<f64, D>,
}

impl<const D: usize> FrameMoments<D> {
    /// Sums over lists of samples around the place `at`.
    pub(super) fn over<'n, K: Kernel>(
        kernel: K,
        lists: impl Iterator<Item = &'n [Near<D>]>,
        (at, h): ([f64; D], f64),
    ) -> Self {
        let (mut weight, mut first, mut second) = (0.0, [0.0; D], [[0.0; D]; D]);
        let inverse = 1.0 / h;
        for sample in lists.flatten() {
            let d: Vector<f64, D> = scale(sub(sample.way, at), inverse);
            let closeness: f64 = kernel.closeness(dot(d, d));
            let theta = sample.factor * kernel.theta(closeness);
            weight += theta;
            for i in 0..D {
                let weighted = theta * d[i];
                first[i] += weighted;
                for j in i..D {
                    second[i][j] += weighted * d[j];
                }
            }
        }
        Self { weight, first, second: mirror(second) }
    }

    /// The same from moments over a plane, along whose axes the vectors then are.
    pub(super) fn of(moments: &Moments) -> Self {
        let (plain, heights) = (moments.plain(), moments.heights());
        let last = D - 1;
        let mut sums = Self { weight: plain[0], first: [0.0; D], second: [[0.0; D]; D] };
        sums.first[last] = heights[0];
        sums.second[last][last] = moments.squares()[0];
        for i in 0..last {
            sums.first[i] = plain[1 + i];
            sums.second[i][last] = heights[1 + i];
            for j in i..last {
                sums.second[i][j] = plain[D + i + j];
            }
        }
        sums.second = mirror(sums.second);
        sums
    }

    /// a(x) − x.
    pub(super) fn aside(&self) -> [f64; D] {
        scale(self.first, 1.0 / self.weight)
    }

    /// C of SPEC § 3.
    pub(super) fn centred(&self) -> Matrix<f64, D> {
        let u = self.aside();
        std::array::from_fn(|i| std::array::from_fn(|j| self.second[i][j] / self.weight - u[i] * u[j]))
    }
}
