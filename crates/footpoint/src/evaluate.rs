//! Evaluation: f, its gradient and what belongs to them, in columns.

mod filling;

use crate::columns::Statuses;
use crate::evaluator::{Answers, Pass, Position, Wanted};
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use filling::Columns;
use std::ops::{BitOr, Range};

/// A set of columns of [`Evaluations`]: only these are computed and stored. Join them with `|`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Want(u32);

impl Want {
    /// f.
    pub const VALUE: Self = Self(1);
    /// a.
    pub const AVERAGE: Self = Self(1 << 1);
    /// n.
    pub const FRAME_NORMAL: Self = Self(1 << 2);
    /// ∇f.
    pub const GRADIENT: Self = Self(1 << 3);
    /// ∇f/|∇f|.
    pub const SURFACE_NORMAL: Self = Self(1 << 4);
    /// The gap of the frame.
    pub const GAP: Self = Self(1 << 5);
    /// Samples with positive weight.
    pub const NEIGHBOURS: Self = Self(1 << 6);
    /// (Σθ)²/Σθ².
    pub const EFFECTIVE_NEIGHBOURS: Self = Self(1 << 7);
    /// S = Σθ.
    pub const WEIGHT_SUM: Self = Self(1 << 8);
    /// Eigenvalues of the matrix that gives the frame.
    pub const EIGENVALUES: Self = Self(1 << 9);
    /// Σ|∂f/∂p_i|².
    pub const SQUARED_SENSITIVITY: Self = Self(1 << 10);
    /// h(x).
    pub const SUPPORT: Self = Self(1 << 11);
    /// |a − x| across n over h(x).
    pub const ECCENTRICITY: Self = Self(1 << 12);
    /// ∇²f.
    pub const HESSIAN: Self = Self(1 << 13);
    /// Curvatures of the level set of f.
    pub const CURVATURE: Self = Self(1 << 14);
    /// The standard deviation of f that the samples' noise causes.
    pub const SIGMA: Self = Self(1 << 15);
    /// The degree of the polynomial that answered.
    pub const DEGREE: Self = Self(1 << 16);
    /// Every column.
    pub const ALL: Self = Self((1 << 17) - 1);

    /// Whether all of `other` is in the set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Want {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Answers, one row a query, in the order of the queries. Columns not wanted are empty; a quantity that does not
/// exist at a point is NaN there, and the status says why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluations<const D: usize> {
    /// f, a length: the distance along n to the weighted average; f_L for Levin's surface.
    pub value: Vec<f64>,
    /// a, the weighted average.
    pub average: Vec<[f64; D]>,
    /// n, a unit vector: the normal of the fitted frame, which is not the surface's.
    pub frame_normal: Vec<[f64; D]>,
    /// ∇f, exact.
    pub gradient: Vec<[f64; D]>,
    /// ∇f/|∇f|: the normal of the level set of f through the point.
    pub surface_normal: Vec<[f64; D]>,
    /// (λ1 − λ0)/λ_max, the two largest for averaged axes; |Nv|/S for averaged normals. 1 is best, 0 no frame.
    pub gap: Vec<f64>,
    /// Samples with positive weight.
    pub neighbours: Vec<u32>,
    /// (Σθ)²/Σθ²: how many equally weighted samples would average as much noise away.
    pub effective_neighbours: Vec<f64>,
    /// S = Σθ.
    pub weight_sum: Vec<f64>,
    /// Eigenvalues, ascending: of W, of Σθ e eᵀ (centred) or of Σθ n nᵀ (axes); NaN for averaged normals.
    pub eigenvalues: Vec<[f64; D]>,
    /// Σ|∂f/∂p_i|²: times the square of the samples' noise, the variance of f (first order).
    pub squared_sensitivity: Vec<f64>,
    /// h(x) = Σθh/S, a length.
    pub support: Vec<f64>,
    /// |a − x| across n, over h(x): 0 amid the samples, larger toward a rim. What [`Acceptance::boundary`] bounds.
    ///
    /// [`Acceptance::boundary`]: crate::Acceptance::boundary
    pub eccentricity: Vec<f64>,
    /// ∇²f, one over a length, exact: ∇f in dual numbers. Of a weight that is smooth enough: `Poly2`'s jumps where a sample
    /// enters the support.
    pub hessian: Vec<[[f64; D]; D]>,
    /// Curvatures of the level set of f through the point.
    pub curvature: Curvatures<D>,
    /// √(Σ G_iᵀ C_i G_i), G_i = ∂f/∂p_i, a length (SPEC § 10): first order in the noise, upper at large noise. A query that is
    /// a sample moves with it. NaN where the cloud's noise is not known.
    pub sigma: Vec<f64>,
    /// The degree of the polynomial that answered, 0 where there is no answer: the definition's, or a lower one with
    /// [`degree_fallback`](crate::Definition::with_degree_fallback).
    pub degree: Vec<u32>,
    /// *ok*, *outside*, *degenerate*, *singular* (no gradient, hence no surface normal) or *invalid*.
    pub status: Vec<Status>,
}

