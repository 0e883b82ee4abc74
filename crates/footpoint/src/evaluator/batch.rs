//! A batch of blocks on its way through the stages: lists, value sums, frames, gradient sums, answers.
//!
//! Each stage runs over the whole batch before the next begins, so that the long chains of the eigenproblems of several
//! blocks overlap. A block has as many positions as the widest vector has lanes; narrower processors take it in parts.

mod hessian;
mod scatters;

use super::answers::{Answers, LANES};
use super::{heights, levin};
use crate::algebra::{dot, each};
use crate::definition::Kind;
use crate::engine::{
    Candidates, Culled, Extent, Frame, FrameSums, General, HeightSums, Heights, List, Mode, Moments, Moved,
    Place, Plain, Position, Resting, Scatter, Statistics, first_pass, second_pass, sensitivity, statistics,
};
use crate::field::NormalField;
use crate::frame::{Fit, LevinFit, fit, gradient, levin_gradient};
use crate::grid::Grid;
use crate::heights::{Degrees, heights_gradient};
use crate::lane::{Lane, Number, vectorized};
use crate::weight::{Kernel, Weight, with_kernel};
use fearless_simd::Level;
use hessian::{Turnings, hessians};
use scatters::scatters;
use std::any::Any;
use std::ops::Range;

/// Blocks of a batch, at most: more would leave the fastest cache.
const BLOCKS: usize = 8;
/// Places in the lists of a batch, at most, unless one block has more: where supports hold ten thousand samples, a batch is
/// one block.
const PLACES: usize = 1 << 15;

/// What to compute, apart from where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) level: Level,
    pub(super) weight: Weight,
    pub(super) kind: Kind,
    pub(super) field: NormalField,
    pub(super) degrees: Degrees,
    pub(super) domain_ratio: f64,
    /// Supports or factors differ.
    pub(super) varied: bool,
    /// Positions have an offset.
    pub(super) moved: bool,
    pub(super) gradient: bool,
    pub(super) sensitivity: bool,
    pub(super) statistics: bool,
    pub(super) eigenvalues: bool,
    pub(super) hessian: bool,
    pub(super) scatter: bool,
}

/// Told of each block before either pass over its candidates: the time to call for the memory that its answers will go to.
pub(crate) type Announce<'a> = &'a dyn Fn(Range<usize>, Pass);

/// The passes over a block's candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    First,
    Second,
}

impl Task {
    /// What dual numbers run in.
    pub(super) fn needs_general_columns(&self) -> bool {
        self.varied || self.hessian
    }

    /// What the first pass sums: polynomials and planes need the positions' second moments whatever the frame does.
    fn summed(&self) -> (NormalField, Moments) {
        let plane = self.degrees.asked > 0 || self.scatter;
        (self.field, if plane { Moments::OfPositions } else { Moments::OfTheField })
    }

    fn needs_statistics(&self) -> bool {
        self.statistics || self.domain_ratio < 1.0
    }
}

/// Positions of a block.
#[derive(Debug)]
pub(super) struct Block<N: Number, const D: usize> {
    anchor: [N::Slot; D],
    offset: [N::Slot; D],
    /// What single precision rounded away.
    residual: [[f64; LANES]; D],
    /// Which of the run's positions these are.
    positions: Range<usize>,
}

/// Where sums are computed for a position, and the way from there to where it is.
#[inline(always)]
pub(super) fn taken_at<N: Culled, const D: usize>(position: &Position<D>) -> ([f64; D], [f64; D]) {
    let (mut at, mut residual) = ([0.0; D], [0.0; D]);
    for k in 0..D {
        (at[k], residual[k]) = N::taken_at(position.anchor[k], position.offset[k]);
    }
    (at, residual)
}

/// One vector's share of a block, and what the stages leave for each other.
#[derive(Debug)]
pub(super) struct Unit<N: Number, const D: usize> {
    pub(super) block: usize,
    /// Its first lane in the block.
    pub(super) lane: usize,
    pub(super) sums: FrameSums<N::Slot, D>,
    statistics: Statistics<N::Slot>,
    pub(super) fit: Fit<N::Slot, D>,
    pub(super) second: [N::Slot; D],
    pub(super) sensitivity: [N::Slot; 2],
    scatter: Scatter<N::Slot>,
}

