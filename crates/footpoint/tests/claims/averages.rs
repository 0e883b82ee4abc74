//! Averages of columns have the weights of the surface: those of the coordinates are a(x), and rows without a number do not count.

use footpoint::samples::{Random, torus};
use footpoint::{Cloud, Definition, Precision, Support, Surface, Want, Weight};

#[test]
fn the_average_of_the_coordinates_is_a() {
    let points = torus(1.0, 0.4, 1500, 3).points;
    let mut random = Random::new(2);
    let supports: Vec<f64> = points.iter().map(|_| 0.2 + 0.1 * random.uniform()).collect();
    let factors: Vec<f64> = points.iter().map(|_| 0.5 + random.uniform()).collect();
    let cloud = Cloud::new(points.clone()).with_supports(supports).unwrap().with_factors(factors).unwrap();
    let at: Vec<[f64; 3]> = points.iter().step_by(7).map(|p| p.map(|c| 1.02 * c)).collect();
    for weight in [Weight::Poly2, Weight::Poly3, Weight::Wendland, Weight::GAUSSIAN] {
        for support in [Support::Uniform(0.25), Support::FromSamples] {
            for (precision, tolerance) in [(Precision::Double, 1e-12), (Precision::Single, 1e-6)] {
                let definition = Definition::default().with_weight(weight).with_support(support);
                let surface = Surface::new(cloud.clone(), definition.with_precision(precision)).unwrap();
                let expected = surface.evaluate(&at, Want::AVERAGE).average;
                for (a, b) in surface.average(&at, &points).iter().zip(expected) {
                    assert!((0..3).all(|k| (a[k] - b[k]).abs() < tolerance), "{weight:?} {support:?}");
                }
            }
        }
    }
}

#[test]
fn rows_without_a_number_do_not_count() {
    let surface = Surface::new(
        Cloud::new([[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]),
        Definition::default().with_support(Support::Uniform(1.0)),
    )
    .unwrap();
    let average = |values: &[[f64; 1]]| surface.average(&[[0.1, 0.0], [5.0, 0.0]], values);
    let found = average(&[[1.0], [f64::NAN], [3.0]]);
    assert!((found[0][0] - 2.0).abs() < 1e-15 && found[1][0].is_nan(), "{found:?}");
    // A list that is too short has no numbers at its end, and one of none has none at all.
    assert!((average(&[[4.0]])[0][0] - 4.0).abs() < 1e-15);
    assert!(average(&[])[0][0].is_nan());
    assert!(surface.average(&[[f64::NAN, 0.0]], &[[1.0]; 3])[0][0].is_nan());
}
