//! Job: each sample with its normal, and signs that agree.

use crate::clock::timed;
use crate::load::Loaded;
use crate::output::{Naming, merge, oriented_normal, put_table, set_vectors};
use crate::report::Report;
use crate::{Context, JobError};
use footpoint::{Component, NonOrientable, NormalSource, Orient, OrientError, Orientation, Verdict};
use footpoint_io::{Table, check_writable};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What decides the signs; see [`Orient`].
#[derive(Clone, Debug, PartialEq)]
pub enum OrientBy {
    /// This viewpoint, a coordinate an axis.
    Towards(Vec<f64>),
    /// This axis.
    Along(Vec<f64>),
    /// The sensor positions in these columns of the input.
    SensorColumns(Vec<String>),
    /// A file of positions, with a column of times that the input has too.
    Trajectory {
        /// The file.
        path: PathBuf,
        /// The column of times in both files.
        time_column: String,
    },
    /// The neighbours.
    Propagated(NonOrientable),
}

/// What to orient, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct OrientPlan {
    /// Which normals.
    pub normals: NormalSource,
    /// What decides their signs.
    pub by: OrientBy,
}

/// How the signs came about.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OrientationReport {
    /// Which normals were oriented.
    pub normals: NormalSource,
    /// Normals that have a sign now.
    pub oriented: usize,
    /// How many of them were reversed.
    pub reversed: usize,
    /// Signs that hang on little: doubtful edges, or normals across the direction that decides.
    pub doubtful: usize,
    /// Connected components; 0 unless propagated.
    pub components: usize,
    /// Components in which signs cannot agree.
    pub non_orientable: usize,
    /// The largest components.
    pub largest: Vec<Component>,
}

/// Components that a report lists.
const LISTED: usize = 10;

/// Writes every sample of `input`, in its order and with all its columns, with its oriented normal and status.
///
/// The normals are called `nx ny nz` in every format, so that they serve as the given normals of what follows; columns of
/// these names become `given_nx`, …. A normal without a sign is NaN.
pub fn orient(
    input: &Path,
    output: &Path,
    plan: &OrientPlan,
    context: &Context<'_>,
) -> Result<Report, JobError> {
    check_writable(output, context.overwrite)?;
    let mut report = Report::new("orient", context.recipe.clone());
    let loaded = Loaded::read_for(output, input, context, &mut report)?;
    match loaded.roles.dimension() {
        2 => run::<2>(loaded, output, plan, context, report),
        _ => run::<3>(loaded, output, plan, context, report),
    }
}

fn run<const D: usize>(
    loaded: Loaded,
    output: &Path,
    plan: &OrientPlan,
    context: &Context<'_>,
    mut report: Report,
) -> Result<Report, JobError> {
    let columns = Columns::<D>::of(&loaded, &plan.by, context, &mut report)?;
    let how = match &plan.by {
        OrientBy::Towards(point) => Orient::Towards(vector("the viewpoint", point)?),
        OrientBy::Along(axis) => Orient::Along(vector("the axis", axis)?),
        OrientBy::SensorColumns(_) => Orient::Sensors(&columns.sensors),
        OrientBy::Trajectory { .. } => Orient::Trajectory { times: &columns.times, path: &columns.path },
        OrientBy::Propagated(non_orientable) => Orient::Propagated(*non_orientable),
    };
    if context.ends_before(&loaded, &[output], &mut report)? {
        return Ok(report);
    }
    let surface = loaded.surface::<D>(context, &mut report)?;
    let result = timed(&mut report.times.compute, || surface.with(&context.run).orient(plan.normals, &how));
    let found = result.map_err(|problem| match problem {
        OrientError::Cancelled(_) => JobError::Cancelled,
        problem => loaded.orient_error(problem),
    })?;
    report.count(&found.status);
    report.orientation = Some(summary(&found, plan.normals));

    let mut computed = Table::default();
    set_vectors(&mut computed, oriented_normal, &found.normal);
    computed.set(Naming::of(output).status(&found.status));
    let mut table = loaded.input.table;
    merge(&mut table, &loaded.roles, computed);
    put_table(output, &table, context, &mut report)?;
    Ok(report)
}

/// What the rule takes from files.
#[derive(Default)]
struct Columns<const D: usize> {
    sensors: Vec<[f64; D]>,
    times: Vec<f64>,
    path: Vec<(f64, [f64; D])>,
}

impl<const D: usize> Columns<D> {
    fn of(
        loaded: &Loaded,
        by: &OrientBy,
        context: &Context<'_>,
        report: &mut Report,
    ) -> Result<Self, JobError> {
        let mut columns = Self::default();
        match by {
            OrientBy::SensorColumns(names) => {
                let names: [&String; D] = vector("the sensor's columns", &names.iter().collect::<Vec<_>>())?;
                columns.sensors = vec![[0.0; D]; loaded.input.table.rows()];
                for (axis, name) in names.into_iter().enumerate() {
                    let values = loaded.column(name)?;
                    columns.sensors.iter_mut().zip(values).for_each(|(sensor, value)| sensor[axis] = value);
                }
            }
            OrientBy::Trajectory { path, time_column } => {
                columns.times = loaded.column(time_column)?;
                let positions = Loaded::read(path, context, report)?;
                report.inputs.push(positions.report());
                loaded.check_dimension(&positions)?;
                columns.path = positions.column(time_column)?.into_iter().zip(positions.points()).collect();
            }
            _ => {}
        }
        Ok(columns)
    }
}

/// As many values as the points have coordinates.
fn vector<T: Copy, const D: usize>(what: &'static str, values: &[T]) -> Result<[T; D], JobError> {
    <[T; D]>::try_from(values).map_err(|_| JobError::Vector { what, expected: D, found: values.len() })
}

fn summary<const D: usize>(found: &Orientation<D>, normals: NormalSource) -> OrientationReport {
    let non_orientable = |component: &&Component| component.verdict == Verdict::NonOrientable;
    OrientationReport {
        normals,
        oriented: found.oriented,
        reversed: found.reversed,
        doubtful: found.doubtful,
        components: found.components.len(),
        non_orientable: found.components.iter().filter(non_orientable).count(),
        largest: found.components.iter().take(LISTED).copied().collect(),
    }
}
