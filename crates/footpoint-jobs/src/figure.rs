//! Job: the figures of the paper, drawn anew.

use crate::clock::timed;
use crate::report::Report;
use crate::triptych::{read_space, triptych};
use crate::{Context, JobError};
use footpoint_io::write_file;
use footpoint_render::figure::{self, FigureError};
use std::io::Write;
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
    /// Pixels in a row of figure 3.
    pub width: usize,
}

/// Figures by their number in the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// This one.
    One(u8),
    /// Every one.
    All,
}

/// The figure that is ray-traced.
const IN_SPACE: u8 = 3;

impl FigurePlan {
    /// The files that are written.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        self.numbers().into_iter().map(|number| self.place(number)).collect()
    }

    fn numbers(&self) -> Vec<u8> {
        match self.which {
            Which::All => [figure::NUMBERS.as_slice(), &[IN_SPACE]].concat(),
            Which::One(number) => vec![number],
        }
    }

    fn place(&self, number: u8) -> PathBuf {
        let kind = if number == IN_SPACE { "png" } else { "svg" };
        self.folder.join(format!("figure-{number}.{kind}"))
    }
}

/// Draws figures of the paper from what the library computes on built-in samples, and writes `figure-N.svg`, and
/// `figure-3.png` of the input or of a built-in scan.
///
/// All names are checked before the first is drawn. The recipe's surface is for figure 3 alone.
pub fn figure(plan: &FigurePlan, context: &Context<'_>) -> Result<Report, JobError> {
    let mut numbers = plan.numbers();
    let in_space = numbers.contains(&IN_SPACE);
    if let (Some(_), Some(&number), false) = (&plan.input, numbers.first(), in_space) {
        return Err(JobError::NoInput(number));
    }
    context.prepare_folder(&plan.folder, &plan.files())?;
    let place = |number: u8| plan.place(number);
    numbers.retain(|&number| number != IN_SPACE);
    let mut report = Report::new("figure", context.recipe.clone());
    if context.is_dry() {
        if let Some(path) = &plan.input {
            read_space(path, context, &mut report)?.check_columns(&context.recipe)?;
        }
        context.plan(&plan.files(), &mut report);
        return Ok(report);
    }
    let drawn = timed(&mut report.times.compute, || {
        let draw =
            |&number: &u8| figure::figure(number, &context.run).map_err(|problem| failed(number, problem));
        numbers.iter().map(draw).collect::<Result<Vec<String>, JobError>>()
    })?;
    if in_space {
        let compute = report.times.compute;
        report = triptych(plan.input.as_deref(), &place(IN_SPACE), plan.width, context)?;
        report.times.compute += compute;
    }
    timed(&mut report.times.write, || -> Result<(), JobError> {
        for (&number, content) in numbers.iter().zip(&drawn) {
            write_file(&place(number), context.overwrite, |file| file.write_all(content.as_bytes()))?;
            report.outputs.push(place(number).display().to_string());
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
