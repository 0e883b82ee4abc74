//! The weights θ and their derivatives ψ = θ'(r)/r and χ = ψ'(r)/r, as functions of s² = (r/h)².

use crate::algebra::{Vector, dot};
use crate::lane::{Lane, Number, exp_of_negative};

/// The weight function θ (SPEC § 1): smooth, positive inside the support radius h, falling to zero at it.
///
/// With s = r/h: `PolyM` is (1 − s²)^m, `Wendland` is (1 − s)⁴(4s + 1), `Gaussian` is exp(−s²) where that is at
/// least `cut`, and zero beyond. For the Gaussian h is its scale and its support ends at h √(−ln cut); because it
/// is cut it is not continuous, and it is here for comparison with older work. `Poly3` is the default: the
/// smallest power with a continuous curvature of f.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Weight {
    /// (1 − s²)².
    Poly2,
    /// (1 − s²)³.
    #[default]
    Poly3,
    /// (1 − s²)⁴.
    Poly4,
    /// (1 − s)⁴ (4s + 1).
    Wendland,
    /// exp(−s²), zero where it is below `cut` (between 0 and 1; 1e-9 is usual).
    Gaussian {
        /// The value below which the weight counts as zero.
        cut: f64,
    },
}

impl Weight {
    /// The Gaussian with the usual cut of 1e-9.
    pub const GAUSSIAN: Self = Self::Gaussian { cut: 1e-9 };

    /// Radius of the support in units of h: 1, and √(−ln cut) for the Gaussian.
    pub fn reach(self) -> f64 {
        match self {
            Self::Gaussian { cut } => (-cut.ln()).sqrt(),
            _ => 1.0,
        }
    }

    /// Effective neighbours (Σθ)²/Σθ² as a share of the samples nearer than h, on an even, flat sampling of a curve
    /// (`dimension` 2) or a surface (3). More than 1 for the Gaussian, which reaches beyond its h.
    pub fn effective_share(self, dimension: usize) -> f64 {
        let curve = dimension == 2;
        match self {
            Self::Poly2 => [5.0 / 9.0, 0.7][usize::from(curve)],
            Self::Poly3 => [7.0 / 16.0, 429.0 / 700.0][usize::from(curve)],
            Self::Poly4 => [9.0 / 25.0, 2431.0 / 4410.0][usize::from(curve)],
            Self::Wendland => [99.0 / 343.0, 11.0 / 23.0][usize::from(curve)],
            Self::Gaussian { .. } => [2.0, (std::f64::consts::PI / 2.0).sqrt()][usize::from(curve)],
        }
    }

    /// How far the surface lies inside a curved one, over κ h² (SPEC § 11): half the weighted mean of r²/h² over an even, flat
    /// sampling of a curve (`dimension` 2; κ its curvature) or a surface (3; κ the mean curvature).
    pub fn bias(self, dimension: usize) -> f64 {
        let power = |m: f64| 0.5 / if dimension == 2 { 2.0 * m + 3.0 } else { m + 2.0 };
        let curve = dimension == 2;
        match self {
            Self::Poly2 => power(2.0),
            Self::Poly3 => power(3.0),
            Self::Poly4 => power(4.0),
            Self::Wendland => [5.0 / 72.0, 1.0 / 28.0][usize::from(curve)],
            Self::Gaussian { .. } => [0.5, 0.25][usize::from(curve)],
        }
    }

    /// The largest |a(x) − x| of a surface point in units of h (SPEC § 8) for frames fitted about a(x).
    pub(crate) fn boundary_limit(self) -> f64 {
        match self {
            Self::Gaussian { .. } => 1.1,
            _ => 0.5,
        }
    }

    /// The same for frames fitted about x, which turn sideways earlier.
    pub(crate) fn boundary_limit_about_x(self, dimension: usize) -> f64 {
        let power = |m: f64| 1.0 / (2.0 * m + if dimension == 2 { 4.0 } else { 5.0 }).sqrt();
        match self {
            Self::Poly2 => power(2.0),
            Self::Poly3 => power(3.0),
            Self::Poly4 => power(4.0),
            Self::Wendland => 0.26,
            Self::Gaussian { .. } => std::f64::consts::FRAC_1_SQRT_2,
        }
    }
}

/// One weight inside the hot loop, in two steps: the *closeness* of a sample, zero outside the support, is kept from the
/// first pass to the second; θ, ψ and χ are functions of it.
pub(crate) trait Kernel: Copy + Sync {
    /// Where the support ends, in s².
    fn end(self) -> f64;
    fn closeness<L: Lane>(self, s2: L) -> L;
    fn theta<L: Lane>(self, closeness: L) -> L;
    /// h² ψ.
    fn psi<L: Lane>(self, closeness: L) -> L;
    /// h⁴ χ. Finite at s = 0 even where χ is not: there it meets factors that vanish.
    fn chi<L: Lane>(self, closeness: L) -> L;

