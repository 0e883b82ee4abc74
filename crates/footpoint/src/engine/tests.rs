//! The engine agrees with the oracle, and dual numbers through the same code give the same gradient.

use super::oracle::{self, Sample};
use super::{BLOCK, Candidates, Needs, Position, first_pass, second_pass};
use crate::algebra::{dot, length, scale, sub};
use crate::cloud::Cloud;
use crate::definition::Definition;
use crate::evaluator::{Depth, Evaluator};
use crate::field::{NormalField, fit, gradient};
use crate::grid::Grid;
use crate::lane::tests::Dual;
use crate::run::Run;
use crate::samples::Random;
use crate::support::Radii;
use crate::weight::{Weight, with_kernel};
use fearless_simd::Level;

const FIELDS: [NormalField; 4] = [
    NormalField::Covariance,
    NormalField::CentredCovariance,
    NormalField::AveragedNormals,
    NormalField::AveragedAxes,
];

const WEIGHTS: [Weight; 6] = [
    Weight::Poly2,
    Weight::Poly3,
    Weight::Poly4,
    Weight::Wendland,
    Weight::GAUSSIAN,
    Weight::Gaussian { cut: 1e-2 },
];

/// A thick, bent sheet of random samples with wild normals, supports and factors; the grid's unit is one.
fn cloud<const D: usize>(
    random: &mut Random,
    weight: Weight,
    per_sample: bool,
    factors: bool,
) -> (Vec<Sample<D>>, Grid<D>) {
    let reach = weight.reach();
    let count = if D == 2 { 60 } else { 250 };
    let samples: Vec<Sample<D>> = (0..count)
        .map(|_| {
            let mut p: [f64; D] = std::array::from_fn(|_| 3.0 * random.uniform() - 1.5);
            p[D - 1] = 0.15 * (random.normal() + p[0] * p[0]);
            let mut n: [f64; D] = std::array::from_fn(|_| 0.2 * random.normal());
            n[D - 1] += 1.0;
            let h = if per_sample { 0.8 + 0.8 * random.uniform() } else { 1.1 } / reach;
            let factor = if factors { 0.5 + random.uniform() } else { 1.0 };
            (p, scale(n, 1.0 / length(n)), h, factor)
        })
        .collect();
    let mut cloud = Cloud::new(samples.iter().map(|s| s.0).collect::<Vec<_>>())
        .with_normals(samples.iter().map(|s| s.1).collect::<Vec<_>>())
        .unwrap();
    if factors {
        cloud = cloud.with_factors(samples.iter().map(|s| s.3).collect::<Vec<_>>()).unwrap();
    }
    let (radii, largest) = if per_sample {
        (Radii::PerSample(samples.iter().map(|s| s.2).collect()), 1.6 / reach)
    } else {
        (Radii::Uniform(1.1 / reach), 1.1 / reach)
    };
    let grid = Grid::new(&cloud, &radii, largest, reach, &Run::new());
    assert_eq!(grid.unit, 1.0);
    (samples, grid)
}

fn every_setting(mut each: impl FnMut(Weight, NormalField, bool, bool)) {
    for weight in WEIGHTS {
        for field in FIELDS {
            for per_sample in [false, true] {
                for factors in [false, true] {
                    each(weight, field, per_sample, factors);
                }
            }
        }
    }
}

fn agrees_with_the_oracle<const D: usize>() {
    let mut random = Random::new(11);
    let (mut worst, mut compared) = ([0.0_f64; 4], 0);
    every_setting(|weight, field, per_sample, factors| {
        let (samples, grid) = cloud::<D>(&mut random, weight, per_sample, factors);
        let definition = Definition::new().with_weight(weight).with_field(field);
        let mut evaluator = Evaluator::new(&grid, &definition, Level::new());
        for _ in 0..5 {
            let centre: [f64; D] = std::array::from_fn(|k| if k == D - 1 { 0.1 } else { random.uniform() });
            let positions: [Position<f64, D>; BLOCK] =
                std::array::from_fn(|_| Position::at(centre.map(|c| c + 0.3 * (random.uniform() - 0.5))));
            let found = evaluator.evaluate(&positions, Depth::Sensitivity);
            for (position, local) in positions.iter().zip(found) {
                assert!(local.status.is_ok());
                if local.gap < 0.1 {
                    continue;
                }
                compared += 1;
                let answer = oracle::evaluate(&samples, weight, field, position.anchor);
                let sign = if dot(answer.normal, local.normal) < 0.0 { -1.0 } else { 1.0 };
                let apart = |a: [f64; D], b: [f64; D]| length(sub(a, scale(b, sign)));
                let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
                let errors = [
                    (local.value - sign * answer.value).abs(),
                    apart(local.normal, answer.normal),
                    apart(local.gradient, answer.gradient) / length(answer.gradient).max(1.0),
                    length(sub(average, answer.average)),
                ];
                for k in 0..4 {
                    let bound = 1e-11;
                    let case = format!("{weight:?} {field:?} {per_sample} {factors} {k}");
                    assert!(errors[k] <= bound, "{case}: {:e}, gap {}", errors[k], local.gap);
                    worst[k] = worst[k].max(errors[k]);
                }
            }
        }
    });
    println!("D = {D}: {compared} compared; f, n, ∇f, a off by {worst:?}");
    assert!(compared > 2000, "{compared}");
}

