//! A probe: a sample with its neighbours, and the surface near it on every level.

use super::fit::{Fitted, fit, in_space};
use super::moments::{FrameMoments, Moments, Near};
use crate::algebra::{add_scaled, dot, length, scale};
use crate::definition::Definition;
use crate::eigen::smallest;
use crate::polynomial::Plane;
use crate::weight::{Kernel, with_kernel};

/// Parts that the samples are dealt to: each replica of the jackknife lacks one.
pub(super) const PARTS: usize = 5;
/// The whole and the replicas.
pub(super) const COPIES: usize = 1 + PARTS;
/// Steps towards the surface, and |f| in units of the radius at which it is reached.
const STEPS: usize = 12;
const REACHED: f64 = 1e-3;
/// Within so many radii of the surface a place tells of it what a foot point would.
const NEAR_ENOUGH: f64 = 0.05;

/// A radius in units of the tree and a degree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    pub(super) h: f64,
    pub(super) degree: u8,
}

/// A sample's neighbours, dealt to the parts, each part by distance; ways are from the sample.
pub(super) struct Around<const D: usize> {
    pub(super) parts: [Vec<Near<D>>; PARTS],
    /// Of degree 0 by this weight: its rule decides what is surface.
    pub(super) definition: Definition,
}

/// A point of the surface near a probe, as its way from the probe's sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot<const D: usize> {
    pub(super) way: [f64; D],
    /// ∇f/|∇f|.
    pub(super) normal: [f64; D],
}

/// What a level says at a probe.
#[derive(Clone, Debug)]
pub(super) struct Evidence<const D: usize> {
    /// The surface's height over the probe's place along the pilot's normal's side: of the whole, then of the replicas.
    pub(super) heights: [f64; COPIES],
    /// Unit normals on the same side.
    pub(super) normals: [[f64; D]; COPIES],
    /// Mean curvatures; NaN below degree 2.
    pub(super) bends: [f64; COPIES],
    /// Whether the rule of SPEC § 8 accepts all copies.
    pub(super) accepted: bool,
    /// Whether the sample finds the level's surface.
    pub(super) found: bool,
}

impl<const D: usize> Around<D> {
    fn lists(&self, (at, h): ([f64; D], f64)) -> [&[Near<D>]; PARTS] {
        let reach = h * self.definition.weight().reach() + length(at);
        let square = reach * reach;
        self.parts.each_ref().map(|part| &part[..part.partition_point(|near| near.square < square)])
    }

    /// The frame of centred covariance at a place; the last axis is n. None where no sample has weight.
    fn frame<K: Kernel>(
        &self,
        kernel: K,
        place: ([f64; D], f64),
    ) -> Option<(FrameMoments<D>, [[f64; D]; D])> {
        let sums = FrameMoments::over(kernel, self.lists(place).into_iter(), place);
        if sums.weight.is_nan() || sums.weight <= 0.0 {
            return None;
        }
        Some((sums, axes(smallest(sums.centred()).vector)))
    }

    fn moments<K: Kernel>(&self, kernel: K, place: ([f64; D], f64), axes: &[[f64; D]; D]) -> Moments {
        let mut all = Moments::NONE;
        for list in self.lists(place) {
            all += &Moments::over(kernel, list, place, axes);
        }
        all
    }

    /// Follows n from a place to the surface of a level; None where that is not found or not accepted.
    pub(super) fn project(&self, from: [f64; D], level: Level) -> Option<Foot<D>> {
        with_kernel!(self.definition.weight(), kernel => self.project_with(kernel, from, level))
    }

    fn project_with<K: Kernel>(&self, kernel: K, from: [f64; D], level: Level) -> Option<Foot<D>> {
        // Where whole steps lead nowhere, halves may: between two sheets f bends.
        self.follow(kernel, from, (level, 1.0)).or_else(|| self.follow(kernel, from, (level, 0.5)))
    }

