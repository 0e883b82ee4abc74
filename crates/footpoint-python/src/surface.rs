//! Surfaces in the plane and in space as one Python class.

use crate::answers::{of_changes, of_evaluations, of_feet, of_hits, of_orientation, of_projections};
use crate::arrays::{Doubles, matrices, numbers, rows};
use crate::errors::{of_comparison, of_job, of_orient, of_uncertainty, wrong};
use crate::options::{self, Options};
use crate::picture;
use crate::work::How;
use footpoint::{
    Cloud, CompareError, Comparison, Noise, Operator, Orient, OrientError, Polyline, Project, Queries, Ray,
    Run, Sign, Surface, Uncertainty, UncertaintyError, Want,
};
use footpoint_jobs::{
    Compare, Context, DistanceSearch, JobError, Recipe, Report, SurfaceSearch, check_distance,
    estimated_noise, surface_of_cloud,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A surface, whose samples have noise, if only of 0: then distances have their bias.
#[pyclass(frozen, name = "Surface", module = "footpoint._footpoint")]
pub(crate) struct AnySurface {
    surface: Either,
    /// Whether the noise is known.
    has_noise: bool,
    /// Neighbours that a point has, more or less: what an evaluation costs.
    neighbours: usize,
}

enum Either {
    Plane(Arc<Surface<2>>),
    Space(Arc<Surface<3>>),
}

/// Evaluations that one of Levin's projections costs, more or less.
const LEVIN: usize = 100;

/// The same for both dimensions.
macro_rules! of_either {
    ($any:expr, $surface:ident => $body:expr) => {
        match &$any.surface {
            Either::Plane($surface) => $body,
            Either::Space($surface) => $body,
        }
    };
}

/// Columns of the samples beside their positions.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Columns<'py> {
    normals: Option<Doubles<'py>>,
    supports: Option<Doubles<'py>>,
    factors: Option<Doubles<'py>>,
    noise: Option<Doubles<'py>>,
}

#[pymethods]
impl AnySurface {
    #[new]
    fn new(
        py: Python<'_>,
        points: Doubles<'_>,
        columns: Columns<'_>,
        definition: &Bound<'_, PyDict>,
        how: How,
    ) -> PyResult<Self> {
        let recipe = options::recipe(&Options(definition))?;
        let has_noise = columns.noise.is_some() || recipe.noise.is_some();
        let surface = match points.shape() {
            [_, 2] => Either::Plane(Arc::new(index(py, &points, &columns, (recipe, &how))?)),
            _ => Either::Space(Arc::new(index(py, &points, &columns, (recipe, &how))?)),
        };
        Ok(Self::of(surface, has_noise))
    }

