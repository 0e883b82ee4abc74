//! Levin's surface in the engine: the oracle's numbers, the gradient that dual numbers give, a symmetric Hessian.

use super::Evaluator;
use super::tests::{EVERYTHING, WEIGHTS, cloud, gathered, locals};
use crate::algebra::{dot, length, scale, sub};
use crate::definition::{Definition, Kind};
use crate::dual::Dual;
use crate::engine::{
    Candidates, General, List, Moments, Place, Position, first_pass, levin_second_pass, levin_sums, oracle,
};
use crate::field::NormalField;
use crate::frame::{fit, fit_levin, levin_gradient};
use crate::lane::{Lane, Precision};
use crate::samples::Random;
use crate::weight::{Kernel, Weight, with_kernel};
use fearless_simd::Level;

fn every_setting(mut each: impl FnMut(Weight, bool, bool)) {
    for weight in WEIGHTS {
        for (per_sample, factors) in [(false, false), (false, true), (true, false), (true, true)] {
            each(weight, per_sample, factors);
        }
    }
}

/// Largest differences of f_L, n and ∇f_L (of its direction in single precision) where the gap exceeds 0.1.
fn off_the_oracle<const D: usize>(precision: Precision, bounds: [f64; 3]) {
    let mut random = Random::new(21);
    let (mut worst, mut compared) = ([0.0_f64; 3], 0);
    every_setting(|weight, per_sample, factors| {
        let (samples, grid) = cloud::<D>(&mut random, weight, per_sample, factors, precision);
        let definition = Definition::new().with_weight(weight).with_kind(Kind::Levin);
        let mut evaluator = Evaluator::new(&grid, &definition, Level::new(), EVERYTHING);
        for _ in 0..10 {
            let centre: [f64; D] = std::array::from_fn(|k| if k == D - 1 { 0.1 } else { random.uniform() });
            let mut positions: Vec<Position<D>> =
                (0..8).map(|_| Position::at(centre.map(|c| c + 0.3 * (random.uniform() - 0.5)))).collect();
            // r = 0.
            positions.push(Position::at(samples[7].0));
            let found = locals(&mut evaluator, &positions);
            for (position, (local, extra)) in positions.iter().zip(found) {
                if local.gap < 0.1 {
                    continue;
                }
                compared += 1;
                assert!(local.status.is_ok() && extra.sensitivity > 0.0);
                let answer = oracle::levin(&samples, weight, position.anchor);
                let sign = if dot(answer.normal, local.normal) < 0.0 { -1.0 } else { 1.0 };
                let apart = |a: [f64; D], b: [f64; D]| length(sub(a, scale(b, sign)));
                let steepness = length(answer.gradient);
                let turned = match precision {
                    Precision::Double => apart(local.gradient, answer.gradient) / steepness.max(1.0),
                    Precision::Single if steepness < 0.3 => 0.0,
                    Precision::Single => apart(local.surface_normal, scale(answer.gradient, 1.0 / steepness)),
                };
                let errors = [
                    (local.value - sign * answer.value).abs(),
                    apart(local.normal, answer.normal) / weight.reach(),
                    turned / weight.reach(),
                ];
                for k in 0..3 {
                    let case = format!("{weight:?} {per_sample} {factors} {k}");
                    assert!(errors[k] <= bounds[k], "{case}: {:e}, gap {}", errors[k], local.gap);
                    worst[k] = worst[k].max(errors[k]);
                }
            }
        }
    });
    println!("D = {D} {precision:?}: {compared} compared; f_L, n, ∇f_L off by {worst:?}");
    assert!(compared > 1000, "{compared}");
}

#[test]
fn the_engine_agrees_with_the_oracle() {
    off_the_oracle::<2>(Precision::Double, [1e-11; 3]);
    off_the_oracle::<3>(Precision::Double, [1e-11; 3]);
}