    /// Closeness in a cloud of one support radius, up to a constant; `square` is h² and `inverse` 1/h².
    #[inline(always)]
    fn uniform_closeness<L: Lane, const D: usize>(self, d: Vector<L, D>, _square: L, inverse: L) -> L {
        self.closeness(dot(d, d) * inverse)
    }

    /// The constants that `uniform_closeness` leaves out: of the closeness, of θ and of h² ψ.
    fn uniform_constants(self, _h: f64) -> [f64; 3] {
        [1.0; 3]
    }
}

/// The exponent is a number and not a type: the loops are compiled once for all of them, and the branch is foreseen.
#[derive(Clone, Copy)]
pub(crate) struct Poly {
    pub(crate) exponent: usize,
}
#[derive(Clone, Copy)]
pub(crate) struct Wendland;
#[derive(Clone, Copy)]
pub(crate) struct Gaussian {
    pub(crate) cut: f64,
}

/// t to the power of 1, 2, 3 or 4.
#[inline(always)]
fn power<L: Lane>(t: L, exponent: usize) -> L {
    match exponent {
        1 => t,
        2 => t * t,
        3 => t * t * t,
        _ => (t * t) * (t * t),
    }
}

/// Closeness 1 − s², or h² − r² where all supports are equal: no division, no square root.
impl Kernel for Poly {
    fn end(self) -> f64 {
        1.0
    }
    #[inline(always)]
    fn closeness<L: Lane>(self, s2: L) -> L {
        (s2.like(1.0) - s2).max(s2.like(0.0))
    }
    #[inline(always)]
    fn theta<L: Lane>(self, closeness: L) -> L {
        power(closeness, self.exponent)
    }
    #[inline(always)]
    fn psi<L: Lane>(self, closeness: L) -> L {
        power(closeness, self.exponent - 1) * closeness.like(-2.0 * self.exponent as f64)
    }
    #[inline(always)]
    fn chi<L: Lane>(self, closeness: L) -> L {
        let (zero, one) = (closeness.like(0.0), closeness.like(1.0));
        let rest = match self.exponent {
            // A step at the end of the support.
            2 => L::select(zero.less(closeness), one, zero),
            _ => power(closeness, self.exponent - 2),
        };
        rest * closeness.like((4 * self.exponent * (self.exponent - 1)) as f64)
    }
    #[inline(always)]
    fn uniform_closeness<L: Lane, const D: usize>(self, d: Vector<L, D>, square: L, _inverse: L) -> L {
        d.iter().fold(square, |rest, &c| (-c).mul_add(c, rest)).max(square.like(0.0))
    }
    fn uniform_constants(self, h: f64) -> [f64; 3] {
        let square = h * h;
        let of_power = |exponent: usize| 1.0 / power(square, exponent);
        [of_power(1), of_power(self.exponent), of_power(self.exponent - 1)]
    }
}

/// Closeness 1 − s.
impl Kernel for Wendland {
    fn end(self) -> f64 {
        1.0
    }
    #[inline(always)]
    fn closeness<L: Lane>(self, s2: L) -> L {
        (s2.like(1.0) - s2.sqrt()).max(s2.like(0.0))
    }
    #[inline(always)]
    fn theta<L: Lane>(self, closeness: L) -> L {
        power(closeness, 4) * (closeness.like(5.0) - closeness * closeness.like(4.0))
    }
    #[inline(always)]
    fn psi<L: Lane>(self, closeness: L) -> L {
        power(closeness, 3) * closeness.like(-20.0)
    }
    #[inline(always)]
    fn chi<L: Lane>(self, closeness: L) -> L {
        let s = (closeness.like(1.0) - closeness).max(closeness.like(L::Number::EPSILON));
        power(closeness, 2) * closeness.like(60.0) / s
    }
}

/// Closeness θ itself.
impl Kernel for Gaussian {
    fn end(self) -> f64 {
        -self.cut.ln()
    }
    #[inline(always)]
    fn closeness<L: Lane>(self, s2: L) -> L {
        let inside = s2.less(s2.like(self.end()));
        L::select(inside, exp_of_negative(-L::select(inside, s2, s2.like(0.0))), s2.like(0.0))
    }
    #[inline(always)]
    fn theta<L: Lane>(self, closeness: L) -> L {
        closeness
    }
    #[inline(always)]
    fn psi<L: Lane>(self, closeness: L) -> L {
        closeness * closeness.like(-2.0)
    }
    #[inline(always)]
    fn chi<L: Lane>(self, closeness: L) -> L {
        closeness * closeness.like(4.0)
    }
}

