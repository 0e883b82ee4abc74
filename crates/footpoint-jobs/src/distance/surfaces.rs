//! The surface of the points' own cloud against that of another, however far they are apart.

use super::feet::SURE;
use super::walk::{Gait, beside, distance, walk};
use crate::report::{Compare, Recipe};
use footpoint::{
    Cancelled, Cloud, CompareError, Compared, Comparison, Definition, Differences, Operator, Pair, Project,
    Queries, Run, Status,
};

/// Evaluations for the foot point beside the end of a walk, which all but a few find in some five.
const MOST_EVALUATIONS: u32 = 40;

/// How to compare two clouds, point by point of the later one.
#[derive(Clone, Debug)]
pub struct SurfaceSearch {
    comparison: Comparison,
    /// For walks from far.
    project: Project,
    /// Distances beyond are *outside*.
    largest: f64,
}

/// Distances between two surfaces, one row a point.
#[derive(Debug)]
pub struct Changes<const D: usize> {
    /// Where the status is not *ok* the distance may stand all the same, without sigma: from the point
    /// itself, which has no surface of its own, or from its surface to the nearest place where the other has
    /// one.
    pub found: Differences<D>,
    /// How many distances were found by a walk along the earlier surface.
    pub walked: usize,
    /// The surfaces of the widest support.
    pub widest: Pair<D>,
}

impl<const D: usize> Changes<D> {
    /// Whether the distance is larger than its level of detection, 1.96 sigma; not so where sigma is not
    /// known.
    pub fn is_significant(&self, row: usize) -> bool {
        self.found.distance[row].abs() > Comparison::LEVEL * self.found.sigma[row]
    }
}

impl SurfaceSearch {
    /// As the recipe says.
    pub fn of(recipe: &Recipe) -> Self {
        let tolerance = recipe.project.map_or(Comparison::TOLERANCE, |project| project.tolerance());
        let mut comparison =
            Comparison::new().with_registration(recipe.registration.unwrap_or(0.0)).with_tolerance(tolerance);
        if let Some(Compare::Surfaces { effective_neighbours }) = &recipe.compare {
            comparison = comparison.with_effective_neighbours(effective_neighbours.clone());
        }
        Self {
            comparison,
            project: Project::new().with_operator(Operator::Orthogonal).with_tolerance(tolerance),
            largest: recipe.largest_distance.unwrap_or(f64::INFINITY),
        }
    }

    /// Compares the clouds at the later one's points.
    pub fn changes<const D: usize>(
        &self,
        (earlier, later): (&Cloud<D>, &Cloud<D>),
        definition: Definition,
        run: &Run<'_>,
    ) -> Result<Changes<D>, CompareError> {
        let Compared { differences: mut found, widest } =
            self.comparison.compare((earlier, later), definition, Queries::Samples, run)?;
        let walked = self.walk(&widest, later.points(), &mut found, &run.silent())?;
        for row in 0..found.status.len() {
            self.judge(&mut found, row);
        }
        Ok(Changes { found, walked, widest })
    }

    /// Walks to the foot points that are missing, or so far that another may be nearer.
    fn walk<const D: usize>(
        &self,
        pair: &Pair<D>,
        points: &[[f64; D]],
        found: &mut Differences<D>,
        run: &Run<'_>,
    ) -> Result<usize, Cancelled> {
        let unsure = |row: &usize| match found.status[*row] {
            Status::Invalid => false,
            Status::Ok => found.distance[*row].abs() > SURE * found.support[*row],
            _ => true,
        };
        let rows: Vec<usize> = (0..points.len()).filter(unsure).collect();
        if rows.is_empty() {
            return Ok(0);
        }
        let own = |row: usize| !found.start[row][0].is_nan();
        let from: Vec<[f64; D]> =
            rows.iter().map(|&row| if own(row) { found.start[row] } else { points[row] }).collect();
        let ends = walk(&pair.earlier, &from, Gait::brisk(self.project, self.largest), run)?;
        let arrived: Vec<(usize, [f64; D])> =
            (0..rows.len()).filter_map(|k| Some((k, beside(ends[k].as_ref().ok()?, from[k])))).collect();
        // Far off, the end of the walk says more than that nothing is near: the surface has a rim there.
        for (&row, end) in rows.iter().zip(&ends) {
            if let (Status::Outside, Err(status)) = (found.status[row], end) {
                found.status[row] = *status;
            }
        }
        let starts: Vec<[f64; D]> = arrived.iter().map(|&(_, start)| start).collect();
        let how = self.project.with_most_evaluations(MOST_EVALUATIONS);
        let there = pair.earlier.with(run).project(&starts, &how)?;
        let later: Vec<[f64; D]> = arrived.iter().map(|&(k, _)| from[k]).collect();
        let sigma = self.comparison.judge(pair, (&there.point, &later), run)?;
        let mut walked = 0;
        for (j, &(k, _)) in arrived.iter().enumerate() {
            let row = rows[k];
            let away = distance(from[k], there.point[j]);
            let ok = found.status[row].is_ok();
            // Only where no earlier sample is within the widest support is it far: else the surface is
            // missing there.
            let far = found.status[row] == Status::Outside && !found.start[row][0].is_nan();
            let known = (ok || far) && !sigma[j].is_nan();
            let nearer = away < found.distance[row].abs();
            if !there.status[j].is_ok() || (ok && !(nearer && known)) {
                continue;
            }
            found.foot[row] = there.point[j];
            found.surface_normal[row] = there.surface_normal[j];
            found.distance[row] = away.copysign(there.distance[j]);
            if known {
                found.status[row] = Status::Ok;
                found.sigma[row] = sigma[j];
                found.support[row] = pair.earlier.support().median;
            }
            walked += 1;
        }
        Ok(walked)
    }

    /// Leaves no number where the distance is too large.
    fn judge<const D: usize>(&self, found: &mut Differences<D>, row: usize) {
        // Not so for NaN.
        if found.distance[row].abs() > self.largest {
            found.status[row] = Status::Outside;
            found.foot[row] = [f64::NAN; D];
            found.surface_normal[row] = [f64::NAN; D];
            (found.distance[row], found.sigma[row]) = (f64::NAN, f64::NAN);
        }
    }
}