impl<N: Number, const D: usize> Unit<N, D> {
    fn new(block: usize, lane: usize) -> Self {
        let (zero, vector, matrix) = (N::ZERO_SLOT, [N::ZERO_SLOT; D], [[N::ZERO_SLOT; D]; D]);
        let sums = FrameSums {
            weight: zero,
            first: vector,
            second: matrix,
            normals: vector,
            axes: matrix,
            scales: zero,
        };
        let frame = Frame { normal: vector, aside: vector, turn: vector };
        let fit = Fit { frame, gap: zero, eigenvalues: vector };
        let statistics = Statistics { squares: zero, neighbours: zero, inside: zero };
        let scatter = Scatter { residuals: zero, freedom: zero, squares: zero };
        Self { block, lane, sums, statistics, fit, second: vector, sensitivity: [zero; 2], scatter }
    }
}

/// The blocks and all that is kept from stage to stage: one thread's scratch.
#[derive(Debug)]
pub(super) struct Batch<N: Number, const D: usize> {
    pub(super) candidates: Candidates<N, D>,
    pub(super) blocks: Vec<Block<N, D>>,
    boxes: Vec<Extent<D>>,
    pub(super) units: Vec<Unit<N, D>>,
    /// One a unit for Levin's surface; empty for others.
    pub(super) levin: Vec<LevinFit<N::Slot, D>>,
    /// One a unit for surfaces of higher degree; empty for others.
    pub(super) moments: Vec<HeightSums<N::Slot>>,
    pub(super) heights: Vec<Heights<N::Slot, D>>,
    places: Vec<u32>,
    ends: Vec<usize>,
    /// Closeness of every candidate to every position, unit by unit.
    pub(super) kept: Vec<N::Slot>,
    /// θ and ψ likewise, for surfaces of higher degree.
    pub(super) weights: Vec<[N::Slot; 2]>,
    turnings: Turnings<N, D>,
    answers: Vec<Answers<D>>,
}

impl<N: Culled, const D: usize> Batch<N, D> {
    pub(super) fn new() -> Self {
        Self {
            candidates: Candidates::new(),
            blocks: Vec::new(),
            boxes: Vec::new(),
            units: Vec::new(),
            levin: Vec::new(),
            moments: Vec::new(),
            heights: Vec::new(),
            places: Vec::new(),
            ends: Vec::new(),
            kept: Vec::new(),
            weights: Vec::new(),
            turnings: Turnings::default(),
            answers: Vec::new(),
        }
    }

    /// Evaluates the first of these positions, which the candidates cover, and returns how many they are.
    pub(super) fn run(
        &mut self,
        task: &Task,
        grid: &Grid<D>,
        positions: &[Position<D>],
        announce: Announce<'_>,
    ) -> usize {
        self.blocks.clear();
        self.boxes.clear();
        // Supports are about so wide.
        let reach = 0.7 * grid.typical_side();
        let most = (PLACES / self.candidates.columns.len.max(1)).clamp(1, BLOCKS);
        let mut taken = 0;
        while taken < positions.len() && self.blocks.len() < most {
            taken += self.add_block(reach, taken, &positions[taken..]);
        }
        self.ends.clear();
        self.candidates.sift(&self.boxes, task.level, &mut self.places, &mut self.ends);
        self.answers.resize(self.blocks.len(), Answers::NOWHERE);
        let places: Vec<Range<usize>> = self.blocks.iter().map(|block| block.positions.clone()).collect();
        run_stages(task, self, &|block, pass| announce(places[block].clone(), pass));
        taken
    }

