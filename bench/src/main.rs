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
mod scaling;
mod speed;
mod table;
mod target;

use case::Cases;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
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
        Part::Peers { groups, peers, folder } => {
            ("peers", peers::peers(&cases, groups, peers, folder, arguments.repeats)?)
        }
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
