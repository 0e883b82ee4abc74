//! Arguments of `distance`.

use super::common::Common;
use super::{QueryNoise, positive};
use clap::Args;
use footpoint_jobs::{Coloured, Recipe};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct DistanceArguments {
    /// Points whose distances are wanted
    pub(crate) input: PathBuf,
    /// Cloud whose surface they are measured to
    #[arg(long, value_name = "CLOUD")]
    pub(crate) to: PathBuf,
    /// File to write: every point with its foot point, distance, normal there and status, all columns kept
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Largest distance, in the unit of the file: points farther off are `outside` [default: none is too far]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = positive)]
    largest: Option<f64>,
    /// Error of the registration of the two files, one standard deviation in the unit of the file: part of sigma; with --noise
    #[arg(long, value_name = "SIGMA", allow_negative_numbers = true)]
    registration: Option<f64>,
    /// Noise of the points, for sigma: one standard deviation in the unit of the file, or a column of them (or covariances, in
    /// columns NAME_xx, NAME_xy …); with --noise
    #[arg(long, value_name = "SIGMA|NAME", allow_negative_numbers = true)]
    query_noise: Option<QueryNoise>,
    /// Last step and |f| allowed, in local supports [default: 1e-6]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = positive)]
    tolerance: Option<f64>,
    /// Add columns red green blue: blue to red for distances with a sign, dark to bright for those without, up to LENGTH
    /// [default: without the 1 % furthest out]
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, require_equals = true, value_parser = positive)]
    colours: Option<Option<f64>>,
    #[command(flatten)]
    pub(super) common: Common,
}

impl DistanceArguments {
    pub(crate) fn coloured(&self) -> Coloured {
        match self.colours {
            None => Coloured::No,
            Some(None) => Coloured::Yes,
            Some(Some(limit)) => Coloured::UpTo(limit),
        }
    }

    pub(super) fn adjust(&self, recipe: &mut Recipe) {
        if let Some(noise) = &self.query_noise {
            noise.adjust(recipe);
        }
        recipe.registration = self.registration.or(recipe.registration);
        recipe.largest_distance = self.largest.or(recipe.largest_distance);
        if let Some(tolerance) = self.tolerance {
            let how = recipe.project.get_or_insert_default();
            *how = how.with_tolerance(tolerance);
        }
    }
}
