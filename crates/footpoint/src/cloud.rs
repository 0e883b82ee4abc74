//! Samples with optional normals, supports, factors and noise.

use crate::algebra::direction;
use crate::noise::{Noise, NoiseError};

/// Samples p_i, with optional unit normals n_i, support radii h_i, factors ω_i (SPEC § 1) and noise.
///
/// Columns are kept in the order given. Normals are rescaled to unit length on entry; a normal that is zero or not
/// finite counts as absent for its sample. A sample with a coordinate or factor that is not finite, or a factor of
/// zero, counts as absent altogether; so does one whose support is zero or not finite, where supports are used.
#[derive(Clone, Debug, Default)]
pub struct Cloud<const D: usize> {
    points: Vec<[f64; D]>,
    normals: Option<Vec<[f64; D]>>,
    supports: Option<Vec<f64>>,
    factors: Option<Vec<f64>>,
    noise: Option<Noise<D>>,
}

/// A column that does not fit its cloud.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// A column has another length than the points.
    #[error("{column}: {found} values for {expected} points")]
    Length {
        /// Which column.
        column: &'static str,
        /// Number of points.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// A support or factor is negative.
    #[error("{column} of sample {index} is {value}: it must be positive")]
    Negative {
        /// Which column.
        column: &'static str,
        /// Position of the sample, from 0.
        index: usize,
        /// The value found.
        value: f64,
    },
    /// More samples than a 32-bit index counts.
    #[error("{0} samples: at most 4294967295 can be indexed; split the cloud")]
    TooMany(usize),
}

impl<const D: usize> Cloud<D> {
    /// A cloud of bare points, D = 2 or 3, in any unit of length.
    pub fn new(points: impl Into<Vec<[f64; D]>>) -> Self {
        Self { points: points.into(), normals: None, supports: None, factors: None, noise: None }
    }

    /// Adds normals, one a sample; they need not have unit length.
    pub fn with_normals(mut self, normals: impl Into<Vec<[f64; D]>>) -> Result<Self, CloudError> {
        let mut normals = normals.into();
        self.check_length("normals", normals.len())?;
        for normal in &mut normals {
            *normal = direction(*normal);
        }
        self.normals = Some(normals);
        Ok(self)
    }

    /// Adds support radii h_i, one a sample, in the unit of the coordinates: for [`Support::FromSamples`].
    ///
    /// [`Support::FromSamples`]: crate::Support::FromSamples
    pub fn with_supports(mut self, supports: impl Into<Vec<f64>>) -> Result<Self, CloudError> {
        self.supports = Some(self.checked_positive("support", supports.into())?);
        Ok(self)
    }

    /// Adds factors ω_i (area, confidence), one a sample: they multiply the weights.
    pub fn with_factors(mut self, factors: impl Into<Vec<f64>>) -> Result<Self, CloudError> {
        self.factors = Some(self.checked_positive("factor", factors.into())?);
        Ok(self)
    }

    /// Says how noisy the positions are: for uncertainties; the surface does not depend on it.
    pub fn with_noise(mut self, noise: Noise<D>) -> Result<Self, NoiseError> {
        noise.check(self.len())?;
        self.noise = Some(noise);
        Ok(self)
    }

    /// Some of the samples, with their normals and factors.
    pub(crate) fn select(&self, rows: &[usize]) -> Self {
        let mut part = Self::new(rows.iter().map(|&i| self.points[i]).collect::<Vec<_>>());
        part.normals = self.normals.as_ref().map(|normals| rows.iter().map(|&i| normals[i]).collect());
        part.factors = self.factors.as_ref().map(|factors| rows.iter().map(|&i| factors[i]).collect());
        part
    }

    /// Number of samples, absent ones included.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The coordinates, as given.
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// Unit normals; NaN where a sample has none.
    pub fn normals(&self) -> Option<&[[f64; D]]> {
        self.normals.as_deref()
    }

    /// Support radii, as given.
    pub fn supports(&self) -> Option<&[f64]> {
        self.supports.as_deref()
    }

    /// Factors, as given.
    pub fn factors(&self) -> Option<&[f64]> {
        self.factors.as_deref()
    }

    /// The noise of the positions, if it is known.
    pub fn noise(&self) -> Option<&Noise<D>> {
        self.noise.as_ref()
    }

    /// How many samples lack a usable normal; all of them without a column of normals.
    pub fn absent_normals(&self) -> usize {
        self.normals.as_ref().map_or(self.len(), |n| n.iter().filter(|n| n[0].is_nan()).count())
    }

    /// Whether sample `i` takes part: finite coordinates and a positive factor.
    pub(crate) fn is_present(&self, i: usize) -> bool {
        let usable = |x: f64| x > 0.0 && x.is_finite();
        self.points[i].iter().all(|c| c.is_finite()) && self.factors.as_ref().is_none_or(|f| usable(f[i]))
    }

    fn check_length(&self, column: &'static str, found: usize) -> Result<(), CloudError> {
        let expected = self.points.len();
        if found == expected { Ok(()) } else { Err(CloudError::Length { column, expected, found }) }
    }

    fn checked_positive(&self, column: &'static str, values: Vec<f64>) -> Result<Vec<f64>, CloudError> {
        self.check_length(column, values.len())?;
        match values.iter().position(|&v| v < 0.0) {
            Some(index) => Err(CloudError::Negative { column, index, value: values[index] }),
            None => Ok(values),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_rescaled_and_unusable_ones_count_as_absent() {
        let normals = [[0.0, 0.0, 2e-200], [0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]];
        let cloud = Cloud::new([[0.0; 3]; 4]).with_normals(normals).unwrap();
        assert_eq!(cloud.normals().unwrap()[0], [0.0, 0.0, 1.0]);
        assert_eq!(cloud.absent_normals(), 3);
    }

    #[test]
    fn columns_that_do_not_fit_are_refused_by_name() {
        let cloud = || Cloud::new([[0.0, 0.0], [1.0, 0.0]]);
        assert_eq!(
            cloud().with_normals([[1.0, 0.0]]).unwrap_err().to_string(),
            "normals: 1 values for 2 points"
        );
        assert_eq!(
            cloud().with_factors([1.0, -2.0]).unwrap_err().to_string(),
            "factor of sample 1 is -2: it must be positive"
        );
        assert!(cloud().with_supports([1.0, f64::NAN]).is_ok());
    }
}