#[test]
fn the_engine_agrees_with_the_oracle() {
    agrees_with_the_oracle::<2>();
    agrees_with_the_oracle::<3>();
}

fn dual_lanes_give_the_gradient<const D: usize>() {
    let mut random = Random::new(12);
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    every_setting(|weight, field, per_sample, factors| {
        let (_, grid) = cloud::<D>(&mut random, weight, per_sample, factors);
        let mut list = Candidates::new();
        let needs = Needs { second: true, axes: true, sensitivity: false, domain: 1.0 };
        for _ in 0..4 {
            let mut x: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
            x[D - 1] = 0.2 * random.uniform();
            let direction: [f64; D] = std::array::from_fn(|_| random.normal());
            let position = Position::at(x);
            list.cover(&grid, &[position], 0.0, weight.reach(), Level::new());
            let dual: [Dual; D] = std::array::from_fn(|k| Dual { value: x[k], slope: direction[k] });
            let (f, steepness, slopes, gap) = with_kernel!(weight, kernel => {
                let sums = first_pass(kernel, &list, position, needs);
                let real = fit(field, &sums);
                let second = second_pass(kernel, &list, position, &real.frame, needs);
                let exact = gradient(&real.frame, sums.weight, second.gradient);
                let sums = first_pass(kernel, &list, Position::at(dual), needs);
                let fitted = fit(field, &sums);
                let f = -dot(fitted.frame.normal, fitted.frame.aside);
                // The gradient itself in dual numbers: its slope is a row of the second derivatives.
                let second = second_pass(kernel, &list, Position::at(dual), &fitted.frame, needs);
                let turning = gradient(&fitted.frame, sums.weight, second.gradient);
                (f, exact, turning, real.gap)
            });
            if gap < 0.1 {
                continue;
            }
            compared += 1;
            let size = length(steepness).max(1.0) * length(direction);
            let error = (f.slope - dot(steepness, direction)).abs() / size;
            assert!(error <= 1e-11, "{weight:?} {field:?}: {error:e}, gap {gap}");
            let values = length(sub(slopes.map(|s| s.value), steepness)) / length(steepness).max(1.0);
            assert!(values <= 1e-12, "{weight:?} {field:?}: {values:e}");
            worst = [worst[0].max(error), worst[1].max(values)];
        }
    });
    println!("D = {D}: {compared} compared, worst {worst:?}");
    assert!(compared > 200, "{compared}");
}

#[test]
fn dual_numbers_fit_the_lanes_and_give_the_gradient() {
    dual_lanes_give_the_gradient::<2>();
    dual_lanes_give_the_gradient::<3>();
}

#[test]
fn second_derivatives_come_from_the_code_of_the_first() {
    // A symmetric Hessian through dual numbers is a sharp test: nothing makes it symmetric but being right.
    let mut random = Random::new(13);
    for field in FIELDS {
        let (_, grid) = cloud::<3>(&mut random, Weight::Poly3, true, true);
        let needs = Needs { second: true, axes: true, sensitivity: false, domain: 1.0 };
        let x = [0.1, -0.2, 0.15];
        let mut list = Candidates::new();
        list.cover(&grid, &[Position::at(x)], 0.0, 1.0, Level::new());
        let hessian: [[f64; 3]; 3] = std::array::from_fn(|row| {
            let dual = Position::at(std::array::from_fn(|k| Dual {
                value: x[k],
                slope: f64::from(u8::from(k == row)),
            }));
            with_kernel!(Weight::Poly3, kernel => {
                let sums = first_pass(kernel, &list, dual, needs);
                let fitted = fit(field, &sums);
                let second = second_pass(kernel, &list, dual, &fitted.frame, needs);
                gradient(&fitted.frame, sums.weight, second.gradient).map(|g| g.slope)
            })
        });
        let size = hessian.iter().flatten().fold(0.0_f64, |m, h| m.max(h.abs()));
        assert!(size > 1e-3);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let skew = (hessian[i][j] - hessian[j][i]).abs() / size;
            assert!(skew < 1e-11, "{field:?}: {skew:e} in {hessian:?}");
        }
    }
}

#[test]
fn vector_levels_with_fused_multiply_adds_give_the_same_bits() {
    let best = Level::new();
    let Some(narrow) = best.as_avx2().map(Level::Avx2) else { return };
    let mut random = Random::new(14);
    every_setting(|weight, field, per_sample, factors| {
        let (_, grid) = cloud::<3>(&mut random, weight, per_sample, factors);
        let definition = Definition::new().with_weight(weight).with_field(field);
        let mut wide = Evaluator::new(&grid, &definition, best);
        let mut narrow = Evaluator::new(&grid, &definition, narrow);
        for count in 1..=BLOCK {
            let positions: Vec<Position<f64, 3>> =
                (0..count).map(|_| Position::at([random.uniform(), random.uniform(), 0.1])).collect();
            let wide = wide.evaluate(&positions, Depth::Sensitivity);
            let narrow = narrow.evaluate(&positions, Depth::Sensitivity);
            for (a, b) in wide.iter().zip(narrow) {
                assert_eq!(a.status, b.status);
                assert_eq!(
                    a.gradient.map(f64::to_bits),
                    b.gradient.map(f64::to_bits),
                    "{weight:?} {field:?}"
                );
                assert_eq!(a.value.to_bits(), b.value.to_bits());
                assert_eq!(a.sensitivity.to_bits(), b.sensitivity.to_bits());
            }
        }
    });
}