    /// Makes a block of the first of these positions: as many as a vector holds, unless they are so far apart that their
    /// common list is longer than two. The first is number `first`.
    fn add_block(&mut self, reach: f64, first: usize, positions: &[Position<D>]) -> usize {
        let centre = self.candidates.centre;
        let mut block = Block {
            anchor: [N::ZERO_SLOT; D],
            offset: [N::ZERO_SLOT; D],
            residual: [[0.0; LANES]; D],
            positions: first..first,
        };
        let mut extent = Extent::NOTHING;
        let single = Extent { low: [0.0; D], high: [0.0; D] }.samples_around(reach);
        for lane in 0..N::BLOCK {
            let Some(position) = positions.get(lane) else { break };
            let (at, residual) = taken_at::<N, D>(position);
            let wider = extent.joined(&Extent { low: at, high: at });
            let far = lane > 0 && wider.longest_side() > reach;
            if far && wider.samples_around(reach) > extent.samples_around(reach) + single {
                break;
            }
            extent = wider;
            block.positions.end += 1;
            for k in 0..D {
                let (anchor, offset) = N::place(at[k], centre[k], position.anchor[k], position.offset[k]);
                N::lanes(&mut block.anchor[k])[lane] = anchor;
                N::lanes(&mut block.offset[k])[lane] = offset;
                block.residual[k][lane] = residual[k];
            }
        }
        let taken = block.positions.len();
        for slot in block.anchor.iter_mut().chain(&mut block.offset) {
            // Lanes without a position of their own repeat the last.
            let last = N::lanes(slot)[taken - 1];
            N::lanes(slot)[taken..].fill(last);
        }
        self.blocks.push(block);
        self.boxes.push(extent);
        taken
    }

    /// The answers of the last run, block by block: the numbers of its positions, and what was found there.
    pub(super) fn answers(&self) -> impl Iterator<Item = (Range<usize>, &Answers<D>)> {
        self.blocks.iter().map(|block| block.positions.clone()).zip(&self.answers)
    }

    /// The part of the list that belongs to a block.
    pub(super) fn list(&self, block: usize) -> List<'_, N, D> {
        let begin = if block == 0 { 0 } else { self.ends[block - 1] };
        List { columns: &self.candidates.columns, places: &self.places[begin..self.ends[block]] }
    }

    /// The list of the next unit, which belongs to this block, and where its pairs stand in what is kept of them, unit by
    /// unit; `begin` moves on.
    #[inline(always)]
    pub(super) fn next_list(&self, block: usize, begin: &mut usize) -> (List<'_, N, D>, Range<usize>) {
        let list = self.list(block);
        let own = *begin..*begin + list.places.len();
        *begin = own.end;
        (list, own)
    }
}

/// Leads to the stages of one dimension and precision.
///
/// Both are found again at run time, so that the kernels are compiled once, with the library, and not
/// again in every crate that uses it.
fn run_stages(task: &Task, batch: &mut dyn Any, announce: &dyn Fn(usize, Pass)) {
    fn sized<N: Culled, const D: usize>(task: &Task, batch: &mut dyn Any, announce: &dyn Fn(usize, Pass)) {
        let Some(batch) = batch.downcast_mut::<Batch<N, D>>() else { return };
        if task.kind == Kind::Levin {
            return levin::stages::<N, D>(task, batch, announce);
        }
        match task.degrees.asked {
            0 => {}
            1 | 2 => return heights::stages::<N, D, 2>(task, batch, announce),
            _ => return heights::stages::<N, D, 3>(task, batch, announce),
        }
        // Positions of 32 bits have no offset: they lie on the lattice.
        match (task.varied, task.moved && N::HAS_OFFSETS) {
            (true, true) => stages::<N, General, D>(task, batch, announce),
            (true, false) => stages::<N, Resting, D>(task, batch, announce),
            (false, true) => stages::<N, Moved, D>(task, batch, announce),
            (false, false) => stages::<N, Plain, D>(task, batch, announce),
        }
    }
    sized::<f64, 3>(task, batch, announce);
    sized::<f64, 2>(task, batch, announce);
    sized::<f32, 3>(task, batch, announce);
    sized::<f32, 2>(task, batch, announce);
}

fn stages<N: Culled, M: Mode, const D: usize>(
    task: &Task,
    batch: &mut Batch<N, D>,
    announce: &dyn Fn(usize, Pass),
) {
    begin::<N, M, D>(task, batch, announce);
    if task.gradient {
        with_kernel!(task.weight, kernel => {
            vectorized!(task.level, simd => gradient_sums::<N::Lanes<_>, N, _, M, D>(simd, kernel, task, (batch, announce)));
        });
    }
    end(task, batch);
}