/// Runs `$body` with `$kernel` bound to the kernel of `$weight`: the only match over the weights in a batch.
macro_rules! with_kernel {
    ($weight:expr, $kernel:ident => $body:expr) => {{
        let exponent = match $weight {
            $crate::weight::Weight::Poly2 => 2,
            $crate::weight::Weight::Poly4 => 4,
            _ => 3,
        };
        match $weight {
            $crate::weight::Weight::Wendland => {
                let $kernel = $crate::weight::Wendland;
                $body
            }
            $crate::weight::Weight::Gaussian { cut } => {
                let $kernel = $crate::weight::Gaussian { cut };
                $body
            }
            _ => {
                let $kernel = $crate::weight::Poly { exponent };
                $body
            }
        }
    }};
}
pub(crate) use with_kernel;

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Weight; 6] = [
        Weight::Poly2,
        Weight::Poly3,
        Weight::Poly4,
        Weight::Wendland,
        Weight::GAUSSIAN,
        Weight::Gaussian { cut: 1e-3 },
    ];

    #[test]
    fn psi_is_the_derivative_of_theta_over_r() {
        for weight in ALL {
            let theta = |s: f64| with_kernel!(weight, k => k.theta(k.closeness(s * s)));
            for i in 1..100 {
                let s = f64::from(i) / 100.0 * weight.reach();
                let step = 1e-5;
                if s + step >= weight.reach() {
                    continue;
                }
                let slope = (theta(s + step) - theta(s - step)) / (2.0 * step);
                let psi = with_kernel!(weight, k => k.psi(k.closeness(s * s)));
                assert!((psi * s - slope).abs() < 1e-8, "{weight:?} at {s}: {} {slope}", psi * s);
            }
            // At a sample nothing divides by r.
            assert!(with_kernel!(weight, k => k.psi(k.closeness(0.0))).is_finite());
            assert_eq!(theta(0.0), 1.0);
        }
    }

    #[test]
    fn chi_is_the_derivative_of_psi_over_r() {
        for weight in ALL {
            let psi = |s: f64| with_kernel!(weight, k => k.psi(k.closeness(s * s)));
            let chi = |s: f64| with_kernel!(weight, k => k.chi(k.closeness(s * s)));
            let step = 1e-5;
            for i in 1..100 {
                let s = f64::from(i) / 100.0 * weight.reach();
                if s + step >= weight.reach() {
                    continue;
                }
                let slope = (psi(s + step) - psi(s - step)) / (2.0 * step);
                assert!((chi(s) * s - slope).abs() < 2e-8, "{weight:?} at {s}: {} {slope}", chi(s) * s);
            }
            assert!(chi(0.0).is_finite());
            assert_eq!(chi(1.001 * weight.reach()), 0.0);
        }
    }

    #[test]
    fn a_uniform_support_gives_the_same_weights_up_to_its_constants() {
        for weight in ALL {
            with_kernel!(weight, k => {
                for h in [1.0, 1.3, 1.99] {
                    let [closeness_factor, theta_factor, psi_factor] = k.uniform_constants(h);
                    for i in 0..100 {
                        let d = [0.013 * f64::from(i) * h, 0.1, -0.2];
                        let plain = k.closeness(dot(d, d) / (h * h));
                        let uniform = k.uniform_closeness(d, h * h, 1.0 / (h * h));
                        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13, "{weight:?}: {a} {b}");
                        close(plain, uniform * closeness_factor);
                        close(k.theta(plain), k.theta(uniform) * theta_factor);
                        close(k.psi(plain), k.psi(uniform) * psi_factor);
                    }
                }
            });
        }
    }

    #[test]
    fn weights_end_at_their_reach() {
        for weight in ALL {
            let end = with_kernel!(weight, k => k.end());
            assert!((end - weight.reach().powi(2)).abs() < 1e-12 * end);
            assert!(with_kernel!(weight, k => k.theta(k.closeness(end * (1.0 - 1e-9)))) > 0.0);
            assert_eq!(with_kernel!(weight, k => k.theta(k.closeness(end * (1.0 + 1e-9)))), 0.0);
            assert_eq!(with_kernel!(weight, k => k.psi(k.closeness(end * 1.5))), 0.0);
        }
    }

    #[test]
    fn effective_shares_and_biases_agree_with_sums_over_an_even_sampling() {
        for weight in ALL {
            for dimension in [2, 3] {
                let (mut sum, mut squares, mut count, mut second) = (0.0, 0.0, 0.0, 0.0);
                let n = 400_i32;
                let across = if dimension == 3 { 5 * n } else { 0 };
                for i in -5 * n..=5 * n {
                    for j in (-across..=across).step_by(8) {
                        let s2 = f64::from(i * i + j * j) / f64::from(n * n);
                        let theta = with_kernel!(weight, k => k.theta(k.closeness(s2)));
                        sum += theta;
                        squares += theta * theta;
                        second += theta * s2;
                        count += f64::from(u8::from(s2 < 1.0));
                    }
                }
                let share = sum * sum / squares / count;
                let expected = weight.effective_share(dimension);
                assert!(
                    (share - expected).abs() < 0.01 * expected,
                    "{weight:?} {dimension}: {share} {expected}"
                );
                let (bias, expected) = (0.5 * second / sum, weight.bias(dimension));
                assert!(
                    (bias - expected).abs() < 0.01 * expected,
                    "{weight:?} {dimension}: {bias} {expected}"
                );
            }
        }
    }
}
