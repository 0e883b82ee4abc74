//! What the report says of distances: their distribution, and how many are significant.

use super::Changes;
use crate::numbers::Sorted;
use footpoint::Comparison;
use serde::Serialize;

/// Percentages at which quantiles are told.
const PERCENT: [u8; 6] = [1, 5, 25, 75, 95, 99];
/// Bars of the histogram: odd, so that one stands around 0.
const BARS: usize = 21;
/// A distance of more standard deviations is significant.
const SIGNIFICANT: f64 = 2.0;

/// How distances are distributed, over the points that are *ok*. Lengths are in the unit of the files; null where no point has an
/// answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceReport {
    /// Whether distances have a sign: positive on the side that the cloud's normals point to.
    pub signed: bool,
    /// Points with a distance.
    pub answered: usize,
    /// How many of them lay too far off for the projection, and were reached along the surface.
    pub walked: usize,
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Standard deviation about the mean.
    pub standard_deviation: f64,
    /// Median.
    pub median: f64,
    /// Median of their magnitudes.
    pub median_magnitude: f64,
    /// Smallest.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
    /// Quantiles at 1, 5, 25, 75, 95 and 99 %.
    pub quantiles: Vec<Quantile>,
    /// Mean of what curvature makes of the distances of points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_bias: Option<f64>,
    /// Median standard deviation of a distance, where there is noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub median_sigma: Option<f64>,
    /// Share of the points whose distance is more than two standard deviations from 0, where there is noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_beyond_two_sigma: Option<f64>,
    /// Median level of detection, 1.96 standard deviations, between surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level_of_detection: Option<f64>,
    /// Points whose distance is larger than their own level of detection, between surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significant: Option<usize>,
    /// Points that are not *ok* and have a distance all the same, without sigma; no other number here knows them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_sigma: Option<usize>,
    /// The radii that were compared, and for how many points each knew most.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<SupportShare>,
    /// Noise of the points, where it was estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub query_noise: Option<f64>,
    /// How many points have which distance.
    pub histogram: Histogram,
    /// The distances at the ends of the colours, where these were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour_range: Option<[f64; 2]>,
}

/// One support among several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SupportShare {
    /// Its radius.
    pub radius: f64,
    /// Points that it answered for.
    pub points: usize,
}

/// One quantile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantile {
    /// Share of the points below it.
    pub percent: u8,
    /// A length.
    pub value: f64,
}

/// Counts over equal ranges.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Histogram {
    /// Where the first bar begins.
    pub low: f64,
    /// Where the last bar ends.
    pub high: f64,
    /// Points of each bar.
    pub counts: Vec<usize>,
    /// Points below the first.
    pub below: usize,
    /// Points above the last.
    pub above: usize,
}

/// Distances with the standard deviation and the bias of each; NaN where there is no answer.
pub(super) struct Found<'f> {
    pub(super) distance: &'f [f64],
    /// None without noise.
    pub(super) sigma: Option<&'f [f64]>,
    /// None between surfaces.
    pub(super) bias: Option<&'f [f64]>,
}

impl DistanceReport {
    pub(super) fn of(found: &Found<'_>, signed: bool, walked: usize) -> Self {
        let distances = Sorted::of(found.distance.iter().copied());
        let mean = distances.mean(|d| d);
        let beyond = |sigma: &[f64]| {
            let pairs = found.distance.iter().zip(sigma);
            pairs.filter(|(d, sigma)| d.abs() > SIGNIFICANT * **sigma).count() as f64
                / distances.count() as f64
        };
        Self {
            signed,
            answered: distances.count(),
            walked,
            mean,
            rms: distances.rms(),
            standard_deviation: distances.mean(|d| (d - mean) * (d - mean)).sqrt(),
            median: distances.quantile(0.5),
            median_magnitude: Sorted::of(found.distance.iter().map(|d| d.abs())).quantile(0.5),
            smallest: distances.quantile(0.0),
            largest: distances.quantile(1.0),
            quantiles: PERCENT
                .iter()
                .map(|&percent| Quantile { percent, value: distances.quantile(f64::from(percent) / 100.0) })
                .collect(),
            mean_bias: found.bias.map(|bias| Sorted::of(bias.iter().copied()).mean(|b| b)),
            median_sigma: found.sigma.map(|sigma| Sorted::of(sigma.iter().copied()).quantile(0.5)),
            share_beyond_two_sigma: found.sigma.map(beyond),
            level_of_detection: None,
            significant: None,
            without_sigma: None,
            supports: Vec::new(),
            query_noise: None,
            histogram: Histogram::of(&distances, signed),
            colour_range: None,
        }
    }