#[test]
fn single_precision_keeps_its_bounds() {
    off_the_oracle::<2>(Precision::Single, [5e-7, 2e-5, 2e-5]);
    off_the_oracle::<3>(Precision::Single, [5e-7, 2e-5, 2e-5]);
}

/// f_L and ∇f_L through all passes, and the gap.
fn through<L: Lane<Token = (), Number = f64>, K: Kernel, const D: usize>(
    kernel: K,
    candidates: &Candidates<f64, D>,
    x: [L; D],
    empty: L::Slot,
) -> (L, [L; D], L) {
    let places: Vec<u32> = (0..candidates.columns.len as u32).collect();
    let list = List { columns: &candidates.columns, places: &places };
    let mut kept = vec![empty; places.len()];
    let x = Place { anchor: x, offset: [x[0].like(0.0); D] };
    let field = NormalField::Covariance;
    let sums = first_pass::<L, K, General, D>(kernel, list, &x, (field, Moments::OfTheField), &mut kept);
    let fitted = fit(field, &sums);
    let levin = levin_sums(kernel, list, &x, fitted.frame.normal, &kept);
    let levin = fit_levin(&sums, &fitted, &levin);
    let second = levin_second_pass(kernel, list, &x, (&levin.frame, levin.value), &kept);
    (levin.value, levin_gradient(&levin, sums.weight, second), fitted.gap)
}

fn dual_lanes_give_the_gradient<const D: usize>() {
    let mut random = Random::new(22);
    let (mut worst, mut compared) = (0.0_f64, 0);
    every_setting(|weight, per_sample, factors| {
        let (_, grid) = cloud::<D>(&mut random, weight, per_sample, factors, Precision::Double);
        for _ in 0..8 {
            let mut x: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
            x[D - 1] = 0.2 * random.uniform();
            let direction: [f64; D] = std::array::from_fn(|_| random.normal());
            let dual: [Dual<f64>; D] = std::array::from_fn(|k| Dual { value: x[k], slope: direction[k] });
            let candidates = gathered(&grid, x, weight);
            let (plain, turning) = with_kernel!(weight, kernel => (
                through::<f64, _, D>(kernel, &candidates, x, 0.0),
                through::<Dual<f64>, _, D>(kernel, &candidates, dual, [0.0; 2]),
            ));
            if plain.2 < 0.1 {
                continue;
            }
            compared += 1;
            let size = length(plain.1).max(1.0) * length(direction);
            let error = (turning.0.slope - dot(plain.1, direction)).abs() / size;
            assert!(error <= 1e-11, "{weight:?}: {error:e}, gap {}", plain.2);
            worst = worst.max(error);
        }
    });
    println!("D = {D}: {compared} compared, worst {worst:e}");
    assert!(compared > 100, "{compared}");
}

#[test]
fn dual_numbers_give_the_gradient() {
    dual_lanes_give_the_gradient::<2>();
    dual_lanes_give_the_gradient::<3>();
}

#[test]
fn second_derivatives_come_from_the_code_of_the_first() {
    let mut random = Random::new(23);
    for weight in [Weight::Poly3, Weight::Poly4, Weight::Wendland, Weight::GAUSSIAN] {
        let (_, grid) = cloud::<3>(&mut random, weight, true, true, Precision::Double);
        let x = [0.1, -0.2, 0.15];
        let candidates = gathered(&grid, x, weight);
        let hessian: [[f64; 3]; 3] = std::array::from_fn(|row| {
            let dual = std::array::from_fn(|k| Dual { value: x[k], slope: f64::from(u8::from(k == row)) });
            with_kernel!(weight, kernel => through::<Dual<f64>, _, 3>(kernel, &candidates, dual, [0.0; 2]))
                .1
                .map(|g| g.slope)
        });
        let size = hessian.iter().flatten().fold(0.0_f64, |m, h| m.max(h.abs()));
        assert!(size > 1e-3);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let skew = (hessian[i][j] - hessian[j][i]).abs() / size;
            assert!(skew < 1e-11, "{weight:?}: {skew:e} in {hessian:?}");
        }
    }
}
