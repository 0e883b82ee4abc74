//! Rays: what hits are, and that none is lost.

mod dense;
mod hits;
mod hostile;
mod options;
mod scan;
mod sheets;
mod without_loss;

use crate::common::{add, dot, length, scale, sub};
use footpoint::samples::Random;
use footpoint::{Ray, Surface};

/// Rays from far outside toward the neighbourhood of random samples, and as many that begin and end anywhere.
fn random_rays<const D: usize>(surface: &Surface<D>, count: usize, seed: u64) -> Vec<Ray<D>> {
    let mut random = Random::new(seed);
    let samples = surface.cloud().points();
    let h = surface.support().median;
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for p in samples {
        for k in 0..D {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let centre = scale(add(low, high), 0.5);
    let size = length(sub(high, low));
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let around: [f64; D] = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
        if dot(around, around) > 1.0 || dot(around, around) < 0.01 {
            continue;
        }
        let far = rays.len() % 4 != 0;
        let origin = add(centre, scale(around, if far { size / length(around) } else { 0.3 * size }));
        let sample = samples[(random.uniform() * samples.len() as f64) as usize];
        let target: [f64; D] = sample.map(|c| c + 1.5 * h * (2.0 * random.uniform() - 1.0));
        rays.push(Ray { origin, direction: sub(target, origin) });
    }
    rays
}
