//! What is known at the positions of a block, and the rules that read it.

use super::batch::Task;
use crate::algebra::{Matrix, dot, length, tangential};
use crate::definition::Definition;
use crate::engine::Heights;
use crate::field::NormalField;
use crate::lane::{Lane, Number};
use crate::status::Status;

/// Positions of the widest block.
pub(super) const LANES: usize = 16;

/// Gaps below so many units in the last place do not determine a frame (SPEC § 3): 1e-12 in double precision.
const DEGENERATE_GAP: f64 = 4500.0;

/// Gradients shorter than so many units in the last place over the gap have no direction: the rounding error of ∇f grows as
/// one over the gap.
const SMALLEST_GRADIENT: f64 = 450.0;

/// Everything at the positions of a block, a lane each, lengths in units of the grid. Quantities that do not exist are NaN.
#[derive(Clone, Debug)]
pub(crate) struct Answers<const D: usize> {
    /// S.
    pub(super) weight_sum: [f64; LANES],
    /// (Σθ)²/Σθ², neighbours and domain balls around: where statistics were asked for.
    pub(super) effective_neighbours: [f64; LANES],
    pub(super) neighbours: [f64; LANES],
    pub(super) inside: [f64; LANES],
    /// h(x).
    pub(super) support: [f64; LANES],
    /// u = a(x) − x.
    pub(super) aside: [[f64; LANES]; D],
    pub(super) gap: [f64; LANES],
    pub(super) eigenvalues: [[f64; LANES]; D],
    pub(super) normal: [[f64; LANES]; D],
    pub(super) value: [f64; LANES],
    pub(super) gradient: [[f64; LANES]; D],
    /// ∇f/|∇f|, where ∇f has a direction.
    surface_normal: [[f64; LANES]; D],
    pub(super) sensitivity: [f64; LANES],
    /// Σ G_iᵀ C_i G_i for the samples' own noise, and g of the frame: with the sensitivity.
    pub(super) variance: [f64; LANES],
    pub(super) turn: [[f64; LANES]; D],
    /// Row k: how ∇f changes along axis k.
    pub(super) hessian: [[[f64; LANES]; D]; D],
    /// n·Nv: zero where no normal of a sample decided the sign.
    pub(super) along: [f64; LANES],
    /// s² of the samples about their plane, and from how many it comes: (Σw(1−H))²/Σw²(1−H)².
    pub(super) scatter: [f64; LANES],
    pub(super) freedom: [f64; LANES],
    /// Degree of the polynomial.
    pub(super) degree: [f64; LANES],
    /// The polynomials of higher degree: with the sensitivity.
    heights: Option<Box<Heights<[f64; LANES], D>>>,
}

impl<const D: usize> Answers<D> {
    /// Nothing exists anywhere.
    pub(crate) const NOWHERE: Self = Self {
        weight_sum: [f64::NAN; LANES],
        effective_neighbours: [f64::NAN; LANES],
        neighbours: [0.0; LANES],
        inside: [0.0; LANES],
        support: [f64::NAN; LANES],
        aside: [[f64::NAN; LANES]; D],
        gap: [f64::NAN; LANES],
        eigenvalues: [[f64::NAN; LANES]; D],
        normal: [[f64::NAN; LANES]; D],
        value: [f64::NAN; LANES],
        gradient: [[f64::NAN; LANES]; D],
        surface_normal: [[f64::NAN; LANES]; D],
        sensitivity: [f64::NAN; LANES],
        variance: [f64::NAN; LANES],
        turn: [[f64::NAN; LANES]; D],
        hessian: [[[f64::NAN; LANES]; D]; D],
        along: [0.0; LANES],
        scatter: [f64::NAN; LANES],
        freedom: [f64::NAN; LANES],
        degree: [0.0; LANES],
        heights: None,
    };

