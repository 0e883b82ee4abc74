//! A progress bar on a terminal for work over a second, plain lines elsewhere.

use crate::print::Verbosity;
use footpoint_jobs::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, IsTerminal, Write};
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
    /// The bar once it is shown, and when the last line was written.
    shown: Mutex<(Option<ProgressBar>, Instant)>,
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
        Self { start, kind, shown: Mutex::new((None, start)) }
    }

    pub(crate) fn show(&self, progress: Progress) {
        if self.kind == Kind::Silent || self.start.elapsed() < PATIENCE {
            return;
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if self.kind == Kind::Terminal {
            let bar = shown.0.get_or_insert_with(|| {
                let style = ProgressStyle::with_template("{bar:40} {percent}% of {len} points, {eta} left");
                ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            });
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
        } else if shown.1.elapsed() >= LINES_APART {
            shown.1 = Instant::now();
            let percent = 100 * progress.done / progress.total.max(1);
            // Messages are for whoever listens.
            let _ = writeln!(io::stderr(), "{percent}% of {} points", progress.total);
        }
    }

    pub(crate) fn finish(&self) {
        if let Some(bar) = self.shown.lock().unwrap_or_else(PoisonError::into_inner).0.take() {
            bar.finish_and_clear();
        }
    }
}
