//! The stages of surfaces of higher degree: those of every frame, then moments, polynomials, and the sums of the gradient.

use super::batch::{Batch, Of, Pass, Task, begin, end, place, stored};
use crate::algebra::each;
use crate::engine::{
    Culled, General, Heights, height_sums, height_weights, heights_second_pass, heights_sensitivity,
};
use crate::heights::fit_heights;
use crate::lane::vectorized;
use crate::polynomial::Plane;
use crate::weight::{Kernel, with_kernel};

/// For polynomials of degree M and below.
pub(super) fn stages<N: Culled, const D: usize, const M: usize>(
    task: &Task,
    batch: &mut Batch<N, D>,
    announce: &dyn Fn(usize, Pass),
) {
    begin::<N, General, D>(task, batch, announce);
    with_kernel!(task.weight, kernel => {
        vectorized!(task.level, simd => weights::<N::Lanes<_>, N, _, D>(simd, kernel, batch));
    });
    vectorized!(task.level, simd => moments::<N::Lanes<_>, N, D, M>(simd, batch));
    vectorized!(task.level, simd => polynomials::<N::Lanes<_>, N, D, M>(simd, task, batch));
    if task.gradient {
        vectorized!(task.level, simd => gradient_sums::<N::Lanes<_>, N, D, M>(simd, task, batch, announce));
    }
    if task.sensitivity {
        vectorized!(task.level, simd => sensitivities::<N::Lanes<_>, N, D, M>(simd, task, batch));
    }
    end(task, batch);
}

#[inline(always)]
fn weights<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    batch: &mut Batch<N, D>,
) {
    let mut weights = std::mem::take(&mut batch.weights);
    if weights.len() < batch.kept.len() {
        weights.resize(batch.kept.len(), [N::ZERO_SLOT; 2]);
    }
    let mut begin = 0;
    for unit in &batch.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        height_weights::<L, K, D>(token, kernel, list, (&batch.kept[own.clone()], &mut weights[own]));
    }
    batch.weights = weights;
}

#[inline(always)]
fn moments<L: Of<N>, N: Culled, const D: usize, const M: usize>(token: L::Token, batch: &mut Batch<N, D>) {
    let mut moments = std::mem::take(&mut batch.moments);
    moments.clear();
    let mut begin = 0;
    for unit in &batch.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let weights = &batch.weights[own];
        let load = |slot: N::Slot| L::load(token, &slot);
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let support = load(unit.sums.scales) / load(unit.sums.weight);
        let plane = Plane::new(each(|k| load(unit.fit.frame.normal[k])), support);
        let sums = height_sums::<L, D, M>(list, &x, &plane, weights);
        moments.push(sums.map(stored::<N, L>));
    }
    batch.moments = moments;
}

#[inline(always)]
fn polynomials<L: Of<N>, N: Culled, const D: usize, const M: usize>(
    token: L::Token,
    task: &Task,
    batch: &mut Batch<N, D>,
) {
    let load = |slot: N::Slot| L::load(token, &slot);
    batch.heights.clear();
    for (unit, moments) in batch.units.iter().zip(&batch.moments) {
        let (sums, fit) = (unit.sums.map(load), unit.fit.map(load));
        let found = fit_heights::<L, D, M>((task.field, task.degrees), &sums, &fit, &moments.map(load));
        batch.heights.push(found.map(stored::<N, L>));
    }
}

#[inline(always)]
fn gradient_sums<L: Of<N>, N: Culled, const D: usize, const M: usize>(
    token: L::Token,
    task: &Task,
    batch: &mut Batch<N, D>,
    announce: &dyn Fn(usize, Pass),
) {
    let mut units = std::mem::take(&mut batch.units);
    let mut begin = 0;
    for (unit, heights) in units.iter_mut().zip(&batch.heights) {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        if unit.lane == 0 {
            announce(unit.block, Pass::Second);
        }
        let weights = &batch.weights[own];
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let fit: Heights<L, D> = heights.map(|slot| L::load(token, &slot));
        let second = heights_second_pass::<L, D, M>(list, &x, (task.field, &fit), weights);
        unit.second = each(|k| stored::<N, L>(second[k]));
    }
    batch.units = units;
}

#[inline(always)]
fn sensitivities<L: Of<N>, N: Culled, const D: usize, const M: usize>(
    token: L::Token,
    task: &Task,
    batch: &mut Batch<N, D>,
) {
    let mut units = std::mem::take(&mut batch.units);
    let mut begin = 0;
    for (unit, heights) in units.iter_mut().zip(&batch.heights) {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let weights = &batch.weights[own];
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let fit: Heights<L, D> = heights.map(|slot| L::load(token, &slot));
        let sums = heights_sensitivity::<L, D, M>(list, &x, (task.field, &fit), weights);
        unit.sensitivity = sums.map(stored::<N, L>);
    }
    batch.units = units;
}