    /// f and what belongs to it, at points or at the samples.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        at: Option<Doubles<'py>>,
        want: Vec<String>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let want = options::want(&want)?;
        if want.contains(Want::SIGMA) && !self.has_noise {
            return Err(wrong("want", "sigma needs the noise of the samples: Surface(..., noise=)"));
        }
        of_either!(self, surface => {
            let queries = queries(at.as_ref())?;
            let pairs = self.neighbours * count(surface, queries);
            let found = how.run(py, pairs, |run| surface.with(run).evaluate(queries, want))?;
            of_evaluations(py, found.map_err(|_| interrupted())?, want)
        })
    }

    /// Points, or the samples, taken to the surface.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: Option<Doubles<'py>>,
        query_noise: Option<Doubles<'py>>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let project = options::project(&Options(options))?;
        if query_noise.is_some() && (points.is_none() || !self.has_noise) {
            return Err(wrong("query_noise", "it belongs to points x and a Surface with noise="));
        }
        of_either!(self, surface => {
            let queries = queries(points.as_ref())?;
            let searched = if matches!(project.operator(), Operator::Levin { .. }) { LEVIN } else { 1 };
            let pairs = searched * self.neighbours * count(surface, queries);
            if !self.has_noise {
                let found = how.run(py, pairs, |run| surface.with(run).project(queries, &project))?;
                return of_projections(py, found.map_err(|_| interrupted())?, None);
            }
            let mut uncertainty = Uncertainty::new().with_project(project);
            if let Some(noise) = noise(query_noise.as_ref())? {
                uncertainty = uncertainty.with_query_noise(noise);
            }
            let found = how.run(py, pairs, |run| surface.with(run).uncertainty(queries, &uncertainty))?;
            let found = found.map_err(|problem| uncertainty_error(&problem))?;
            of_projections(py, found.feet, Some((found.sigma, found.bias)))
        })
    }

    /// The foot point of every query, however far.
    fn distance<'py>(
        &self,
        py: Python<'py>,
        points: Doubles<'py>,
        query_noise: Option<Doubles<'py>>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let options = Options(options);
        let recipe = Recipe {
            largest_distance: options.number("largest")?,
            registration: options.number("registration")?,
            compare: Some(Compare::Points),
            project: Some(options::project(&options)?),
            // Only whether there is some is looked at.
            query_noise: query_noise.is_some().then_some(0.0),
            noise: self.has_noise.then_some(footpoint_jobs::NoiseSource::Uniform(0.0)),
            ..Recipe::default()
        };
        check_distance(&recipe).map_err(|error| of_job(error, recipe.definition.support()))?;
        of_either!(self, surface => {
            let search = DistanceSearch::of(&recipe, noise(query_noise.as_ref())?);
            let points = rows(&points)?;
            let found = how.run(py, usize::MAX, |run| search.feet(surface, points, run))?;
            of_feet(py, found.map_err(|problem| uncertainty_error(&problem))?, self.has_noise)
        })
    }

    /// The surface of the points against this one, however far.
    fn compare<'py>(
        &self,
        py: Python<'py>,
        points: Doubles<'py>,
        normals: Option<Doubles<'py>>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let options = Options(options);
        let tolerance = options.number("tolerance")?.unwrap_or(Comparison::TOLERANCE);
        let given = options.get("effective_neighbours", "a list of numbers")?;
        let compare = given
            .map_or_else(Compare::default, |effective_neighbours| Compare::Surfaces { effective_neighbours });
        let recipe = Recipe {
            largest_distance: options.number("largest")?,
            registration: options.number("registration")?,
            project: Some(Project::new().with_tolerance(tolerance)),
            compare: Some(compare),
            ..Recipe::default()
        };
        of_either!(self, surface => {
            let definition = *surface.definition();
            check_distance(&recipe).map_err(|error| of_job(error, definition.support()))?;
            let search = SurfaceSearch::of(&recipe);
            let mut later = Cloud::new(rows(&points)?);
            if let Some(normals) = &normals {
                later = later.with_normals(rows(normals)?).map_err(|problem| wrong("points", problem))?;
            }
            let found = how.run(py, usize::MAX, |run| {
                search.changes((surface.cloud(), &later), definition, run)
            })?;
            of_changes(py, found.map_err(|problem| match problem {
                CompareError::Cancelled(_) => interrupted(),
                problem => of_comparison(&problem, definition.support()),
            })?)
        })
    }

    /// The noise of points along the normals of their own surface, by this one's definition.
    fn noise_of(&self, py: Python<'_>, points: Doubles<'_>, how: How) -> PyResult<f64> {
        of_either!(self, surface => noise_of(py, surface, &points, &how))
    }

    /// Where rays meet the surface.
    fn cast<'py>(
        &self,
        py: Python<'py>,
        origins: Doubles<'py>,
        directions: Doubles<'py>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let cast = options::cast(&Options(options))?;
        of_either!(self, surface => {
            let pairs = rows(&origins)?.iter().zip(rows(&directions)?);
            let rays: Vec<_> = pairs.map(|(&origin, &direction)| Ray { origin, direction }).collect();
            let pairs = self.neighbours * rays.len();
            let found = how.run(py, pairs, |run| surface.with(run).cast(&rays, &cast))?;
            of_hits(py, found.map_err(|_| interrupted())?)
        })
    }

    /// Normals of the samples with signs that agree. `by` names the rule, `values` are its numbers: a vector, a row a
    /// sample, or times and a path of rows (t, x, y, z).
    fn orient<'py>(
        &self,
        py: Python<'py>,
        by: &str,
        values: Vec<Doubles<'py>>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let options = Options(options);
        let source = options::normal_source(&options)?;
        let non_orientable = options::non_orientable(&options)?;
        of_either!(self, surface => {
            let mut path = Vec::new();
            let rule = match (by, &values[..]) {
                ("towards", [point]) => Orient::Towards(vector("towards", point)?),
                ("along", [axis]) => Orient::Along(vector("along", axis)?),
                ("sensors", [sensors]) => Orient::Sensors(rows(sensors)?),
                ("trajectory", [times, stamps, positions]) => {
                    path.extend(numbers(stamps)?.iter().copied().zip(rows(positions)?.iter().copied()));
                    Orient::Trajectory { times: numbers(times)?, path: &path }
                }
                _ => Orient::Propagated(non_orientable),
            };
            let found = how.run(py, usize::MAX, |run| surface.with(run).orient(source, &rule))?;
            of_orientation(py, found.map_err(|problem| match problem {
                OrientError::Cancelled(_) => interrupted(),
                problem => of_orient(&problem),
            })?)
        })
    }

    /// The curve as polylines: vertices, unit normals there, whether it is closed, and its length.
    fn contour<'py>(
        &self,
        py: Python<'py>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Vec<Line<'py>>> {
        let Either::Plane(surface) = &self.surface else {
            return Err(wrong(
                "points",
                "they have 3 coordinates; contours are those of curves in the plane",
            ));
        };
        let contour = options::contour(&Options(options))?;
        let surface = Arc::clone(surface);
        let found = how.run_owned(py, move |run| surface.with(run).contour(&contour))?;
        let found = found.map_err(|_| interrupted())?;
        let line = |line: Polyline| {
            let length = line.length();
            Ok((array(py, &line.points)?, array(py, &line.surface_normal)?, line.closed, length))
        };
        found.polylines.into_iter().map(line).collect()
    }

    /// The same surface with these normals of the samples.
    fn with_normals(&self, py: Python<'_>, normals: Doubles<'_>, how: How) -> PyResult<Self> {
        let surface = match &self.surface {
            Either::Plane(surface) => Either::Plane(Arc::new(with_normals(py, surface, &normals, &how)?)),
            Either::Space(surface) => Either::Space(Arc::new(with_normals(py, surface, &normals, &how)?)),
        };
        Ok(Self { surface, has_noise: self.has_noise, neighbours: self.neighbours })
    }

    /// A picture as bytes, with how it was made.
    fn render<'py>(
        &self,
        py: Python<'py>,
        values: Option<Doubles<'py>>,
        to: Option<Bound<'py, Self>>,
        options: &Bound<'py, PyDict>,
        how: How,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Either::Space(surface) = &self.surface else {
            return Err(wrong("points", "they have 2 coordinates, which make a curve; pictures need 3"));
        };
        let to = match to.as_ref().map(|to| &to.get().surface) {
            Some(Either::Space(to)) => Some(&**to),
            Some(Either::Plane(_)) => return Err(wrong("to", "its points have 2 coordinates, not 3")),
            None => None,
        };
        picture::render(py, (surface, to, values.as_ref()), &Options(options), &how)
    }

    /// The samples as they were given.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_either!(self, surface => array(py, surface.cloud().points()))
    }

    /// Unit normals of the samples, NaN where there is none.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        of_either!(self, surface => surface.cloud().normals().map(|normals| array(py, normals)).transpose())
    }

    /// What the surface says of itself.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let facts = PyDict::new(py);
        of_either!(self, surface => {
            let support = surface.support();
            facts.set_item("support", (support.uniform, support.smallest, support.median, support.largest))?;
            facts.set_item("dimension", dimension(surface))?;
            facts.set_item("signed", surface.sign() == Sign::Given)?;
            facts.set_item("samples", surface.cloud().len())?;
            facts.set_item("samples_used", surface.samples_used())?;
            facts.set_item("cell_side", surface.cell_side())?;
            facts.set_item("degree", surface.definition().degree())?;
            facts.set_item("noise", match surface.cloud().noise() {
                Some(&Noise::Uniform(sigma)) if self.has_noise => Some(sigma),
                _ => None,
            })?;
            facts.set_item("support_choice", surface.support_choice().map(|choice| {
                (choice.effective_neighbours, choice.noise, choice.error_from_noise, choice.error_from_bias)
            }))?;
        });
        Ok(facts)
    }
}

