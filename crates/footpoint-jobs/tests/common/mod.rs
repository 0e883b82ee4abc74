//! What several tests need: contexts, folders, columns of what was written.

#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

use footpoint_io::Table;
use footpoint_jobs::scan::ScanPlan;
use footpoint_jobs::{Context, DemoPlan, DemoReport, Recipe, Report, Support, demo};
use std::path::Path;

/// A recipe with this support, everything else as recommended.
pub(crate) fn with_support(support: Support) -> Recipe {
    let mut recipe = Recipe::default();
    recipe.definition = recipe.definition.with_support(support);
    recipe
}

/// Runs the demo into `folder`.
pub(crate) fn run_demo(folder: &Path, scan: ScanPlan, support: Support) -> Report {
    let plan = DemoPlan { folder: folder.to_owned(), scan, picture_width: 64 };
    demo(&plan, &Context { recipe: with_support(support), ..Context::default() }).unwrap()
}

pub(crate) fn found(report: &Report) -> DemoReport {
    report.demo.unwrap()
}

pub(crate) fn table(folder: &Path, name: &str) -> Table {
    footpoint_io::read(&folder.join(name)).unwrap().table
}

pub(crate) fn numbers(table: &Table, name: &str) -> Vec<f64> {
    table.column(name).unwrap().data.to_f64().unwrap()
}

pub(crate) fn names(table: &Table) -> String {
    table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(" ")
}
