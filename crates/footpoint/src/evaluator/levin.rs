//! The stages of Levin's surface: those of every frame, then f_L, then the sums of its gradient.

use super::batch::{Batch, Of, Pass, Task, begin, end, place, stored};
use crate::algebra::each;
use crate::engine::{Culled, General, levin_second_pass, levin_sensitivity, levin_sums};
use crate::frame::{LevinFit, fit_levin};
use crate::lane::vectorized;
use crate::weight::{Kernel, with_kernel};

pub(super) fn stages<N: Culled, const D: usize>(
    task: &Task,
    batch: &mut Batch<N, D>,
    announce: &dyn Fn(usize, Pass),
) {
    begin::<N, General, D>(task, batch, announce);
    with_kernel!(task.weight, kernel => {
        vectorized!(task.level, simd => values::<N::Lanes<_>, N, _, D>(simd, kernel, batch));
    });
    if task.gradient {
        with_kernel!(task.weight, kernel => {
            vectorized!(task.level, simd => gradient_sums::<N::Lanes<_>, N, _, D>(simd, kernel, task, (batch, announce)));
        });
    }
    end(task, batch);
}

#[inline(always)]
fn values<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    batch: &mut Batch<N, D>,
) {
    let mut fits = std::mem::take(&mut batch.levin);
    fits.clear();
    let load = |slot: N::Slot| L::load(token, &slot);
    let mut begin = 0;
    for unit in &batch.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let kept = &batch.kept[own];
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let fit = unit.fit.map(load);
        let sums = levin_sums::<L, K, D>(kernel, list, &x, fit.frame.normal, kept);
        fits.push(fit_levin(&unit.sums.map(load), &fit, &sums).map(stored::<N, L>));
    }
    batch.levin = fits;
}

#[inline(always)]
fn gradient_sums<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    task: &Task,
    (batch, announce): (&mut Batch<N, D>, &dyn Fn(usize, Pass)),
) {
    let mut units = std::mem::take(&mut batch.units);
    let mut begin = 0;
    for (unit, fit) in units.iter_mut().zip(&batch.levin) {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        if unit.lane == 0 {
            announce(unit.block, Pass::Second);
        }
        let kept = &batch.kept[own];
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let LevinFit { frame, value, .. } = fit.map(|slot| L::load(token, &slot));
        let second = levin_second_pass::<L, K, D>(kernel, list, &x, (&frame, value), kept);
        unit.second = each(|k| stored::<N, L>(second[k]));
        if task.sensitivity {
            let sums = levin_sensitivity::<L, K, D>(kernel, list, &x, (&frame, value), kept);
            unit.sensitivity = sums.map(stored::<N, L>);
        }
    }
    batch.units = units;
}