impl AnySurface {
    fn of(surface: Either, has_noise: bool) -> Self {
        let neighbours = match &surface {
            Either::Plane(surface) => neighbours(surface),
            Either::Space(surface) => neighbours(surface),
        };
        Self { surface, has_noise, neighbours }
    }
}

/// Most neighbours that some of the samples have, at least 1.
fn neighbours<const D: usize>(surface: &Surface<D>) -> usize {
    let samples = surface.cloud().points();
    let some: Vec<[f64; D]> = samples.iter().step_by(samples.len().div_ceil(8).max(1)).copied().collect();
    let run = Run::new().threads(1);
    let found = surface.with(&run).evaluate(&some, Want::NEIGHBOURS).unwrap_or_default();
    found.neighbours.into_iter().fold(1, |most, count| most.max(count as usize))
}

/// The surface of these samples.
fn index<const D: usize>(
    py: Python<'_>,
    points: &Doubles<'_>,
    columns: &Columns<'_>,
    (recipe, how): (Recipe, &How),
) -> PyResult<Surface<D>> {
    let support = recipe.definition.support();
    let fit = |problem| of_job(JobError::Cloud { path: String::new(), problem }, support);
    let noise = noise(columns.noise.as_ref())?.unwrap_or(Noise::Uniform(0.0));
    let mut cloud = Cloud::new(rows::<D>(points)?).with_noise(noise).map_err(|e| wrong("noise", e))?;
    if let Some(normals) = &columns.normals {
        cloud = cloud.with_normals(rows::<D>(normals)?).map_err(fit)?;
    }
    if let Some(supports) = &columns.supports {
        cloud = cloud.with_supports(numbers(supports)?).map_err(fit)?;
    }
    if let Some(factors) = &columns.factors {
        cloud = cloud.with_factors(numbers(factors)?).map_err(fit)?;
    }
    let made = how.run_owned(py, move |run| {
        let context = Context { recipe, run: *run, ..Context::default() };
        let mut report = Report::new("surface", context.recipe.clone());
        surface_of_cloud(cloud, "points", &context, &mut report)
    })?;
    made.map_err(|error| of_job(error, support))
}

