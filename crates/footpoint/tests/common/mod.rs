//! What several tests need: the shared golden numbers and data, where they stand beside the project; clouds with
//! every column; comparison by bits.
#![allow(dead_code)]
#![allow(clippy::unwrap_used)]

use footpoint::samples::{Random, Samples};
use footpoint::{
    Cloud, Definition, Evaluations, Kind, NormalField, Operator, Projections, Support, Surface, Want, Weight,
};
use serde_json::Value;
use std::path::PathBuf;

/// A folder of the shared material, or `None` with a message where it is absent (a fresh clone).
pub(crate) fn shared(folder: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: no shared/{folder} beside the project");
    None
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

pub(crate) fn vector<const D: usize>(value: &Value) -> [f64; D] {
    numbers(value).try_into().unwrap()
}

pub(crate) fn vectors<const D: usize>(value: &Value) -> Vec<[f64; D]> {
    value.as_array().unwrap().iter().map(vector).collect()
}

pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub(crate) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn add<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] + b[k])
}

pub(crate) fn scale<const D: usize>(a: [f64; D], s: f64) -> [f64; D] {
    a.map(|c| c * s)
}

pub(crate) fn length<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

/// The part of `a` across the unit vector `n`.
pub(crate) fn across<const D: usize>(a: [f64; D], n: [f64; D]) -> [f64; D] {
    sub(a, scale(n, dot(a, n)))
}

pub(crate) const FIELDS: [NormalField; 4] = [
    NormalField::Covariance,
    NormalField::CentredCovariance,
    NormalField::AveragedNormals,
    NormalField::AveragedAxes,
];

/// Every normal field of the point set surface, two of higher degree, and Levin's surface.
pub(crate) fn definitions() -> impl Iterator<Item = Definition> {
    let fields = FIELDS.into_iter().map(|field| Definition::new().with_field(field));
    fields.chain([
        Definition::new().with_kind(Kind::Levin),
        Definition::new().with_degree(2),
        Definition::new().with_field(NormalField::AveragedNormals).with_degree(3).with_degree_fallback(true),
    ])
}

/// The operators that iterate on f.
pub(crate) const OPERATORS: [Operator; 3] =
    [Operator::Basic, Operator::AlmostOrthogonal, Operator::Orthogonal];

/// Every weight, each with the share of h that gives it about as many neighbours as the others; the Gaussian's cut
/// is so low that its step does not show.
pub(crate) const WEIGHTS: [(Weight, f64); 5] = [
    (Weight::Poly2, 0.9),
    (Weight::Poly3, 1.0),
    (Weight::Poly4, 1.1),
    (Weight::Wendland, 1.2),
    (Weight::Gaussian { cut: 1e-16 }, 0.5),
];

/// Which columns a cloud carries beside points and normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Variant {
    Uniform,
    PerSample,
    Factors,
    PerSampleAndFactors,
}

pub(crate) const VARIANTS: [Variant; 4] =
    [Variant::Uniform, Variant::PerSample, Variant::Factors, Variant::PerSampleAndFactors];

/// What a surface is made of, as plain columns that a test can change and the brute force can read.
#[derive(Clone, Debug)]
pub(crate) struct Columns<const D: usize> {
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) normals: Option<Vec<[f64; D]>>,
    /// Used if given; else `radius`.
    pub(crate) supports: Option<Vec<f64>>,
    pub(crate) factors: Option<Vec<f64>>,
    pub(crate) radius: f64,
}

impl<const D: usize> Columns<D> {
    /// The samples with their normals; supports vary by ± 25 %, factors from a half to one and a half.
    pub(crate) fn new(samples: &Samples<D>, radius: f64, variant: Variant) -> Self {
        let mut random = Random::new(77);
        let count = samples.points.len();
        let mut column = |low: f64, high: f64| -> Vec<f64> {
            (0..count).map(|_| low + (high - low) * random.uniform()).collect()
        };
        let supports = column(0.75 * radius, 1.25 * radius);
        let factors = column(0.5, 1.5);
        let per_sample = matches!(variant, Variant::PerSample | Variant::PerSampleAndFactors);
        let with_factors = matches!(variant, Variant::Factors | Variant::PerSampleAndFactors);
        Self {
            points: samples.points.clone(),
            normals: Some(samples.normals.clone()),
            supports: per_sample.then_some(supports),
            factors: with_factors.then_some(factors),
            radius,
        }
    }