    fn follow<K: Kernel>(&self, kernel: K, from: [f64; D], (level, pace): (Level, f64)) -> Option<Foot<D>> {
        let mut at = from;
        for _ in 0..STEPS {
            let place = (at, level.h);
            let (sums, axes) = self.frame(kernel, place)?;
            let n = axes[D - 1];
            if level.degree == 0 {
                let value = -dot(n, sums.aside());
                if value.is_nan() {
                    return None;
                }
                if value.abs() > REACHED {
                    at = add_scaled(at, n, -pace * value * level.h);
                    continue;
                }
            }
            let fitted: Fitted<D> = fit(&self.moments(kernel, place, &axes), level.degree)?;
            if fitted.value.is_nan() {
                return None;
            }
            if fitted.value.abs() > REACHED {
                at = add_scaled(at, n, -pace * fitted.value * level.h);
                continue;
            }
            let accepted = fitted.is_accepted(&self.definition);
            let normal = in_space(scale(fitted.gradient, 1.0 / length(fitted.gradient)), &axes);
            return accepted.then_some(Foot { way: at, normal });
        }
        None
    }

    /// What the levels of one radius say at a foot of the pilot's, in the order of `degrees`.
    pub(super) fn evidence(&self, foot: &Foot<D>, h: f64, degrees: &[u8]) -> Vec<Evidence<D>> {
        with_kernel!(self.definition.weight(), kernel => self.evidence_with(kernel, foot, h, degrees))
    }

    fn evidence_with<K: Kernel>(
        &self,
        kernel: K,
        foot: &Foot<D>,
        h: f64,
        degrees: &[u8],
    ) -> Vec<Evidence<D>> {
        let place = (foot.way, h);
        let Some((_, axes)) = self.frame(kernel, place) else {
            return degrees.iter().map(|_| Evidence::NONE).collect();
        };
        let lists = self.lists(place);
        let parts = lists.map(|list| Moments::over(kernel, list, place, &axes));
        let mut whole = Moments::NONE;
        parts.iter().for_each(|part| whole += part);
        let of_level = |&degree: &u8| {
            let mut evidence = Evidence::NONE;
            evidence.accepted = true;
            for copy in 0..COPIES {
                let fitted = match copy {
                    0 => fit(&whole, degree),
                    _ => fit(&whole.without(&parts[copy - 1]), degree),
                };
                evidence.take(copy, fitted.as_ref(), (foot, h, &axes), &self.definition);
            }
            // SPEC § 8 judges zeros: where this level's lies elsewhere it is sought.
            evidence.found = (evidence.accepted && evidence.heights[0].abs() < NEAR_ENOUGH * h)
                || self.project_with(kernel, [0.0; D], Level { h, degree }).is_some();
            evidence
        };
        degrees.iter().map(of_level).collect()
    }
}

/// Axes along a plane, of unit length, and its normal.
fn axes<const D: usize>(normal: [f64; D]) -> [[f64; D]; D] {
    let plane = Plane::new(normal, 1.0);
    std::array::from_fn(|k| if k == D - 1 { normal } else { plane.along[k] })
}

impl<const D: usize> Evidence<D> {
    const NONE: Self = Self {
        heights: [f64::NAN; COPIES],
        normals: [[f64::NAN; D]; COPIES],
        bends: [f64::NAN; COPIES],
        accepted: false,
        found: false,
    };

    fn take(
        &mut self,
        copy: usize,
        fitted: Option<&Fitted<D>>,
        (foot, h, axes): (&Foot<D>, f64, &[[f64; D]; D]),
        definition: &Definition,
    ) {
        let Some(fitted) = fitted else {
            self.accepted = false;
            return;
        };
        let unit = in_space(scale(fitted.gradient, 1.0 / length(fitted.gradient)), axes);
        let side = if dot(unit, foot.normal) < 0.0 { -1.0 } else { 1.0 };
        self.heights[copy] = side * fitted.way() * h;
        self.normals[copy] = scale(unit, side);
        self.bends[copy] = side * fitted.bend / h;
        self.accepted &= fitted.is_accepted(definition) && self.heights[copy].is_finite();
    }
}
