//! Points of a case, what is true about them, and the supports that hold the neighbours wanted.

use crate::case::{Neighbours, Radii, Torus};
use footpoint::samples::{Random, torus};
use footpoint::{Cloud, Definition, Queries, Run, Support, Surface, Want};
use std::f64::consts::PI;

/// A cloud and the surface it was sampled from.
pub(crate) struct Sampled {
    pub(crate) points: Vec<[f64; 3]>,
    /// Of the places that were sampled, before the noise.
    pub(crate) normals: Vec<[f64; 3]>,
    torus: Torus,
}

/// Supports of a cloud: one radius, or one a sample with that as their middle.
#[derive(Clone)]
pub(crate) struct Supports {
    pub(crate) radius: f64,
    pub(crate) each: Option<Vec<f64>>,
}

/// Corrections of a radius; each brings the count ten times nearer at least.
const CORRECTIONS: usize = 5;

impl Sampled {
    pub(crate) fn new(data: &Torus) -> Self {
        let sampled = torus(data.major, data.minor, data.samples, data.seed);
        let normals = sampled.normals.clone();
        let points = sampled.with_noise(data.noise(), data.seed + 1).points;
        Self { points, normals, torus: data.clone() }
    }

    /// Distance of a point from the torus, negative inside, and the torus' normal there.
    pub(crate) fn truth(&self, [x, y, z]: [f64; 3]) -> (f64, [f64; 3]) {
        let ring = x.hypot(y);
        let outward = ring - self.torus.major;
        let length = outward.hypot(z);
        let across = outward / length / ring;
        (length - self.torus.minor, [x * across, y * across, z / length])
    }

    /// Supports with the mean count wanted.
    pub(crate) fn supports(&self, wanted: Neighbours, radii: Radii) -> Result<Supports, String> {
        // A sample is its own neighbour, the others fill a disc. Across the surface two samples differ by twice the
        // variance of the noise: the ball must be that much wider than the disc.
        let beyond = 2.0 * self.torus.noise().powi(2);
        let mut disc = (wanted.mean - 1.0) * self.torus.area_per_sample() / PI;
        for _ in 0..CORRECTIONS {
            let supports = self.spread((disc + beyond).sqrt(), radii);
            let count = self.mean_count(&supports)?;
            // Half the tolerance leaves room for a rival whose ball is closed.
            if (count - wanted.mean).abs() <= 0.5 * wanted.tolerance {
                return Ok(supports);
            }
            disc *= (wanted.mean - 1.0) / (count - 1.0);
        }
        Err(format!("no radius gives {} neighbours", wanted.mean))
    }

    fn spread(&self, radius: f64, radii: Radii) -> Supports {
        let each = match radii {
            Radii::Uniform => None,
            Radii::PerSample { spread, seed } => {
                let mut random = Random::new(seed);
                let mut one = |_: &_| radius * (1.0 + spread * (2.0 * random.uniform() - 1.0));
                Some(self.points.iter().map(&mut one).collect())
            }
        };
        Supports { radius, each }
    }

    fn mean_count(&self, supports: &Supports) -> Result<f64, String> {
        let definition = Definition::new().with_support(supports.rule());
        let surface = Surface::new(self.cloud(supports)?, definition).map_err(|e| e.to_string())?;
        Ok(mean_count(&surface))
    }

    /// The samples with their normals and, where they differ, their supports.
    pub(crate) fn cloud(&self, supports: &Supports) -> Result<Cloud<3>, String> {
        let cloud = Cloud::new(self.points.clone());
        match &supports.each {
            Some(each) => cloud.with_supports(each.clone()).map_err(|e| e.to_string()),
            None => Ok(cloud),
        }
    }
}

impl Supports {
    pub(crate) fn rule(&self) -> Support {
        if self.each.is_some() { Support::FromSamples } else { Support::Uniform(self.radius) }
    }
}

impl Torus {
    fn area_per_sample(&self) -> f64 {
        4.0 * PI * PI * self.major * self.minor / self.samples as f64
    }

    pub(crate) fn noise(&self) -> f64 {
        self.noise_in_spacings * self.area_per_sample().sqrt()
    }
}

/// Samples in the support, on average over the samples.
pub(crate) fn mean_count(surface: &Surface<3>) -> f64 {
    let run = Run::new().threads(1);
    let counts =
        surface.with(&run).evaluate(Queries::Samples, Want::NEIGHBOURS).unwrap_or_default().neighbours;
    counts.iter().map(|&count| f64::from(count)).sum::<f64>() / counts.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled() -> Sampled {
        Sampled::new(&Torus { major: 1.0, minor: 0.4, samples: 20_000, seed: 7, noise_in_spacings: 0.5 })
    }

    #[test]
    fn supports_hold_the_neighbours_wanted() {
        let sampled = sampled();
        for (mean, tolerance) in [(30.0, 0.5), (100.0, 1.0)] {
            for radii in [Radii::Uniform, Radii::PerSample { spread: 0.25, seed: 3 }] {
                let supports = sampled.supports(Neighbours { mean, tolerance }, radii).unwrap();
                let squares = (0..200).map(|i| {
                    let near = |(j, p): (usize, &[f64; 3])| {
                        let radius = supports.each.as_ref().map_or(supports.radius, |each| each[j]);
                        let q = sampled.points[i * 100];
                        (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>() < radius * radius
                    };
                    sampled.points.iter().enumerate().filter(|&pair| near(pair)).count() as f64
                });
                // 200 of the samples know the mean of all to a few hundredths.
                let counted = squares.sum::<f64>() / 200.0;
                assert!((counted - mean).abs() < 0.06 * mean, "{radii:?}: {counted} for {mean}");
            }
        }
    }

    #[test]
    fn the_truth_is_that_of_the_samples_without_noise() {
        let data = Torus { major: 1.0, minor: 0.4, samples: 100, seed: 7, noise_in_spacings: 0.0 };
        let sampled = Sampled::new(&data);
        for (point, normal) in sampled.points.iter().zip(&sampled.normals) {
            let (distance, true_normal) = sampled.truth(*point);
            assert!(distance.abs() < 1e-14);
            assert!((0..3).all(|k| (normal[k] - true_normal[k]).abs() < 1e-14));
        }
    }
}
