//! Arguments of `project`.

use super::common::Common;
use super::{QueryNoise, positive};
use clap::{Args, ValueEnum};
use footpoint_jobs::{Operator, Recipe};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct ProjectArguments {
    /// Points to project
    pub(crate) input: PathBuf,
    /// Cloud that defines the surface [default: the points themselves]
    #[arg(long, value_name = "CLOUD")]
    pub(crate) onto: Option<PathBuf>,
    /// File to write: every point on the surface, all columns kept
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Which point of the surface [default: orthogonal]
    #[arg(long, value_enum)]
    operator: Option<OperatorName>,
    /// Degree of the polynomial of Levin's second step, 0 to 4 [default: step one alone]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u8).range(0..=4))]
    levin_degree: Option<u8>,
    /// Last step and |f| allowed, in local supports [default: 1e-6]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = positive)]
    tolerance: Option<f64>,
    /// Noise of foreign points: one standard deviation in the unit of the file, a column of them (or covariances, in columns
    /// NAME_xx, NAME_xy …), or `auto`: from their own residuals; with --noise
    #[arg(
        long,
        value_name = "SIGMA|NAME|auto",
        requires = "noise",
        requires = "onto",
        allow_negative_numbers = true
    )]
    query_noise: Option<QueryNoise>,
    #[command(flatten)]
    pub(super) common: Common,
}

impl ProjectArguments {
    pub(super) fn adjust(&self, recipe: &mut Recipe) -> Result<(), String> {
        let how = recipe.project.get_or_insert_default();
        if let Some(operator) = self.operator {
            *how = how.with_operator(match operator {
                OperatorName::Basic => Operator::Basic,
                OperatorName::Almost => Operator::AlmostOrthogonal,
                OperatorName::Orthogonal => Operator::Orthogonal,
                OperatorName::Levin => Operator::Levin { degree: None },
            });
        }
        match (self.levin_degree, how.operator()) {
            (None, _) => {}
            (degree, Operator::Levin { .. }) => *how = how.with_operator(Operator::Levin { degree }),
            (Some(_), _) => return Err("--levin-degree belongs to --operator levin".to_owned()),
        }
        if let Some(tolerance) = self.tolerance {
            *how = how.with_tolerance(tolerance);
        }
        if let Some(noise) = &self.query_noise {
            noise.adjust(recipe);
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OperatorName {
    /// To the weighted average first, then along the frame normal; not idempotent
    Basic,
    /// Along the frame normal at the result
    Almost,
    /// Along the surface normal at the result: the foot point
    Orthogonal,
    /// Levin's own, to compare with: the plane that fits best, then --levin-degree over it; slow
    Levin,
}
