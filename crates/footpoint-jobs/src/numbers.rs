//! What reports say of many numbers: quantiles, means.

/// Finite numbers in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sorted(Vec<f64>);

impl Sorted {
    /// Those that are finite.
    pub(crate) fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = numbers.into_iter().filter(|v| v.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        Self(sorted)
    }

    pub(crate) fn values(&self) -> &[f64] {
        &self.0
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// The number below which this share lies, linear between the two nearest: 0 the smallest, 0.5 the median, 1 the
    /// largest. NaN where there is none.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        let place = share * self.count().saturating_sub(1) as f64;
        let (below, part) = (place.floor() as usize, place.fract());
        match (self.0.get(below), self.0.get(below + 1)) {
            (Some(low), Some(high)) => low + part * (high - low),
            (low, _) => low.copied().unwrap_or(f64::NAN),
        }
    }

    /// The mean of what `of` makes of the numbers; NaN where there is none.
    pub(crate) fn mean(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.0.iter().map(|&v| of(v)).sum::<f64>() / self.count() as f64
    }

    /// The root mean square; NaN where there is none.
    pub(crate) fn rms(&self) -> f64 {
        self.mean(|v| v * v).sqrt()
    }
}

/// The median of those that are not NaN.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| !v.is_nan());
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_the_nearest_two() {
        let sorted = Sorted::of([4.0, f64::NAN, 1.0, 2.0, f64::INFINITY, 3.0]);
        assert_eq!([0.0, 0.5, 0.9, 1.0].map(|share| sorted.quantile(share)), [1.0, 2.5, 3.7, 4.0]);
        assert_eq!((sorted.mean(|v| v), sorted.rms()), (2.5, 7.5_f64.sqrt()));
        assert_eq!(Sorted::of([7.0]).quantile(0.3), 7.0);
        let none = Sorted::default();
        assert!(none.quantile(0.5).is_nan() && none.rms().is_nan());
    }
}
