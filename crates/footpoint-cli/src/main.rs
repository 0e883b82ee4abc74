//! The `footpoint` command: arguments to job to report.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod args;
mod print;
mod progress;

use args::{Arguments, Verb};
use clap::Parser;
use footpoint_jobs as jobs;
use footpoint_jobs::{Context, JobError, Report, Run};
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Nothing done: wrong usage or input.
const NOTHING_DONE: u8 = 2;
/// More points without an answer than `--strict` allows.
const NOT_STRICT: u8 = 1;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let common = arguments.verb.common();
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancelled);
    // Without the handler an interrupt ends the program at once, which is no worse than before.
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));

    let progress = progress::Bar::new(common.verbosity());
    let report = |p| progress.show(p);
    let run = Run::new().threads(common.threads).cancel(&cancelled).progress(&report);
    let result = arguments.verb.recipe().and_then(|recipe| {
        let context = Context { recipe, overwrite: common.overwrite(), run };
        work(&arguments.verb, context)
    });
    progress.finish();
    match result.and_then(|report| finish(&arguments.verb, &report)) {
        Ok(code) => code,
        Err(problem) => {
            // Nothing can be said where even the error stream is closed.
            let _ = writeln!(io::stderr(), "footpoint: {problem}");
            ExitCode::from(NOTHING_DONE)
        }
    }
}

/// Runs the job of a verb.
fn work(verb: &Verb, context: Context<'_>) -> Result<Report, String> {
    let done = match verb {
        Verb::Demo(a) => jobs::demo(&a.plan(), &context),
        Verb::Info(a) => jobs::info(&a.input, &context),
        Verb::Evaluate(a) => jobs::evaluate(&a.cloud, &a.at, &a.output, &a.extra(), &context),
        Verb::Normals(a) => jobs::normals(&a.input, &a.output, (a.choice(), a.bending()), &context),
        Verb::Orient(a) => jobs::orient(&a.input, &a.output, &a.plan(), &context),
        Verb::Project(a) => jobs::project(&a.input, a.onto.as_deref(), &a.output, &context),
        Verb::Distance(a) => jobs::distance(&a.input, &a.to, &a.output, a.coloured(), &context),
        Verb::Figure(a) => jobs::figure(&a.plan(), &context),
        Verb::Render(a) => jobs::render(&a.input, a.output.as_deref(), &a.plan()?, &context),
    };
    done.map_err(|error| explain(&error))
}

/// The error, with the option that helps.
fn explain(error: &JobError) -> String {
    if error.is_existing_output() {
        return format!("{error} (--force overwrites it)");
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
    } else if matches!(verb, Verb::Demo(_) | Verb::Info(_)) {
        // What these find is their result, which even -q wants.
        (words(common.verbosity().or_normal()), String::new())
    } else {
        (String::new(), words(common.verbosity()))
    };
    let allowed = common.strict.unwrap_or(f64::INFINITY) * report.points as f64;
    let strict = report.not_ok() as f64 > allowed;
    if strict {
        messages += &format!("strict: {} of {} points are not ok\n", report.not_ok(), report.points);
    }
    match io::stdout().write_all(results.as_bytes()).and_then(|()| io::stdout().flush()) {
        // A reader that has seen enough is no error.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => return Err(error.to_string()),
        _ => {}
    }
    // The result stands in the file even if nobody reads the messages.
    let _ = io::stderr().write_all(messages.as_bytes());
    Ok(if strict { ExitCode::from(NOT_STRICT) } else { ExitCode::SUCCESS })
}
