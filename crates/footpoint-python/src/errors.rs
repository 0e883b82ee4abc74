//! Errors of the library as Python's exceptions, with the names of the arguments.

use footpoint::{
    CloudError, CompareError, DefinitionError, Error, OrientError, SupportError, UncertaintyError,
};
use footpoint_io::{ReadProblem, WriteProblem};
use footpoint_jobs::{JobError, Support};
use footpoint_render::{CameraError, RenderError};
use pyo3::PyErr;
use pyo3::exceptions::{PyFileExistsError, PyIsADirectoryError, PyRuntimeError, PyValueError};
use std::io;

/// An option or a column that makes no sense.
pub(crate) fn wrong(argument: &str, problem: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {problem}"))
}

/// Why a job gave nothing. `support` is the rule that was asked for.
pub(crate) fn of_job(error: JobError, support: Support) -> PyErr {
    match error {
        JobError::Surface { problem, .. } => of_surface(&problem, support),
        JobError::Cloud { problem, .. } => of_cloud(&problem),
        JobError::Noise { problem, .. } => wrong("noise", problem),
        JobError::NoPoints(_) => wrong("points", "there is none"),
        JobError::Number { what, value, wanted } => {
            let argument = if what.contains("registration") { "registration" } else { "largest" };
            wrong(argument, format!("it is {value}, but must be {wanted}"))
        }
        JobError::PartOfSigma(what) => {
            let argument = if what.contains("registration") { "registration" } else { "query_noise" };
            wrong(argument, "it is part of sigma, which needs the noise of the surface's samples: noise=")
        }
        JobError::OnlyPoints(what) => {
            let argument = if what.contains("queries") { "query_noise" } else { "noise" };
            wrong(
                argument,
                "it belongs to compare=\"points\"; surfaces are compared by the scatter of the samples",
            )
        }
        other => of_file(other),
    }
}

/// Why two clouds cannot be compared. `support` is the rule that was asked for.
pub(crate) fn of_comparison(problem: &CompareError, support: Support) -> PyErr {
    match problem {
        CompareError::Earlier(problem) => of_surface(problem, support),
        CompareError::Later(Error::Support(problem)) => wrong("points", problem),
        CompareError::Later(problem) => of_surface(problem, support),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

/// Why a file could not be read or written.
pub(crate) fn of_file(error: JobError) -> PyErr {
    let text = error.to_string();
    match error {
        JobError::Read(error) => match *error.problem {
            ReadProblem::Io(problem) => of_io(&problem, text),
            ReadProblem::Folder => PyIsADirectoryError::new_err(text),
            _ => PyValueError::new_err(text),
        },
        JobError::Write(error) => match error.problem {
            WriteProblem::Exists => PyFileExistsError::new_err(format!("{text}: overwrite=True")),
            WriteProblem::NotAFile => PyIsADirectoryError::new_err(text),
            WriteProblem::NoFolder(_) => of_io(&io::ErrorKind::NotFound.into(), text),
            WriteProblem::NotWritable(problem) | WriteProblem::Io(problem) => of_io(&problem, text),
            _ => PyValueError::new_err(text),
        },
        JobError::Cancelled => PyRuntimeError::new_err("cancelled"),
        _ => PyValueError::new_err(text),
    }
}

/// The subclass of `OSError` that this kind of failure has.
fn of_io(problem: &io::Error, text: String) -> PyErr {
    io::Error::new(problem.kind(), text).into()
}

fn of_surface(problem: &Error, support: Support) -> PyErr {
    match problem {
        Error::Cloud(problem) => of_cloud(problem),
        Error::Definition(problem) => wrong(argument_of(problem), problem),
        Error::Support(problem @ (SupportError::NoSample(_) | SupportError::Coincident(_))) => {
            wrong("points", problem)
        }
        Error::Support(problem) => wrong(rule_of(support), problem),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

fn of_cloud(problem: &CloudError) -> PyErr {
    match problem {
        CloudError::Length { column, .. } | CloudError::Negative { column, .. } => {
            wrong(if *column == "normals" { "normals" } else { plural(column) }, problem)
        }
        other => wrong("points", other),
    }
}

fn plural(column: &str) -> &'static str {
    if column == "factor" { "factors" } else { "supports" }
}

fn argument_of(problem: &DefinitionError) -> &'static str {
    match problem {
        DefinitionError::DomainRatio(_) => "domain_ratio",
        DefinitionError::Degree(_) | DefinitionError::DegreeOfField(..) => "degree",
        DefinitionError::Cut(_) => "cut",
        DefinitionError::SingleRange { .. } => "precision",
        DefinitionError::NormalsAbsent(_) => "field",
        _ => "accept_alignment, accept_gap or accept_boundary",
    }
}

/// The argument that gives this rule.
fn rule_of(support: Support) -> &'static str {
    match support {
        Support::Uniform(_) => "radius",
        Support::FromSamples => "supports",
        Support::AutoPerSample { .. } | Support::LeastErrorPerSample => "per_sample",
        _ => "auto",
    }
}

/// Why nothing is oriented.
pub(crate) fn of_orient(problem: &OrientError) -> PyErr {
    match problem {
        OrientError::Length { column, .. } => wrong(column, problem),
        OrientError::NotFinite(what) => {
            wrong(if what.contains("axis") { "along" } else { "towards" }, problem)
        }
        OrientError::NoPath | OrientError::Path(_) => wrong("trajectory", problem),
        OrientError::NoNormals => wrong("normals", problem),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

/// Why there are no uncertainties.
pub(crate) fn of_uncertainty(problem: &UncertaintyError) -> PyErr {
    match problem {
        UncertaintyError::QueryNoise(problem) => wrong("query_noise", problem),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

/// Why there is no picture.
pub(crate) fn of_render(problem: &RenderError) -> PyErr {
    match problem {
        RenderError::Size(..) => wrong("size", problem),
        RenderError::NoSamples => wrong("samples", problem),
        RenderError::Range(..) => wrong("range", problem),
        RenderError::Camera(CameraError::NoSight { .. }) => wrong("look_from, look_at", problem),
        RenderError::Camera(CameraError::NoUp(_)) => wrong("look_up", problem),
        RenderError::Camera(CameraError::Fov(_)) => wrong("fov", problem),
        RenderError::Camera(CameraError::Height(_)) => wrong("view_height", problem),
        other => PyValueError::new_err(other.to_string()),
    }
}
