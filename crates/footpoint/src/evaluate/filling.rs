//! The columns of an evaluation, filled by several threads.

use super::{Evaluations, Want};
use crate::algebra::{Matrix, scale};
use crate::columns::{Counts, Numbers, Statuses};
use crate::curvature::Curvature;
use crate::evaluator::{Answers, Extra, Local, Pass, Position};
use crate::field::NormalField;
use crate::status::Status;
use crate::surface::Surface;
use crate::variance::variance;

/// The columns while threads fill them.
pub(super) struct Columns<'c, const D: usize> {
    surface: &'c Surface<D>,
    /// Where in the grid each query stands, if the queries are the samples.
    own: &'c [Option<u32>],
    value: Numbers<'c, 1>,
    average: Numbers<'c, D>,
    frame_normal: Numbers<'c, D>,
    gradient: Numbers<'c, D>,
    surface_normal: Numbers<'c, D>,
    gap: Numbers<'c, 1>,
    neighbours: Counts<'c>,
    effective_neighbours: Numbers<'c, 1>,
    weight_sum: Numbers<'c, 1>,
    eigenvalues: Numbers<'c, D>,
    squared_sensitivity: Numbers<'c, 1>,
    support: Numbers<'c, 1>,
    eccentricity: Numbers<'c, 1>,
    hessian: Numbers<'c, D>,
    mean: Numbers<'c, 1>,
    gaussian: Numbers<'c, 1>,
    principal: Numbers<'c, 2>,
    directions: Numbers<'c, D>,
    sigma: Numbers<'c, 1>,
    degree: Counts<'c>,
    status: &'c Statuses,
    has_gradient: bool,
    /// Whether any of the columns is wanted that take some work for each row.
    has_derived: bool,
}

