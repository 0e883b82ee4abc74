//! Ambient occlusion: which share of the sky a point of the surface sees.

use crate::picture::MOST_RAYS;
use crate::shading::Seen;
use crate::vector::{add_scaled, scale, tangents};
use footpoint::{Cancelled, Cast, Ray, Running, Sought};
use std::f64::consts::TAU;

/// How occlusion is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occlusion {
    /// Rays from every point that is seen; 16 with 4 samples a pixel is smooth.
    pub rays: usize,
    /// What is further away than this hides nothing, a length.
    pub reach: f64,
}

/// How far off the surface rays begin, in supports: nearer, the surface's own bends would hide it.
const OFF: f64 = 0.25;
/// The golden ratio's part, whose multiples spread evenly in a circle.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// For every point the share of the rays of a cosine-weighted half space that meets nothing. Directions depend on the point's
/// number in the picture alone.
pub(crate) fn open(
    running: &Running<'_, 3>,
    support: f64,
    how: &Occlusion,
    seen: &[Seen],
) -> Result<Vec<f64>, Cancelled> {
    let count = how.rays.max(1);
    let cast = Cast::new().with_sought(Sought::Any).with_tolerance(1e-3).with_range(0.0..how.reach);
    let mut shares = Vec::with_capacity(seen.len());
    for some in seen.chunks((MOST_RAYS / count).max(1)) {
        let mut rays = Vec::with_capacity(some.len() * count);
        for point in some {
            let [a, b] = tangents(point.normal);
            let origin = add_scaled(point.point, point.normal, OFF * support);
            let turn = (point.number as f64 * GOLDEN).fract();
            for k in 0..count {
                let (u, v) = ((k as f64 + 0.5) / count as f64, (k as f64 * GOLDEN + turn).fract());
                let ((sine, cosine), across) = ((TAU * v).sin_cos(), u.sqrt());
                let direction = add_scaled(scale(point.normal, (1.0 - u).sqrt()), a, across * cosine);
                rays.push(Ray { origin, direction: add_scaled(direction, b, across * sine) });
            }
        }
        let hits = running.cast(&rays, &cast)?;
        shares.extend(hits.status.chunks(count).map(|statuses| {
            1.0 - statuses.iter().filter(|status| status.is_ok()).count() as f64 / count as f64
        }));
    }
    Ok(shares)
}