    /// Takes f from where it was computed to where it was asked for, and replaces what does not exist by NaN.
    #[inline(always)]
    pub(super) fn finish<N: Number>(&mut self, residual: &[[f64; LANES]; D], task: &Task) {
        let mut exists = [false; LANES];
        let mut framed = [false; LANES];
        let keep = |kept: bool, value: f64| if kept { value } else { f64::NAN };
        for i in 0..N::BLOCK {
            exists[i] = self.inside[i] > 0.0;
            let gap = if self.gap[i].is_nan() { 0.0 } else { self.gap[i] };
            self.gap[i] = keep(exists[i], gap);
            framed[i] = exists[i] && gap >= DEGENERATE_GAP * N::EPSILON;
            self.weight_sum[i] = keep(exists[i], self.weight_sum[i]);
            self.effective_neighbours[i] = keep(exists[i], self.effective_neighbours[i]);
            self.support[i] = keep(exists[i], self.support[i]);
            self.degree[i] = if framed[i] { self.degree[i] } else { 0.0 };
            // No polynomial, no f.
            let answered = framed[i] && !self.value[i].is_nan();
            self.sensitivity[i] = keep(answered, self.sensitivity[i]);
        }
        let has_matrix = task.field != NormalField::AveragedNormals;
        let mut squares = [0.0; LANES];
        for k in 0..D {
            for i in 0..N::BLOCK {
                // To first order: the way is below a millionth of h.
                self.value[i] += self.gradient[k][i] * residual[k][i];
                self.aside[k][i] = keep(exists[i], self.aside[k][i] - residual[k][i]);
                self.eigenvalues[k][i] = keep(exists[i] && has_matrix, self.eigenvalues[k][i]);
                self.normal[k][i] = keep(framed[i], self.normal[k][i]);
                self.gradient[k][i] = keep(framed[i] && task.gradient, self.gradient[k][i]);
                squares[i] += self.gradient[k][i] * self.gradient[k][i];
            }
        }
        let mut inverse = [0.0; LANES];
        for i in 0..N::BLOCK {
            self.value[i] = keep(framed[i], self.value[i]);
            let length = squares[i].sqrt();
            let steep = length * self.gap[i] >= SMALLEST_GRADIENT * N::EPSILON && length < f64::INFINITY;
            inverse[i] = keep(steep, 1.0 / length);
        }
        let mut squares = [0.0; LANES];
        for k in 0..D {
            for i in 0..N::BLOCK {
                self.surface_normal[k][i] = self.gradient[k][i] * inverse[i];
                squares[i] += self.surface_normal[k][i] * self.surface_normal[k][i];
            }
        }
        // Once more: the first division leaves the length a few roundings from one.
        for i in 0..N::BLOCK {
            squares[i] = 1.0 / squares[i].sqrt();
        }
        for k in 0..D {
            for i in 0..N::BLOCK {
                self.surface_normal[k][i] *= squares[i];
            }
        }
    }

    /// The second derivatives at one position, if they were asked for and a frame exists.
    pub(crate) fn hessian(&self, lane: usize) -> Matrix<f64, D> {
        let at = |i: usize, k: usize| self.hessian[i][k][lane];
        let framed = !self.value[lane].is_nan();
        std::array::from_fn(|i| {
            std::array::from_fn(|k| if framed { 0.5 * at(i, k) + 0.5 * at(k, i) } else { f64::NAN })
        })
    }

    /// Keeps the polynomials of as many lanes as a vector has, the first of them this one.
    #[inline(always)]
    pub(super) fn put_heights<L: Lane>(&mut self, first: usize, heights: &Heights<L, D>) {
        let kept = self.heights.get_or_insert_with(|| Box::new(heights.map(|_| [f64::NAN; LANES])));
        **kept = kept.joined(heights, |mut lanes, vector| {
            vector.write(&mut lanes[first..first + L::WIDTH]);
            lanes
        });
    }

    /// One position's answers.
    #[inline(always)]
    pub(crate) fn local(&self, lane: usize) -> Local<D> {
        let status = if self.support[lane].is_nan() {
            Status::Outside
        } else if self.value[lane].is_nan() {
            Status::Degenerate
        } else {
            Status::Ok
        };
        Local {
            status,
            support: self.support[lane],
            aside: at(&self.aside, lane),
            gap: self.gap[lane],
            normal: at(&self.normal, lane),
            value: self.value[lane],
            gradient: at(&self.gradient, lane),
            surface_normal: at(&self.surface_normal, lane),
            signed: self.along[lane] > 0.0,
        }
    }

