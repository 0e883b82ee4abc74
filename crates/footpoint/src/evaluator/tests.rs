//! The engine agrees with the oracle, and dual numbers through the same code give the same gradient.

use super::{Evaluator, Extra, Local, Wanted};
use crate::algebra::{dot, length, scale, sub};
use crate::cloud::Cloud;
use crate::definition::Definition;
use crate::dual::Dual;
use crate::engine::oracle::{self, Sample};
use crate::engine::{
    Candidates, Extent, General, List, Mode, Moments, Place, Plain, Position, first_pass, second_pass,
};
use crate::field::NormalField;
use crate::frame::{fit, gradient};
use crate::grid::Grid;
use crate::lane::{Lane, Precision};
use crate::run::Run;
use crate::samples::Random;
use crate::support::Radii;
use crate::weight::{Kernel, Weight, with_kernel};
use fearless_simd::Level;

pub(super) const FIELDS: [NormalField; 4] = [
    NormalField::Covariance,
    NormalField::CentredCovariance,
    NormalField::AveragedNormals,
    NormalField::AveragedAxes,
];

pub(super) const WEIGHTS: [Weight; 6] = [
    Weight::Poly2,
    Weight::Poly3,
    Weight::Poly4,
    Weight::Wendland,
    Weight::GAUSSIAN,
    Weight::Gaussian { cut: 1e-2 },
];