/// The stages up to the frames.
pub(super) fn begin<N: Culled, M: Mode, const D: usize>(
    task: &Task,
    batch: &mut Batch<N, D>,
    announce: &dyn Fn(usize, Pass),
) {
    with_kernel!(task.weight, kernel => {
        vectorized!(task.level, simd => value_sums::<N::Lanes<_>, N, _, M, D>(simd, kernel, task, (batch, announce)));
    });
    vectorized!(task.level, simd => frames::<N::Lanes<_>, N, D>(simd, task, batch));
}

/// The last stages.
pub(super) fn end<N: Culled, const D: usize>(task: &Task, batch: &mut Batch<N, D>) {
    if task.hessian {
        hessians::<N, D>(task, batch);
    }
    if task.scatter {
        scatters::<N, D>(task, batch);
    }
    vectorized!(task.level, simd => answers::<N::Lanes<_>, N, D>(simd, task, batch));
}

/// The lane scalar that goes with a number.
pub(super) trait Of<N: Number>: Lane<Number = N, Slot = N::Slot> {}
impl<N: Number, L: Lane<Number = N, Slot = N::Slot>> Of<N> for L {}

#[inline(always)]
pub(super) fn stored<N: Number, L: Of<N>>(value: L) -> N::Slot {
    let mut slot = N::ZERO_SLOT;
    value.store(&mut slot);
    slot
}

/// The positions of a unit.
#[inline(always)]
pub(super) fn place<N: Number, L: Of<N>, const D: usize>(
    token: L::Token,
    block: &Block<N, D>,
    lane: usize,
) -> Place<L, D> {
    let part = |mut whole: N::Slot| {
        let mut part = N::ZERO_SLOT;
        N::lanes(&mut part)[..L::WIDTH].copy_from_slice(&N::lanes(&mut whole)[lane..lane + L::WIDTH]);
        L::load(token, &part)
    };
    Place { anchor: each(|k| part(block.anchor[k])), offset: each(|k| part(block.offset[k])) }
}

#[inline(always)]
fn value_sums<L: Of<N>, N: Culled, K: Kernel, M: Mode, const D: usize>(
    token: L::Token,
    kernel: K,
    task: &Task,
    (batch, announce): (&mut Batch<N, D>, &dyn Fn(usize, Pass)),
) {
    let parts = N::BLOCK / L::WIDTH;
    let mut units = std::mem::take(&mut batch.units);
    let mut kept = std::mem::take(&mut batch.kept);
    units.clear();
    let room = batch.ends.last().map_or(0, |end| end * parts);
    if kept.len() < room {
        kept.resize(room, N::ZERO_SLOT);
    }
    let mut rest = kept.as_mut_slice();
    for (b, block) in batch.blocks.iter().enumerate() {
        let list = batch.list(b);
        announce(b, Pass::First);
        for part in 0..parts {
            let lane = part * L::WIDTH;
            let mut unit = Unit::new(b, lane);
            let (own, after) = rest.split_at_mut(list.places.len());
            rest = after;
            let x = place::<N, L, D>(token, block, lane);
            let sums = first_pass::<L, K, M, D>(kernel, list, &x, task.summed(), own);
            unit.sums = sums.map(stored::<N, L>);
            if task.needs_statistics() {
                let sums = statistics::<L, K, D>((token, task.varied), kernel, list, own, task.domain_ratio);
                unit.statistics = sums.map(stored::<N, L>);
            }
            units.push(unit);
        }
    }
    batch.units = units;
    batch.kept = kept;
}

#[inline(always)]
fn frames<L: Of<N>, N: Culled, const D: usize>(token: L::Token, task: &Task, batch: &mut Batch<N, D>) {
    let load = |slot: N::Slot| L::load(token, &slot);
    for unit in &mut batch.units {
        unit.fit = fit(task.field, &unit.sums.map(load)).map(stored::<N, L>);
    }
}

