//! Time: user and system seconds of the whole process, and seconds by the clock on the wall.

use rustix::time::{ClockId, Timespec, clock_gettime};
use serde::Serialize;

/// Seconds that one piece of work took.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Seconds {
    /// User and system time of all threads.
    pub(crate) cpu: f64,
    pub(crate) wall: f64,
}

/// Does the work and times it.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, Seconds) {
    let now = || (seconds(ClockId::ProcessCPUTime), seconds(ClockId::Monotonic));
    let before = now();
    let result = work();
    let after = now();
    (result, Seconds { cpu: after.0 - before.0, wall: after.1 - before.1 })
}

fn seconds(clock: ClockId) -> f64 {
    let Timespec { tv_sec, tv_nsec } = clock_gettime(clock);
    tv_sec as f64 + 1e-9 * tv_nsec as f64
}

/// NaN for no value.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// As many digits as a measurement deserves.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
