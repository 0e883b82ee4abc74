//! Wall and CPU time of the stages of a job.

use serde::Serialize;
use std::time::Instant;

/// Time that a stage took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spent {
    /// Seconds on the clock.
    pub wall_seconds: f64,
    /// Seconds of all cores, user and system; absent where the system does not tell.
    pub cpu_seconds: Option<f64>,
}

impl Default for Spent {
    /// No time yet.
    fn default() -> Self {
        Self { wall_seconds: 0.0, cpu_seconds: cpu_seconds().map(|_| 0.0) }
    }
}

/// Times of a job's stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// Reading and parsing files.
    pub read: Spent,
    /// Choosing supports and indexing the samples.
    pub index: Spent,
    /// Evaluating or projecting.
    pub compute: Spent,
    /// Drawing pictures.
    pub draw: Spent,
    /// Writing files.
    pub write: Spent,
}

impl std::ops::AddAssign for Spent {
    fn add_assign(&mut self, other: Self) {
        self.wall_seconds += other.wall_seconds;
        self.cpu_seconds = self.cpu_seconds.zip(other.cpu_seconds).map(|(a, b)| a + b);
    }
}

/// Runs `stage` and adds the time it took to `spent`.
pub(crate) fn timed<T>(spent: &mut Spent, stage: impl FnOnce() -> T) -> T {
    let (wall, cpu) = (Instant::now(), cpu_seconds());
    let result = stage();
    *spent += Spent {
        wall_seconds: wall.elapsed().as_secs_f64(),
        cpu_seconds: cpu_seconds().zip(cpu).map(|(now, before)| now - before),
    };
    result
}

#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}
