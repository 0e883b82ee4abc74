//! A dry run: a job ends where its work would begin, after all that it reads and checks.

use crate::load::Loaded;
use crate::report::Report;
use crate::{Context, JobError};
use footpoint_io::check_file;
use std::path::{Path, PathBuf};

/// What a job is to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Its work.
    #[default]
    Work,
    /// To read, to check and to tell what it would do, with the errors of the work itself. What is wrong with a
    /// surface shows only when it is made.
    DryRun,
}

impl Context<'_> {
    /// Whether nothing is to be computed or written.
    pub(crate) fn is_dry(&self) -> bool {
        self.mode == Mode::DryRun
    }

    /// Whether the job ends here, with its plan in the report; fails where the surface's file lacks a column.
    pub(crate) fn ends_before<P: AsRef<Path>>(
        &self,
        surface: &Loaded,
        outputs: &[P],
        report: &mut Report,
    ) -> Result<bool, JobError> {
        if self.is_dry() {
            surface.check_columns(&self.recipe)?;
            self.plan(outputs, report);
        }
        Ok(self.is_dry())
    }

    /// Says in the report that these files would be written.
    pub(crate) fn plan<P: AsRef<Path>>(&self, outputs: &[P], report: &mut Report) {
        report.dry_run = true;
        report.outputs.extend(outputs.iter().map(|path| path.as_ref().display().to_string()));
    }

    /// Makes a folder, unless nothing is to be written, and checks the files that it will take.
    pub(crate) fn prepare_folder(&self, folder: &Path, files: &[PathBuf]) -> Result<(), JobError> {
        if self.is_dry() && !folder.exists() {
            return Ok(());
        }
        let made = std::fs::create_dir_all(folder);
        made.map_err(|problem| JobError::Folder { path: folder.to_owned(), problem })?;
        for file in files {
            check_file(file, self.overwrite)?;
        }
        Ok(())
    }
}
