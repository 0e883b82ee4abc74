//! A simulated laser scan of a vase whose exact shape is known.
//!
//! What a real scan has and a set of random surface points lacks: parts hidden from every station, a
//! density that falls with distance and slant, several stations overlapping, noise along the ray only,
//! an open rim. And what a real scan lacks: the truth for every sample.

mod vessel;

use footpoint::samples::Random;
pub use vessel::{Hit, Vessel};
use vessel::{add, cross, dot, norm, scale, sub, unit};

/// Where the stations stand, one after the other: distance from the vase in metres and height in degrees
/// above the horizon. The third looks up at the foot, the second and fourth down through the opening.
const POSTS: [(f64, f64); 5] = [(0.75, 18.0), (0.95, 57.0), (1.05, -38.0), (0.70, 46.0), (1.60, 4.0)];

/// The point the stations look at: about the middle of the vase's height, in metres.
const AIM: [f64; 3] = [0.0, 0.0, -0.01];

/// Beams that meet the surface at more than this angle from its normal, in degrees, return too weak an echo.
const STEEPEST_INCIDENCE: f64 = 80.0;

/// How far a beam may stray from its place in the raster, in steps of the raster.
const JITTER: f64 = 0.3;

/// How the vase is scanned. The same plan gives the same scan, bit for bit, on every run.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanPlan {
    /// Number of stations, spread around the vase at different distances and heights.
    pub stations: u8,
    /// Rays that each station casts over its square field of view; about a third of them find the vase.
    pub rays: u32,
    /// Keep every so many rows and columns of the raster: 2 gives the same scan with a quarter of its
    /// samples, each of which is also in the full one. 0 counts as 1.
    pub every: u32,
    /// Standard deviation of the measured range, in metres.
    pub noise: f64,
    /// Seed of jitter and noise.
    pub seed: u64,
}

impl Default for ScanPlan {
    fn default() -> Self {
        Self { stations: 5, rays: 160_000, every: 1, noise: 4e-4, seed: 1 }
    }
}

/// A plan that gives no scan.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// No station or no ray.
    #[error("{stations} stations with {rays} rays each: a scan needs at least one of each")]
    Empty {
        /// Stations planned.
        stations: u8,
        /// Rays of each.
        rays: u32,
    },
    /// The deviation of the ranges is negative or not finite.
    #[error("noise of {0} metres: it must be zero or positive, and finite")]
    Noise(f64),
}

impl ScanPlan {
    /// Fails if the plan asks for nothing, or for a noise that is no deviation.
    pub fn check(&self) -> Result<(), PlanError> {
        if self.stations == 0 || self.rays == 0 {
            return Err(PlanError::Empty { stations: self.stations, rays: self.rays });
        }
        match self.noise >= 0.0 && self.noise.is_finite() {
            true => Ok(()),
            false => Err(PlanError::Noise(self.noise)),
        }
    }

    /// Positions of the stations in metres, in the order in which they scan.
    pub fn station_positions(&self) -> Vec<[f64; 3]> {
        let turn = std::f64::consts::TAU / f64::from(self.stations.max(1));
        (0..self.stations)
            .map(|k| {
                let (distance, height) = POSTS[usize::from(k) % POSTS.len()];
                let (sin, cos) = (turn * f64::from(k) + 0.5).sin_cos();
                let (rise, level) = height.to_radians().sin_cos();
                add(AIM, [level * cos, level * sin, rise], distance)
            })
            .collect()
    }
}

/// A simulated scan: for every sample what the scanner reports and what is true.
///
/// All four lists have the same length and the scan's order: station after station, each row by row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scan {
    /// Measured points, in metres: the true ones moved along their rays by the noise.
    pub points: Vec<[f64; 3]>,
    /// The points where the rays met the surface, in metres, exact to rounding.
    pub truth: Vec<[f64; 3]>,
    /// Unit normals of the surface at those points, always the vase's outward ones, also where the
    /// scanner saw the inside.
    pub normals: Vec<[f64; 3]>,
    /// The station that took the sample, counted from 0 as in [`ScanPlan::station_positions`].
    pub station: Vec<u8>,
}

