//! Two epochs with one support, and how well each surface is known at a point.

use super::{CompareError, widening};
use crate::algebra::dot;
use crate::cloud::Cloud;
use crate::columns::Numbers;
use crate::definition::Definition;
use crate::evaluator::Wanted;
use crate::project::Project;
use crate::queries::{Grouped, Queries};
use crate::run::{Cancelled, Run};
use crate::support::Support;
use crate::surface::{Running, Surface};

/// Evaluations that a foot point may take: the few points that need more are at no good place of the
/// surface, and another support answers for most of them.
const MOST_EVALUATIONS: u32 = 20;

/// How foot points are sought.
pub(super) fn way(tolerance: f64) -> Project {
    Project::new().with_tolerance(tolerance).with_most_evaluations(MOST_EVALUATIONS)
}

/// The surfaces of two epochs by one definition.
#[derive(Debug)]
pub struct Pair<const D: usize> {
    /// Whose normals give the sign, and whose radius both have.
    pub earlier: Surface<D>,
    /// Where distances begin.
    pub later: Surface<D>,
}

impl<const D: usize> Pair<D> {
    /// Both with the radius that the definition's rule gives the earlier; where it gives one per sample, the
    /// later gets its own by that rule or, for a column that it has not, the earlier's median.
    pub fn build(
        earlier: Cloud<D>,
        later: Cloud<D>,
        definition: Definition,
        run: &Run<'_>,
    ) -> Result<Self, CompareError> {
        let earlier = Surface::build(earlier, definition, run)
            .map_err(|problem| CompareError::of(problem, CompareError::Earlier))?;
        let support = earlier.support();
        let has_column = later.supports().is_some();
        let one = support.uniform || (definition.support() == Support::FromSamples && !has_column);
        let definition =
            if one { definition.with_support(Support::Uniform(support.median)) } else { definition };
        let later = Surface::build(later, definition, run)
            .map_err(|problem| CompareError::of(problem, CompareError::Later))?;
        Ok(Self { earlier, later })
    }
}

/// How well a place is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    /// The square of a length; infinite where nothing is known.
    pub(super) variance: f64,
    /// Degrees of freedom that it comes from.
    freedom: f64,
}

impl Known {
    pub(super) const NOTHING: Self = Self { variance: f64::INFINITY, freedom: f64::NAN };

    pub(super) fn is_nothing(&self) -> bool {
        self.variance == f64::INFINITY
    }

    /// Of a difference, by Welch and Satterthwaite.
    pub(super) fn joined(&self, other: &Self) -> Self {
        let variance = self.variance + other.variance;
        let share = |side: &Self| (side.variance / variance).powi(2) / side.freedom;
        let freedom = 1.0 / (share(self) + share(other));
        // Not so for NaN.
        if freedom >= LEAST_FREEDOM { Self { variance, freedom } } else { Self::NOTHING }
    }

    /// A standard deviation widened for how few samples it comes from, with the registration's.
    pub(super) fn sigma(&self, registration: f64) -> f64 {
        if self.is_nothing() {
            return f64::NAN;
        }
        (self.variance.sqrt() * widening(self.freedom)).hypot(registration)
    }
}

/// Below, a scatter says nothing: σ would be more than twice as wide, and no series holds.
const LEAST_FREEDOM: f64 = 2.0;

