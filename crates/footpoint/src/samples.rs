//! Points on known curves and surfaces, with their true normals: for examples and tests.

use std::f64::consts::TAU;

/// Points with the exact unit normals of the shape they lie on (outward where the shape has an outside).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples<const D: usize> {
    /// Coordinates.
    pub points: Vec<[f64; D]>,
    /// Unit normals.
    pub normals: Vec<[f64; D]>,
}

/// A small generator of random numbers (SplitMix64): the same numbers for the same seed on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator that starts from `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normally distributed with mean 0 and standard deviation 1 (polar method).
    pub fn normal(&mut self) -> f64 {
        loop {
            let (a, b) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let s = a * a + b * b;
            if s > 0.0 && s < 1.0 {
                return a * (-2.0 * s.ln() / s).sqrt();
            }
        }
    }
}

impl<const D: usize> Samples<D> {
    /// Moves every point along all axes by normally distributed noise of this standard deviation.
    pub fn with_noise(mut self, deviation: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        for point in &mut self.points {
            *point = point.map(|c| c + deviation * random.normal());
        }
        self
    }

    fn push(&mut self, point: [f64; D], normal: [f64; D]) {
        self.points.push(point);
        self.normals.push(normal);
    }
}

/// `count` points uniformly distributed over a sphere about the origin.
pub fn sphere(radius: f64, count: usize, seed: u64) -> Samples<3> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    for _ in 0..count {
        let z = 2.0 * random.uniform() - 1.0;
        let (sine, cosine) = (TAU * random.uniform()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        let normal = [r * cosine, r * sine, z];
        samples.push(normal.map(|c| radius * c), normal);
    }
    samples
}

/// `count` points uniformly distributed over a torus about the z axis.
pub fn torus(major: f64, minor: f64, count: usize, seed: u64) -> Samples<3> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    while samples.points.len() < count {
        let (sine, cosine) = (TAU * random.uniform()).sin_cos();
        // The inside has less area than the outside: reject in proportion.
        if random.uniform() * (major + minor) > major + minor * cosine {
            continue;
        }
        let (round_sine, round_cosine) = (TAU * random.uniform()).sin_cos();
        let normal = [cosine * round_cosine, cosine * round_sine, sine];
        let ring = major + minor * cosine;
        samples.push([ring * round_cosine, ring * round_sine, minor * sine], normal);
    }
    samples
}

/// `count` points uniformly distributed over the square |x|, |y| < half at z = 0.
pub fn plane(half: f64, count: usize, seed: u64) -> Samples<3> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    for _ in 0..count {
        let mut coordinate = || half * (2.0 * random.uniform() - 1.0);
        samples.push([coordinate(), coordinate(), 0.0], [0.0, 0.0, 1.0]);
    }
    samples
}

/// `count` points uniformly distributed over a circle about the origin.
pub fn circle(radius: f64, count: usize, seed: u64) -> Samples<2> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    for _ in 0..count {
        let (sine, cosine) = (TAU * random.uniform()).sin_cos();
        samples.push([radius * cosine, radius * sine], [cosine, sine]);
    }
    samples
}

/// `count` points on the ellipse with these half axes along x and y, uniform in the angle parameter.
pub fn ellipse(a: f64, b: f64, count: usize, seed: u64) -> Samples<2> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    for _ in 0..count {
        let (sine, cosine) = (TAU * random.uniform()).sin_cos();
        let normal = [b * cosine, a * sine];
        let length = normal[0].hypot(normal[1]);
        samples.push([a * cosine, b * sine], normal.map(|c| c / length));
    }
    samples
}