/// Scans the vase: every ray of every station gives a sample where it first meets the surface, unless it
/// misses or meets it at more than 80 degrees from the normal. Sequential; takes
/// about a second for the default plan.
pub fn scan(vessel: &Vessel, plan: &ScanPlan) -> Scan {
    let mut scan = Scan::default();
    // All stations share one angular step, as one scanner carried from post to post would, and a field of
    // view in which the vase fits from the nearest post.
    let nearest = POSTS.iter().fold(f64::INFINITY, |least, post| least.min(post.0));
    let half_view = ((vessel.reach() + norm(AIM)) / nearest).asin();
    let side = f64::from(plan.rays).sqrt().round() as u32;
    let step = 2.0 * half_view / f64::from(side.max(1));
    let weakest = STEEPEST_INCIDENCE.to_radians().cos();

    for (station, origin) in (0..plan.stations).zip(plan.station_positions()) {
        let ahead = unit(sub(AIM, origin));
        let right = unit(cross(ahead, [0.0, 0.0, 1.0]));
        let up = cross(right, ahead);
        for row in (0..side).step_by(plan.every.max(1) as usize) {
            for column in (0..side).step_by(plan.every.max(1) as usize) {
                let mut random = random_for_ray(plan.seed, station, row, column);
                let mut angle = |k: u32| {
                    (f64::from(k) + 0.5 + JITTER * (2.0 * random.uniform() - 1.0)) * step - half_view
                };
                let (sin_across, cos_across) = angle(column).sin_cos();
                let (sin_down, cos_down) = angle(row).sin_cos();
                let level = add(scale(ahead, cos_across), right, sin_across);
                let direction = unit(add(scale(level, cos_down), up, -sin_down));
                let Some(hit) = vessel.first_hit(origin, direction) else { continue };
                if dot(hit.normal, direction).abs() < weakest {
                    continue;
                }
                scan.points.push(add(hit.point, direction, plan.noise * random.normal()));
                scan.truth.push(hit.point);
                scan.normals.push(hit.normal);
                scan.station.push(station);
            }
        }
    }
    scan
}

/// Random numbers started afresh for every ray: a ray's jitter and noise depend neither on the other rays nor on
/// how many of them are cast.
fn random_for_ray(seed: u64, station: u8, row: u32, column: u32) -> Random {
    let mut stir = seed;
    for word in [u64::from(station), u64::from(row) << 32 | u64::from(column)] {
        stir = Random::new(stir).bits() ^ word;
    }
    Random::new(Random::new(stir).bits())
}

#[cfg(test)]
mod tests {
    use super::vessel::gauge_value;
    use super::*;

    fn ray(plan: &ScanPlan, scan: &Scan, i: usize) -> ([f64; 3], [f64; 3], f64) {
        let origin = plan.station_positions()[usize::from(scan.station[i])];
        let way = sub(scan.truth[i], origin);
        (origin, unit(way), norm(way))
    }

    #[test]
    fn the_default_scan_is_large_exact_and_as_noisy_as_asked() {
        let (vessel, plan) = (Vessel::new(), ScanPlan::default());
        let scan = scan(&vessel, &plan);
        let count = scan.points.len();
        assert!(count >= 200_000, "{count}");
        assert_eq!([scan.truth.len(), scan.normals.len(), scan.station.len()], [count; 3]);
        let (mut along, mut inside) = (0.0, 0);
        for i in 0..count {
            let (_, direction, _) = ray(&plan, &scan, i);
            let error = sub(scan.points[i], scan.truth[i]);
            along += dot(error, direction).powi(2);
            assert!(norm(cross(error, direction)) < 1e-15, "noise across the ray");
            assert!(dot(scan.normals[i], direction).abs() > 0.1736 && scan.truth[i][2] < 0.1851);
            inside += usize::from(dot(scan.normals[i], direction) > 0.0);
            if i % 10 == 0 {
                let (distance, _, normal) = vessel.distance(scan.truth[i]);
                assert!(distance.abs() < 1e-12 && norm(sub(normal, scan.normals[i])) < 1e-9, "{distance}");
            }
        }
        assert!(inside > count / 10, "{inside} of {count} on the inside");
        let deviation = (along / count as f64).sqrt();
        // The relative standard error of a deviation from 200,000 samples is 0.16 %.
        assert!((deviation / plan.noise - 1.0).abs() < 0.008, "{deviation}");
    }

    #[test]
    fn nothing_of_the_vase_stands_between_station_and_sample() {
        let vessel = Vessel::new();
        let plan = ScanPlan { rays: 900, ..ScanPlan::default() };
        let scan = scan(&vessel, &plan);
        assert!(scan.points.len() > 500);
        for i in 0..scan.points.len() {
            let (origin, direction, range) = ray(&plan, &scan, i);
            // The last 0.6 m are enough: no two points of the vase are further apart.
            let steps = 20_000;
            let start = (range - 0.6).max(0.0);
            let mut before = None;
            for k in 0..steps {
                let t = start + (range - 1e-6 - start) * f64::from(k) / f64::from(steps - 1);
                let x = add(origin, direction, t);
                let outside = gauge_value(x) > 1.0;
                if x[2] < vessel.rim_height() {
                    assert!(before.is_none_or(|side| side == outside), "sample {i} lies behind the surface");
                    before = Some(outside);
                }
            }
        }
    }

    #[test]
    fn scans_repeat_and_a_quarter_scan_is_part_of_the_full_one() {
        let vessel = Vessel::new();
        let plan = ScanPlan { rays: 4900, ..ScanPlan::default() };
        let full = scan(&vessel, &plan);
        assert_eq!(full, scan(&vessel, &plan));
        assert_ne!(full, scan(&vessel, &ScanPlan { seed: 2, ..plan.clone() }));

        let quarter = scan(&vessel, &ScanPlan { every: 2, ..plan });
        let share = quarter.points.len() as f64 / full.points.len() as f64;
        assert!((share - 0.25).abs() < 0.02, "{share}");
        let mut rest = full.points.iter();
        assert!(quarter.points.iter().all(|point| rest.any(|other| other == point)), "not a part, in order");
    }
}
