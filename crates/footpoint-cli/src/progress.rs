//! Progress of each stage, with its rate and the time left: a bar on a terminal for work over a second, plain lines elsewhere.

use crate::print::Verbosity;
use footpoint_jobs::{Progress, Stage};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Work that takes less is not worth a word.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between plain lines, for logs.
const LINES_APART: Duration = Duration::from_secs(10);

/// Shows how far the job has come.
pub(crate) struct Bar {
    start: Instant,
    kind: Kind,
    shown: Mutex<Shown>,
}

/// What is shown of the stage that runs.
struct Shown {
    bar: Option<ProgressBar>,
    label: String,
    /// What progress counts.
    unit: &'static str,
    began: Instant,
    last_line: Instant,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Silent,
    Terminal,
    Lines,
}

impl Bar {
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        let kind = match verbosity {
            Verbosity::Quiet => Kind::Silent,
            _ if io::stderr().is_terminal() => Kind::Terminal,
            _ => Kind::Lines,
        };
        let start = Instant::now();
        let label = String::new();
        let shown = Shown { bar: None, label, unit: "", began: start, last_line: start };
        Self { start, kind, shown: Mutex::new(shown) }
    }

    /// Begins a stage.
    pub(crate) fn begin(&self, stage: Stage<'_>) {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (label, unit) = match stage {
            Stage::Read(path) => (format!("reading {}", name(path)), ""),
            Stage::Index => ("indexing".to_owned(), ""),
            Stage::Compute => ("computing".to_owned(), " points"),
            Stage::Draw => ("drawing".to_owned(), " rays"),
            Stage::Write(path) => (format!("writing {}", name(path)), " points"),
            _ => return,
        };
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.clear();
        (shown.label, shown.unit, shown.began) = (label, unit, Instant::now());
        if self.kind == Kind::Terminal && self.start.elapsed() >= PATIENCE {
            shown.make_bar();
        }
    }

    pub(crate) fn show(&self, progress: Progress) {
        if self.kind == Kind::Silent || self.start.elapsed() < PATIENCE {
            return;
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let (done, total) = (progress.done as u64, progress.total as u64);
        if self.kind == Kind::Terminal {
            if shown.bar.is_none() {
                shown.make_bar();
            }
            if let Some(bar) = &shown.bar {
                bar.set_length(total);
                bar.set_position(done);
                bar.set_message(describe(done, total, shown.unit, shown.began.elapsed()));
            }
        } else if shown.last_line.elapsed() >= LINES_APART {
            shown.last_line = Instant::now();
            let text = describe(done, total, shown.unit, shown.began.elapsed());
            // Messages are for whoever listens.
            let _ = writeln!(io::stderr(), "{}: {text}", shown.label);
        }
    }

    pub(crate) fn finish(&self) {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

impl Shown {
    fn make_bar(&mut self) {
        let style = ProgressStyle::with_template("{prefix} {bar:30} {msg}");
        let bar = ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(self.label.clone());
        bar.tick();
        self.bar = Some(bar);
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// `42 % of 1.2 million points, 300 thousand a second, 2 s left`.
fn describe(done: u64, total: u64, unit: &str, since: Duration) -> String {
    let share = done as f64 / total.max(1) as f64;
    let seconds = since.as_secs_f64();
    let mut text = format!("{:.0} % of {}{unit}", 100.0 * share, short(total as f64));
    if seconds > 0.0 && share > 0.0 {
        let left = seconds * (1.0 / share - 1.0);
        text += &format!(", {} a second, {} left", short(done as f64 / seconds), time(left));
    }
    text
}

/// A count in three digits.
fn short(count: f64) -> String {
    let (value, word) = match count {
        c if c >= 1e9 => (c / 1e9, " billion"),
        c if c >= 1e6 => (c / 1e6, " million"),
        c if c >= 1e4 => (c / 1e3, " thousand"),
        c => (c, ""),
    };
    if value < 10.0 && !word.is_empty() { format!("{value:.1}{word}") } else { format!("{value:.0}{word}") }
}

/// Seconds, or minutes and seconds.
fn time(seconds: f64) -> String {
    if seconds < 90.0 {
        return format!("{seconds:.0} s");
    }
    let seconds = seconds as u64;
    format!("{} min {} s", seconds / 60, seconds % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_times_are_short() {
        let second = Duration::from_secs(1);
        assert_eq!(
            describe(300_000, 1_200_000, " points", second),
            "25 % of 1.2 million points, 300 thousand a second, 3 s left"
        );
        assert_eq!(describe(0, 50, " rays", second), "0 % of 50 rays");
        assert_eq!(describe(1, 200, "", second), "0 % of 200, 1 a second, 3 min 19 s left");
        assert_eq!(describe(0, 0, "", second), "0 % of 0");
    }
}
