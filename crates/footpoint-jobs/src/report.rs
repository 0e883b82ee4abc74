//! The report of a job: what was computed from what, how it went, how long it took.

use crate::clock::Times;
use crate::demo::DemoReport;
use crate::distance::DistanceReport;
use crate::info::InfoReport;
use crate::orient::OrientationReport;
use crate::render::RenderReport;
use footpoint::{
    Comparison, Definition, DegreeAim, DegreeChoice, Noise, Project, Sign, Status, SupportChoice,
    SupportSummary, Surface,
};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the report's layout.
pub const SCHEMA: &str = "footpoint-report/1";

/// What a job says of itself. Lengths are in the unit of the files, keys name their unit otherwise.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// The job: `normals`, `project`, …
    pub job: &'static str,
    /// Whether nothing was computed or written: outputs are those that would be.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub dry_run: bool,
    /// Files read.
    pub inputs: Vec<InputReport>,
    /// Files written.
    pub outputs: Vec<String>,
    /// What was computed; `--definition` replays it.
    #[serde(flatten)]
    pub recipe: Recipe,
    /// The surface that was used.
    pub surface: Option<SurfaceReport>,
    /// Points asked about; rays of a picture.
    pub points: usize,
    /// How many points ended with each status; only those that occur.
    pub statuses: Vec<StatusCount>,
    /// How far `project` moved the points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved: Option<MovedReport>,
    /// What `distance` found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<DistanceReport>,
    /// How `orient` found the signs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<OrientationReport>,
    /// What `render` drew.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub render: Option<RenderReport>,
    /// What `info` found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub info: Option<InfoReport>,
    /// What `demo` found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demo: Option<DemoReport>,
    /// Time by stage.
    pub times: Times,
    /// Points over the wall seconds of `compute`; rays over those of `draw`.
    pub points_per_second: f64,
}

/// What is computed and from which columns: all that a replay needs beside the files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The surface's definition.
    pub definition: Definition,
    /// Column of support radii.
    #[serde(default)]
    pub support_column: Option<String>,
    /// Column of factors.
    #[serde(default)]
    pub factor_column: Option<String>,
    /// Columns that are left out as if the files had none of that name; `normals` for those that hold normals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drop: Vec<String>,
    /// Only the points inside this box are read, from every file: its lowest and its highest corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<[[f64; 3]; 2]>,
    /// Where the noise of the samples is from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseSource>,
    /// Chooses the degree before anything else; the definition in the report then has it.
    #[serde(skip)]
    pub choose_degree: Option<DegreeAim>,
    /// Noise of foreign points, a standard deviation in the unit of the files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub query_noise: Option<f64>,
    /// Column of such noise, or of covariances as for [`NoiseSource::Column`]; it comes before `query_noise`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub query_noise_column: Option<String>,
    /// Whether such noise is estimated from the residuals of the points about their own surface.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub query_noise_estimated: bool,
    /// What `distance` compares; none is [`Compare::default`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Compare>,
    /// Error of the registration of the queries with the cloud, a standard deviation in the unit of the files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub registration: Option<f64>,
    /// Largest distance that counts as an answer, in the unit of the files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_distance: Option<f64>,
    /// Operator and tolerance of a projection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Project>,
}

/// What `distance` compares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Compare {
    /// Points with the surface of a cloud.
    Points,
    /// The surface of the points with that of a cloud.
    Surfaces {
        /// Supports that are tried, by effective neighbours of the cloud; none for the definition's own.
        effective_neighbours: Vec<f64>,
    },
}

impl Default for Compare {
    fn default() -> Self {
        Self::Surfaces { effective_neighbours: Comparison::EFFECTIVE_NEIGHBOURS.to_vec() }
    }
}

impl Recipe {
    /// Whether `distance` compares points, and not surfaces.
    pub fn compares_points(&self) -> bool {
        self.compare == Some(Compare::Points)
    }
}

/// Where the noise of the samples is from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// One standard deviation, in the unit of the file.
    Uniform(f64),
    /// A column of them; or of covariances, if there are `NAME_xx`, `NAME_xy`, … and no `NAME`.
    Column(String),
    /// Estimated from the residuals.
    Estimated,
}

impl NoiseSource {
    /// `auto`, a number, or the name of a column.
    pub fn of(text: &str) -> Self {
        match text.parse() {
            Ok(sigma) => Self::Uniform(sigma),
            Err(_) if text == "auto" => Self::Estimated,
            Err(_) => Self::Column(text.to_owned()),
        }
    }
}

