//! Over random and hostile clouds every quantity is either a sound number or NaN with a status that says why.
#![allow(clippy::unwrap_used)]

use crate::common::{dot, length};
use footpoint::samples::Random;
use footpoint::{
    Cloud, Definition, Kind, Noise, NonOrientable, NormalField, NormalSource, Operator, Orient, Precision,
    Project, Queries, Status, Support, Surface, Uncertainty, Want, Weight,
};
use proptest::prelude::*;

/// A cloud that nobody would scan: some of it flat, some on a line, in one place, absent or far away.
fn cloud<const D: usize>(seed: u64, size: f64) -> Vec<[f64; D]> {
    let mut random = Random::new(seed);
    let count = 4 + (60.0 * random.uniform()) as usize;
    let shape = (6.0 * random.uniform()) as u32;
    (0..count)
        .map(|i| {
            let mut p: [f64; D] = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
            match shape {
                0 => {}
                1 => p[D - 1] = 0.0,
                2 => p = std::array::from_fn(|k| if k == 0 { p[0] } else { 0.0 }),
                3 if i % 2 == 0 => p = [0.25; D],
                4 if i % 5 == 0 => p[0] = [f64::NAN, f64::INFINITY, 1e300, -1e18, 0.0][(i / 5) % 5],
                _ => p[D - 1] = 0.1 * p[0] * p[0] + 1e-3 * random.normal(),
            }
            p.map(|c| c * size)
        })
        .collect()
}

fn kinds() -> [Definition; 7] {
    let field = |field| Definition::new().with_field(field);
    [
        field(NormalField::Covariance),
        field(NormalField::CentredCovariance),
        field(NormalField::AveragedNormals),
        field(NormalField::AveragedAxes),
        Definition::new().with_kind(Kind::Levin),
        field(NormalField::CentredCovariance).with_degree(2),
        field(NormalField::AveragedNormals).with_degree(3).with_degree_fallback(true),
    ]
}

fn check<const D: usize>(seed: u64, size: f64, weight: Weight, precision: Precision) {
    let points = cloud::<D>(seed, size);
    let mut random = Random::new(seed ^ 0xabc);
    let normals: Vec<[f64; D]> = points
        .iter()
        .map(|_| std::array::from_fn(|k| if k == D - 1 { 1.0 } else { random.normal() }))
        .collect();
    let mut queries: Vec<[f64; D]> =
        (0..20).map(|_| std::array::from_fn(|_| size * (2.4 * random.uniform() - 1.2))).collect();
    queries.push([f64::NAN; D]);
    queries.push([1e30 * size; D]);
    for definition in kinds() {
        let definition = definition
            .with_weight(weight)
            .with_precision(precision)
            .with_support(Support::Uniform(0.7 * size));
        let cloud = Cloud::new(points.clone())
            .with_normals(normals.clone())
            .unwrap()
            .with_noise(Noise::Uniform(0.01 * size))
            .unwrap();
        let Ok(surface) = Surface::new(cloud, definition) else { continue };
        let what = format!("seed {seed}, {size:e}, {weight:?} {precision:?} {:?}", definition.kind());
        for at in [Queries::Samples, Queries::Points(&queries)] {
            evaluations(&surface, at, &what);
            let found = surface.uncertainty(at, &Uncertainty::new()).unwrap();
            for (i, status) in found.feet.status.iter().enumerate() {
                let known = [found.sigma[i], found.bias[i]];
                assert!(status.is_ok() || known.iter().all(|v| v.is_nan()), "{what}: {status:?} {known:?}");
                assert!(!status.is_ok() || (known[0] >= 0.0 && known[1].is_finite()), "{what}: {known:?}");
            }
            let levin = Project::new().with_operator(Operator::Levin { degree: Some(2) });
            let found = surface.project(at, &levin);
            for (i, status) in found.status.iter().enumerate() {
                assert!(!status.is_ok() || found.point[i].iter().all(|c| c.is_finite()), "{what}");
                assert!(status.is_ok() || found.distance[i].is_nan(), "{what}");
            }
        }
        let estimate = surface.estimate_noise();
        assert!(
            if estimate.samples == 0 { estimate.sigma.is_nan() } else { estimate.sigma >= 0.0 },
            "{what}"
        );
        let how = Orient::Propagated(NonOrientable::Force);
        let oriented = surface.orient(NormalSource::Surface, &how).unwrap();
        for (normal, status) in oriented.normal.iter().zip(&oriented.status) {
            let unit = (length(*normal) - 1.0).abs() < 1e-5;
            assert!(if status.is_ok() { unit } else { normal[0].is_nan() }, "{what}: {status:?} {normal:?}");
        }
    }
}

fn evaluations<const D: usize>(surface: &Surface<D>, at: Queries<'_, D>, what: &str) {
    let e = surface.evaluate(at, Want::ALL);
    for (i, status) in e.status.iter().enumerate() {
        let c = &e.curvature;
        let bent = [c.mean[i], c.principal[i][0]];
        let second = e.hessian[i].as_flattened();
        if !status.is_ok() {
            assert!(bent.iter().all(|k| k.is_nan()) && c.directions[i][0][0].is_nan(), "{what}: {status:?}");
        }
        match status {
            // f exists, only ∇f has no direction.
            Status::Ok | Status::Singular => {
                assert!(e.value[i].is_finite() && e.sigma[i] >= 0.0, "{what}: {}", e.sigma[i]);
                assert!(second.iter().all(|h| h.is_finite()), "{what}: {second:?}");
                assert!(e.eccentricity[i] >= 0.0);
            }
            _ => assert!(second.iter().all(|h| h.is_nan()) && e.sigma[i].is_nan(), "{what}: {status:?}"),
        }
        if status.is_ok() {
            assert!(bent.iter().all(|k| k.is_finite()), "{what}: {bent:?}");
            let direction = c.directions[i][0];
            assert!(
                (length(direction) - 1.0).abs() < 1e-9 && dot(direction, e.surface_normal[i]).abs() < 1e-5
            );
            assert!(D == 2 || c.principal[i][0] >= c.principal[i][1], "{what}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_a_plausible_lie(
        seed in 0_u64..1 << 40,
        magnitude in -12_i32..12,
        weight in prop::sample::select(vec![Weight::Poly2, Weight::Poly3, Weight::Poly4, Weight::Wendland, Weight::GAUSSIAN]),
        single in any::<bool>(),
    ) {
        let precision = if single { Precision::Single } else { Precision::Double };
        let size = 10.0_f64.powi(magnitude);
        check::<2>(seed, size, weight, precision);
        check::<3>(seed, size, weight, precision);
    }
}