#[inline(always)]
fn gradient_sums<L: Of<N>, N: Culled, K: Kernel, M: Mode, const D: usize>(
    token: L::Token,
    kernel: K,
    task: &Task,
    (batch, announce): (&mut Batch<N, D>, &dyn Fn(usize, Pass)),
) {
    let mut units = std::mem::take(&mut batch.units);
    let mut begin = 0;
    for unit in &mut units {
        let (list, own) = batch.next_list(unit.block, &mut begin);
        if unit.lane == 0 {
            announce(unit.block, Pass::Second);
        }
        let kept = &batch.kept[own];
        let x = place::<N, L, D>(token, &batch.blocks[unit.block], unit.lane);
        let frame = unit.fit.frame.map(|slot| L::load(token, &slot));
        let second = second_pass::<L, K, M, D>(kernel, list, &x, (task.field, &frame), kept);
        unit.second = each(|k| stored::<N, L>(second[k]));
        if task.sensitivity {
            let sums = sensitivity::<L, K, D>(task.varied, kernel, list, &x, (task.field, &frame), kept);
            unit.sensitivity = sums.map(stored::<N, L>);
        }
    }
    batch.units = units;
}

#[inline(always)]
fn answers<L: Of<N>, N: Culled, const D: usize>(token: L::Token, task: &Task, batch: &mut Batch<N, D>) {
    let load = |slot: N::Slot| L::load(token, &slot);
    for (number, unit) in batch.units.iter().enumerate() {
        let levin = batch.levin.get(number).map(|levin| levin.map(load));
        let out = &mut batch.answers[unit.block];
        let lanes = unit.lane..unit.lane + L::WIDTH;
        let Fit { frame, gap, eigenvalues } = unit.fit.map(load);
        let weight = load(unit.sums.weight);
        let put = |out: &mut [f64; LANES], value: L| value.write(&mut out[lanes.clone()]);
        put(&mut out.weight_sum, weight);
        put(&mut out.support, load(unit.sums.scales) / weight);
        put(&mut out.gap, gap);
        let heights = batch.heights.get(number);
        let value = match (levin, heights) {
            (Some(levin), _) => levin.value,
            (_, Some(heights)) => -load(heights.coefficients[0]),
            _ => -dot(frame.normal, frame.aside),
        };
        put(&mut out.value, value);
        if batch.candidates.columns.has_normals() {
            put(&mut out.along, dot(frame.normal, each(|k| load(unit.sums.normals[k]))));
        }
        let second = each(|k| load(unit.second[k]));
        let gradient = match (levin, heights) {
            _ if !task.gradient => frame.normal,
            (Some(levin), _) => levin_gradient(&levin, weight, second),
            (_, Some(heights)) => heights_gradient(each(|k| load(heights.closed[k])), weight, second),
            _ => gradient(task.field, &frame, weight, second),
        };
        for k in 0..D {
            put(&mut out.aside[k], frame.aside[k]);
            put(&mut out.normal[k], frame.normal[k]);
            put(&mut out.gradient[k], gradient[k]);
            if task.eigenvalues {
                put(&mut out.eigenvalues[k], eigenvalues[k]);
            }
        }
        if task.needs_statistics() {
            let statistics = unit.statistics.map(load);
            put(&mut out.effective_neighbours, weight * weight / statistics.squares);
            put(&mut out.neighbours, statistics.neighbours);
            put(&mut out.inside, statistics.inside);
        } else {
            put(&mut out.inside, weight);
        }
        if task.sensitivity {
            let [plain, noisy] = unit.sensitivity.map(load);
            put(&mut out.sensitivity, plain / (weight * weight));
            put(&mut out.variance, noisy / (weight * weight));
            for k in 0..D {
                put(&mut out.turn[k], levin.map_or(frame.turn[k], |levin| levin.frame.turn[k]));
            }
        }
        if task.scatter {
            let Scatter { residuals, freedom, squares } = unit.scatter.map(load);
            put(&mut out.scatter, residuals / freedom);
            put(&mut out.freedom, freedom * freedom / squares);
        }
        if let Some(heights) = heights {
            put(&mut out.degree, load(heights.degree));
            if task.sensitivity {
                out.put_heights(lanes.start, &heights.map(load));
            }
        }
    }
    for (answers, block) in batch.answers.iter_mut().zip(&batch.blocks) {
        answers.finish::<N>(&block.residual, task);
    }
}