impl<const D: usize> Running<'_, D> {
    /// How well the surface is known at these of its points, each found to the tolerance.
    pub(super) fn known(&self, points: &[[f64; D]], tolerance: f64) -> Result<Vec<Known>, Cancelled> {
        let surface = self.surface;
        let unit = surface.grid.unit;
        let grouped = Grouped::new(surface, Queries::Points(points), self.run);
        let wanted = Wanted { gradient: true, sensitivity: true, scatter: true, ..Wanted::default() };
        let mut found: Vec<[f64; 2]> = Vec::new();
        {
            let numbers = Numbers::rows(&mut found, points.len(), true);
            grouped.for_each_group(self.run, wanted, |evaluator, group| {
                for &row in &group.invalid {
                    numbers.put(row as usize, [f64::NAN; 2]);
                }
                evaluator.evaluate(&group.positions, &|_, _| (), |i, answers, lane| {
                    let row = group.rows[i] as usize;
                    let (local, extra) = (answers.local(lane), answers.extra(lane));
                    let slope = dot(local.gradient, local.gradient);
                    let largest = points[row].iter().fold(0.0_f64, |most, c| most.max(c.abs()));
                    let precision = tolerance * local.support * unit + 2.0 * f64::EPSILON * largest;
                    let of_samples = extra.scatter * extra.sensitivity / slope * unit * unit;
                    // A plane takes as many samples as there are axes; one of them H has taken.
                    let freedom = extra.freedom - (D - 1) as f64;
                    numbers.put(row, [of_samples + precision * precision, freedom]);
                });
            })?;
        }
        let known = |[variance, freedom]: [f64; 2]| {
            // Not so for NaN.
            let told = variance >= 0.0 && variance.is_finite() && freedom > 0.0;
            if told { Known { variance, freedom } } else { Known::NOTHING }
        };
        Ok(found.into_iter().map(known).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{add_scaled, sub, tangential};
    use crate::evaluate::Want;
    use crate::field::NormalField;
    use crate::lane::Precision;
    use crate::samples::{self, Random};

    /// v and the degrees of freedom by sums over all samples, and leverages from an orthonormal basis of the
    /// plane's functions.
    fn reference<const D: usize>(surface: &Surface<D>, y: [f64; D]) -> [f64; 2] {
        let want = Want::FRAME_NORMAL | Want::SQUARED_SENSITIVITY | Want::GRADIENT | Want::SUPPORT;
        let at = surface.evaluate(&[y], want);
        let (n, h) = (at.frame_normal[0], at.support[0]);
        let near: Vec<(f64, [f64; D])> = (surface.samples_with_supports().into_iter())
            .map(|(p, own)| (sub(p, y), own * own))
            .filter(|(d, square)| dot(*d, *d) < *square)
            .map(|(d, square)| ((1.0 - dot(d, d) / square).powi(3), d))
            .collect();
        let inner = |a: &[f64], b: &[f64]| -> f64 { (0..near.len()).map(|i| near[i].0 * a[i] * b[i]).sum() };
        // 1 and the coordinates along the plane, made orthonormal one by one; the plane has D − 1 of them.
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut functions = vec![vec![1.0; near.len()]];
        functions.extend((0..D).map(|k| near.iter().map(|(_, d)| tangential(*d, n)[k]).collect()));
        for mut function in functions {
            for _ in 0..2 {
                for earlier in &basis {
                    let share = inner(&function, earlier);
                    function.iter_mut().zip(earlier).for_each(|(f, e)| *f -= share * e);
                }
            }
            let length = inner(&function, &function).sqrt();
            if length > 1e-6 * h {
                basis.push(function.iter().map(|f| f / length).collect());
            }
        }
        assert_eq!(basis.len(), D);
        let mut residual: Vec<f64> = near.iter().map(|(_, d)| dot(*d, n)).collect();
        for function in &basis {
            let share = inner(&residual, function);
            residual.iter_mut().zip(function).for_each(|(r, f)| *r -= share * f);
        }
        let free = |i: usize| near[i].0 * (1.0 - near[i].0 * basis.iter().map(|f| f[i] * f[i]).sum::<f64>());
        let freedom: f64 = (0..near.len()).map(free).sum();
        let squares: f64 = (0..near.len()).map(|i| free(i).powi(2)).sum();
        let scatter = inner(&residual, &residual) / freedom;
        let slope = dot(at.gradient[0], at.gradient[0]);
        [scatter * at.squared_sensitivity[0] / slope, freedom * freedom / squares - (D - 1) as f64]
    }

    fn agrees<const D: usize>(cloud: &Cloud<D>, definition: Definition, bound: f64) {
        let surface = Surface::new(cloud.clone(), definition).unwrap();
        let mut random = Random::new(5);
        let points: Vec<[f64; D]> =
            (0..20).map(|i| add_scaled(cloud.points()[7 * i], [0.02; D], random.normal())).collect();
        let feet = surface.project(&points, &Project::new());
        let run = Run::new();
        let known = surface.with(&run).known(&feet.point, 0.0).unwrap();
        let mut compared = 0;
        for (row, known) in known.iter().enumerate().filter(|(row, _)| feet.status[*row].is_ok()) {
            let [variance, freedom] = reference(&surface, feet.point[row]);
            assert!((known.variance / variance - 1.0).abs() < bound, "{definition:?} {known:?} {variance}");
            assert!((known.freedom / freedom - 1.0).abs() < bound, "{definition:?} {known:?} {freedom}");
            compared += 1;
        }
        assert!(compared > 15, "{definition:?}: {compared}");
    }

    #[test]
    fn what_is_known_agrees_with_sums_over_all_samples() {
        let torus = samples::torus(1.0, 0.4, 3000, 1).with_noise(0.01, 2);
        let space = Cloud::new(torus.points).with_normals(torus.normals).unwrap();
        let ellipse = samples::ellipse(1.0, 0.6, 600, 1).with_noise(0.01, 2);
        let plane = Cloud::new(ellipse.points).with_normals(ellipse.normals).unwrap();
        let usual = Definition::default();
        for field in [
            NormalField::CentredCovariance,
            NormalField::Covariance,
            NormalField::AveragedNormals,
            NormalField::AveragedAxes,
        ] {
            agrees(&space, usual.with_field(field), 1e-6);
            agrees(&plane, usual.with_field(field), 1e-6);
        }
        agrees(&space, usual.with_support(Support::AutoPerSample { effective_neighbours: 20.0 }), 1e-6);
        agrees(&space, usual.with_precision(Precision::Single), 1e-3);
        agrees(&space, usual.with_degree(2), 1e-6);
    }

    #[test]
    fn few_samples_make_nothing_known() {
        let known = |variance: f64, freedom: f64| Known { variance, freedom };
        let joined = known(1.0, 4.0).joined(&known(3.0, 12.0));
        // 16 / (1/4 + 9/12).
        assert_eq!((joined.variance, joined.freedom), (4.0, 16.0));
        assert!((joined.sigma(0.0) / 2.0 - 2.1199 / 1.96).abs() < 1e-3);
        assert!(known(1.0, 1.0).joined(&known(1e-9, 50.0)).is_nothing());
        assert!(Known::NOTHING.joined(&joined).is_nothing() && joined.joined(&Known::NOTHING).is_nothing());
        assert!(Known::NOTHING.sigma(1.0).is_nan());
    }
}