    /// What is rarely asked for at one position.
    #[inline(always)]
    pub(crate) fn extra(&self, lane: usize) -> Extra<D> {
        Extra {
            neighbours: self.neighbours[lane] as u32,
            weight_sum: self.weight_sum[lane],
            effective_neighbours: self.effective_neighbours[lane],
            eigenvalues: at(&self.eigenvalues, lane),
            sensitivity: self.sensitivity[lane],
            variance: if self.value[lane].is_nan() { f64::NAN } else { self.variance[lane] },
            turn: at(&self.turn, lane),
            scatter: self.scatter[lane],
            freedom: self.freedom[lane],
            degree: self.degree[lane] as u8,
            heights: self.heights.as_ref().map(|heights| heights.map(|lanes| lanes[lane])),
        }
    }
}

#[inline(always)]
fn at<const D: usize>(vector: &[[f64; LANES]; D], lane: usize) -> [f64; D] {
    std::array::from_fn(|k| vector[k][lane])
}

/// What is rarely asked for at one position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra<const D: usize> {
    pub(crate) neighbours: u32,
    /// S.
    pub(crate) weight_sum: f64,
    pub(crate) effective_neighbours: f64,
    pub(crate) eigenvalues: [f64; D],
    pub(crate) sensitivity: f64,
    /// Σ G_iᵀ C_i G_i for the samples' own noise.
    pub(crate) variance: f64,
    /// g of the frame.
    pub(crate) turn: [f64; D],
    /// s², and from how many samples it comes.
    pub(crate) scatter: f64,
    pub(crate) freedom: f64,
    /// Degree of the polynomial.
    pub(crate) degree: u8,
    /// The polynomial of higher degree.
    pub(crate) heights: Option<Heights<f64, D>>,
}

/// The frame, f and ∇f at one position, lengths in units of the grid. Quantities that do not exist are NaN.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local<const D: usize> {
    /// *ok*, *outside* or *degenerate*.
    pub(crate) status: Status,
    /// h(x).
    pub(crate) support: f64,
    /// u = a(x) − x.
    pub(crate) aside: [f64; D],
    pub(crate) gap: f64,
    pub(crate) normal: [f64; D],
    pub(crate) value: f64,
    pub(crate) gradient: [f64; D],
    /// ∇f/|∇f|; NaN where ∇f has no direction.
    pub(crate) surface_normal: [f64; D],
    /// Whether normals of the samples decided the sign.
    pub(crate) signed: bool,
}

impl<const D: usize> Local<D> {
    /// Nothing exists here.
    pub(crate) const NOWHERE: Self = Self {
        status: Status::Outside,
        support: f64::NAN,
        aside: [f64::NAN; D],
        gap: f64::NAN,
        normal: [f64::NAN; D],
        value: f64::NAN,
        gradient: [f64::NAN; D],
        surface_normal: [f64::NAN; D],
        signed: false,
    };

    /// n·∇f.
    pub(crate) fn alignment(&self) -> f64 {
        dot(self.normal, self.gradient)
    }

    /// The part of a − x across n: only this tells of a rim.
    pub(crate) fn across(&self) -> f64 {
        length(tangential(self.aside, self.normal))
    }

    /// Whether ∇f has a direction.
    pub(crate) fn has_surface_normal(&self) -> bool {
        !self.surface_normal[0].is_nan()
    }

    /// The rule of SPEC § 8, for a position where f vanishes.
    pub(crate) fn acceptance(&self, definition: &Definition) -> Status {
        match self.status {
            Status::Ok => definition.verdict::<D>(self.gap, self.alignment(), (self.across(), self.support)),
            status => status,
        }
    }

    /// The same for an answer that has a surface normal.
    pub(crate) fn verdict(&self, definition: &Definition) -> Status {
        match self.acceptance(definition) {
            Status::Ok if !self.has_surface_normal() => Status::Singular,
            verdict => verdict,
        }
    }
}
