//! The foot point of every query, however far it is, with what is known of the distance's errors.

use super::walk::{Gait, beside, distance, walk};
use crate::Recipe;
use footpoint::{
    Noise, Operator, Project, Run, Status, Surface, Uncertainties, Uncertainty, UncertaintyError,
};

/// Beyond this distance, in the smallest support, another foot point may be nearer than the projection's (SPEC § 11).
pub(super) const SURE: f64 = 0.5;

/// How to find foot points, however far.
#[derive(Clone, Debug)]
pub struct DistanceSearch<const D: usize> {
    /// The orthogonal projection.
    project: Project,
    /// Noise of the queries.
    noise: Option<Noise<D>>,
    /// Error of the registration, a standard deviation.
    registration: f64,
    /// Distances beyond are *outside*.
    largest: f64,
}

/// Foot points, one row a query.
#[derive(Clone, Debug)]
pub struct Feet<const D: usize> {
    /// Everything but the registration; NaN where the status is not *ok*, foot points too.
    pub found: Uncertainties<D>,
    /// How many were found by a walk along the surface.
    pub walked: usize,
}

impl<const D: usize> DistanceSearch<D> {
    /// As the recipe says, for queries of this noise.
    pub fn of(recipe: &Recipe, noise: Option<Noise<D>>) -> Self {
        Self {
            project: recipe.project.unwrap_or_default().with_operator(Operator::Orthogonal),
            noise,
            registration: recipe.registration.unwrap_or(0.0),
            largest: recipe.largest_distance.unwrap_or(f64::INFINITY),
        }
    }

    /// Finds the foot points. The surface's cloud has noise, if only of 0: without any there is no bias either.
    pub fn feet(
        &self,
        surface: &Surface<D>,
        queries: &[[f64; D]],
        run: &Run<'_>,
    ) -> Result<Feet<D>, UncertaintyError> {
        let mut found = surface.with(run).uncertainty(queries, &self.uncertainty(None))?;
        let unsure = |&row: &usize| match found.feet.status[row] {
            Status::Invalid => false,
            Status::Ok => found.feet.distance[row].abs() > SURE * surface.support().smallest,
            _ => true,
        };
        let rows: Vec<usize> = (0..queries.len()).filter(unsure).collect();
        let walked = self.walk(surface, (queries, &rows), &mut found, run)?;
        for row in 0..queries.len() {
            self.finish(&mut found, row);
        }
        Ok(Feet { found, walked })
    }

    /// What the library is asked for; `rows` are those of the queries, by default all.
    fn uncertainty(&self, rows: Option<&[usize]>) -> Uncertainty<D> {
        let uncertainty = Uncertainty::new().with_project(self.project);
        let noise = match (&self.noise, rows) {
            (None, _) => return uncertainty,
            (Some(Noise::Each(all)), Some(rows)) => Noise::Each(rows.iter().map(|&row| all[row]).collect()),
            (Some(Noise::Covariances(all)), Some(rows)) => {
                Noise::Covariances(rows.iter().map(|&row| all[row]).collect())
            }
            (Some(noise), _) => noise.clone(),
        };
        uncertainty.with_query_noise(noise)
    }

    /// Walks to the foot points of some queries, and takes what is nearer than what there is.
    fn walk(
        &self,
        surface: &Surface<D>,
        (queries, rows): (&[[f64; D]], &[usize]),
        found: &mut Uncertainties<D>,
        run: &Run<'_>,
    ) -> Result<usize, UncertaintyError> {
        if rows.is_empty() {
            return Ok(0);
        }
        let far: Vec<[f64; D]> = rows.iter().map(|&row| queries[row]).collect();
        let ends = walk(surface, &far, Gait::patient(self.project, self.largest), run)?;
        let mut arrived = Vec::new();
        let mut starts = Vec::new();
        for (&row, end) in rows.iter().zip(ends) {
            match end {
                Ok(foot) => {
                    arrived.push(row);
                    starts.push(beside(&foot, queries[row]));
                }
                Err(status) if !found.feet.status[row].is_ok() => found.feet.status[row] = status,
                Err(_) => {}
            }
        }
        let quiet = run.silent();
        let there = surface.with(&quiet).uncertainty(&starts, &self.uncertainty(Some(&arrived)))?;
        let mut walked = 0;
        for (k, &row) in arrived.iter().enumerate() {
            let (old, new) = (&mut found.feet, &there.feet);
            let away = distance(queries[row], new.point[k]);
            let nearer = new.status[k].is_ok() && away < old.distance[row].abs();
            if old.status[row].is_ok() && !nearer {
                continue;
            }
            old.status[row] = new.status[k];
            old.point[row] = new.point[k];
            old.surface_normal[row] = new.surface_normal[k];
            old.distance[row] = away.copysign(new.distance[k]);
            (found.sigma[row], found.bias[row]) = (there.sigma[k], there.bias[k]);
            walked += usize::from(new.status[k].is_ok());
        }
        Ok(walked)
    }

    /// Judges the distance, adds the registration's error, and leaves no number where there is no answer.
    fn finish(&self, found: &mut Uncertainties<D>, row: usize) {
        let feet = &mut found.feet;
        if feet.status[row].is_ok() && feet.distance[row].abs() > self.largest {
            feet.status[row] = Status::Outside;
        }
        if feet.status[row].is_ok() {
            found.sigma[row] = found.sigma[row].hypot(self.registration);
            return;
        }
        feet.point[row] = [f64::NAN; D];
        feet.surface_normal[row] = [f64::NAN; D];
        feet.distance[row] = f64::NAN;
        (found.sigma[row], found.bias[row]) = (f64::NAN, f64::NAN);
    }
}
