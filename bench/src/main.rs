//! Measures footpoint against its targets, its rivals and its own size. Prints a record as JSON.

// A program that prints its result, and on the error stream how far it has come.
#![allow(clippy::print_stdout)]

mod answers;
mod baseline;
mod case;
mod clock;
mod cloud;
mod contest;
mod machine;
mod notes;
mod peers;
mod rays;
mod scaling;
mod speed;
mod study;
mod table;
mod target;

use case::Cases;
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Parser)]
#[command(about)]
struct Arguments {
    #[command(subcommand)]
    part: Part,
    /// Repeats of everything, in place of what the cases say: for a quick look.
    #[arg(long, global = true)]
    repeats: Option<usize>,
}

#[derive(Subcommand)]
enum Part {
    /// The cases against the targets and the scalar rival.
    Speed {
        /// Only these groups of cases.
        groups: Vec<String>,
    },
    /// Cost against size.
    Scaling,
    /// Hits a second.
    Rays,
    /// Other programs on the same points.
    Peers {
        /// Only these groups of jobs.
        groups: Vec<String>,
        /// A peer as NAME=COMMAND; those without one are left out.
        #[arg(long = "peer")]
        peers: Vec<String>,
        /// Where points and answers are exchanged.
        #[arg(long)]
        folder: PathBuf,
    },
    /// Accuracy where the truth is known.
    Study {
        /// The page that gets the tables.
        #[arg(long)]
        page: PathBuf,
        /// The file that gets all numbers.
        #[arg(long)]
        record: PathBuf,
    },
    /// Prints a record as a table for the README.
    Table {
        /// A record of speed or of peers.
        record: PathBuf,
    },
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let cases = Cases::read().map_err(|e| format!("cases.json: {e}"))?;
    let (part, mut record) = match &arguments.part {
        Part::Speed { groups } => ("speed", speed::speed(&cases, groups, arguments.repeats)?),
        Part::Scaling => ("scaling", scaling::scaling()),
        Part::Rays => ("rays", rays::rays(&cases, arguments.repeats)?),
        Part::Peers { groups, peers, folder } => {
            ("peers", peers::peers(&cases, groups, peers, folder, arguments.repeats)?)
        }
        Part::Study { page, record } => return write_study(page, record),
        Part::Table { record } => {
            let text = std::fs::read_to_string(record).map_err(|e| format!("{}: {e}", record.display()))?;
            let record = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", record.display()))?;
            print!("{}", table::table(&record));
            return Ok(ExitCode::SUCCESS);
        }
    };
    notes::add(&mut record, part);
    println!("{record:#}");
    let failed = record["failures"].as_array().is_none_or(|failures| !failures.is_empty());
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// The study's tables into their page, its numbers into their record.
fn write_study(page: &Path, record: &Path) -> Result<ExitCode, String> {
    let problem = |path: &Path, e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = std::fs::read_to_string(page).map_err(|e| problem(page, &e))?;
    let found = study::study(study::Plan::FULL).map_err(|e| e.to_string())?;
    let text = study::written(&text, &found).ok_or_else(|| problem(page, &"no marks for the tables"))?;
    std::fs::write(page, text).map_err(|e| problem(page, &e))?;
    std::fs::write(record, study::compact(&found)).map_err(|e| problem(record, &e))?;
    let failed = found["failures"].as_array().is_none_or(|failures| !failures.is_empty());
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}
