//! Work without Python's lock: progress, and interrupts that are heard.

use footpoint::{Progress, Run};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// So few points are done before an interrupt could be heard, and without a thread they cost no more than in the library.
const FEW: usize = 1000;
/// How often interrupts are listened for.
const TICK: Duration = Duration::from_millis(50);

/// How to run: threads (0 for one per core), and who is told of progress.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct How {
    threads: usize,
    /// Called with the points that are done and those there are, from the calling thread.
    progress: Option<Py<PyAny>>,
}

impl How {
    /// Does `work` on so many points while other Python threads run.
    ///
    /// Longer work has a thread of its own, and the calling one wakes up every so often to let Python handle signals (which
    /// it does in its main thread alone) and to tell of progress; an exception from either cancels the work.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python<'_>,
        points: usize,
        work: impl FnOnce(&Run<'_>) -> T + Send,
    ) -> PyResult<T> {
        if points < FEW && self.progress.is_none() {
            return Ok(py.detach(|| work(&Run::new().threads(self.threads))));
        }
        let cancel = AtomicBool::new(false);
        let seen = Mutex::new(None);
        let report =
            |progress: Progress| *seen.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        let run = Run::new().threads(self.threads).cancel(&cancel).progress(&report);
        py.detach(|| {
            thread::scope(|scope| {
                let (done, ended) = mpsc::channel::<()>();
                let worker = thread::Builder::new().spawn_scoped(scope, || {
                    // Hung up when the work ends, also by a panic.
                    let _done = done;
                    work(&run)
                });
                let worker = worker.map_err(|error| PyOSError::new_err(error.to_string()))?;
                let mut heard = Ok(());
                while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                    if heard.is_ok() {
                        heard = Python::attach(|py| self.tick(py, &seen));
                        cancel.store(heard.is_err(), Ordering::Relaxed);
                    }
                }
                let result = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
                heard.and_then(|()| Python::attach(|py| self.tick(py, &seen)))?;
                Ok(result)
            })
        })
    }

    /// Handles signals and tells of progress.
    fn tick(&self, py: Python<'_>, seen: &Mutex<Option<Progress>>) -> PyResult<()> {
        py.check_signals()?;
        let Some(callback) = &self.progress else { return Ok(()) };
        let latest = seen.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(Progress { done, total }) = latest {
            callback.call1(py, (done, total))?;
        }
        Ok(())
    }
}
