//! No cloud makes casting panic or run on, and no hit is reported that is none.

use footpoint::samples::Random;
use footpoint::{Cast, Cloud, Definition, Kind, NormalField, Ray, Support, Surface};

/// Clouds that nobody wants, and a support for each.
fn clouds() -> Vec<(&'static str, Vec<[f64; 3]>, Support)> {
    let mut random = Random::new(1);
    let mut cube = |count: usize, size: f64| -> Vec<[f64; 3]> {
        (0..count).map(|_| std::array::from_fn(|_| size * (random.uniform() - 0.5))).collect()
    };
    let line = (0..200).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let mut outliers = cube(500, 1.0);
    outliers.extend([[1e14, 0.0, 0.0], [0.0, -1e13, 1e12], [f64::NAN, 0.0, 0.0], [f64::INFINITY; 3]]);
    vec![
        ("one sample", vec![[1.0, 2.0, 3.0]], Support::Uniform(1.0)),
        ("repeats", vec![[1.0, 2.0, 3.0]; 500], Support::Uniform(1.0)),
        ("a line", line, Support::Uniform(3.0)),
        ("a volume", cube(3000, 10.0), Support::Uniform(1.0)),
        ("outliers", outliers, Support::Uniform(0.2)),
        ("denormal", cube(300, 1e-310), Support::Uniform(1e-311)),
        ("huge", cube(300, 1e300), Support::Uniform(1e299)),
        ("one support for all", cube(300, 1.0), Support::Uniform(100.0)),
    ]
}

#[test]
fn every_cloud_gets_answers() {
    for (name, points, support) in clouds() {
        let (low, high) = (points[0], points[points.len() / 2]);
        for kind in
            [Definition::new(), Definition::new().with_kind(Kind::Levin), Definition::new().with_degree(2)]
        {
            let definition = kind.with_support(support);
            let Ok(surface) = Surface::new(Cloud::new(points.clone()), definition) else { continue };
            let h = surface.support().median;
            let mut random = Random::new(2);
            let rays: Vec<Ray<3>> = (0..60)
                .map(|i| {
                    let mut near = |p: [f64; 3]| p.map(|c| c + h * (2.0 * random.uniform() - 1.0));
                    let (from, to) = (near(low), near(high));
                    let direction: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
                    let back = if i % 2 == 0 { 0.0 } else { 10.0 };
                    Ray { origin: std::array::from_fn(|k| from[k] - back * direction[k]), direction }
                })
                .collect();
            let all = surface.cast_all(&rays, &Cast::new());
            let first = surface.cast(&rays, &Cast::new());
            for i in 0..rays.len() {
                assert_eq!(first.status[i].is_ok(), !all.of(i).is_empty(), "{name}, {definition:?}");
                assert_eq!(first.status[i].is_ok(), first.t[i].is_finite(), "{name}, {definition:?}");
            }
        }
    }
}

#[test]
fn a_signed_field_needs_its_signs() {
    // Normals of random sign: averages vanish, so there are few hits, and each is one.
    let sphere = footpoint::samples::sphere(1.0, 2000, 1);
    let mut random = Random::new(4);
    let mut flip = |n: [f64; 3]| if random.uniform() < 0.5 { n.map(|c| -c) } else { n };
    let flipped: Vec<[f64; 3]> = sphere.normals.iter().map(|n| flip(*n)).collect();
    let cloud = Cloud::new(sphere.points).with_normals(flipped).unwrap();
    let definition = Definition::new().with_field(NormalField::AveragedNormals);
    let surface = Surface::new(cloud, definition).unwrap();
    let found = super::dense::compare(&surface, &super::random_rays(&surface, 300, 1));
    assert_eq!(found.wrong, 0, "{found:?}");
}