    /// The same for distances between surfaces.
    pub(super) fn of_changes<const D: usize>(changes: &Changes<D>, signed: bool) -> Self {
        let found = &changes.found;
        let ok = |row: usize| found.status[row].is_ok();
        let rows = 0..found.status.len();
        let distances: Vec<f64> =
            rows.clone().map(|row| if ok(row) { found.distance[row] } else { f64::NAN }).collect();
        let sigma = Sorted::of(found.sigma.iter().copied());
        let mut radii: Vec<f64> = found.support.iter().copied().filter(|h| h.is_finite()).collect();
        radii.sort_unstable_by(f64::total_cmp);
        let supports =
            radii.chunk_by(|a, b| a == b).map(|same| SupportShare { radius: same[0], points: same.len() });
        let sum = Found { distance: &distances, sigma: Some(&found.sigma), bias: None };
        Self {
            level_of_detection: Some(Comparison::LEVEL * sigma.quantile(0.5)),
            significant: Some(rows.clone().filter(|&row| changes.is_significant(row)).count()),
            without_sigma: Some(rows.filter(|&row| !ok(row) && found.distance[row].is_finite()).count()),
            supports: supports.collect(),
            ..Self::of(&sum, signed, changes.walked)
        }
    }
}

impl Histogram {
    /// Without the hundredths furthest out, symmetric about 0 for distances with a sign, from 0 on for those without.
    fn of(distances: &Sorted, signed: bool) -> Self {
        let reach = |beyond: f64| {
            let [low, high] = [beyond, 1.0 - beyond].map(|share| distances.quantile(share));
            if signed { low.abs().max(high.abs()) } else { high }
        };
        // Where nearly all are 0 the rest decides.
        let reach = if reach(0.01) > 0.0 { reach(0.01) } else { reach(0.0) };
        let [low, high] = [if signed { -reach } else { 0.0 }, reach];
        let mut histogram = Self { low, high, counts: vec![0; BARS], below: 0, above: 0 };
        for &distance in distances.values() {
            if distance < low {
                histogram.below += 1;
            } else if distance > high {
                histogram.above += 1;
            } else {
                // Where all are alike the middle has them all.
                let share = if high > low { (distance - low) / (high - low) } else { 0.5 };
                histogram.counts[((share * BARS as f64) as usize).min(BARS - 1)] += 1;
            }
        }
        histogram
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(distances: &[f64], signed: bool) -> Histogram {
        Histogram::of(&Sorted::of(distances.iter().copied()), signed)
    }

    #[test]
    fn a_histogram_counts_everything_once() {
        let distances: Vec<f64> = (0..=1000).map(|i| f64::from(i) / 1000.0 - 0.3).collect();
        let signed = histogram(&distances, true);
        assert!((signed.high - 0.69).abs() < 1e-12 && signed.low == -signed.high, "{signed:?}");
        assert_eq!((signed.below, signed.above), (0, 10));
        assert_eq!(signed.counts.iter().sum::<usize>() + 10, 1001);
        // From -0.69 to -0.3 there is nothing.
        assert!(signed.counts[..5].iter().all(|&c| c == 0) && signed.counts[10] > 0, "{signed:?}");
        let same = histogram(&[0.0; 7], true);
        assert_eq!((same.counts[10], same.low, same.high), (7, 0.0, 0.0));
        let mut few = [0.0; 1000];
        few[3] = 0.2;
        assert_eq!(histogram(&few, false).high, 0.2);
        let unsigned = histogram(&[0.5; 7], false);
        assert_eq!((unsigned.low, unsigned.high, unsigned.counts[20]), (0.0, 0.5, 7));
        assert_eq!(histogram(&[], true).counts, [0; 21]);
    }

    #[test]
    fn significance_is_counted_among_the_answers() {
        let found = Found {
            distance: &[0.1, -0.3, f64::NAN, 0.0],
            sigma: Some(&[0.1, 0.1, f64::NAN, 0.1]),
            bias: Some(&[0.01, 0.02, f64::NAN, 0.03]),
        };
        let report = DistanceReport::of(&found, true, 0);
        assert_eq!((report.answered, report.share_beyond_two_sigma), (3, Some(1.0 / 3.0)));
        assert_eq!(report.median_sigma, Some(0.1));
        assert!((report.mean + 0.2 / 3.0).abs() < 1e-15 && (report.mean_bias.unwrap() - 0.02).abs() < 1e-15);
        let variance = report.rms.powi(2) - report.mean.powi(2);
        assert!((report.standard_deviation.powi(2) - variance).abs() < 1e-15);
        assert_eq!(
            (report.smallest, report.median, report.largest, report.median_magnitude),
            (-0.3, 0.0, 0.1, 0.1)
        );
    }
}