/// Curvatures of level sets of f (SPEC § 4), one over a length, positive where the surface bends toward −∇f: a sphere with
/// outward ∇f has 1/R. They flip with the sign of f. NaN where ∇f has no direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curvatures<const D: usize> {
    /// (k1 + k2)/2; in 2-D the curvature.
    pub mean: Vec<f64>,
    /// k1 k2; NaN in 2-D.
    pub gaussian: Vec<f64>,
    /// k1 ≥ k2; in 2-D the curvature and NaN.
    pub principal: Vec<[f64; 2]>,
    /// Unit vectors along the surface in which it bends by k1 and k2, the component of largest magnitude positive; any two across
    /// each other where k1 = k2. In 2-D the tangent and NaN.
    pub directions: Vec<[[f64; D]; 2]>,
}

impl<const D: usize> Surface<D> {
    /// Evaluates f and what belongs to it (SPEC §§ 3 and 4). Relative accuracy 1e-11 where the gap exceeds 0.1.
    pub fn evaluate<'q>(&self, at: impl Into<Queries<'q, D>>, want: Want) -> Evaluations<D> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).evaluate(at, want).unwrap_or_default()
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::evaluate`].
    pub fn evaluate<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
    ) -> Result<Evaluations<D>, Cancelled> {
        let mut found = Evaluations::default();
        self.evaluate_into(at, want, &mut found)?;
        Ok(found)
    }

    /// [`Surface::evaluate`] into columns that are there already: their memory is used again, which saves up to a
    /// quarter of the time. What they hold after an error is not specified.
    pub fn evaluate_into<'q>(
        &self,
        at: impl Into<Queries<'q, D>>,
        want: Want,
        columns: &mut Evaluations<D>,
    ) -> Result<(), Cancelled> {
        let surface = self.surface;
        let queries = at.into();
        let rows = queries.points(surface).len();
        let grouped = Grouped::new(surface, queries, self.run);
        let any = |columns: Want| want.0 & columns.0 != 0;
        let wanted = Wanted {
            moving: false,
            gradient: any(Want::GRADIENT | Want::SURFACE_NORMAL | Want::CURVATURE | Want::SIGMA),
            sensitivity: any(Want::SQUARED_SENSITIVITY | Want::SIGMA),
            statistics: any(Want::NEIGHBOURS | Want::EFFECTIVE_NEIGHBOURS),
            eigenvalues: any(Want::EIGENVALUES),
            hessian: any(Want::HESSIAN | Want::CURVATURE),
            scatter: false,
        };
        let own = if any(Want::SIGMA) { grouped.own_places() } else { Vec::new() };
        let status = Statuses::new(rows);
        let has_gradient = wanted.gradient || wanted.sensitivity;
        let filling = Columns::new((surface, &own), (columns, rows), want, (&status, has_gradient));
        grouped.for_each_group(self.run, wanted, |evaluator, group| {
            let announce = |places: Range<usize>, pass: Pass| {
                group.rows[places].iter().for_each(|&row| filling.expect(row as usize, pass));
            };
            evaluator.evaluate(&group.positions, &announce, |i, answers, lane| {
                let row = group.rows[i] as usize;
                filling.put(row, &group.positions[i], (answers, lane));
            });
            for &row in &group.invalid {
                let nowhere = Position::at([f64::NAN; D]);
                filling.put(row as usize, &nowhere, (&Answers::NOWHERE, 0));
                status.put(row as usize, Status::Invalid);
            }
        })?;
        status.finish(&mut columns.status);
        Ok(())
    }
}
