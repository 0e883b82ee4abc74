//! Second derivatives of f: the code of ∇f once more, in dual numbers, one direction at a time (SPEC § 4).

use super::{Batch, Of, Task, place};
use crate::algebra::each;
use crate::definition::Kind;
use crate::dual::Dual;
use crate::engine::{
    Culled, Frame, FrameSums, General, HeightSums, Heights, Place, first_pass, height_sums, height_weights,
    heights_second_pass, levin_second_pass, levin_sums, second_pass,
};
use crate::frame::{Fit, LevinFit, fit, fit_levin, gradient, levin_gradient};
use crate::heights::{fit_heights, heights_gradient};
use crate::lane::{Lane, Number, vectorized_narrow};
use crate::polynomial::{HIGHEST, Plane};
use crate::weight::{Kernel, with_kernel};

/// A dual number in every lane.
type Pair<N> = [<N as Number>::Slot; 2];

/// What the stages leave for each other, for one vector's share of a block.
#[derive(Debug)]
pub(super) struct Turning<N: Number, const D: usize> {
    block: usize,
    lane: usize,
    sums: FrameSums<Pair<N>, D>,
    fit: Fit<Pair<N>, D>,
    levin: LevinFit<Pair<N>, D>,
    second: [Pair<N>; D],
}

/// Scratch for one direction.
#[derive(Debug)]
pub(super) struct Turnings<N: Number, const D: usize> {
    units: Vec<Turning<N, D>>,
    /// One a unit for surfaces of higher degree.
    moments: Vec<HeightSums<Pair<N>>>,
    heights: Vec<Heights<Pair<N>, D>>,
    /// Closeness of every candidate to every position, unit by unit.
    kept: Vec<Pair<N>>,
    /// θ and ψ likewise, for surfaces of higher degree.
    weights: Vec<[Pair<N>; 2]>,
}

impl<N: Number, const D: usize> Default for Turnings<N, D> {
    fn default() -> Self {
        let (units, moments, heights) = (Vec::new(), Vec::new(), Vec::new());
        Self { units, moments, heights, kept: Vec::new(), weights: Vec::new() }
    }
}

/// Fills the answers' second derivatives. Of the kernels only AVX2's and the baseline's are compiled: those of AVX-512 would give
/// the same bits, and the code is long.
pub(super) fn hessians<N: Culled, const D: usize>(task: &Task, batch: &mut Batch<N, D>) {
    let mut turnings = std::mem::take(&mut batch.turnings);
    for along in 0..D {
        with_kernel!(task.weight, kernel => {
            vectorized_narrow!(task.level, simd => {
                value_sums::<N::Lanes<_>, N, _, D>((simd, kernel, task), along, batch, &mut turnings);
            });
        });
        vectorized_narrow!(task.level, simd => frames::<N::Lanes<_>, N, D>(simd, task, &mut turnings));
        if task.degrees.asked > 0 {
            heights::<N, D>(task, along, batch, &mut turnings);
        } else {
            with_kernel!(task.weight, kernel => {
                vectorized_narrow!(task.level, simd => {
                    gradient_sums::<N::Lanes<_>, N, _, D>((simd, kernel, task), along, batch, &mut turnings);
                });
            });
        }
        vectorized_narrow!(task.level, simd => {
            rows::<N::Lanes<_>, N, D>((simd, task), along, batch, &turnings);
        });
    }
    batch.turnings = turnings;
}

/// The stages of higher degree, all of them in the code of the highest: what a lower one leaves out is zero there.
fn heights<N: Culled, const D: usize>(
    task: &Task,
    along: usize,
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    with_kernel!(task.weight, kernel => {
        vectorized_narrow!(task.level, simd => weights::<N::Lanes<_>, N, _, D>((simd, kernel), batch, turnings));
    });
    vectorized_narrow!(task.level, simd => moments::<N::Lanes<_>, N, D>(simd, along, batch, turnings));
    vectorized_narrow!(task.level, simd => polynomials::<N::Lanes<_>, N, D>(simd, task, turnings));
    vectorized_narrow!(task.level, simd => {
        heights_gradient_sums::<N::Lanes<_>, N, D>((simd, task), along, batch, turnings);
    });
}

#[inline(always)]
fn stored<N: Number, L: Of<N>>(dual: Dual<L>) -> Pair<N> {
    let mut pair = [N::ZERO_SLOT; 2];
    dual.store(&mut pair);
    pair
}

/// A position on its way along an axis.
#[inline(always)]
fn moving<L: Lane, const D: usize>(x: &Place<L, D>, along: usize) -> Place<Dual<L>, D> {
    let slope = |k: usize| x.offset[k].like(if k == along { 1.0 } else { 0.0 });
    Place {
        anchor: each(|k| Dual::constant(x.anchor[k])),
        offset: each(|k| Dual { value: x.offset[k], slope: slope(k) }),
    }
}

#[inline(always)]
fn value_sums<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    (token, kernel, task): (L::Token, K, &Task),
    along: usize,
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    turnings.units.clear();
    let parts = N::BLOCK / L::WIDTH;
    let room = batch.ends.last().map_or(0, |end| end * parts);
    if turnings.kept.len() < room {
        turnings.kept.resize(room, [N::ZERO_SLOT; 2]);
    }
    let mut rest = turnings.kept.as_mut_slice();
    for (b, block) in batch.blocks.iter().enumerate() {
        let list = batch.list(b);
        for part in 0..parts {
            let lane = part * L::WIDTH;
            let (own, after) = rest.split_at_mut(list.places.len());
            rest = after;
            let x = moving(&place::<N, L, D>(token, block, lane), along);
            let sums = first_pass::<Dual<L>, K, General, D>(kernel, list, &x, task.summed(), own);
            let zero = [N::ZERO_SLOT; 2];
            let frame = Frame { normal: [zero; D], aside: [zero; D], turn: [zero; D] };
            turnings.units.push(Turning {
                block: b,
                lane,
                sums: sums.map(stored::<N, L>),
                fit: Fit { frame, gap: zero, eigenvalues: [zero; D] },
                levin: LevinFit { frame, value: zero, steepness: zero },
                second: [zero; D],
            });
        }
    }
}