    pub(crate) fn cloud(&self) -> Cloud<D> {
        let mut cloud = Cloud::new(self.points.clone());
        if let Some(normals) = &self.normals {
            cloud = cloud.with_normals(normals.clone()).unwrap();
        }
        if let Some(supports) = &self.supports {
            cloud = cloud.with_supports(supports.clone()).unwrap();
        }
        if let Some(factors) = &self.factors {
            cloud = cloud.with_factors(factors.clone()).unwrap();
        }
        cloud
    }

    pub(crate) fn support(&self) -> Support {
        if self.supports.is_some() { Support::FromSamples } else { Support::Uniform(self.radius) }
    }

    pub(crate) fn surface(&self, definition: Definition) -> Surface<D> {
        Surface::new(self.cloud(), definition.with_support(self.support())).unwrap()
    }

    pub(crate) fn field(&self, field: NormalField) -> Surface<D> {
        self.surface(Definition::new().with_field(field))
    }

    /// The samples at these places, in this order.
    pub(crate) fn select(&self, places: &[usize]) -> Self {
        fn pick<T: Copy>(column: &[T], places: &[usize]) -> Vec<T> {
            places.iter().map(|&i| column[i]).collect()
        }
        Self {
            points: pick(&self.points, places),
            normals: self.normals.as_ref().map(|c| pick(c, places)),
            supports: self.supports.as_ref().map(|c| pick(c, places)),
            factors: self.factors.as_ref().map(|c| pick(c, places)),
            radius: self.radius,
        }
    }
}

/// A random point of the cube between −1 and 1.
pub(crate) fn in_cube<const D: usize>(random: &mut Random) -> [f64; D] {
    std::array::from_fn(|_| 2.0 * random.uniform() - 1.0)
}

/// `count` random samples, each moved by a random vector of at most `reach` along every axis.
pub(crate) fn near_samples<const D: usize>(
    points: &[[f64; D]],
    count: usize,
    reach: f64,
    seed: u64,
) -> Vec<[f64; D]> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            let p = points[(random.uniform() * points.len() as f64) as usize];
            add(p, scale(in_cube(&mut random), reach))
        })
        .collect()
}

/// ∂f/∂x_k by differences of the fourth order; `None` where a sample enters or leaves a support on the way.
pub(crate) fn differences<const D: usize>(
    surface: &Surface<D>,
    x: [f64; D],
    n: [f64; D],
    h: f64,
) -> Option<[f64; D]> {
    let step = 1e-4 * h;
    let mut gradient = [0.0; D];
    for k in 0..D {
        let shifted: Vec<[f64; D]> = [-2.0, -1.0, 1.0, 2.0]
            .iter()
            .map(|times| add(x, std::array::from_fn(|j| if j == k { times * step } else { 0.0 })))
            .collect();
        let e = surface.evaluate(&shifted, Want::VALUE | Want::FRAME_NORMAL | Want::NEIGHBOURS);
        if e.neighbours.iter().any(|&count| count != e.neighbours[0]) {
            return None;
        }
        let f = |j: usize| e.value[j] * dot(e.frame_normal[j], n).signum();
        gradient[k] = (f(0) - 8.0 * f(1) + 8.0 * f(2) - f(3)) / (12.0 * step);
    }
    Some(gradient)
}

/// A permutation of 0, …, count − 1.
pub(crate) fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut random = Random::new(seed);
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        order.swap(i, (random.uniform() * (i + 1) as f64) as usize);
    }
    order
}

pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, v| if v > m || v.is_nan() { v } else { m })
}

/// An even sampling of the unit sphere, with its normals.
pub(crate) fn fibonacci_sphere(count: usize) -> Samples<3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let points: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (sine, cosine) = (golden * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [r * cosine, r * sine, z]
        })
        .collect();
    Samples { normals: points.clone(), points }
}

/// An even sampling of the unit circle, with its normals.
pub(crate) fn even_circle(count: usize) -> Samples<2> {
    let points: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let (sine, cosine) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
            [cosine, sine]
        })
        .collect();
    Samples { normals: points.clone(), points }
}

/// An even sampling of a torus: rings of points, as many on each as its length asks for.
pub(crate) fn even_torus(major: f64, minor: f64, rings: u32) -> Samples<3> {
    let mut samples = Samples::default();
    let spacing = std::f64::consts::TAU * minor / f64::from(rings);
    for i in 0..rings {
        let (sine, cosine) = (std::f64::consts::TAU * f64::from(i) / f64::from(rings)).sin_cos();
        let ring = major + minor * cosine;
        let count = (std::f64::consts::TAU * ring / spacing).round() as u32;
        for j in 0..count {
            let (y, x) = (std::f64::consts::TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(count))
                .sin_cos();
            samples.points.push([ring * x, ring * y, minor * sine]);
            samples.normals.push([cosine * x, cosine * y, sine]);
        }
    }
    samples
}

