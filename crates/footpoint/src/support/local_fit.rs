//! The surface near one point by its weighted mean and by a quadratic, and what noise does to both.

use crate::algebra::{Matrix, Vector, add_scaled, dot, length, mirror, scale, tangential};
use crate::eigen::{pseudo_inverse, smallest};
use crate::weight::{Kernel, Weight, with_kernel};

/// A distinct point: its way from the point asked about in units of h, and the factors of its samples together.
pub(super) type Neighbour<const D: usize> = ([f64; D], f64);

/// The frame of centred covariance at a point, lengths in units of h (SPEC § 3).
pub(super) struct Frame<const D: usize> {
    /// ωθ of each neighbour.
    weights: Vec<f64>,
    sum: f64,
    /// a(x) − x.
    aside: [f64; D],
    pub(super) normal: [f64; D],
    pub(super) value: f64,
    gap: f64,
    /// n·∇f.
    alignment: f64,
}

/// Heights over the frame, in units of h: how the weighted mean and a quadratic differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadratic {
    /// The quadratic's height minus the mean's: the mean's bias, and noise.
    pub(super) difference: f64,
    /// Variance of that difference, and of the mean, for noise of variance 1 in every distinct point.
    pub(super) difference_variance: f64,
    pub(super) mean_variance: f64,
    /// Variance of the points about the quadratic.
    pub(super) noise: f64,
}

/// Monomials of degree 2 in two variables; three of them in one.
const MONOMIALS: usize = 6;

/// A pivot smaller than this share of the largest diagonal element means that the points do not determine a quadratic.
const SINGULAR: f64 = 1e-9;

impl<const D: usize> Frame<D> {
    /// `None` where no neighbour has weight.
    pub(super) fn fit(neighbours: &[Neighbour<D>], weight: Weight) -> Option<Self> {
        with_kernel!(weight, kernel => Self::fit_with(kernel, neighbours))
    }

    fn fit_with(kernel: impl Kernel, neighbours: &[Neighbour<D>]) -> Option<Self> {
        let mut weights = Vec::with_capacity(neighbours.len());
        let (mut sum, mut first, mut second) = (0.0, [0.0; D], [[0.0; D]; D]);
        for &(d, factor) in neighbours {
            let w: f64 = factor * kernel.theta(kernel.closeness(squared(d)));
            weights.push(w);
            sum += w;
            for i in 0..D {
                let weighted = w * d[i];
                first[i] += weighted;
                for j in i..D {
                    second[i][j] += weighted * d[j];
                }
            }
        }
        if sum.is_nan() || sum <= 0.0 {
            return None;
        }
        let aside: Vector<f64, D> = scale(first, 1.0 / sum);
        let mut matrix: Matrix<f64, D> = mirror(second);
        for i in 0..D {
            for j in 0..D {
                matrix[i][j] = matrix[i][j] / sum - aside[i] * aside[j];
            }
        }
        let pair = smallest(matrix);
        let normal = pair.vector;
        let value = -dot(normal, aside);
        let turn = pseudo_inverse(matrix, pair.values[0], normal, aside);
        // n·∇f of SPEC § 4, with the derivative of n contracted as in § 10.
        let mut slope = 0.0;
        for &(d, factor) in neighbours {
            let psi: f64 = factor * kernel.psi(kernel.closeness(squared(d)));
            let height = dot(normal, d);
            slope += psi * height * (height + value) * (1.0 + dot(turn, aside) - dot(turn, d));
        }
        let gap = (pair.values[1] - pair.values[0]) / pair.values[D - 1];
        Some(Self { weights, sum, aside, normal, value, gap, alignment: 1.0 + slope / sum })
    }

    /// The rule of SPEC § 8 with its usual limits.
    pub(super) fn is_accepted(&self, boundary_limit: f64) -> bool {
        self.gap >= 0.1
            && self.alignment >= 0.3
            && length(tangential(self.aside, self.normal)) <= boundary_limit
    }

    /// `None` where the points do not determine a quadratic.
    pub(super) fn quadratic(&self, neighbours: &[Neighbour<D>]) -> Option<Quadratic> {
        let axes = tangents(self.normal);
        let count = if D == 2 { 3 } else { MONOMIALS };
        // A = Σwφφᵀ, B = Σw²φφᵀ, b = Σwφz.
        let (mut a, mut b2) = ([[0.0; MONOMIALS]; MONOMIALS], [[0.0; MONOMIALS]; MONOMIALS]);
        let (mut b, mut heights) = ([0.0; MONOMIALS], 0.0);
        for (&(d, _), &w) in neighbours.iter().zip(&self.weights) {
            let phi = monomials::<D>(dot(axes[0], d), dot(axes[1], d));
            let z = dot(self.normal, d);
            heights += w * z * z;
            for i in 0..count {
                let weighted = w * phi[i];
                b[i] += weighted * z;
                for j in 0..=i {
                    a[i][j] += weighted * phi[j];
                    b2[i][j] += w * weighted * phi[j];
                }
            }
        }
        for i in 0..count {
            for j in 0..i {
                b2[j][i] = b2[i][j];
            }
        }
        let factor = Factor::of(a, count)?;
        let coefficients = factor.solve(b);
        let at_zero = factor.solve(std::array::from_fn(|i| if i == 0 { 1.0 } else { 0.0 }));
        let leverage: f64 = (0..count).map(|i| factor.solve(b2[i])[i]).sum();
        let explained: f64 = (0..count).map(|i| coefficients[i] * b[i]).sum();
        let product = |row: usize| -> f64 { (0..count).map(|j| b2[row][j] * at_zero[j]).sum() };
        let quadratic_variance: f64 = (0..count).map(|i| at_zero[i] * product(i)).sum();
        let mean_variance = b2[0][0] / (self.sum * self.sum);
        // E Σwρ² = σ²(Σw − tr A⁻¹B).
        let noise = (heights - explained).max(0.0) / (self.sum - leverage);
        let known = self.sum - leverage > 1e-6 * self.sum;
        known.then_some(Quadratic {
            difference: coefficients[0] - dot(self.normal, self.aside),
            difference_variance: quadratic_variance - 2.0 * product(0) / self.sum + mean_variance,
            mean_variance,
            noise,
        })
    }
}

