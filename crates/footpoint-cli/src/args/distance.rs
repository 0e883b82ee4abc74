//! Arguments of `distance`.

use super::common::Common;
use super::{QueryNoise, positive};
use clap::{Args, ValueEnum};
use footpoint_jobs::{Coloured, Compare, Recipe};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct DistanceArguments {
    /// Points whose distances are wanted, such as the later of two scans
    pub(crate) input: PathBuf,
    /// Cloud whose surface they are measured to, such as the earlier
    #[arg(long, value_name = "CLOUD")]
    pub(crate) to: PathBuf,
    /// File to write: every point with its foot point, distance, what of it is significant, and status, all columns kept
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Largest distance, in the unit of the file: points farther off are `outside` [default: none is too far]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = positive)]
    largest: Option<f64>,
    /// What is compared with the cloud's surface [default: surfaces]
    #[arg(long, value_enum)]
    compare: Option<CompareName>,
    /// Error of the files' registration, a standard deviation
    #[arg(long, value_name = "SIGMA", allow_negative_numbers = true)]
    registration: Option<f64>,
    /// Noise of the points, for sigma of --compare points with --noise: a number, a column, or `auto`
    ///
    /// One standard deviation in the unit of the file, a column of them (or covariances, in columns NAME_xx, NAME_xy …), or `auto`:
    /// estimated from the residuals of the points about their own surface.
    #[arg(long, value_name = "SIGMA|NAME|auto", allow_negative_numbers = true)]
    query_noise: Option<QueryNoise>,
    /// Last step and |f| allowed, in local supports [default: 1e-4, of points 1e-6]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = positive)]
    tolerance: Option<f64>,
    /// Add columns red green blue: blue to red for distances with a sign, dark to bright for those without, up to LENGTH
    /// [default: without the 1 % furthest out]
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, require_equals = true, value_parser = positive)]
    colours: Option<Option<f64>>,
    #[command(flatten)]
    pub(super) common: Common,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CompareName {
    /// The surface of the points: sigma from the scatter of the samples, at 8, 16 and 32 effective neighbours or the support given
    Surfaces,
    /// The points themselves, however few they are: sigma from --noise and --query-noise
    Points,
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
        // A support of the user's own is the only one.
        let supports = if self.common.chooses_support() { Some(Vec::new()) } else { None };
        recipe.compare = match (self.compare, recipe.compare.take()) {
            (Some(CompareName::Points), _) | (None, Some(Compare::Points)) => Some(Compare::Points),
            (_, Some(Compare::Surfaces { effective_neighbours })) => {
                Some(Compare::Surfaces { effective_neighbours: supports.unwrap_or(effective_neighbours) })
            }
            // So is the one of a report that was not of surfaces.
            _ => Some(match supports.or(self.common.definition.as_ref().map(|_| Vec::new())) {
                Some(effective_neighbours) => Compare::Surfaces { effective_neighbours },
                None => Compare::default(),
            }),
        };
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
