//! The stage that looks how the samples scatter about their plane.

use super::{Batch, Of, Task, place, stored};
use crate::algebra::each;
use crate::engine::{Culled, Regression, scatter};
use crate::lane::vectorized;
use crate::weight::{Kernel, with_kernel};

pub(super) fn scatters<N: Culled, const D: usize>(task: &Task, batch: &mut Batch<N, D>) {
    with_kernel!(task.weight, kernel => {
        vectorized!(task.level, simd => run::<N::Lanes<_>, N, _, D>(simd, kernel, task, batch));
    });
}

#[inline(always)]
fn run<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    token: L::Token,
    kernel: K,
    task: &Task,
    batch: &mut Batch<N, D>,
) {
    let mut units = std::mem::take(&mut batch.units);
    let mut begin = 0;
    for unit in &mut units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let load = |slot: N::Slot| L::load(token, &slot);
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let plane = Regression::new(&unit.sums.map(load), each(|k| load(unit.fit.frame.normal[k])));
        let sums = scatter::<L, K, D>(task.varied, kernel, list, &x, &plane, &batch.kept[own]);
        unit.scatter = sums.map(stored::<N, L>);
    }
    batch.units = units;
}
