//! Arguments of the command line, and what they mean to the jobs.

mod common;
mod distance;
mod project;
mod render;

use crate::meta;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use common::Common;
use distance::DistanceArguments;
use footpoint_jobs::scan::ScanPlan;
use footpoint_jobs::{
    Bending, DegreeAim, DemoPlan, Extra, FigurePlan, NoiseSource, NonOrientable, NormalChoice, NormalSource,
    OrientBy, OrientPlan, Recipe, Support, Which,
};
use project::ProjectArguments;
use render::RenderArguments;
use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;

/// Computes with the smooth surface that a point cloud describes.
///
/// The surface is where f(x) = n(x)·(x − a(x)) vanishes (Alexa & Adamson 2004); its normal is the exact gradient
/// of f. Files: ply las laz e57 pcd obj npy npz and text (xyz csv txt pts pwn xy); read only: COPC, ptx, gzip.
/// Two columns are a curve in the plane. Lengths are in the unit of the file, angles in degrees.
#[derive(Debug, Parser)]
#[command(name = "footpoint", version, max_term_width = 100, after_help = EXIT_CODES, disable_help_subcommand = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    #[command(flatten)]
    Work(Box<Verb>),
    #[command(flatten)]
    About(About),
}

/// Words about the command itself.
#[derive(Debug, Subcommand)]
pub(crate) enum About {
    /// Explain a command, or `definition`: weights, fields and supports in plain words
    Help {
        /// A command, or `definition`
        #[arg(value_parser = topic)]
        topic: Option<String>,
    },
    /// Print completions for a shell: `footpoint completions bash > /etc/bash_completion.d/footpoint`
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print a manual page: `footpoint man | man -l -`
    Man {
        /// A command [default: the page that lists them]
        #[arg(value_parser = verb)]
        command: Option<String>,
    },
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 more points than --strict allows are not ok, or some are missing in the file; 2 nothing done; 130 interrupted.\n\
    Each point has a status: ok outside degenerate boundary singular not_converged invalid (0 … 6 but in text).";

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Simulate a laser scan, compute its normals and projection, compare with the truth, draw it
    #[command(
        after_help = "Examples:\n  footpoint demo\n  footpoint demo --range-noise 0.001 -o fine\nMore options: --help"
    )]
    Demo(DemoArguments),
    /// Describe a file: counts, bounds, repeats, spacing, normals, and the support that fits it
    #[command(
        after_help = "Examples:\n  footpoint info scan.ply\n  footpoint info scan.ply --json | jq .surface.support\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Info(InfoArguments),
    /// Evaluate f, its gradient and what belongs to them at given points
    #[command(
        after_help = "Examples:\n  footpoint evaluate scan.ply --at points.csv -o f.csv\n  footpoint evaluate scan.ply --at points.csv -o f.csv --with curvature,sigma --noise auto\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Evaluate(EvaluateArguments),
    /// Give every sample its normal
    #[command(
        after_help = "Examples:\n  footpoint normals scan.ply -o normals.ply\n  footpoint normals noisy.xyz -o normals.csv --auto 40 --curvature\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Normals(NormalsArguments),
    /// Give every sample its normal, with signs that agree
    #[command(
        after_help = "Examples:\n  footpoint orient scan.ply -o oriented.ply\n  footpoint orient scan.ply -o oriented.ply --towards 0,0,1.7\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Orient(OrientArguments),
    /// Take points to the surface
    #[command(
        after_help = "Examples:\n  footpoint project scan.ply -o smooth.ply\n  footpoint project points.csv --onto scan.ply -o feet.csv --noise auto\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Project(ProjectArguments),
    /// Tell how far a cloud, or points, lie from another's surface, and what of it is significant
    #[command(
        after_help = "Examples:\n  footpoint distance new.ply --to old.ply -o off.ply\n  footpoint distance new.ply --to old.ply -o off.ply --registration 0.002 --colours\n  footpoint distance points.csv --to cloud.ply -o off.csv --compare points --noise auto\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Distance(DistanceArguments),
    /// Draw the figures of the paper: the surface as f = 0, its normals, the steps of projections
    #[command(
        after_help = "Examples:\n  footpoint figure all -o figures\n  footpoint figure 3 scan.ply -o figures\nMore options: --help"
    )]
    Figure(FigureArguments),
    /// Draw the surface: one picture, light or colours for numbers
    #[command(
        after_help = "Examples:\n  footpoint render scan.ply\n  footpoint render scan.ply -o bent.png --shading curvature --view front\nMore options: --help; weights, fields and supports in plain words: footpoint help definition"
    )]
    Render(RenderArguments),
}

