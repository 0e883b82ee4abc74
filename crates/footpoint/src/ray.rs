//! Rays and where they meet the surface (SPEC §§ 8, 9).

use crate::algebra::{add_scaled, dot, length, scale};
use crate::evaluate::Want;
use crate::queries::Queries;
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use std::ops::Range;

/// The points origin + t·direction. The direction need not be a unit vector: t is measured in its lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<const D: usize> {
    /// Where t is 0.
    pub origin: [f64; D],
    /// Finite and not zero, or the ray is *invalid*.
    pub direction: [f64; D],
}

/// Which hit of a ray is sought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Sought {
    /// The one with the smallest t.
    #[default]
    First,
    /// Any one: enough to know what is in shadow.
    Any,
}

/// How to cast rays: which hit, between which t, how exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Cast {
    sought: Sought,
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    tolerance: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    from: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    to: f64,
}

impl Default for Cast {
    fn default() -> Self {
        Self { sought: Sought::First, tolerance: 1e-6, from: 0.0, to: f64::INFINITY }
    }
}

impl Cast {
    /// The first hit from the origin on, to 1e-6 h.
    pub fn new() -> Self {
        Self::default()
    }

    /// Seeks this hit.
    pub fn with_sought(mut self, sought: Sought) -> Self {
        self.sought = sought;
        self
    }

    /// A hit is a point where |f| is at most this many local supports. NaN counts as 0.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = if tolerance.is_nan() { 0.0 } else { tolerance };
        self
    }

    /// Seeks hits between these t; a NaN bounds nothing.
    pub fn with_range(mut self, range: Range<f64>) -> Self {
        self.from = if range.start.is_nan() { f64::NEG_INFINITY } else { range.start };
        self.to = if range.end.is_nan() { f64::INFINITY } else { range.end };
        self
    }
}

/// One hit a ray, in the order of the rays; NaN where a ray has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits<const D: usize> {
    /// Where along the ray, in lengths of its direction.
    pub t: Vec<f64>,
    /// The point.
    pub point: Vec<[f64; D]>,
    /// ∇f/|∇f|, turned to face the ray: its product with the direction is not positive.
    pub surface_normal: Vec<[f64; D]>,
    /// n, with the sign of every evaluation.
    pub frame_normal: Vec<[f64; D]>,
    /// ∇f, with the sign of every evaluation.
    pub gradient: Vec<[f64; D]>,
    /// Evaluations of f spent on the ray.
    pub evaluations: Vec<u32>,
    /// *ok* for a hit. Else what became of the first zero of f that was met and not accepted; *outside* where none was met.
    pub status: Vec<Status>,
}

/// Every hit of every ray.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AllHits<const D: usize> {
    /// The hits of the first ray, of the second, and so on, each ray's with ascending t.
    pub hits: Hits<D>,
    /// Where each ray's hits begin, and where the last's end.
    pub begins: Vec<usize>,
}

impl<const D: usize> AllHits<D> {
    /// The rows of a ray's hits.
    pub fn of(&self, ray: usize) -> Range<usize> {
        self.begins[ray]..self.begins[ray + 1]
    }
}

impl<const D: usize> Surface<D> {
    /// Where rays meet the surface: the zeros of f along them that belong to it (SPEC § 8). One bad ray never fails the batch.
    pub fn cast(&self, rays: &[Ray<D>], how: &Cast) -> Hits<D> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).cast(rays, how).unwrap_or_default()
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::cast`].
    pub fn cast(&self, rays: &[Ray<D>], how: &Cast) -> Result<Hits<D>, Cancelled> {
        let surface = self.surface;
        let h = surface.support().median;
        let one = Run::new().threads(1);
        let want = Want::VALUE | Want::FRAME_NORMAL | Want::GRADIENT | Want::SURFACE_NORMAL;
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for p in surface.cloud().points() {
            for k in 0..D {
                low[k] = low[k].min(p[k] - h);
                high[k] = high[k].max(p[k] + h);
            }
        }
        let mut found = Hits::default();
        for ray in rays {
            self.run.check()?;
            let (mut near, mut far) = (how.from, how.to);
            for k in 0..D {
                let (a, b) = ((low[k] - ray.origin[k]) / ray.direction[k], (high[k] - ray.origin[k]) / ray.direction[k]);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            let step = 0.1 * h / length(ray.direction);
            let count = if far > near { ((far - near) / step).ceil() as usize } else { 0 };
            let at = |t: f64| add_scaled(ray.origin, ray.direction, t);
            let points: Vec<[f64; D]> = (0..count).map(|i| at(near + i as f64 * step)).collect();
            let all = surface.with(&one).evaluate(Queries::Points(&points), want)?;
            let mut hit = None;
            for i in 1..count {
                if !(all.status[i - 1].is_ok() && all.status[i].is_ok()) {
                    continue;
                }
                let along = dot(all.frame_normal[i - 1], all.frame_normal[i]);
                if all.value[i - 1] * all.value[i] * along > 0.0 {
                    continue;
                }
                let (mut a, mut b) = (near + (i - 1) as f64 * step, near + i as f64 * step);
                for _ in 0..40 {
                    let middle = surface.with(&one).evaluate(Queries::Points(&[at(0.5 * (a + b))]), want)?;
                    let along = dot(all.frame_normal[i - 1], middle.frame_normal[0]);
                    if all.value[i - 1] * middle.value[0] * along > 0.0 { a = 0.5 * (a + b) } else { b = 0.5 * (a + b) }
                }
                let last = surface.with(&one).evaluate(Queries::Points(&[at(a)]), want)?;
                if dot(last.frame_normal[0], last.gradient[0]) > 0.3 {
                    hit = Some((a, last));
                    break;
                }
            }
            match hit {
                Some((t, here)) => {
                    found.t.push(t);
                    found.point.push(at(t));
                    let normal = here.surface_normal[0];
                    let sign = if dot(normal, ray.direction) > 0.0 { -1.0 } else { 1.0 };
                    found.surface_normal.push(scale(normal, sign));
                    found.frame_normal.push(here.frame_normal[0]);
                    found.gradient.push(here.gradient[0]);
                    found.status.push(Status::Ok);
                }
                None => {
                    found.t.push(f64::NAN);
                    found.point.push([f64::NAN; D]);
                    found.surface_normal.push([f64::NAN; D]);
                    found.frame_normal.push([f64::NAN; D]);
                    found.gradient.push([f64::NAN; D]);
                    found.status.push(Status::Outside);
                }
            }
            found.evaluations.push(count as u32);
        }
        Ok(found)
    }
}
