//! Rays and where they meet the surface (SPEC §§ 8, 9).

mod march;
mod waves;

use crate::algebra::{dot, scale};
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

    /// What |f| is compared with: nobody asks where a hit of any kind is.
    fn effective_tolerance(&self) -> f64 {
        match self.sought {
            Sought::First => self.tolerance,
            Sought::Any => self.tolerance.max(1e-3),
        }
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

    /// All zeros along rays that belong to the surface; which hit the definition of `how` seeks does not matter.
    pub fn cast_all(&self, rays: &[Ray<D>], how: &Cast) -> AllHits<D> {
        let run = Run::new();
        self.with(&run).cast_all(rays, how).unwrap_or_default()
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::cast`].
    pub fn cast(&self, rays: &[Ray<D>], how: &Cast) -> Result<Hits<D>, Cancelled> {
        let mut found = waves::cast(self, rays, (how, waves::Stop::AtFirst))?;
        let mut hits = Hits::nowhere(rays.len());
        hits.evaluations = found.evaluations;
        hits.status = found.status;
        for hit in found.hits.drain(..) {
            hits.put(hit.ray as usize, &rays[hit.ray as usize], &hit);
        }
        Ok(hits)
    }

    /// [`Surface::cast_all`].
    pub fn cast_all(&self, rays: &[Ray<D>], how: &Cast) -> Result<AllHits<D>, Cancelled> {
        let first = Cast { sought: Sought::First, ..*how };
        let found = waves::cast(self, rays, (&first, waves::Stop::AtEnd))?;
        let mut all = AllHits { hits: Hits::nowhere(found.hits.len()), begins: vec![0; rays.len() + 1] };
        for (row, hit) in found.hits.iter().enumerate() {
            let ray = hit.ray as usize;
            all.hits.put(row, &rays[ray], hit);
            all.hits.evaluations[row] = found.evaluations[ray];
            all.begins[ray + 1] = row + 1;
        }
        for ray in 0..rays.len() {
            all.begins[ray + 1] = all.begins[ray + 1].max(all.begins[ray]);
        }
        Ok(all)
    }
}

/// A hit, lengths in the unit of the samples.
#[derive(Clone, Copy, Debug)]
struct Hit<const D: usize> {
    ray: u32,
    t: f64,
    point: [f64; D],
    surface_normal: [f64; D],
    frame_normal: [f64; D],
    gradient: [f64; D],
}

impl<const D: usize> Hits<D> {
    fn nowhere(rows: usize) -> Self {
        let vectors = || vec![[f64::NAN; D]; rows];
        Self {
            t: vec![f64::NAN; rows],
            point: vectors(),
            surface_normal: vectors(),
            frame_normal: vectors(),
            gradient: vectors(),
            evaluations: vec![0; rows],
            status: vec![Status::Outside; rows],
        }
    }

    fn put(&mut self, row: usize, ray: &Ray<D>, hit: &Hit<D>) {
        let away = dot(hit.surface_normal, ray.direction) > 0.0;
        self.t[row] = hit.t;
        self.point[row] = hit.point;
        self.surface_normal[row] = scale(hit.surface_normal, if away { -1.0 } else { 1.0 });
        self.frame_normal[row] = hit.frame_normal;
        self.gradient[row] = hit.gradient;
        self.status[row] = Status::Ok;
    }
}
