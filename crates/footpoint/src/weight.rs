//! The weights θ and their derivatives ψ = θ'(r)/r, as functions of s² = (r/h)².

use crate::lane::{Lane, exp_of_negative};

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

/// One weight inside the hot loop. Both functions are zero outside the support.
pub(crate) trait Kernel: Copy + Sync {
    /// Where the support ends, in s².
    fn end(self) -> f64;
    fn theta<L: Lane>(self, s2: L) -> L;
    /// h² ψ.
    fn psi<L: Lane>(self, s2: L) -> L;
}

#[derive(Clone, Copy)]
pub(crate) struct Poly<const M: usize>;
#[derive(Clone, Copy)]
pub(crate) struct Wendland;
#[derive(Clone, Copy)]
pub(crate) struct Gaussian {
    pub(crate) cut: f64,
}

#[inline(always)]
fn power<L: Lane>(t: L, exponent: usize) -> L {
    (1..exponent).fold(t, |product, _| product * t)
}

impl<const M: usize> Kernel for Poly<M> {
    fn end(self) -> f64 {
        1.0
    }
    #[inline(always)]
    fn theta<L: Lane>(self, s2: L) -> L {
        power((s2.like(1.0) - s2).max(s2.like(0.0)), M)
    }
    #[inline(always)]
    fn psi<L: Lane>(self, s2: L) -> L {
        power((s2.like(1.0) - s2).max(s2.like(0.0)), M - 1) * s2.like(-2.0 * M as f64)
    }
}

impl Kernel for Wendland {
    fn end(self) -> f64 {
        1.0
    }
    #[inline(always)]
    fn theta<L: Lane>(self, s2: L) -> L {
        let s = s2.sqrt();
        power((s2.like(1.0) - s).max(s2.like(0.0)), 4) * (s * s2.like(4.0) + s2.like(1.0))
    }
    #[inline(always)]
    fn psi<L: Lane>(self, s2: L) -> L {
        power((s2.like(1.0) - s2.sqrt()).max(s2.like(0.0)), 3) * s2.like(-20.0)
    }
}

impl Kernel for Gaussian {
    fn end(self) -> f64 {
        -self.cut.ln()
    }
    #[inline(always)]
    fn theta<L: Lane>(self, s2: L) -> L {
        let inside = s2.less(s2.like(self.end()));
        L::select(inside, exp_of_negative(-L::select(inside, s2, s2.like(0.0))), s2.like(0.0))
    }
    #[inline(always)]
    fn psi<L: Lane>(self, s2: L) -> L {
        self.theta(s2) * s2.like(-2.0)
    }
}

/// Runs `$body` with `$kernel` bound to the kernel of `$weight`: the only match over the weights in a batch.
macro_rules! with_kernel {
    ($weight:expr, $kernel:ident => $body:expr) => {
        match $weight {
            $crate::weight::Weight::Poly2 => {
                let $kernel = $crate::weight::Poly::<2>;
                $body
            }
            $crate::weight::Weight::Poly3 => {
                let $kernel = $crate::weight::Poly::<3>;
                $body
            }
            $crate::weight::Weight::Poly4 => {
                let $kernel = $crate::weight::Poly::<4>;
                $body
            }
            $crate::weight::Weight::Wendland => {
                let $kernel = $crate::weight::Wendland;
                $body
            }
            $crate::weight::Weight::Gaussian { cut } => {
                let $kernel = $crate::weight::Gaussian { cut };
                $body
            }
        }
    };
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
            let theta = |s: f64| with_kernel!(weight, k => k.theta(s * s));
            for i in 1..100 {
                let s = f64::from(i) / 100.0 * weight.reach();
                let step = 1e-5;
                if s + step >= weight.reach() {
                    continue;
                }
                let slope = (theta(s + step) - theta(s - step)) / (2.0 * step);
                let psi = with_kernel!(weight, k => k.psi(s * s));
                assert!((psi * s - slope).abs() < 1e-8, "{weight:?} at {s}: {} {slope}", psi * s);
            }
            // At a sample nothing divides by r.
            assert!(with_kernel!(weight, k => k.psi(0.0)).is_finite());
            assert_eq!(theta(0.0), 1.0);
        }
    }

    #[test]
    fn weights_end_at_their_reach() {
        for weight in ALL {
            let end = with_kernel!(weight, k => k.end());
            assert!((end - weight.reach().powi(2)).abs() < 1e-12 * end);
            assert!(with_kernel!(weight, k => k.theta(end * (1.0 - 1e-9))) > 0.0);
            assert_eq!(with_kernel!(weight, k => k.theta(end * (1.0 + 1e-9))), 0.0);
            assert_eq!(with_kernel!(weight, k => k.psi(end * 1.5)), 0.0);
        }
    }

    #[test]
    fn effective_shares_agree_with_sums_over_an_even_sampling() {
        for weight in ALL {
            for dimension in [2, 3] {
                let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
                let n = 400_i32;
                let across = if dimension == 3 { 5 * n } else { 0 };
                for i in -5 * n..=5 * n {
                    for j in (-across..=across).step_by(8) {
                        let s2 = f64::from(i * i + j * j) / f64::from(n * n);
                        let theta = with_kernel!(weight, k => k.theta(s2));
                        sum += theta;
                        squares += theta * theta;
                        count += f64::from(u8::from(s2 < 1.0));
                    }
                }
                let share = sum * sum / squares / count;
                let expected = weight.effective_share(dimension);
                assert!(
                    (share - expected).abs() < 0.01 * expected,
                    "{weight:?} {dimension}: {share} {expected}"
                );
            }
        }
    }
}
