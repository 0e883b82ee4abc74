//! Job: the figures of the paper, drawn anew.

use crate::clock::timed;
use crate::report::Report;
use crate::{Context, JobError};
use footpoint_io::{check_file_writable, write_file};
use footpoint_render::figure::{self, FigureError};
use std::path::PathBuf;

/// Which figures to draw and where to put them.
#[derive(Clone, Debug, PartialEq)]
pub struct FigurePlan {
    /// Which of them.
    pub which: Which,
    /// Folder for `figure-1.svg`, …; made if it does not exist.
    pub folder: PathBuf,
    /// A cloud for figure 3 in place of the built-in one; no other figure takes one.
    pub input: Option<PathBuf>,
}

/// Figures by their number in the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// This one.
    One(u8),
    /// Every one.
    All,
}

/// Draws figures of the paper from what the library computes on built-in samples, and writes `figure-N.svg`.
///
/// All are drawn before the first is written. The recipe's surface is for figure 3 alone.
pub fn figure(plan: &FigurePlan, context: &Context<'_>) -> Result<Report, JobError> {
    let numbers = match plan.which {
        Which::All => figure::NUMBERS.to_vec(),
        Which::One(number) => vec![number],
    };
    // The ray-traced figure belongs here: a file of its own beside the others, drawn from `plan.input`.
    if numbers.contains(&3) {
        return Err(JobError::NoTriptych);
    }
    if let (Some(_), Some(&number)) = (&plan.input, numbers.first()) {
        return Err(JobError::NoInput(number));
    }
    let mut report = Report::new("figure", context.recipe.clone());
    let made = std::fs::create_dir_all(&plan.folder);
    made.map_err(|problem| JobError::Folder { path: plan.folder.clone(), problem })?;
    let files: Vec<PathBuf> =
        numbers.iter().map(|number| plan.folder.join(format!("figure-{number}.svg"))).collect();
    for file in &files {
        check_file_writable(file, context.overwrite)?;
    }
    let drawn = timed(&mut report.times.compute, || {
        let draw =
            |&number: &u8| figure::figure(number, &context.run).map_err(|problem| failed(number, problem));
        numbers.iter().map(draw).collect::<Result<Vec<String>, JobError>>()
    })?;
    timed(&mut report.times.write, || -> Result<(), JobError> {
        for (file, content) in files.iter().zip(&drawn) {
            write_file(file, content.as_bytes(), context.overwrite)?;
            report.outputs.push(file.display().to_string());
        }
        Ok(())
    })?;
    Ok(report)
}

fn failed(number: u8, problem: FigureError) -> JobError {
    match problem {
        FigureError::Cancelled(_) => JobError::Cancelled,
        problem => JobError::Figure { number, problem },
    }
}