impl<'c, const D: usize> Columns<'c, D> {
    pub(super) fn new(
        (surface, own): (&'c Surface<D>, &'c [Option<u32>]),
        (to, rows): (&'c mut Evaluations<D>, usize),
        want: Want,
        (status, has_gradient): (&'c Statuses, bool),
    ) -> Self {
        let bent = want.contains(Want::CURVATURE);
        let derived = [Want::ECCENTRICITY, Want::HESSIAN, Want::CURVATURE, Want::SIGMA, Want::DEGREE];
        Self {
            surface,
            own,
            value: Numbers::values(&mut to.value, rows, want.contains(Want::VALUE)),
            average: Numbers::rows(&mut to.average, rows, want.contains(Want::AVERAGE)),
            frame_normal: Numbers::rows(&mut to.frame_normal, rows, want.contains(Want::FRAME_NORMAL)),
            gradient: Numbers::rows(&mut to.gradient, rows, want.contains(Want::GRADIENT)),
            surface_normal: Numbers::rows(&mut to.surface_normal, rows, want.contains(Want::SURFACE_NORMAL)),
            gap: Numbers::values(&mut to.gap, rows, want.contains(Want::GAP)),
            neighbours: Counts::values(&mut to.neighbours, rows, want.contains(Want::NEIGHBOURS)),
            effective_neighbours: Numbers::values(
                &mut to.effective_neighbours,
                rows,
                want.contains(Want::EFFECTIVE_NEIGHBOURS),
            ),
            weight_sum: Numbers::values(&mut to.weight_sum, rows, want.contains(Want::WEIGHT_SUM)),
            eigenvalues: Numbers::rows(&mut to.eigenvalues, rows, want.contains(Want::EIGENVALUES)),
            squared_sensitivity: Numbers::values(
                &mut to.squared_sensitivity,
                rows,
                want.contains(Want::SQUARED_SENSITIVITY),
            ),
            support: Numbers::values(&mut to.support, rows, want.contains(Want::SUPPORT)),
            eccentricity: Numbers::values(&mut to.eccentricity, rows, want.contains(Want::ECCENTRICITY)),
            hessian: Numbers::matrices(&mut to.hessian, rows, want.contains(Want::HESSIAN)),
            mean: Numbers::values(&mut to.curvature.mean, rows, bent),
            gaussian: Numbers::values(&mut to.curvature.gaussian, rows, bent),
            principal: Numbers::rows(&mut to.curvature.principal, rows, bent),
            directions: Numbers::matrices(&mut to.curvature.directions, rows, bent),
            sigma: Numbers::values(&mut to.sigma, rows, want.contains(Want::SIGMA)),
            degree: Counts::values(&mut to.degree, rows, want.contains(Want::DEGREE)),
            status,
            has_gradient,
            has_derived: derived.into_iter().any(|column| want.contains(column)),
        }
    }

    /// Calls for the memory of a row, which is far from the last one where queries are in random order; half of it before
    /// each pass, because the processor waits for few lines at a time.
    #[inline(always)]
    pub(super) fn expect(&self, row: usize, pass: Pass) {
        if pass == Pass::First {
            self.value.expect(row);
            self.average.expect(row);
            self.frame_normal.expect(row);
            self.gap.expect(row);
            self.neighbours.expect(row);
            self.effective_neighbours.expect(row);
        } else {
            self.gradient.expect(row);
            self.surface_normal.expect(row);
            self.weight_sum.expect(row);
            self.eigenvalues.expect(row);
            self.squared_sensitivity.expect(row);
            self.support.expect(row);
            self.status.expect(row);
        }
    }

    #[inline(always)]
    pub(super) fn put(&self, row: usize, position: &Position<D>, (answers, lane): (&Answers<D>, usize)) {
        let surface = self.surface;
        let unit = surface.grid.unit;
        let (local, extra) = (answers.local(lane), answers.extra(lane));
        // Moments of positions carry a square of the unit, moments of normals none.
        let moment = if surface.definition.field() == NormalField::AveragedAxes { 1.0 } else { unit * unit };
        self.value.put(row, [local.value * unit]);
        let average: [f64; D] = std::array::from_fn(|k| position.anchor[k] + local.aside[k]);
        self.average.put(row, scale(average, unit));
        self.frame_normal.put(row, local.normal);
        self.gradient.put(row, local.gradient);
        self.surface_normal.put(row, local.surface_normal);
        self.gap.put(row, [local.gap]);
        self.neighbours.put(row, extra.neighbours);
        self.effective_neighbours.put(row, [extra.effective_neighbours]);
        self.weight_sum.put(row, [extra.weight_sum]);
        self.eigenvalues.put(row, scale(extra.eigenvalues, moment));
        self.squared_sensitivity.put(row, [extra.sensitivity]);
        self.support.put(row, [local.support * unit]);
        let level = self.has_gradient && local.status.is_ok() && !local.has_surface_normal();
        self.status.put(row, if level { Status::Singular } else { local.status });
        if self.has_derived {
            self.put_derived(row, position, (answers, lane));
        }
    }

    /// Columns that take some work; apart, because the loop over rows is a tenth slower with their code in it.
    #[inline(never)]
    fn put_derived(&self, row: usize, position: &Position<D>, (answers, lane): (&Answers<D>, usize)) {
        let (local, extra) = (answers.local(lane), answers.extra(lane));
        let hessian = answers.hessian(lane);
        self.degree.put(row, if local.value.is_nan() { 0 } else { u32::from(extra.degree) });
        self.eccentricity.put(row, [local.across() / local.support]);
        self.hessian.put_matrix(row, hessian.map(|r| scale(r, 1.0 / self.surface.grid.unit)));
        if self.mean.is_wanted() {
            self.put_curvature(row, &local, hessian);
        }
        if self.sigma.is_wanted() {
            self.sigma.put(row, [self.sigma(row, position, (&local, &extra))]);
        }
    }

    fn put_curvature(&self, row: usize, local: &Local<D>, hessian: Matrix<f64, D>) {
        let inverse = 1.0 / self.surface.grid.unit;
        let bent = Curvature::new(local.gradient, local.surface_normal, hessian);
        self.mean.put(row, [bent.mean * inverse]);
        self.gaussian.put(row, [bent.gaussian * inverse * inverse]);
        self.principal.put(row, bent.principal.map(|k| k * inverse));
        self.directions.put_matrix(row, bent.directions);
    }

    fn sigma(&self, row: usize, position: &Position<D>, answers: (&Local<D>, &Extra<D>)) -> f64 {
        match self.own.get(row).copied().flatten() {
            Some(place) => variance(self.surface, Some((row, place)), position, answers).sqrt(),
            None => variance(self.surface, None, position, answers).sqrt(),
        }
    }
}
