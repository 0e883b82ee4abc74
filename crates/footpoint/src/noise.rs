//! Noise of positions: how far samples may lie from where they were measured.

use crate::algebra::{Matrix, Vector, dot};

/// Standard deviations of positions, lengths in the unit of the coordinates: what uncertainties are computed from
/// (SPEC § 10). Positions are independent of each other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Noise<const D: usize> {
    /// One figure for every axis of every position.
    Uniform(f64),
    /// One figure a position, for every axis.
    Each(Vec<f64>),
    /// One covariance a position, squares of lengths: symmetric and positive semidefinite.
    Covariances(Vec<[[f64; D]; D]>),
}

/// Noise that makes no sense or does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoiseError {
    /// Another number of figures than positions.
    #[error("noise: {found} values for {expected} points")]
    Length {
        /// Number of positions.
        expected: usize,
        /// Number of figures given.
        found: usize,
    },
    /// A figure that is negative or not finite, or a covariance that is not symmetric and positive semidefinite.
    #[error(
        "noise of point {index}: it must be finite and not negative, a covariance symmetric and semidefinite"
    )]
    Value {
        /// Position, from 0.
        index: usize,
    },
}

impl<const D: usize> Noise<D> {
    /// Fails where it does not fit this many positions.
    pub(crate) fn check(&self, expected: usize) -> Result<(), NoiseError> {
        let usable = |sigma: &f64| *sigma >= 0.0 && sigma.is_finite();
        let (found, wrong) = match self {
            Self::Uniform(sigma) => (expected, (!usable(sigma)).then_some(0)),
            Self::Each(sigmas) => (sigmas.len(), sigmas.iter().position(|s| !usable(s))),
            Self::Covariances(matrices) => (matrices.len(), matrices.iter().position(|m| !is_covariance(m))),
        };
        if found != expected {
            return Err(NoiseError::Length { expected, found });
        }
        wrong.map_or(Ok(()), |index| Err(NoiseError::Value { index }))
    }

    /// vᵀ C v for the covariance of one position.
    pub(crate) fn variance(&self, i: usize, v: Vector<f64, D>) -> f64 {
        match self {
            Self::Uniform(sigma) => sigma * sigma * dot(v, v),
            Self::Each(sigmas) => sigmas[i] * sigmas[i] * dot(v, v),
            Self::Covariances(matrices) => dot(v, matrices[i].map(|row| dot(row, v))),
        }
    }

    /// Columns for the sums, one figure a position: none for one figure, one of variances, or the upper triangle of the covariances
    /// row by row. `unit` is that of the sums.
    pub(crate) fn columns(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Each(_) => 1,
            Self::Covariances(_) => D * (D + 1) / 2,
        }
    }

    /// One number of one of these columns.
    pub(crate) fn entry(&self, i: usize, column: usize) -> f64 {
        match self {
            Self::Uniform(sigma) => sigma * sigma,
            Self::Each(sigmas) => sigmas[i] * sigmas[i],
            Self::Covariances(matrices) => {
                let (row, k) = upper::<D>(column);
                matrices[i][row][k]
            }
        }
    }
}

/// Row and column of an entry of the upper triangle.
fn upper<const D: usize>(mut entry: usize) -> (usize, usize) {
    let mut row = 0;
    while entry >= D - row {
        entry -= D - row;
        row += 1;
    }
    (row, row + entry)
}

/// Whether the matrix is symmetric, finite and positive semidefinite up to rounding.
fn is_covariance<const D: usize>(m: &Matrix<f64, D>) -> bool {
    let trace = (0..D).map(|k| m[k][k]).sum::<f64>();
    let slack = 1e-9 * trace;
    if !trace.is_finite() || !(0..D).all(|k| m[k][k] >= 0.0) {
        return false;
    }
    let pair = |i: usize, k: usize| {
        let off = m[i][k];
        (off - m[k][i]).abs() <= slack && off * off <= m[i][i] * m[k][k] + slack * slack
    };
    let pairs = (0..D).all(|i| (i + 1..D).all(|k| pair(i, k)));
    let last = D - 1;
    let determinant = m[0][0] * (m[1][1] * m[last][last] - m[1][last] * m[1][last])
        - m[0][1] * (m[0][1] * m[last][last] - m[1][last] * m[0][last])
        + m[0][last] * (m[0][1] * m[1][last] - m[1][1] * m[0][last]);
    pairs && (D == 2 || determinant >= -slack * trace * trace)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_that_does_not_fit_is_refused() {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
        assert!(Noise::Covariances(vec![identity; 2]).check(2).is_ok());
        assert_eq!(Noise::<3>::Each(vec![1.0]).check(2), Err(NoiseError::Length { expected: 2, found: 1 }));
        for wrong in [f64::NAN, -1.0, f64::INFINITY] {
            assert_eq!(Noise::<3>::Each(vec![0.0, wrong]).check(2), Err(NoiseError::Value { index: 1 }));
            assert!(Noise::<2>::Uniform(wrong).check(7).is_err());
        }
        // Not symmetric, not semidefinite in a pair, not semidefinite as a whole.
        for wrong in [
            [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1.0, -0.9, -0.9], [-0.9, 1.0, -0.9], [-0.9, -0.9, 1.0]],
        ] {
            assert_eq!(Noise::Covariances(vec![wrong]).check(1), Err(NoiseError::Value { index: 0 }));
        }
    }

    #[test]
    fn the_three_forms_of_one_noise_agree() {
        let v = [0.3, -0.5, 0.7];
        let diagonal = std::array::from_fn(|i| std::array::from_fn(|k| if i == k { 0.04 } else { 0.0 }));
        let forms = [Noise::Uniform(0.2), Noise::Each(vec![0.2]), Noise::Covariances(vec![diagonal])];
        for form in &forms {
            assert!((form.variance(0, v) - 0.04 * dot(v, v)).abs() < 1e-16);
        }
        assert_eq!(forms.map(|f| f.columns()), [0, 1, 6]);
        let full = Noise::Covariances(vec![[[1.0, 2.0, 3.0], [2.0, 5.0, 6.0], [3.0, 6.0, 9.0]]]);
        assert_eq!(std::array::from_fn(|c| full.entry(0, c)), [1.0, 2.0, 3.0, 5.0, 6.0, 9.0]);
    }
}