impl Verb {
    /// What to compute, with the options that only some verbs have.
    pub(crate) fn recipe(&self) -> Result<Recipe, String> {
        let mut recipe = self.common().recipe()?;
        match self {
            Self::Demo(a) => a.adjust(&mut recipe),
            Self::Project(a) => a.adjust(&mut recipe)?,
            Self::Distance(a) => a.adjust(&mut recipe),
            Self::Figure(a) => a.check(&recipe)?,
            Self::Normals(_) | Self::Orient(_) => {
                recipe.choose_degree = recipe.choose_degree.map(|_| DegreeAim::Normal);
            }
            _ => {}
        }
        Ok(recipe)
    }

    pub(crate) fn common(&self) -> &Common {
        match self {
            Self::Demo(a) => &a.common,
            Self::Info(a) => &a.common,
            Self::Evaluate(a) => &a.common,
            Self::Normals(a) => &a.common,
            Self::Orient(a) => &a.common,
            Self::Project(a) => &a.common,
            Self::Distance(a) => &a.common,
            Self::Figure(a) => &a.common,
            Self::Render(a) => &a.common,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct DemoArguments {
    /// Folder for scan.ply, normals.ply, projected.ply, picture.png and triptych.png
    #[arg(short, long, value_name = "DIR", default_value = "footpoint-demo")]
    output: PathBuf,
    /// Standard deviation of the simulated ranges, in metres
    #[arg(long, value_name = "METRES", default_value_t = ScanPlan::default().noise)]
    range_noise: f64,
    /// Rays that each of the stations casts
    #[arg(long, value_name = "COUNT", default_value_t = ScanPlan::default().rays)]
    rays: u32,
    /// Width of picture.png in pixels; 0 draws nothing
    #[arg(long, value_name = "PIXELS", default_value_t = 800, value_parser = clap::value_parser!(u16).range(0..=20_000))]
    picture_width: u16,
    /// Seed of the simulated noise
    #[arg(long, value_name = "NUMBER", default_value_t = ScanPlan::default().seed)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

impl DemoArguments {
    pub(crate) fn plan(&self) -> DemoPlan {
        let scan =
            ScanPlan { noise: self.range_noise, rays: self.rays, seed: self.seed, ..ScanPlan::default() };
        DemoPlan { folder: self.output.clone(), scan, picture_width: self.picture_width.into() }
    }

    /// The scan's density varies tenfold, so unless told otherwise each sample gets its own support.
    fn adjust(&self, recipe: &mut Recipe) {
        if !self.common.chooses_support() && self.common.definition.is_none() {
            let support = Support::AutoPerSample { effective_neighbours: DEMO_EFFECTIVE_NEIGHBOURS };
            recipe.definition = recipe.definition.with_support(support);
        }
    }
}

/// Wide enough to average the demo's noise, narrow enough for its detail.
const DEMO_EFFECTIVE_NEIGHBOURS: f64 = 24.0;

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The file
    pub(crate) input: PathBuf,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArguments {
    /// The cloud that defines the surface
    pub(crate) cloud: PathBuf,
    /// Points to evaluate at
    #[arg(long, value_name = "QUERIES")]
    pub(crate) at: PathBuf,
    /// File to write: one row a query
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// More columns, by commas
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    with: Vec<ExtraName>,
    #[command(flatten)]
    common: Common,
}

impl EvaluateArguments {
    pub(crate) fn extra(&self) -> Vec<Extra> {
        self.with.iter().map(|name| name.meaning()).collect()
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
enum ExtraName {
    /// S, the sum of the weights
    WeightSum,
    /// Eigenvalues of the matrix that gives the frame
    Eigenvalues,
    /// Σ|∂f/∂p_i|²: times the noise squared, the variance of f
    SquaredSensitivity,
    /// The local support h(x)
    Support,
    /// |a − x| across n, in supports: large at a rim
    Eccentricity,
    /// Second derivatives of f
    Hessian,
    /// Mean, Gaussian and principal curvatures with their directions
    Curvature,
    /// Standard deviation of f, with --noise
    Sigma,
    /// Degree of the polynomial that answered
    Degree,
}

impl ExtraName {
    fn meaning(self) -> Extra {
        match self {
            Self::WeightSum => Extra::WeightSum,
            Self::Eigenvalues => Extra::Eigenvalues,
            Self::SquaredSensitivity => Extra::SquaredSensitivity,
            Self::Support => Extra::Support,
            Self::Eccentricity => Extra::Eccentricity,
            Self::Hessian => Extra::Hessian,
            Self::Curvature => Extra::Curvature,
            Self::Sigma => Extra::Sigma,
            Self::Degree => Extra::Degree,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct NormalsArguments {
    /// The cloud
    pub(crate) input: PathBuf,
    /// File to write: every sample with its normal, all columns kept
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Which normal
    #[arg(long, value_enum, default_value = "surface")]
    normal: NormalName,
    /// Add mean, Gaussian and principal curvatures with their directions
    #[arg(long)]
    curvature: bool,
    #[command(flatten)]
    common: Common,
}

impl NormalsArguments {
    pub(crate) fn bending(&self) -> Bending {
        if self.curvature { Bending::Write } else { Bending::Omit }
    }

    pub(crate) fn choice(&self) -> NormalChoice {
        match self.normal {
            NormalName::Surface => NormalChoice::Surface,
            NormalName::Frame => NormalChoice::Frame,
            NormalName::Both => NormalChoice::Both,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum NormalName {
    /// Exact normal of the surface, from the gradient of f
    Surface,
    /// Normal of the fitted frame
    Frame,
    /// Both of them
    Both,
}

#[derive(Debug, Args)]
pub(crate) struct OrientArguments {
    /// The cloud
    pub(crate) input: PathBuf,
    /// File to write: every sample with its oriented normal nx ny nz, all columns kept
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Which normals get signs
    #[arg(long, value_enum, default_value = "surface")]
    normal: SourceName,
    /// Normals face this point [default: signs go from neighbour to neighbour, each component faces outward]
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', group = "how", allow_hyphen_values = true)]
    towards: Option<Vec<f64>>,
    /// Normals have a positive component along this axis
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', group = "how", allow_hyphen_values = true)]
    along: Option<Vec<f64>>,
    /// Normals face the sensor, whose position at each sample is in these columns
    #[arg(long, value_name = "NAMES", value_delimiter = ',', group = "how")]
    sensor_columns: Option<Vec<String>>,
    /// Normals face the sensor, which moves along the points of this file
    #[arg(long, value_name = "FILE", group = "how")]
    trajectory: Option<PathBuf>,
    /// Column of times in the cloud and in the trajectory
    #[arg(long, value_name = "NAME", default_value = "time", requires = "trajectory")]
    time_column: String,
    /// Orient surfaces without sides too, such as a Möbius strip: a seam remains
    #[arg(long, conflicts_with = "how")]
    force_orientation: bool,
    #[command(flatten)]
    common: Common,
}

impl OrientArguments {
    pub(crate) fn plan(&self) -> OrientPlan {
        let normals = match self.normal {
            SourceName::Surface => NormalSource::Surface,
            SourceName::Given => NormalSource::Given,
        };
        let by = match (&self.towards, &self.along, &self.sensor_columns, &self.trajectory) {
            (Some(point), ..) => OrientBy::Towards(point.clone()),
            (_, Some(axis), ..) => OrientBy::Along(axis.clone()),
            (_, _, Some(names), _) => OrientBy::SensorColumns(names.clone()),
            (_, _, _, Some(path)) => {
                OrientBy::Trajectory { path: path.clone(), time_column: self.time_column.clone() }
            }
            _ if self.force_orientation => OrientBy::Propagated(NonOrientable::Force),
            _ => OrientBy::Propagated(NonOrientable::Leave),
        };
        OrientPlan { normals, by }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SourceName {
    /// Exact normals of the surface, from the gradient of f
    Surface,
    /// The file's own normals, whose signs count for nothing
    Given,
}

#[derive(Debug, Args)]
pub(crate) struct FigureArguments {
    /// Number of the figure, 1 to 6, or `all`
    #[arg(value_name = "WHICH", value_parser = which)]
    which: Which,
    /// Cloud for figure 3 [default: a built-in one]
    input: Option<PathBuf>,
    /// Folder for figure-1.svg, figure-2.svg, figure-3.png …
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Width of figure 3, which is ray-traced
    #[arg(long, value_name = "PIXELS", default_value_t = 1440)]
    width: usize,
    #[command(flatten)]
    common: Common,
}

impl FigureArguments {
    pub(crate) fn plan(&self) -> FigurePlan {
        FigurePlan {
            which: self.which,
            folder: self.output.clone(),
            input: self.input.clone(),
            width: self.width,
        }
    }

    /// The figures in the plane show built-in curves: an option of the surface would change nothing.
    fn check(&self, recipe: &Recipe) -> Result<(), String> {
        match self.which {
            Which::One(3) | Which::All => Ok(()),
            _ if *recipe == Recipe::default() => Ok(()),
            _ => Err("the figures show built-in surfaces; options of the surface are for figure 3 alone"
                .to_owned()),
        }
    }
}

/// `all`, or the number of a figure.
fn which(text: &str) -> Result<Which, String> {
    match text.parse() {
        _ if text == "all" => Ok(Which::All),
        Ok(number @ 1..=6) => Ok(Which::One(number)),
        _ => Err("it must be 1, 2, 3, 4, 5, 6 or `all`".to_owned()),
    }
}

/// Noise of queries: a number, or the name of a column.
#[derive(Clone, Debug, PartialEq)]
struct QueryNoise(NoiseSource);

impl FromStr for QueryNoise {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self(NoiseSource::of(text)))
    }
}

impl QueryNoise {
    /// In place of what was replayed.
    fn adjust(&self, recipe: &mut Recipe) {
        recipe.query_noise_estimated = self.0 == NoiseSource::Estimated;
        (recipe.query_noise, recipe.query_noise_column) = match &self.0 {
            NoiseSource::Uniform(sigma) => (Some(*sigma), None),
            NoiseSource::Column(name) => (None, Some(name.clone())),
            NoiseSource::Estimated => (None, None),
        };
    }
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 => Ok(value),
        _ => Err("it must be a number above 0".to_owned()),
    }
}

/// `1%` or `0.01`.
fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&(value * unit)) => Ok(value * unit),
        _ => {
            Err("a share is a number such as 1% or 0.01 (put --strict last, or write --strict=1%)".to_owned())
        }
    }
}

/// A command, or a topic of help.
fn topic(text: &str) -> Result<String, String> {
    if text == meta::TOPIC { Ok(text.to_owned()) } else { verb(text) }
}

/// A command.
fn verb(text: &str) -> Result<String, String> {
    let names = meta::names();
    if names.iter().any(|name| name == text) {
        return Ok(text.to_owned());
    }
    Err(format!("it must be `{}`, or one of: {}", meta::TOPIC, names.join(" ")))
}
