//! Answers of the library as columns by name.

use crate::arrays::Answers;
use footpoint::{
    Comparison, Curvatures, Evaluations, Hits, Orientation, Projections, Uncertainties, Verdict, Want,
};
use footpoint_jobs::{Changes, Feet};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Evaluations: the columns that were wanted.
pub(crate) fn of_evaluations<const D: usize>(
    py: Python<'_>,
    found: Evaluations<D>,
    want: Want,
) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    let has = |column| want.contains(column);
    let numbers = [
        ("value", Want::VALUE, found.value),
        ("gap", Want::GAP, found.gap),
        ("effective_neighbours", Want::EFFECTIVE_NEIGHBOURS, found.effective_neighbours),
        ("weight_sum", Want::WEIGHT_SUM, found.weight_sum),
        ("squared_sensitivity", Want::SQUARED_SENSITIVITY, found.squared_sensitivity),
        ("support", Want::SUPPORT, found.support),
        ("eccentricity", Want::ECCENTRICITY, found.eccentricity),
        ("sigma", Want::SIGMA, found.sigma),
    ];
    for (name, _, values) in numbers.into_iter().filter(|(_, column, _)| has(*column)) {
        answers.put(name, values)?;
    }
    let vectors = [
        ("average", Want::AVERAGE, found.average),
        ("frame_normal", Want::FRAME_NORMAL, found.frame_normal),
        ("gradient", Want::GRADIENT, found.gradient),
        ("surface_normal", Want::SURFACE_NORMAL, found.surface_normal),
        ("eigenvalues", Want::EIGENVALUES, found.eigenvalues),
    ];
    for (name, _, values) in vectors.into_iter().filter(|(_, column, _)| has(*column)) {
        answers.put_rows(name, values)?;
    }
    let counts = [("neighbours", Want::NEIGHBOURS, found.neighbours), ("degree", Want::DEGREE, found.degree)];
    for (name, _, values) in counts.into_iter().filter(|(_, column, _)| has(*column)) {
        answers.put(name, values)?;
    }
    if has(Want::HESSIAN) {
        answers.put_matrices("hessian", found.hessian)?;
    }
    if has(Want::CURVATURE) {
        answers.0.set_item("curvature", of_curvatures(py, found.curvature)?)?;
    }
    answers.put_status(found.status)?;
    Ok(answers.0)
}

fn of_curvatures<const D: usize>(py: Python<'_>, found: Curvatures<D>) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    answers.put("mean", found.mean)?;
    answers.put("gaussian", found.gaussian)?;
    answers.put_rows("principal", found.principal)?;
    answers.put_matrices("directions", found.directions)?;
    Ok(answers.0)
}

/// Projected points; with noise, the errors of their distances.
pub(crate) fn of_projections<const D: usize>(
    py: Python<'_>,
    found: Projections<D>,
    errors: Option<(Vec<f64>, Vec<f64>)>,
) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    answers.put_rows("point", found.point)?;
    answers.put_rows("surface_normal", found.surface_normal)?;
    answers.put_rows("frame_normal", found.frame_normal)?;
    answers.put("distance", found.distance)?;
    answers.put("residual", found.residual)?;
    answers.put("evaluations", found.evaluations)?;
    if let Some((sigma, bias)) = errors {
        answers.put("sigma", sigma)?;
        answers.put("bias", bias)?;
    }
    answers.put_status(found.status)?;
    Ok(answers.0)
}

/// Foot points, however far.
pub(crate) fn of_feet<const D: usize>(
    py: Python<'_>,
    found: Feet<D>,
    has_sigma: bool,
) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    let Uncertainties { feet, sigma, bias } = found.found;
    answers.put_rows("foot", feet.point)?;
    answers.put("distance", feet.distance)?;
    if has_sigma {
        answers.put("sigma", sigma)?;
    }
    answers.put("bias", bias)?;
    answers.put_rows("surface_normal", feet.surface_normal)?;
    answers.put_status(feet.status)?;
    answers.0.set_item("walked", found.walked)?;
    Ok(answers.0)
}

/// Distances between surfaces.
pub(crate) fn of_changes<const D: usize>(py: Python<'_>, changes: Changes<D>) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    let significant = (0..changes.found.status.len()).map(|row| changes.is_significant(row)).collect();
    let level = changes.found.sigma.iter().map(|sigma| Comparison::LEVEL * sigma).collect();
    answers.put_rows("foot", changes.found.foot)?;
    answers.put("distance", changes.found.distance)?;
    answers.put("sigma", changes.found.sigma)?;
    answers.put::<f64>("level_of_detection", level)?;
    answers.put::<bool>("significant", significant)?;
    answers.put_rows("surface_normal", changes.found.surface_normal)?;
    answers.put_status(changes.found.status)?;
    answers.0.set_item("walked", changes.walked)?;
    Ok(answers.0)
}

/// Where rays meet the surface.
pub(crate) fn of_hits<const D: usize>(py: Python<'_>, found: Hits<D>) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    answers.put("t", found.t)?;
    answers.put_rows("point", found.point)?;
    answers.put_rows("surface_normal", found.surface_normal)?;
    answers.put_rows("frame_normal", found.frame_normal)?;
    answers.put_rows("gradient", found.gradient)?;
    answers.put("evaluations", found.evaluations)?;
    answers.put_status(found.status)?;
    Ok(answers.0)
}

/// Oriented normals, and their components as (samples, reversed, doubtful edges, odd edges, whether it is orientable).
pub(crate) fn of_orientation<const D: usize>(
    py: Python<'_>,
    found: Orientation<D>,
) -> PyResult<Bound<'_, PyDict>> {
    let answers = Answers::new(py);
    answers.put_rows("normal", found.normal)?;
    answers.put_status(found.status)?;
    if !found.component.is_empty() {
        let number = |component| if component == u32::MAX { -1 } else { i64::from(component) };
        answers.put("component", found.component.into_iter().map(number).collect::<Vec<i64>>())?;
    }
    let components: Vec<(usize, usize, usize, usize, bool)> = found
        .components
        .iter()
        .map(|c| (c.samples, c.reversed, c.doubtful_edges, c.odd_edges, c.verdict == Verdict::Orientable))
        .collect();
    answers.0.set_item("components", components)?;
    answers.0.set_item("oriented", found.oriented)?;
    answers.0.set_item("reversed", found.reversed)?;
    answers.0.set_item("doubtful", found.doubtful)?;
    Ok(answers.0)
}
