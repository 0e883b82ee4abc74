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

/// `count` points uniformly distributed over a Möbius strip: a band of this half width about a circle in the xy plane, which
/// makes half a turn. It has no sides, so the normals' signs change along the half line y = 0, x > 0.
pub fn moebius(radius: f64, half_width: f64, count: usize, seed: u64) -> Samples<3> {
    let widest = (radius + half_width).hypot(half_width / 2.0);
    uniform(count, seed, widest, |u, random| {
        let v = half_width * (2.0 * random.uniform() - 1.0);
        let ((sine, cosine), (half_sine, half_cosine)) = (u.sin_cos(), (u / 2.0).sin_cos());
        let ring = radius + v * half_cosine;
        let across = [half_cosine * cosine, half_cosine * sine, half_sine];
        let along = [
            -ring * sine - v / 2.0 * half_sine * cosine,
            ring * cosine - v / 2.0 * half_sine * sine,
            v / 2.0 * half_cosine,
        ];
        ([ring * cosine, ring * sine, v * half_sine], along, across)
    })
}

/// `count` points uniformly distributed over a Klein bottle: a figure eight, `minor` times (sin v, sin 2v), that
/// makes half a turn on its way around a circle of radius `major` in the xy plane. It crosses itself along that circle. It has
/// no sides, so the normals' signs change along the half plane y = 0, x > 0.
pub fn klein(major: f64, minor: f64, count: usize, seed: u64) -> Samples<3> {
    // The eight reaches 1.25 minor from the circle, and its parameter runs at √5 minor at most.
    let widest = (major + 1.25 * minor).hypot(0.625 * minor) * 5.0_f64.sqrt() * minor;
    uniform(count, seed, widest, |u, random| {
        let (v_sine, v_cosine) = (TAU * random.uniform()).sin_cos();
        let (wide, high) = (minor * v_sine, minor * 2.0 * v_sine * v_cosine);
        let (wide_v, high_v) = (minor * v_cosine, minor * 2.0 * (v_cosine * v_cosine - v_sine * v_sine));
        let ((sine, cosine), (half_sine, half_cosine)) = (u.sin_cos(), (u / 2.0).sin_cos());
        let turned = |a: f64, b: f64| (half_cosine * a - half_sine * b, half_sine * a + half_cosine * b);
        let ((out, up), (out_v, up_v)) = (turned(wide, high), turned(wide_v, high_v));
        let ring = major + out;
        let along = [-ring * sine - up / 2.0 * cosine, ring * cosine - up / 2.0 * sine, out / 2.0];
        ([ring * cosine, ring * sine, up], along, [out_v * cosine, out_v * sine, up_v])
    })
}

/// Points of a surface of revolution or the like, uniform by area: `at` gives a point at the angle u with another parameter of
/// its own choice, and the derivatives by both, whose cross product is at most `widest` long.
fn uniform(
    count: usize,
    seed: u64,
    widest: f64,
    at: impl Fn(f64, &mut Random) -> ([f64; 3], [f64; 3], [f64; 3]),
) -> Samples<3> {
    let mut random = Random::new(seed);
    let mut samples = Samples::default();
    while samples.points.len() < count {
        let u = TAU * random.uniform();
        let (point, a, b) = at(u, &mut random);
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let area = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        // Reject in proportion to the area of a piece of the parameters.
        if area > widest * random.uniform() {
            samples.push(point, normal.map(|c| c / area));
        }
    }
    samples
}
