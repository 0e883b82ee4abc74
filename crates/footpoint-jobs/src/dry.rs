//! A dry run: what a job would read, compute and write, without computing or writing.

use crate::load::Loaded;
use crate::report::Report;
use crate::{Context, JobError};
use footpoint_io::{check_file, check_writable};
use std::path::{Path, PathBuf};

/// The files of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    /// Point files to read, in the order of the job.
    pub reads: Vec<PathBuf>,
    /// Point files to write.
    pub clouds: Vec<PathBuf>,
    /// Pictures to write.
    pub pictures: Vec<PathBuf>,
    /// Whether the job makes the folder that it writes to.
    pub makes_folder: bool,
}

/// Reads what the job would read and checks that it could write what it would, and reports both with the recipe.
///
/// Fails as the job would on files and columns; problems of the surface show only when it is made.
pub fn dry_run(job: &'static str, files: &Files, context: &Context<'_>) -> Result<Report, JobError> {
    let mut report = Report::new(job, context.recipe.clone());
    report.dry_run = true;
    let later = |path: &Path| files.makes_folder && !path.parent().is_some_and(Path::is_dir);
    for path in files.clouds.iter().filter(|path| !later(path)) {
        check_writable(path, context.overwrite)?;
    }
    for path in files.pictures.iter().filter(|path| !later(path)) {
        check_file(path, context.overwrite)?;
    }
    report.outputs.extend(files.clouds.iter().chain(&files.pictures).map(|path| path.display().to_string()));
    for (i, path) in files.reads.iter().enumerate() {
        let loaded = Loaded::read(path, context, &mut report)?;
        report.inputs.push(loaded.report());
        // The surface's columns are asked for in the file that defines it.
        if i == 0 {
            loaded.check_columns(&context.recipe)?;
        }
    }
    Ok(report)
}
