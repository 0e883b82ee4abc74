//! Job: each sample with its normal.

use crate::clock::timed;
use crate::evaluate::set_curvatures;
use crate::load::Loaded;
use crate::output::{Naming, merge, put_table, set_vectors};
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::{Queries, Want};
use footpoint_io::{Table, check_writable};
use std::path::Path;

/// Which normal to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalChoice {
    /// ∇f/|∇f|: the exact normal of the level set of f through the sample.
    #[default]
    Surface,
    /// n: the normal of the frame.
    Frame,
    /// Both.
    Both,
}

/// Whether curvatures are written beside the normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bending {
    /// Normals alone.
    #[default]
    Omit,
    /// Mean, Gaussian and principal curvatures with their directions; in 2-D the curvature.
    Write,
}

/// Writes every sample of `input`, in its order and with all its columns, with its normal and status.
///
/// A normal that does not exist is NaN. Columns of the input whose names the results take become `given_nx`, ….
pub fn normals(
    input: &Path,
    output: &Path,
    choice: (NormalChoice, Bending),
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_writable(output, context.overwrite)?;
    let mut report = Report::new("normals", context.recipe.clone());
    let loaded = Loaded::read_for(output, input, context, &mut report)?;
    match loaded.roles.dimension() {
        2 => run::<2>(loaded, output, choice, context, report),
        _ => run::<3>(loaded, output, choice, context, report),
    }
}

fn run<const D: usize>(
    loaded: Loaded,
    output: &Path,
    choice: (NormalChoice, Bending),
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    if context.ends_before(&loaded, &[output], &mut report)? {
        return Ok(report);
    }
    let surface = loaded.surface::<D>(context, &mut report)?;
    let (choice, bending) = choice;
    let mut want = match choice {
        NormalChoice::Surface => Want::SURFACE_NORMAL,
        NormalChoice::Frame => Want::FRAME_NORMAL,
        NormalChoice::Both => Want::SURFACE_NORMAL | Want::FRAME_NORMAL,
    };
    if bending == Bending::Write {
        want = want | Want::CURVATURE;
    }
    let result =
        timed(&mut report.times.compute, || surface.with(&context.run).evaluate(Queries::Samples, want))?;
    report.count(&result.status);

    let naming = Naming::of(output);
    let mut computed = Table::default();
    if want.contains(Want::SURFACE_NORMAL) {
        set_vectors(&mut computed, |axis| naming.surface_normal(axis), &result.surface_normal);
    }
    if want.contains(Want::FRAME_NORMAL) {
        set_vectors(&mut computed, |axis| naming.frame_normal(axis), &result.frame_normal);
    }
    if bending == Bending::Write {
        set_curvatures(&mut computed, &result.curvature);
    }
    computed.set(naming.status(&result.status));
    let mut table = loaded.input.table;
    merge(&mut table, &loaded.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}