/// Every column but those that need second derivatives, which cost seven times the others, noise or a degree.
pub(crate) const FIRST_ORDER: [Want; 13] = [
    Want::VALUE,
    Want::AVERAGE,
    Want::FRAME_NORMAL,
    Want::GRADIENT,
    Want::SURFACE_NORMAL,
    Want::GAP,
    Want::NEIGHBOURS,
    Want::EFFECTIVE_NEIGHBOURS,
    Want::WEIGHT_SUM,
    Want::EIGENVALUES,
    Want::SQUARED_SENSITIVITY,
    Want::SUPPORT,
    Want::ECCENTRICITY,
];

/// These columns as one set.
pub(crate) fn first_order() -> Want {
    FIRST_ORDER.into_iter().fold(Want::VALUE, |all, one| all | one)
}

/// A row of named numbers by their bits, so that NaN equals NaN and a difference says where it is.
pub(crate) type Row = Vec<(&'static str, u64)>;

pub(crate) fn evaluation_rows<const D: usize>(e: &Evaluations<D>) -> Vec<Row> {
    (0..e.status.len())
        .map(|i| {
            let mut row: Row = vec![("status", e.status[i] as u64)];
            let mut vector = |name, v: &[f64]| row.extend(v.iter().map(|c| (name, c.to_bits())));
            vector("value", &e.value[i..=i]);
            vector("average", &e.average[i]);
            vector("frame normal", &e.frame_normal[i]);
            vector("gradient", &e.gradient[i]);
            vector("surface normal", &e.surface_normal[i]);
            vector("gap", &e.gap[i..=i]);
            vector("effective neighbours", &e.effective_neighbours[i..=i]);
            vector("weight sum", &e.weight_sum[i..=i]);
            vector("eigenvalues", &e.eigenvalues[i]);
            vector("squared sensitivity", &e.squared_sensitivity[i..=i]);
            vector("support", &e.support[i..=i]);
            row.push(("neighbours", u64::from(e.neighbours[i])));
            let mut vector = |name, v: &[f64]| row.extend(v.iter().map(|c| (name, c.to_bits())));
            vector("eccentricity", &e.eccentricity[i..=i]);
            vector("second derivatives", e.hessian[i].as_flattened());
            vector("mean curvature", &e.curvature.mean[i..=i]);
            vector("Gaussian curvature", &e.curvature.gaussian[i..=i]);
            vector("principal curvatures", &e.curvature.principal[i]);
            vector("principal directions", e.curvature.directions[i].as_flattened());
            vector("sigma", &e.sigma[i..=i]);
            row.push(("degree", u64::from(e.degree[i])));
            row
        })
        .collect()
}

pub(crate) fn projection_rows<const D: usize>(p: &Projections<D>) -> Vec<Row> {
    (0..p.status.len())
        .map(|i| {
            let mut row: Row = vec![("status", p.status[i] as u64)];
            let mut vector = |name, v: &[f64]| row.extend(v.iter().map(|c| (name, c.to_bits())));
            vector("point", &p.point[i]);
            vector("surface normal", &p.surface_normal[i]);
            vector("frame normal", &p.frame_normal[i]);
            vector("distance", &p.distance[i..=i]);
            vector("residual", &p.residual[i..=i]);
            row.push(("evaluations", u64::from(p.evaluations[i])));
            row
        })
        .collect()
}

/// Without the columns that hold locations: they move with the cloud.
pub(crate) fn without_locations(rows: Vec<Row>) -> Vec<Row> {
    let keep = |row: Row| row.into_iter().filter(|(name, _)| !matches!(*name, "average" | "point"));
    rows.into_iter().map(|row| keep(row).collect()).collect()
}

#[track_caller]
pub(crate) fn same_rows(found: &[Row], expected: &[Row], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        let unlike = f
            .iter()
            .zip(e)
            .filter(|(f, e)| f != e)
            .map(|(f, e)| (f.0, f64::from_bits(f.1), f64::from_bits(e.1), f.1.min(1000), e.1.min(1000)));
        assert!(f == e, "{what}: row {i} differs: {:?}", unlike.collect::<Vec<_>>());
    }
}

/// Rows of numbers after the header of a text file; the points' share of an ASCII PLY.
pub(crate) fn rows_of_text(text: &str, most: usize) -> Vec<Vec<f64>> {
    let body = text.split_once("end_header").map_or(text, |(_, body)| body.trim_start());
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    body.lines().take(most).map(numbers).collect()
}