/// One file read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputReport {
    /// Its path as given.
    pub path: String,
    /// Its format: `ply`, `las`, `text`, …
    pub format: &'static str,
    /// Points in it.
    pub points: usize,
    /// 2 or 3.
    pub dimension: usize,
    /// Points that the file states and does not hold, because it is damaged.
    pub missing_points: u64,
    /// The coordinate reference system, as the file states it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// The unit of the coordinates, where the file states it: `metre`, `foot`, `us_survey_foot`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// Points with a coordinate that is not finite: they keep their place and get no answer.
    pub not_finite: usize,
    /// Whether the file has normals.
    pub normals: bool,
    /// Normals that are zero or not finite: they count as absent.
    pub unusable_normals: usize,
    /// Guesses and doubts of the reader, and what it passed over.
    pub notes: Vec<String>,
}

/// The surface of a job.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceReport {
    /// The support radii that the rule gave.
    pub support: SupportSummary,
    /// The evidence for them, where the rule was that of least error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub support_choice: Option<SupportChoice>,
    /// The evidence for the degree, where it was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub degree_choice: Option<DegreeChoice>,
    /// Whether signs mean something.
    pub sign: Sign,
    /// Samples that take part.
    pub samples_used: usize,
    /// Samples left out: coordinates not finite, or no positive support or factor.
    pub samples_absent: usize,
    /// Bound on |a − x|/h that was used.
    pub boundary_limit: f64,
    /// Noise of the samples where one figure holds for all, given or estimated: a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_sigma: Option<f64>,
    /// Moves of the cloud by whole multiples of this keep every bit of the result.
    pub cell_side: f64,
}

/// How many points ended with a status.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatusCount {
    /// The status's name.
    pub status: &'static str,
    /// Its points.
    pub points: usize,
}

/// How far points were moved, over those that are *ok*.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MovedReport {
    /// Root mean square distance.
    pub rms: f64,
    /// Median distance.
    pub median: f64,
    /// Largest distance.
    pub largest: f64,
    /// Mean number of evaluations of f, over all points.
    pub mean_evaluations: f64,
}

impl Report {
    /// An empty report of a job.
    pub fn new(job: &'static str, recipe: Recipe) -> Self {
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            job,
            dry_run: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            recipe,
            surface: None,
            points: 0,
            statuses: Vec::new(),
            moved: None,
            distance: None,
            orientation: None,
            render: None,
            info: None,
            demo: None,
            times: Times::default(),
            points_per_second: 0.0,
        }
    }

    /// Takes in the statuses of all points; to be called once the time of `compute` is known.
    pub(crate) fn count(&mut self, statuses: &[Status]) {
        self.points = statuses.len();
        self.statuses = Status::ALL
            .into_iter()
            .map(|status| StatusCount {
                status: status.name(),
                points: statuses.iter().filter(|&&s| s == status).count(),
            })
            .filter(|count| count.points > 0)
            .collect();
        let seconds = self.times.compute.wall_seconds;
        self.points_per_second = if seconds > 0.0 { self.points as f64 / seconds } else { 0.0 };
    }

    pub(crate) fn wrote(&mut self, path: &Path) {
        self.outputs.push(path.display().to_string());
    }

    /// Points whose status is not *ok*.
    pub fn not_ok(&self) -> usize {
        self.statuses.iter().filter(|c| c.status != Status::Ok.name()).map(|c| c.points).sum()
    }
}

impl SurfaceReport {
    pub(crate) fn of<const D: usize>(surface: &Surface<D>) -> Self {
        Self {
            support: surface.support(),
            support_choice: surface.support_choice(),
            degree_choice: None,
            sign: surface.sign(),
            samples_used: surface.samples_used(),
            samples_absent: surface.cloud().len() - surface.samples_used(),
            boundary_limit: surface.definition().boundary_limit::<D>(),
            noise_sigma: match surface.cloud().noise() {
                Some(&Noise::Uniform(sigma)) => Some(sigma),
                _ => None,
            },
            cell_side: surface.cell_side(),
        }
    }
}

/// Reads the recipe out of a report, to replay it.
pub fn recipe_of(report: &str) -> Result<Recipe, serde_json::Error> {
    #[derive(Deserialize)]
    struct Head {
        schema: String,
        #[serde(flatten)]
        recipe: Recipe,
    }
    let head: Head = serde_json::from_str(report)?;
    if head.schema == SCHEMA {
        return Ok(head.recipe);
    }
    let problem = format!("schema is \"{}\", expected \"{SCHEMA}\"", head.schema);
    Err(serde::de::Error::custom(problem))
}
