//! Options that every verb has: the surface's definition, and how to run.

use super::share;
use crate::print::Verbosity;
use clap::{ArgAction, Args, ValueEnum};
use footpoint_jobs::{
    DegreeAim, Kind, Mode, NoiseSource, NormalField, Overwrite, Precision, Recipe, Support, Weight, recipe_of,
};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(next_help_heading = "Surface")]
pub(crate) struct Common {
    /// One support radius for all samples, in the unit of the file
    #[arg(long, value_name = "H", group = "support", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// One radius with this many effective neighbours, or `best` [default: 16]
    ///
    /// It is chosen so that an even sampling has this many effective neighbours; `best`: so that noise and curvature together make
    /// the least error.
    #[arg(long, value_name = "N_EFF", group = "support", allow_negative_numbers = true, value_parser = aim)]
    auto: Option<Aim>,
    /// One radius per sample, chosen in the same way
    #[arg(long, value_name = "N_EFF", group = "support", allow_negative_numbers = true, value_parser = aim)]
    per_sample: Option<Aim>,
    /// Column of support radii, in the unit of the file
    #[arg(long, value_name = "NAME", group = "support", hide_short_help = true)]
    support_column: Option<String>,
    /// Column of factors that multiply the weights (area, confidence)
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    factor_column: Option<String>,
    /// Columns to leave out, by commas, as if the files had none of that name; `normals` for nx ny nz
    #[arg(long, value_name = "NAMES", value_delimiter = ',', hide_short_help = true)]
    drop: Vec<String>,
    /// Read only the points inside this box: the lowest and the highest coordinates
    ///
    /// Of every file, its faces included; of a COPC file no more is read than that. Points in the plane have any height. `finite` is
    /// the box of all numbers: it leaves out points whose coordinates are none.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z|finite", value_parser = corners, allow_hyphen_values = true, hide_short_help = true)]
    within: Option<[[f64; 3]; 2]>,
    /// Noise of the samples, for sigma: a number, a column, or `auto`
    ///
    /// One standard deviation in the unit of the file, a column of them (or covariances, in columns NAME_xx, NAME_xy …), or
    /// `auto`: estimated from the residuals.
    #[arg(long, value_name = "SIGMA|NAME|auto", allow_negative_numbers = true)]
    noise: Option<String>,
    /// Weight function [default: poly3]
    #[arg(long, value_enum)]
    weight: Option<WeightName>,
    /// Value below which the Gaussian counts as zero [default: 1e-9]
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, hide_short_help = true)]
    cut: Option<f64>,
    /// Definition of the surface [default: pss]
    #[arg(long, value_enum, hide_short_help = true)]
    surface: Option<SurfaceName>,
    /// Normal field [default: centred]
    #[arg(long, value_enum)]
    field: Option<FieldName>,
    /// Degree of the polynomial in place of the average, 0 to 3 or `auto` [default: 0]
    ///
    /// 2 and 3 have no bias from curvature, and more noise. `auto` takes the least error of positions, or of normals where these
    /// are asked for.
    #[arg(long, value_name = "M|auto", value_parser = degree)]
    degree: Option<DegreeName>,
    /// Let the next lower degree answer where the samples do not determine the polynomial
    #[arg(long, hide_short_help = true)]
    degree_fallback: bool,
    /// Numbers that sums are computed in [default: double]
    #[arg(long, value_enum, hide_short_help = true)]
    precision: Option<PrecisionName>,
    /// Radius of the domain around each sample, in supports [default: 1]
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, hide_short_help = true)]
    domain_ratio: Option<f64>,
    /// Least n·∇f of a surface point [default: 0.3]
    #[arg(long, value_name = "COSINE", allow_negative_numbers = true, hide_short_help = true)]
    accept_alignment: Option<f64>,
    /// Least gap of a surface point [default: 0.1]
    #[arg(long, value_name = "GAP", allow_negative_numbers = true, hide_short_help = true)]
    accept_gap: Option<f64>,
    /// Largest distance to the weighted average of a surface point, in supports [default: 0.5; less for some
    /// weights and fields]
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, hide_short_help = true)]
    accept_boundary: Option<f64>,
    /// Replay the definition in this report; other options override it
    #[arg(long, value_name = "REPORT", hide_short_help = true)]
    pub(super) definition: Option<PathBuf>,
    /// Threads to use; 0 is one per core
    #[arg(long, default_value_t = 0, help_heading = "Running", hide_short_help = true)]
    pub(crate) threads: usize,
    /// Print the report as JSON on standard output
    #[arg(long, help_heading = "Running")]
    pub(crate) json: bool,
    /// Exit with 1 if any point, or more than this share (such as 1%), is not ok
    #[arg(long, value_name = "SHARE", num_args = 0..=1, default_missing_value = "0%",
          value_parser = share, help_heading = "Running")]
    pub(crate) strict: Option<f64>,
    /// Read the files and tell what would be done; compute and write nothing
    #[arg(long, help_heading = "Running")]
    pub(crate) dry_run: bool,
    /// Overwrite existing files
    #[arg(long, help_heading = "Running")]
    force: bool,
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Running")]
    quiet: bool,
    /// Say more
    #[arg(short, long, action = ArgAction::SetTrue, help_heading = "Running", hide_short_help = true)]
    verbose: bool,
}

