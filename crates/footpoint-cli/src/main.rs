//! The `footpoint` command: arguments to job to report.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod args;
mod meta;
mod print;
mod progress;

use args::{Arguments, Command, Verb};
use clap::Parser;
use footpoint_jobs as jobs;
use footpoint_jobs::{Context, JobError, Report, Run, Stage};
use std::io::{self, Write};
use std::panic;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// Nothing done: wrong usage or input.
const NOTHING_DONE: u8 = 2;
/// More points without an answer than `--strict` allows.
const NOT_STRICT: u8 = 1;
/// Interrupted, as shells have it.
const INTERRUPTED: u8 = 130;

fn main() -> ExitCode {
    silence_unpacking();
    match Arguments::parse().command {
        Command::Work(verb) => run(&verb),
        Command::About(about) => match print_out(&meta::text(&about)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(problem) => fail(&problem, NOTHING_DONE),
        },
    }
}

/// Damaged LAZ makes its decoder panic, which the reader turns into an error: nobody is to read of it twice.
fn silence_unpacking() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if thread::current().name() != Some(jobs::UNPACKING) {
            usual(info);
        }
    }));
}

/// Runs a verb, and reports.
fn run(verb: &Verb) -> ExitCode {
    let common = verb.common();
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancelled);
    // Without the handler an interrupt ends the program at once, which is no worse than before.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));

    let progress = progress::Bar::new(common.verbosity());
    let report = |p| progress.show(p);
    let stage = |stage: Stage<'_>| progress.begin(stage);
    let run = Run::new().threads(common.threads).cancel(&cancelled).progress(&report);
    let result = verb.recipe().and_then(|recipe| {
        let context =
            Context { recipe, overwrite: common.overwrite(), mode: common.mode(), run, stage: Some(&stage) };
        work(verb, &context)
    });
    progress.finish();
    match result.and_then(|report| finish(verb, &report)) {
        Ok(code) => code,
        Err(problem) if cancelled.load(Ordering::Relaxed) => fail(&problem, INTERRUPTED),
        Err(problem) => fail(&problem, NOTHING_DONE),
    }
}

fn fail(problem: &str, code: u8) -> ExitCode {
    // Nothing can be said where even the error stream is closed.
    let _ = writeln!(io::stderr(), "footpoint: {problem}");
    ExitCode::from(code)
}

/// Runs the job of a verb.
fn work(verb: &Verb, context: &Context<'_>) -> Result<Report, String> {
    let done = match verb {
        Verb::Demo(a) => jobs::demo(&a.plan(), context),
        Verb::Info(a) => jobs::info(&a.input, context),
        Verb::Evaluate(a) => jobs::evaluate(&a.cloud, &a.at, &a.output, &a.extra(), context),
        Verb::Normals(a) => jobs::normals(&a.input, &a.output, (a.choice(), a.bending()), context),
        Verb::Orient(a) => jobs::orient(&a.input, &a.output, &a.plan(), context),
        Verb::Project(a) => jobs::project(&a.input, a.onto.as_deref(), &a.output, context),
        Verb::Distance(a) => jobs::distance(&a.input, &a.to, &a.output, a.coloured(), context),
        Verb::Figure(a) => jobs::figure(&a.plan(), context),
        Verb::Render(a) => jobs::render(&a.input, a.output.as_deref(), &a.plan()?, context),
    };
    done.map_err(|error| explain(&error))
}

/// The error, with the option that helps.
fn explain(error: &JobError) -> String {
    if error.is_existing_output() {
        return format!("{error} (--force overwrites it)");
    }
    if error.is_no_coordinate() {
        return format!("{error} (--within finite does)");
    }
    error.to_string()
}

/// Prints what is to be printed and judges the statuses.
fn finish(verb: &Verb, report: &Report) -> Result<ExitCode, String> {
    let common = verb.common();
    let words = |verbosity| print::report(report, verbosity);
    let (results, mut messages) = if common.json {
        let json = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
        (json + "\n", words(common.verbosity()))
    } else if report.dry_run || matches!(verb, Verb::Demo(_) | Verb::Info(_)) {
        // What these find is their result, which even -q wants.
        (words(common.verbosity().or_normal()), String::new())
    } else {
        (String::new(), words(common.verbosity()))
    };
    let allowed = common.strict.unwrap_or(f64::INFINITY) * report.points as f64;
    let mut strict = report.not_ok() as f64 > allowed;
    if strict {
        messages += &format!("strict: {} of {} points not ok\n", report.not_ok(), report.points);
    }
    for input in report.inputs.iter().filter(|input| input.missing_points > 0 && common.strict.is_some()) {
        strict = true;
        messages +=
            &format!("strict: {}: {} missing\n", input.path, print::count(input.missing_points, "point"));
    }
    print_out(&results)?;
    // The result stands in the file even if nobody reads the messages.
    let _ = io::stderr().write_all(messages.as_bytes());
    Ok(if strict { ExitCode::from(NOT_STRICT) } else { ExitCode::SUCCESS })
}

/// Prints a result.
fn print_out(text: &str) -> Result<(), String> {
    match io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()) {
        // A reader that has seen enough is no error.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.to_string()),
        _ => Ok(()),
    }
}
