//! What holds for every kind, field and degree: the same bits from all vector levels, and sensitivities that sum to ∇f.

use super::tests::{EVERYTHING, FIELDS, WEIGHTS, cloud, locals};
use super::{Evaluator, own_sensitivity};
use crate::algebra::{add, dot, length};
use crate::definition::{Definition, Kind};
use crate::engine::Position;
use crate::field::NormalField;
use crate::lane::Precision;
use crate::samples::Random;
use fearless_simd::Level;

/// Every kind with every weight, with and without supports and factors of the samples' own.
fn every_setting(mut each: impl FnMut(Definition, bool, bool)) {
    let fields = FIELDS.map(|field| Definition::new().with_field(field));
    let degrees = (1..=3).flat_map(|degree| {
        [NormalField::CentredCovariance, NormalField::AveragedNormals]
            .map(|field| Definition::new().with_field(field).with_degree(degree).with_degree_fallback(true))
    });
    let levin = [Definition::new().with_kind(Kind::Levin)];
    for definition in fields.into_iter().chain(levin).chain(degrees) {
        for weight in WEIGHTS {
            for (per_sample, factors) in [(false, false), (false, true), (true, false), (true, true)] {
                each(definition.with_weight(weight), per_sample, factors);
            }
        }
    }
}

#[test]
fn vector_levels_with_fused_multiply_adds_give_the_same_bits() {
    let best = Level::new();
    let Some(narrow) = best.as_avx2().map(Level::Avx2) else { return };
    let mut random = Random::new(14);
    for precision in [Precision::Double, Precision::Single] {
        every_setting(|definition, per_sample, factors| {
            let weight = definition.weight();
            let (_, grid) = cloud::<3>(&mut random, weight, per_sample, factors, precision);
            let mut wide = Evaluator::new(&grid, &definition, best, EVERYTHING);
            let mut narrow = Evaluator::new(&grid, &definition, narrow, EVERYTHING);
            for count in 1..=18 {
                let positions: Vec<Position<3>> =
                    (0..count).map(|_| Position::at([random.uniform(), random.uniform(), 0.1])).collect();
                let (wide, narrow) = (locals(&mut wide, &positions), locals(&mut narrow, &positions));
                for (a, b) in wide.iter().zip(&narrow) {
                    // Every number is printed with all its digits.
                    assert_eq!(format!("{a:?}"), format!("{b:?}"), "{precision:?} {definition:?}");
                }
            }
        });
    }
}

fn sensitivities_sum_to_the_gradient<const D: usize>() {
    let mut random = Random::new(25);
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    every_setting(|definition, per_sample, factors| {
        let (_, grid) = cloud::<D>(&mut random, definition.weight(), per_sample, factors, Precision::Double);
        let mut evaluator = Evaluator::new(&grid, &definition, Level::new(), EVERYTHING);
        let positions: Vec<Position<D>> = (0..8)
            .map(|_| {
                Position::at(std::array::from_fn(|k| if k == D - 1 { 0.1 } else { random.uniform() - 0.5 }))
            })
            .collect();
        for (position, (local, extra)) in positions.iter().zip(locals(&mut evaluator, &positions)) {
            if local.gap < 0.1 || !local.status.is_ok() {
                continue;
            }
            compared += 1;
            let (mut sum, mut squares) = ([0.0; D], 0.0);
            for place in 0..grid.len() {
                let sample = (grid.sample(place).unwrap(), place as u32);
                let g = own_sensitivity((&grid, &definition), sample, position, (&local, &extra));
                sum = add(sum, g);
                squares += dot(g, g);
            }
            // Where few samples determine a polynomial their sensitivities are large, and cancel in the sum.
            let size = length(local.gradient).max(1.0).max(squares.sqrt());
            let errors =
                [length(add(sum, local.gradient)) / size, (squares - extra.sensitivity).abs() / squares];
            let case = format!("{definition:?} {per_sample} {factors} {extra:?}");
            let bound = if definition.degree() == 0 { 1e-11 } else { 1e-8 };
            assert!(errors.iter().all(|e| *e < bound), "{case}: {errors:?}");
            worst = [worst[0].max(errors[0]), worst[1].max(errors[1])];
        }
    });
    println!("D = {D}: {compared} compared, worst {worst:?}");
    assert!(compared > 1000, "{compared}");
}

#[test]
fn the_sensitivities_to_all_samples_sum_to_the_gradient() {
    sensitivities_sum_to_the_gradient::<2>();
    sensitivities_sum_to_the_gradient::<3>();
}