/// A degree, or the choice of one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DegreeName {
    Fixed(u8),
    Auto,
}

/// What an automatic support aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    EffectiveNeighbours(f64),
    LeastError,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum WeightName {
    /// (1 − s²)², s = r/h
    Poly2,
    /// (1 − s²)³
    Poly3,
    /// (1 − s²)⁴
    Poly4,
    /// (1 − s)⁴ (4s + 1)
    Wendland,
    /// exp(−s²), zero below --cut; h is its scale
    Gaussian,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SurfaceName {
    /// Point set surface: f(x) = n(x)·(x − a(x)), n by --field
    Pss,
    /// Levin's surface: where the plane that fits best passes through the point itself
    Levin,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FieldName {
    /// Smallest covariance about the weighted average
    Centred,
    /// Smallest covariance about the point itself, as in the paper
    Covariance,
    /// Average of the samples' normals
    Averaged,
    /// Main axis of the samples' normals, whatever their signs
    Axes,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PrecisionName {
    /// 64 bits: 1e-11 relative
    Double,
    /// 32 bits, for speed: f within 4e-7 supports, normals within 2e-5 rad; tolerances from 1e-6 on
    Single,
}

impl Common {
    pub(super) fn chooses_support(&self) -> bool {
        self.radius.is_some()
            || self.auto.is_some()
            || self.per_sample.is_some()
            || self.support_column.is_some()
    }

    pub(crate) fn mode(&self) -> Mode {
        if self.dry_run { Mode::DryRun } else { Mode::Work }
    }

    pub(crate) fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }

    pub(crate) fn verbosity(&self) -> Verbosity {
        match (self.quiet, self.verbose) {
            (true, _) => Verbosity::Quiet,
            (false, true) => Verbosity::Verbose,
            (false, false) => Verbosity::Normal,
        }
    }

    /// The replayed or the recommended recipe, with the options that were given.
    pub(super) fn recipe(&self) -> Result<Recipe, String> {
        let mut recipe = match &self.definition {
            None => Recipe::default(),
            Some(path) => {
                let problem = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
                let text = std::fs::read_to_string(path).map_err(|error| problem(&error))?;
                recipe_of(&text).map_err(|error| problem(&format!("not a report to replay: {error}")))?
            }
        };
        let mut definition = recipe.definition;
        if self.chooses_support() {
            recipe.support_column.clone_from(&self.support_column);
            definition = definition.with_support(match (self.radius, self.per_sample, self.auto) {
                (Some(h), _, _) => Support::Uniform(h),
                (_, Some(Aim::LeastError), _) => Support::LeastErrorPerSample,
                (_, Some(Aim::EffectiveNeighbours(effective_neighbours)), _) => {
                    Support::AutoPerSample { effective_neighbours }
                }
                (_, _, Some(Aim::LeastError)) => Support::LeastError,
                (_, _, Some(Aim::EffectiveNeighbours(effective_neighbours))) => {
                    Support::Auto { effective_neighbours }
                }
                (None, None, None) => Support::FromSamples,
            });
        }
        if self.factor_column.is_some() {
            recipe.factor_column.clone_from(&self.factor_column);
        }
        if !self.drop.is_empty() {
            recipe.drop.clone_from(&self.drop);
        }
        recipe.within = self.within.or(recipe.within);
        if let Some(noise) = &self.noise {
            recipe.noise = Some(NoiseSource::of(noise));
        }
        if let Some(weight) = self.weight {
            definition = definition.with_weight(match weight {
                WeightName::Poly2 => Weight::Poly2,
                WeightName::Poly3 => Weight::Poly3,
                WeightName::Poly4 => Weight::Poly4,
                WeightName::Wendland => Weight::Wendland,
                WeightName::Gaussian => Weight::GAUSSIAN,
            });
        }
        match (self.cut, definition.weight()) {
            (None, _) => {}
            (Some(cut), Weight::Gaussian { .. }) => {
                definition = definition.with_weight(Weight::Gaussian { cut });
            }
            (Some(_), _) => return Err("--cut belongs to --weight gaussian".to_owned()),
        }
        match (self.surface, definition.kind()) {
            (Some(SurfaceName::Levin), _) => definition = definition.with_kind(Kind::Levin),
            (Some(SurfaceName::Pss), Kind::Levin) => definition = definition.with_kind(Kind::default()),
            _ => {}
        }
        if self.field.is_some() && definition.kind() == Kind::Levin {
            return Err("--field belongs to --surface pss: Levin's frames have covariance about x".to_owned());
        }
        if let Some(field) = self.field {
            definition = definition.with_field(match field {
                FieldName::Centred => NormalField::CentredCovariance,
                FieldName::Covariance => NormalField::Covariance,
                FieldName::Averaged => NormalField::AveragedNormals,
                FieldName::Axes => NormalField::AveragedAxes,
            });
        }
        match self.degree {
            None => {}
            Some(_) if definition.kind() == Kind::Levin => {
                return Err(
                    "--degree belongs to --surface pss; that of Levin's second step is --levin-degree"
                        .to_owned(),
                );
            }
            Some(DegreeName::Fixed(degree)) => definition = definition.with_degree(degree),
            Some(DegreeName::Auto) => recipe.choose_degree = Some(DegreeAim::Position),
        }
        if self.degree_fallback {
            definition = definition.with_degree_fallback(true);
        }
        if let Some(precision) = self.precision {
            definition = definition.with_precision(match precision {
                PrecisionName::Double => Precision::Double,
                PrecisionName::Single => Precision::Single,
            });
        }
        if let Some(ratio) = self.domain_ratio {
            definition = definition.with_domain_ratio(ratio);
        }
        let mut acceptance = definition.acceptance();
        acceptance.alignment = self.accept_alignment.unwrap_or(acceptance.alignment);
        acceptance.gap = self.accept_gap.unwrap_or(acceptance.gap);
        acceptance.boundary = self.accept_boundary.or(acceptance.boundary);
        recipe.definition = definition.with_acceptance(acceptance);
        Ok(recipe)
    }
}

/// `auto` or a number, which the library judges.
fn degree(text: &str) -> Result<DegreeName, String> {
    match text {
        "auto" => Ok(DegreeName::Auto),
        _ => text.parse().map(DegreeName::Fixed).map_err(|_| "it must be 0, 1, 2, 3 or `auto`".to_owned()),
    }
}

/// Two corners of a box.
fn corners(text: &str) -> Result<[[f64; 3]; 2], String> {
    if text == "finite" {
        return Ok([[f64::MIN; 3], [f64::MAX; 3]]);
    }
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok(&[a, b, c, d, e, f]) if a <= d && b <= e && c <= f => Ok([[a, b, c], [d, e, f]]),
        _ => Err("it must be six numbers, the lowest x, y, z, then the highest, or `finite`".to_owned()),
    }
}

/// `best` or a number, which the library judges.
fn aim(text: &str) -> Result<Aim, String> {
    match text {
        "best" => Ok(Aim::LeastError),
        _ => text
            .parse()
            .map(Aim::EffectiveNeighbours)
            .map_err(|_| "it must be a number of effective neighbours, or `best`".to_owned()),
    }
}
