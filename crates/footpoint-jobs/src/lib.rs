//! The work behind footpoint's commands: files in, files and a report out.
//!
//! The command line, and every other front, calls these jobs and holds no geometry of its own. Each job checks its
//! output before it computes, keeps every column and the order of its input, and leaves no partial file behind.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod clock;
mod demo;
mod describe;
mod distance;
mod dry;
mod evaluate;
mod figure;
mod info;
mod load;
mod normals;
mod numbers;
mod orient;
mod output;
mod project;
mod render;
mod report;
pub mod scan;
mod stage;
mod triptych;

pub use clock::{Spent, Times};
pub use demo::{DemoPlan, DemoReport, demo};
pub use describe::{format_name, missing_points, notes, origin_of, unit_name};
pub use distance::{
    Changes, Coloured, DistanceReport, DistanceSearch, Feet, Histogram, Quantile, SupportShare,
    SurfaceSearch, check_distance, distance,
};
pub use dry::Mode;
pub use evaluate::{Extra, USUAL, evaluate};
pub use figure::{FigurePlan, Which, figure};
pub use info::{InfoReport, NormalsReport, info};
pub use load::{estimated_noise, surface_of_cloud};
pub use normals::{Bending, NormalChoice, normals};
pub use orient::{OrientBy, OrientPlan, OrientationReport, orient};
pub use project::project;
pub use render::{
    RenderPlan, RenderReport, Show, axis, check_picture, picture, render, title, write_picture,
};
pub use report::{
    Compare, InputReport, MovedReport, NoiseSource, Recipe, Report, SCHEMA, StatusCount, SurfaceReport,
    recipe_of,
};
pub use stage::Stage;
pub use triptych::triptych;

/// What the jobs take from the library, so that a front needs no other crate.
pub use footpoint::{
    Acceptance, Definition, DegreeAim, DegreeChoice, Kind, NonOrientable, NormalField, NormalSource,
    Operator, Precision, Progress, Project, Run, Status, Support, Weight,
};
pub use footpoint_io::{Overwrite, UNPACKING};
pub use footpoint_render::{
    Background, Camera, Canvas, Origin, Projection, Relief, Upright, View, Why, Wish,
};

use std::path::PathBuf;

/// What every job needs beside its files.
#[derive(Clone, Default)]
pub struct Context<'r> {
    /// What to compute.
    pub recipe: Recipe,
    /// What to do about output files that exist.
    pub overwrite: Overwrite,
    /// Whether to do it, or only to tell.
    pub mode: Mode,
    /// Threads, progress, cancelling.
    pub run: Run<'r>,
    /// Told of each stage as it begins; the run's progress is its own from then on.
    pub stage: Option<&'r (dyn Fn(Stage<'_>) + Sync)>,
}

