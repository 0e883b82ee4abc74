//! Work without Python's lock: progress, and interrupts that are heard.

use footpoint::{Progress, Run};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use std::io;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// So few pairs of a point and a neighbour are done before an interrupt could be heard, and without a thread they cost no more
/// than in the library.
const FEW: usize = 40_000;
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

/// What the calling thread and the one that works know of each other.
#[derive(Default)]
struct Shared {
    cancel: AtomicBool,
    seen: Mutex<Option<Progress>>,
}

impl Shared {
    fn seen(&self) -> MutexGuard<'_, Option<Progress>> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work<T>(&self, threads: usize, work: impl FnOnce(&Run<'_>) -> T) -> T {
        let report = |now: Progress| {
            let mut seen = self.seen();
            // Threads may come here in another order than that in which they counted.
            *seen = Some(seen.filter(|seen| seen.total == now.total && seen.done > now.done).unwrap_or(now));
        };
        work(&Run::new().threads(threads).cancel(&self.cancel).progress(&report))
    }
}

impl How {
    /// Does `work` on so many pairs of a point and a neighbour while other Python threads run.
    ///
    /// Longer work has a thread of its own, and the calling one wakes up every so often to let Python handle signals (which
    /// it does in its main thread alone) and to tell of progress; an exception from either cancels the work.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python<'_>,
        pairs: usize,
        work: impl FnOnce(&Run<'_>) -> T + Send,
    ) -> PyResult<T> {
        if pairs < FEW && self.progress.is_none() {
            return Ok(py.detach(|| work(&Run::new().threads(self.threads))));
        }
        let (shared, threads) = (&Shared::default(), self.threads);
        py.detach(|| {
            thread::scope(|scope| {
                let (tell, told) = mpsc::channel();
                let task = move || drop(tell.send(shared.work(threads, work)));
                let worker = thread::Builder::new().spawn_scoped(scope, task).map_err(no_thread)?;
                match self.listen(shared, &told)? {
                    Some(result) => Ok(result),
                    None => Err(worker.join().map_or_else(|panic| resume_unwind(panic), |()| silent())),
                }
            })
        })
    }

    /// The same for work that owns what it needs: an interrupt does not wait until it ends.
    pub(crate) fn run_owned<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Run<'_>) -> T + Send + 'static,
    ) -> PyResult<T> {
        let shared = Arc::new(Shared::default());
        let (theirs, threads) = (Arc::clone(&shared), self.threads);
        py.detach(|| {
            let (tell, told) = mpsc::channel();
            let task = move || drop(tell.send(theirs.work(threads, work)));
            let worker = thread::Builder::new().spawn(task).map_err(no_thread)?;
            match self.listen(&shared, &told)? {
                Some(result) => Ok(result),
                None => Err(worker.join().map_or_else(|panic| resume_unwind(panic), |()| silent())),
            }
        })
    }

    /// Waits for the result, with an ear for Python; none where the worker panicked.
    fn listen<T>(&self, shared: &Shared, told: &Receiver<T>) -> PyResult<Option<T>> {
        loop {
            let result = told.recv_timeout(TICK);
            let ticked = Python::attach(|py| self.tick(py, shared));
            shared.cancel.store(ticked.is_err(), Ordering::Relaxed);
            ticked?;
            match result {
                Ok(result) => return self.end(shared).map(|()| Some(result)),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// Handles signals and tells of progress.
    fn tick(&self, py: Python<'_>, shared: &Shared) -> PyResult<()> {
        py.check_signals()?;
        let Some(callback) = &self.progress else { return Ok(()) };
        // The lock is not held while Python runs.
        let latest = *shared.seen();
        if let Some(Progress { done, total }) = latest {
            callback.call1(py, (done, total))?;
        }
        Ok(())
    }

    /// Tells that all is done: of files it is known only now.
    fn end(&self, shared: &Shared) -> PyResult<()> {
        let latest = shared.seen().filter(|latest| latest.done < latest.total);
        match (&self.progress, latest) {
            (Some(callback), Some(Progress { total, .. })) => {
                Python::attach(|py| callback.call1(py, (total, total)).map(drop))
            }
            _ => Ok(()),
        }
    }
}

fn no_thread(problem: io::Error) -> PyErr {
    PyOSError::new_err(format!("threads: none can be made here: {problem}"))
}

/// What cannot happen: a worker that ends without a result and without a panic.
fn silent() -> PyErr {
    PyRuntimeError::new_err("the work ended without a result")
}
