//! What is known of f at a point, and whether a zero of it belongs to the curve.

use super::Contour;
use crate::algebra::{dot, length, sub};
use crate::evaluate::Want;
use crate::queries::Queries;
use crate::run::Cancelled;
use crate::surface::Running;

/// What contouring wants to know of a point; a value that is NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) value: f64,
    pub(super) normal: [f64; 2],
    pub(super) gradient: [f64; 2],
    pub(super) surface_normal: [f64; 2],
    pub(super) support: f64,
    /// |a − x|, a length.
    pub(super) aside: f64,
    /// |f| is as small as is asked for.
    pub(super) is_zero: bool,
    /// A zero here belongs to the curve.
    pub(super) is_accepted: bool,
}

/// Evaluates points and applies the rule of acceptance (SPEC § 8).
pub(super) struct Judge<'r> {
    pub(super) running: Running<'r, 2>,
    tolerance: f64,
    /// Bound on |a − x|/h.
    pub(super) boundary: f64,
    pub(super) evaluations: usize,
}

impl<'r> Judge<'r> {
    pub(super) fn new(running: Running<'r, 2>, how: &Contour) -> Self {
        let boundary = running.surface.definition().boundary_limit::<2>();
        Self { running, tolerance: how.tolerance, boundary, evaluations: 0 }
    }

    pub(super) fn see(&mut self, points: &[[f64; 2]]) -> Result<Vec<Seen>, Cancelled> {
        let want = Want::VALUE
            | Want::AVERAGE
            | Want::FRAME_NORMAL
            | Want::GRADIENT
            | Want::SURFACE_NORMAL
            | Want::GAP
            | Want::SUPPORT
            | Want::ECCENTRICITY;
        self.evaluations += points.len();
        let e = self.running.evaluate(Queries::Points(points), want)?;
        let definition = self.running.surface.definition();
        let seen = |i: usize| {
            let (normal, gradient, ok) = (e.frame_normal[i], e.gradient[i], e.status[i].is_ok());
            let alignment = dot(normal, gradient);
            let is_accepted =
                ok && definition.verdict::<2>(e.gap[i], alignment, (e.eccentricity[i], 1.0)).is_ok();
            Seen {
                value: if ok { e.value[i] } else { f64::NAN },
                normal,
                gradient,
                surface_normal: e.surface_normal[i],
                support: e.support[i],
                aside: length(sub(e.average[i], points[i])),
                is_zero: ok && e.value[i].abs() <= self.tolerance * e.support[i],
                is_accepted,
            }
        };
        Ok((0..points.len()).map(seen).collect())
    }
}