fn squared<const D: usize>(d: [f64; D]) -> f64 {
    d.iter().map(|c| c * c).sum()
}

/// Unit vectors across n; the second is zero in the plane.
fn tangents<const D: usize>(n: [f64; D]) -> [[f64; D]; 2] {
    let mut axes = [[0.0; D]; 2];
    if D == 2 {
        (axes[0][0], axes[0][1]) = (-n[1], n[0]);
        return axes;
    }
    // The axis most across n, made orthogonal to it, and their cross product.
    let least = (1..D).fold(0, |least, k| if n[k].abs() < n[least].abs() { k } else { least });
    axes[0][least] = 1.0;
    let across = add_scaled(axes[0], n, -n[least]);
    axes[0] = scale(across, 1.0 / squared(across).sqrt());
    for k in 0..D {
        let (i, j) = ((k + 1) % D, (k + 2) % D);
        axes[1][k] = n[i] * axes[0][j] - n[j] * axes[0][i];
    }
    axes
}

fn monomials<const D: usize>(s: f64, t: f64) -> [f64; MONOMIALS] {
    if D == 2 { [1.0, s, s * s, 0.0, 0.0, 0.0] } else { [1.0, s, t, s * s, s * t, t * t] }
}

/// Cholesky's factor of a symmetric positive definite matrix given by its lower triangle.
struct Factor {
    lower: [[f64; MONOMIALS]; MONOMIALS],
    count: usize,
}

impl Factor {
    fn of(mut a: [[f64; MONOMIALS]; MONOMIALS], count: usize) -> Option<Self> {
        let largest = (0..count).fold(0.0_f64, |largest, i| largest.max(a[i][i]));
        for j in 0..count {
            for k in 0..j {
                let factor = a[j][k];
                for i in j..count {
                    a[i][j] -= a[i][k] * factor;
                }
            }
            if a[j][j].is_nan() || a[j][j] <= SINGULAR * largest {
                return None;
            }
            let root = a[j][j].sqrt();
            for i in j..count {
                a[i][j] /= root;
            }
        }
        Some(Self { lower: a, count })
    }

    fn solve(&self, mut b: [f64; MONOMIALS]) -> [f64; MONOMIALS] {
        let Self { lower, count } = self;
        for i in 0..*count {
            for k in 0..i {
                b[i] -= lower[i][k] * b[k];
            }
            b[i] /= lower[i][i];
        }
        for i in (0..*count).rev() {
            for k in i + 1..*count {
                b[i] -= lower[k][i] * b[k];
            }
            b[i] /= lower[i][i];
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Random;

    /// Points of the graph z = κ (s² + t²)/2 with noise, seen from its lowest point.
    fn bowl(curvature: f64, noise: f64, count: usize, seed: u64) -> Vec<Neighbour<3>> {
        let mut random = Random::new(seed);
        let mut coordinate = || 2.0 * random.uniform() - 1.0;
        let flat: Vec<[f64; 2]> = (0..count).map(|_| [coordinate(), coordinate()]).collect();
        let height = |s: f64, t: f64| 0.5 * curvature * (s * s + t * t);
        flat.iter().map(|&[s, t]| ([s, t, height(s, t) + noise * random.normal()], 1.0)).collect()
    }

    #[test]
    fn the_difference_is_the_bias_and_the_residual_the_noise() {
        let quadratic = |curvature: f64, noise: f64| {
            let bowl = bowl(curvature, noise, 4000, 3);
            Frame::fit(&bowl, Weight::Poly3).and_then(|frame| frame.quadratic(&bowl)).unwrap()
        };
        let clean = quadratic(0.2, 0.0);
        // κ_H h²/(2(m + 2)) of SPEC § 11.
        assert!((clean.difference.abs() / 0.02 - 1.0).abs() < 0.05, "{clean:?}");
        assert!(clean.noise < 1e-4, "{clean:?}");
        let noisy = quadratic(0.0, 0.02);
        assert!((noisy.noise.sqrt() / 0.02 - 1.0).abs() < 0.05, "{noisy:?}");
    }

    #[test]
    fn variances_are_those_of_repeated_draws() {
        let draws: Vec<(f64, Quadratic)> = (0..600)
            .map(|seed| {
                let mut points = bowl(0.0, 0.0, 40, 7);
                let mut random = Random::new(seed);
                points.iter_mut().for_each(|(d, _)| d[2] = 0.001 * random.normal());
                let frame = Frame::fit(&points, Weight::Poly3).unwrap();
                let normal_up = frame.normal[2].signum();
                (normal_up * frame.value, frame.quadratic(&points).unwrap())
            })
            .collect();
        let mean = |of: &dyn Fn(&(f64, Quadratic)) -> f64| draws.iter().map(of).sum::<f64>() / 600.0;
        let differences =
            mean(&|(_, q)| q.difference * q.difference) / mean(&|(_, q)| 1e-6 * q.difference_variance);
        let means = mean(&|(f, _)| f * f) / mean(&|(_, q)| 1e-6 * q.mean_variance);
        println!("measured over expected variance: difference {differences:.3}, mean {means:.3}");
        assert!((differences - 1.0).abs() < 0.2 && (means - 1.0).abs() < 0.3);
    }
}