/// A thick, bent sheet of random samples with wild normals, supports and factors; the grid's unit is one.
pub(super) fn cloud<const D: usize>(
    random: &mut Random,
    weight: Weight,
    per_sample: bool,
    factors: bool,
    precision: Precision,
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
    let grid = Grid::new(&cloud, &radii, largest, reach, precision, &Run::new());
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

pub(super) const EVERYTHING: Wanted = Wanted {
    moving: false,
    gradient: true,
    sensitivity: true,
    statistics: true,
    eigenvalues: true,
    hessian: true,
    scatter: true,
};

pub(super) fn locals<const D: usize>(
    evaluator: &mut Evaluator<'_, D>,
    positions: &[Position<D>],
) -> Vec<(Local<D>, Extra<D>)> {
    let mut found = Vec::new();
    evaluator.evaluate(positions, &|_, _| {}, |place, answers, lane| {
        assert_eq!(place, found.len());
        found.push((answers.local(lane), answers.extra(lane)));
    });
    found
}

/// Largest differences of f, n, ∇f (of its direction in single precision) and a from the oracle's where the gap exceeds
/// 0.1, in units of the largest support.
fn off_the_oracle<const D: usize>(precision: Precision, wanted: Wanted, bounds: [f64; 4]) {
    let mut random = Random::new(11);
    let (mut worst, mut compared) = ([0.0_f64; 4], 0);
    every_setting(|weight, field, per_sample, factors| {
        let (samples, grid) = cloud::<D>(&mut random, weight, per_sample, factors, precision);
        let definition = Definition::new().with_weight(weight).with_field(field);
        let mut evaluator = Evaluator::new(&grid, &definition, Level::new(), wanted);
        for _ in 0..5 {
            let centre: [f64; D] = std::array::from_fn(|k| if k == D - 1 { 0.1 } else { random.uniform() });
            let positions: [Position<D>; 8] =
                std::array::from_fn(|_| Position::at(centre.map(|c| c + 0.3 * (random.uniform() - 0.5))));
            let found = locals(&mut evaluator, &positions);
            for (position, (local, _)) in positions.iter().zip(found) {
                assert!(local.status.is_ok());
                if local.gap < 0.1 {
                    continue;
                }
                compared += 1;
                let answer = oracle::evaluate(&samples, weight, field, position.anchor);
                let sign = if dot(answer.normal, local.normal) < 0.0 { -1.0 } else { 1.0 };
                let apart = |a: [f64; D], b: [f64; D]| length(sub(a, scale(b, sign)));
                let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
                let steepness = length(answer.gradient);
                let turned = match precision {
                    Precision::Double => apart(local.gradient, answer.gradient) / steepness.max(1.0),
                    // Where ∇f nearly vanishes its direction is not determined.
                    Precision::Single if steepness < 0.3 => 0.0,
                    Precision::Single => apart(local.surface_normal, scale(answer.gradient, 1.0 / steepness)),
                };
                let errors = [
                    (local.value - sign * answer.value).abs(),
                    apart(local.normal, answer.normal),
                    turned,
                    length(sub(average, answer.average)),
                ];
                for k in 0..4 {
                    let case = format!("{weight:?} {field:?} {per_sample} {factors} {k}");
                    // The Gaussian's support is several of its h: angles are that much less sharp in single precision.
                    let bound = if k == 1 || k == 2 { bounds[k] * weight.reach() } else { bounds[k] };
                    assert!(errors[k] <= bound, "{case}: {:e}, gap {}", errors[k], local.gap);
                    worst[k] = worst[k].max(errors[k]);
                }
            }
        }
    });
    println!("D = {D} {precision:?}: {compared} compared; f, n, ∇f, a off by {worst:?}");
    assert!(compared > 2000, "{compared}");
}

#[test]
fn the_engine_agrees_with_the_oracle() {
    for moving in [false, true] {
        let wanted = Wanted { moving, ..EVERYTHING };
        off_the_oracle::<2>(Precision::Double, wanted, [1e-11; 4]);
        off_the_oracle::<3>(Precision::Double, wanted, [1e-11; 4]);
    }
}

#[test]
fn single_precision_keeps_its_bounds() {
    off_the_oracle::<2>(Precision::Single, EVERYTHING, [2e-7, 2e-5, 2e-5, 2e-6]);
    off_the_oracle::<3>(Precision::Single, EVERYTHING, [2e-7, 2e-5, 2e-5, 2e-6]);
}

/// What both passes give at one place, in general mode or plain.
struct Answer<L, const D: usize> {
    value: L,
    gradient: [L; D],
    gap: L,
}

fn through<L: Lane<Token = (), Number = f64>, M: Mode, K: Kernel, const D: usize>(
    kernel: K,
    candidates: &Candidates<f64, D>,
    field: NormalField,
    x: [L; D],
    empty: L::Slot,
) -> Answer<L, D> {
    let places: Vec<u32> = (0..candidates.columns.len as u32).collect();
    let list = List { columns: &candidates.columns, places: &places };
    let mut kept = vec![empty; places.len()];
    let x = Place { anchor: x, offset: [x[0].like(0.0); D] };
    let sums = first_pass::<L, K, M, D>(kernel, list, &x, (field, Moments::OfTheField), &mut kept);
    let fitted = fit(field, &sums);
    let second = second_pass::<L, K, M, D>(kernel, list, &x, (field, &fitted.frame), &kept);
    Answer {
        value: -dot(fitted.frame.normal, fitted.frame.aside),
        gradient: gradient(field, &fitted.frame, sums.weight, second),
        gap: fitted.gap,
    }
}

pub(super) fn gathered<const D: usize>(grid: &Grid<D>, x: [f64; D], weight: Weight) -> Candidates<f64, D> {
    let mut candidates = Candidates::new();
    candidates.gather(grid, Extent::around([x].into_iter()), weight.reach(), true, Level::new());
    candidates
}

#[test]
fn plain_and_general_mode_agree() {
    let mut random = Random::new(15);
    let mut worst = 0.0_f64;
    for weight in WEIGHTS {
        for field in FIELDS {
            let (_, grid) = cloud::<3>(&mut random, weight, false, false, Precision::Double);
            let x = [0.2 * random.uniform(), 0.1, 0.1];
            let candidates = gathered(&grid, x, weight);
            let (plain, general) = with_kernel!(weight, kernel => (
                through::<f64, Plain, _, 3>(kernel, &candidates, field, x, 0.0),
                through::<f64, General, _, 3>(kernel, &candidates, field, x, 0.0),
            ));
            let errors = [plain.value - general.value, length(sub(plain.gradient, general.gradient))];
            worst = errors.iter().fold(worst, |m, e| m.max(e.abs()));
        }
    }
    assert!(worst < 1e-12, "{worst:e}");
}

fn dual_lanes_give_the_gradient<const D: usize>() {
    let mut random = Random::new(12);
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    every_setting(|weight, field, per_sample, factors| {
        let (_, grid) = cloud::<D>(&mut random, weight, per_sample, factors, Precision::Double);
        for _ in 0..4 {
            let mut x: [f64; D] = std::array::from_fn(|_| random.uniform() - 0.5);
            x[D - 1] = 0.2 * random.uniform();
            let direction: [f64; D] = std::array::from_fn(|_| random.normal());
            let dual: [Dual<f64>; D] = std::array::from_fn(|k| Dual { value: x[k], slope: direction[k] });
            let candidates = gathered(&grid, x, weight);
            let (plain, turning) = with_kernel!(weight, kernel => (
                through::<f64, General, _, D>(kernel, &candidates, field, x, 0.0),
                // The gradient itself in dual numbers: its slope is a row of the second derivatives.
                through::<Dual<f64>, General, _, D>(kernel, &candidates, field, dual, [0.0; 2]),
            ));
            if plain.gap < 0.1 {
                continue;
            }
            compared += 1;
            let size = length(plain.gradient).max(1.0) * length(direction);
            let error = (turning.value.slope - dot(plain.gradient, direction)).abs() / size;
            assert!(error <= 1e-11, "{weight:?} {field:?}: {error:e}, gap {}", plain.gap);
            let values = length(sub(turning.gradient.map(|s| s.value), plain.gradient))
                / length(plain.gradient).max(1.0);
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
        let (_, grid) = cloud::<3>(&mut random, Weight::Poly3, true, true, Precision::Double);
        let x = [0.1, -0.2, 0.15];
        let candidates = gathered(&grid, x, Weight::Poly3);
        let hessian: [[f64; 3]; 3] = std::array::from_fn(|row| {
            let dual = std::array::from_fn(|k| Dual { value: x[k], slope: f64::from(u8::from(k == row)) });
            with_kernel!(Weight::Poly3, kernel => {
                through::<Dual<f64>, General, _, 3>(kernel, &candidates, field, dual, [0.0; 2]).gradient.map(|g| g.slope)
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
