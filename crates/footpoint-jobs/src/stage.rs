//! The stages of a job, for whoever shows how far it has come.

use crate::{Context, JobError};
use footpoint::{Progress, Run};
use footpoint_io::{
    Bounds, Input, ReadOptions, ReadProblem, Table, Watch, WriteOptions, read_with, write_with,
};
use std::ops::ControlFlow;
use std::path::Path;

/// What a job does, and what its progress counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage<'p> {
    /// Reads this file: bytes, or points where the format is packed.
    Read(&'p Path),
    /// Chooses supports and indexes the samples; no progress.
    Index,
    /// Computes: points.
    Compute,
    /// Draws: rays.
    Draw,
    /// Writes this file; no progress.
    Write(&'p Path),
}

impl Context<'_> {
    /// Says that a stage begins.
    pub(crate) fn begin(&self, stage: Stage<'_>) {
        if let Some(stages) = self.stage {
            stages(stage);
        }
    }

    /// Reads a file: the part that the recipe wants of it, with progress and cancelling.
    pub fn read(&self, path: &Path) -> Result<Input, JobError> {
        self.begin(Stage::Read(path));
        let watch = Watching(&self.run);
        let within = self.recipe.within.map(|[low, high]| Bounds { low, high });
        read_with(path, &ReadOptions { watch: Some(&watch), within }).map_err(|error| match *error.problem {
            ReadProblem::Stopped => JobError::Cancelled,
            _ => JobError::Read(error),
        })
    }

    /// Writes a file, in the format of its extension.
    pub fn write(&self, path: &Path, table: &Table) -> Result<(), JobError> {
        self.begin(Stage::Write(path));
        let options = WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() };
        let written = write_with(path, table, &options, Some(&Stopping(&self.run)));
        // A file that is complete is kept: the work is done.
        written.map_err(|error| if self.run.is_cancelled() { JobError::Cancelled } else { error.into() })
    }
}

/// A run as the writer of a file sees it: how much there will be is not known.
struct Stopping<'r>(&'r Run<'r>);

impl Watch for Stopping<'_> {
    fn at(&self, _: u64, _: u64) -> ControlFlow<()> {
        if self.0.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// A run as the reader of a file sees it.
struct Watching<'r>(&'r Run<'r>);

impl Watch for Watching<'_> {
    fn at(&self, done: u64, all: u64) -> ControlFlow<()> {
        let count = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        self.0.announce(Progress { done: count(done), total: count(all) });
        if self.0.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