/// Why a job gave nothing; no file was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] footpoint_io::ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] footpoint_io::WriteError),
    /// A file has no coordinates.
    #[error("{}: {problem}", path.display())]
    Roles {
        /// The file.
        path: PathBuf,
        /// What is missing.
        problem: footpoint_io::roles::RolesError,
    },
    /// A file without a single point.
    #[error("{0}: the file has no points")]
    NoPoints(String),
    /// A column that was asked for is absent or holds text.
    #[error("{path}: no column of numbers named `{name}`; columns found: {found}")]
    Column {
        /// The file.
        path: String,
        /// The column asked for.
        name: String,
        /// The columns there are.
        found: String,
    },
    /// Two files of different dimensions.
    #[error("{first} has {first_dimension}-D points and {second} {second_dimension}-D ones: they must agree")]
    Dimensions {
        /// The cloud.
        first: String,
        /// Its dimension.
        first_dimension: usize,
        /// The other file.
        second: String,
        /// Its dimension.
        second_dimension: usize,
    },
    /// The cloud's columns do not fit.
    #[error("{path}: {problem}")]
    Cloud {
        /// The file.
        path: String,
        /// What does not fit.
        problem: footpoint::CloudError,
    },
    /// No surface can be made of the file.
    #[error("{path}: {problem}")]
    Surface {
        /// The file.
        path: String,
        /// What stands against it.
        problem: footpoint::Error,
    },
    /// The noise of a file does not fit.
    #[error("{path}: {problem}")]
    Noise {
        /// The file.
        path: String,
        /// What is wrong.
        problem: footpoint::NoiseError,
    },
    /// Uncertainties without noise.
    #[error("sigma needs the noise of the samples: --noise SIGMA, --noise COLUMN or --noise auto")]
    NoNoise,
    /// Uncertainties cannot be had.
    #[error(transparent)]
    Uncertainty(footpoint::UncertaintyError),
    /// An error of the registration or of the queries without noise of the samples.
    #[error(
        "{0} is part of sigma, which needs the noise of the samples: --noise SIGMA, --noise COLUMN or --noise auto"
    )]
    PartOfSigma(&'static str),
    /// What serves the comparison of points alone.
    #[error(
        "{0} belongs to --compare points; surfaces are compared by the scatter of the samples around every point, on both sides"
    )]
    OnlyPoints(&'static str),
    /// A number that makes no sense.
    #[error("{what} is {value}: it must be {wanted}")]
    Number {
        /// Which number.
        what: &'static str,
        /// As given.
        value: f64,
        /// What would make sense.
        wanted: &'static str,
    },
    /// Coordinates that are angles.
    #[error(
        "{0}: its coordinates are degrees of longitude and latitude, which are no lengths: reproject the file to metres or \
         feet first, to its UTM zone or a national grid (`pdal translate IN OUT reprojection \
         --filters.reprojection.out_srs=EPSG:CODE`)"
    )]
    Degrees(String),
    /// The samples cannot be oriented as asked.
    #[error("{path}: {problem}")]
    Orient {
        /// The file.
        path: String,
        /// What stands against it.
        problem: footpoint::OrientError,
    },
    /// A vector with another number of coordinates than the points.
    #[error("{what}: {found} given, but the points have {expected} coordinates")]
    Vector {
        /// Which vector.
        what: &'static str,
        /// Dimension of the points.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A folder cannot be made.
    #[error("{}: cannot make this folder: {problem}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        problem: std::io::Error,
    },
    /// A figure cannot be drawn.
    #[error("figure {number}: {problem}")]
    Figure {
        /// Its number in the paper.
        number: u8,
        /// What stands against it.
        problem: footpoint_render::figure::FigureError,
    },
    /// A file where no figure takes one.
    #[error("figure {0} shows built-in samples and takes no file; figure 3 does")]
    NoInput(u8),
    /// A scan that cannot be simulated.
    #[error(transparent)]
    Plan(#[from] scan::PlanError),
    /// A curve where a surface is needed.
    #[error(
        "{0}: its points have 2 coordinates, which make a curve: `footpoint figure` draws curves, this needs 3"
    )]
    OnlyPlane(String),
    /// A name that is not a picture's.
    #[error("{0}: pictures are written as PNG; end the name in .png")]
    NotPng(String),
    /// An OBJ file for more than it holds.
    #[error(
        "{0}: OBJ holds only coordinates, normals and colours, and this command gives more; write PLY, LAS or text"
    )]
    NotForObj(String),
    /// Two outputs of one name.
    #[error("{0}: two pictures are to be written there; give each its own name")]
    SameFile(String),
    /// A picture cannot be drawn.
    #[error("{path}: {problem}")]
    Render {
        /// The file.
        path: String,
        /// What stands against it.
        problem: footpoint_render::RenderError,
    },
    /// A picture of nothing.
    #[error(
        "{0}: no ray met the surface, so there is no picture. Look from elsewhere (--view, --look-from, --look-at), or \
         widen the support (--auto 40, --per-sample 16): `footpoint info` says how well it suits the points"
    )]
    NothingHit(String),
    /// The job was cancelled.
    #[error("cancelled; nothing was written")]
    Cancelled,
}

impl JobError {
    /// Why there is no picture of this file.
    pub(crate) fn of_render(path: &str, problem: footpoint_render::RenderError) -> Self {
        match problem {
            footpoint_render::RenderError::Cancelled(_) => Self::Cancelled,
            problem => Self::Render { path: path.to_owned(), problem },
        }
    }

    /// Whether an output exists already and may not be overwritten.
    pub fn is_existing_output(&self) -> bool {
        matches!(self, Self::Write(error) if matches!(error.problem, footpoint_io::WriteProblem::Exists))
    }

    /// Whether the output cannot hold a point without coordinates.
    pub fn is_no_coordinate(&self) -> bool {
        use footpoint_io::{LasMisfit::Coordinate, WriteProblem::Las};
        matches!(self, Self::Write(error) if matches!(error.problem, Las(Coordinate { .. })))
    }
}

impl From<footpoint::Cancelled> for JobError {
    fn from(_: footpoint::Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<footpoint::UncertaintyError> for JobError {
    fn from(error: footpoint::UncertaintyError) -> Self {
        match error {
            footpoint::UncertaintyError::Cancelled(_) => Self::Cancelled,
            other => Self::Uncertainty(other),
        }
    }
}