#[inline(always)]
fn frames<L: Of<N>, N: Culled, const D: usize>(token: L::Token, task: &Task, turnings: &mut Turnings<N, D>) {
    for unit in &mut turnings.units {
        let sums = unit.sums.map(|pair| Dual::<L>::load(token, &pair));
        unit.fit = fit(task.field, &sums).map(stored::<N, L>);
    }
}

#[inline(always)]
fn gradient_sums<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    (token, kernel, task): (L::Token, K, &Task),
    along: usize,
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    let mut begin = 0;
    for unit in &mut turnings.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let kept = &turnings.kept[own];
        let x = moving(&place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane), along);
        let load = |pair: Pair<N>| Dual::<L>::load(token, &pair);
        let fit = unit.fit.map(load);
        let second = if task.kind == Kind::Levin {
            let sums = levin_sums::<Dual<L>, K, D>(kernel, list, &x, fit.frame.normal, kept);
            let levin = fit_levin(&unit.sums.map(load), &fit, &sums);
            unit.levin = levin.map(stored::<N, L>);
            levin_second_pass::<Dual<L>, K, D>(kernel, list, &x, (&levin.frame, levin.value), kept)
        } else {
            second_pass::<Dual<L>, K, General, D>(kernel, list, &x, (task.field, &fit.frame), kept)
        };
        unit.second = each(|k| stored::<N, L>(second[k]));
    }
}

#[inline(always)]
fn weights<L: Of<N>, N: Culled, K: Kernel, const D: usize>(
    (token, kernel): (L::Token, K),
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    if turnings.weights.len() < turnings.kept.len() {
        turnings.weights.resize(turnings.kept.len(), [[N::ZERO_SLOT; 2]; 2]);
    }
    let mut begin = 0;
    for unit in &turnings.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let columns = (&turnings.kept[own.clone()], &mut turnings.weights[own]);
        height_weights::<Dual<L>, K, D>(token, kernel, list, columns);
    }
}

#[inline(always)]
fn moments<L: Of<N>, N: Culled, const D: usize>(
    token: L::Token,
    along: usize,
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    turnings.moments.clear();
    let mut begin = 0;
    for unit in &turnings.units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let weights = &turnings.weights[own];
        let x = moving(&place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane), along);
        let load = |pair: Pair<N>| Dual::<L>::load(token, &pair);
        let support = load(unit.sums.scales) / load(unit.sums.weight);
        let plane = Plane::new(each(|k| load(unit.fit.frame.normal[k])), support);
        let sums = height_sums::<Dual<L>, D, HIGHEST>(list, &x, &plane, weights);
        turnings.moments.push(sums.map(stored::<N, L>));
    }
}

#[inline(always)]
fn polynomials<L: Of<N>, N: Culled, const D: usize>(
    token: L::Token,
    task: &Task,
    turnings: &mut Turnings<N, D>,
) {
    let load = |pair: Pair<N>| Dual::<L>::load(token, &pair);
    turnings.heights.clear();
    for (unit, moments) in turnings.units.iter().zip(&turnings.moments) {
        let (sums, fit) = (unit.sums.map(load), unit.fit.map(load));
        let how = (task.field, task.degrees);
        let found = fit_heights::<Dual<L>, D, HIGHEST>(how, &sums, &fit, &moments.map(load));
        turnings.heights.push(found.map(stored::<N, L>));
    }
}

#[inline(always)]
fn heights_gradient_sums<L: Of<N>, N: Culled, const D: usize>(
    (token, task): (L::Token, &Task),
    along: usize,
    batch: &Batch<N, D>,
    turnings: &mut Turnings<N, D>,
) {
    let mut begin = 0;
    for (unit, heights) in turnings.units.iter_mut().zip(&turnings.heights) {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        let weights = &turnings.weights[own];
        let x = moving(&place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane), along);
        let fit = heights.map(|pair: Pair<N>| Dual::<L>::load(token, &pair));
        let second = heights_second_pass::<Dual<L>, D, HIGHEST>(list, &x, (task.field, &fit), weights);
        unit.second = each(|k| stored::<N, L>(second[k]));
    }
}

/// How ∇f changes along the axis.
#[inline(always)]
fn rows<L: Of<N>, N: Culled, const D: usize>(
    (token, task): (L::Token, &Task),
    along: usize,
    batch: &mut Batch<N, D>,
    turnings: &Turnings<N, D>,
) {
    let load = |pair: Pair<N>| Dual::<L>::load(token, &pair);
    for (number, unit) in turnings.units.iter().enumerate() {
        let second = each(|k| load(unit.second[k]));
        let weight = load(unit.sums.weight);
        let gradient = if task.kind == Kind::Levin {
            levin_gradient(&unit.levin.map(load), weight, second)
        } else if task.degrees.asked > 0 {
            heights_gradient(each(|k| load(turnings.heights[number].closed[k])), weight, second)
        } else {
            gradient(task.field, &unit.fit.frame.map(load), weight, second)
        };
        let row = &mut batch.answers[unit.block].hessian[along];
        for k in 0..D {
            gradient[k].slope.write(&mut row[k][unit.lane..unit.lane + L::WIDTH]);
        }
    }
}