/// The noise of points along the normals of their own surface, by the definition of another.
fn noise_of<const D: usize>(
    py: Python<'_>,
    surface: &Surface<D>,
    points: &Doubles<'_>,
    how: &How,
) -> PyResult<f64> {
    let definition = *surface.definition();
    let cloud = Cloud::new(rows::<D>(points)?);
    let found = how.run_owned(py, move |run| {
        let recipe = Recipe { definition, ..Recipe::default() };
        estimated_noise(cloud, "points", &Context { recipe, run: *run, ..Context::default() })
    })?;
    found.map_err(|error| match error {
        JobError::Cancelled => interrupted(),
        error => of_job(error, definition.support()),
    })
}

/// A polyline for Python.
type Line<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, bool, f64);

/// The surface of the same samples with other normals.
fn with_normals<const D: usize>(
    py: Python<'_>,
    surface: &Surface<D>,
    normals: &Doubles<'_>,
    how: &How,
) -> PyResult<Surface<D>> {
    let support = surface.definition().support();
    let fit = |problem| of_job(JobError::Cloud { path: String::new(), problem }, support);
    let cloud = surface.cloud().clone().with_normals(rows::<D>(normals)?).map_err(fit)?;
    let definition = *surface.definition();
    let made = how.run_owned(py, move |run| Surface::build(cloud, definition, run))?;
    made.map_err(|problem| match problem {
        footpoint::Error::Cancelled(_) => interrupted(),
        problem => of_job(JobError::Surface { path: String::new(), problem }, support),
    })
}

/// The samples themselves for no array.
fn queries<'a, const D: usize>(at: Option<&'a Doubles<'_>>) -> PyResult<Queries<'a, D>> {
    at.map_or(Ok(Queries::Samples), |at| rows(at).map(Queries::Points))
}

fn count<const D: usize>(surface: &Surface<D>, queries: Queries<'_, D>) -> usize {
    match queries {
        Queries::Points(points) => points.len(),
        Queries::Samples => surface.cloud().len(),
    }
}

fn dimension<const D: usize>(_: &Surface<D>) -> usize {
    D
}

/// One figure, one a point, or one covariance a point, by the number of axes.
fn noise<const D: usize>(array: Option<&Doubles<'_>>) -> PyResult<Option<Noise<D>>> {
    array
        .map(|array| {
            Ok(match (array.ndim(), numbers(array)?) {
                (0, &[sigma]) => Noise::Uniform(sigma),
                (3, _) => Noise::Covariances(matrices(array)?),
                (_, sigmas) => Noise::Each(sigmas.to_vec()),
            })
        })
        .transpose()
}

fn vector<const D: usize>(argument: &str, array: &Doubles<'_>) -> PyResult<[f64; D]> {
    let values = numbers(array)?;
    <[f64; D]>::try_from(values)
        .map_err(|_| wrong(argument, format!("{} numbers for {D} coordinates", values.len())))
}

fn array<'py, const D: usize>(py: Python<'py>, rows: &[[f64; D]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), D])
}

fn uncertainty_error(problem: &UncertaintyError) -> PyErr {
    match problem {
        UncertaintyError::Cancelled(_) => interrupted(),
        problem => of_uncertainty(problem),
    }
}

/// Where work was cancelled the exception that did it is raised instead.
pub(crate) fn interrupted() -> PyErr {
    PyKeyboardInterrupt::new_err(())
}
