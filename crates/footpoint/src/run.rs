//! How a computation runs: threads, progress, cancelling.

use fearless_simd::Level;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Groups that one thread takes at a time: enough to hide the bookkeeping, few enough to share evenly.
const GROUPS_AT_A_TIME: usize = 2;
/// So many quick items are done sooner than a thread wakes up.
#[cfg(feature = "threads")]
const QUICK: usize = 1024;

/// How to run: who does not care takes the default (all cores, silent, not cancellable).
///
/// Results have the same bits for any number of threads. Threads belong to the library's own pool, which is made on
/// first use and made again after a fork.
#[derive(Clone, Copy, Default)]
pub struct Run<'r> {
    threads: Option<usize>,
    progress: Option<&'r (dyn Fn(Progress) + Sync)>,
    cancel: Option<&'r AtomicBool>,
    instructions: Instructions,
}

/// The most that the processor's vector unit is asked for. Less than the processor has serves comparisons and tests:
/// AVX-512 and AVX2 give the same bits, the baseline, which rounds twice in `a·b + c`, others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Instructions {
    /// All that the processor has.
    #[default]
    Best,
    /// At most AVX2 with fused multiply-adds.
    Avx2,
    /// What every processor of the kind has.
    Baseline,
}

impl Instructions {
    /// The level to compute with on this processor.
    pub(crate) fn level(self) -> Level {
        let best = Level::new();
        match self {
            Self::Best => best,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => best.as_avx2().map_or(best, Level::Avx2),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
            Self::Avx2 => best,
            Self::Baseline => Level::baseline(),
        }
    }
}

/// How far a computation has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Points finished.
    pub done: usize,
    /// Points in all.
    pub total: usize,
}

/// The computation was cancelled through its [`Run`]; nothing of it is returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl<'r> Run<'r> {
    /// All cores, silent, not cancellable.
    pub fn new() -> Self {
        Self::default()
    }

    /// Uses this many threads, 256 or one per core at most; 0 means one per core, 1 the calling thread: several callers with 1
    /// each do not wait for each other.
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = (threads > 0).then_some(threads);
        self
    }

    /// Calls `report` now and then, from any thread, with the number of points finished.
    pub fn progress(mut self, report: &'r (dyn Fn(Progress) + Sync)) -> Self {
        self.progress = Some(report);
        self
    }

    /// Stops soon after `flag` becomes true, however wide supports are. It has to stay true until then.
    pub fn cancel(mut self, flag: &'r AtomicBool) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Asks the processor for at most these instructions.
    pub fn instructions(mut self, instructions: Instructions) -> Self {
        self.instructions = instructions;
        self
    }

    /// The level to compute with.
    pub(crate) fn level(&self) -> Level {
        self.instructions.level()
    }

    /// The same run without its progress.
    pub fn silent(self) -> Self {
        Self { progress: None, ..self }
    }

    /// Calls what [`Run::progress`] was given: for a front whose work is many calls, each with a [`Run::silent`] run.
    pub fn announce(&self, progress: Progress) {
        if let Some(report) = self.progress {
            report(progress);
        }
    }

    /// Whether the flag of [`Run::cancel`] is set: for a front's own work between calls.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Fails once the run has been cancelled.
    pub(crate) fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Calls `work(0)`, …, `work(count − 1)`, each thread with a state of its own from `state`. `size` tells how many points
    /// a piece of work stands for.
    pub(crate) fn for_each_group<S>(
        &self,
        count: usize,
        size: impl Fn(usize) -> usize + Sync + Send,
        state: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, usize) + Sync + Send,
    ) -> Result<(), Cancelled> {
        let total = (0..count).map(&size).sum();
        let done = AtomicUsize::new(0);
        let several = |state: &mut S, chunk: usize| {
            self.check()?;
            let mut finished = 0;
            for group in chunk * GROUPS_AT_A_TIME..count.min((chunk + 1) * GROUPS_AT_A_TIME) {
                work(state, group);
                // What was made while it was cancelled is not to be trusted.
                self.check()?;
                finished += size(group);
            }
            let done = done.fetch_add(finished, Ordering::Relaxed) + finished;
            self.announce(Progress { done, total });
            Ok(())
        };
        let chunks = count.div_ceil(GROUPS_AT_A_TIME);
        #[cfg(feature = "threads")]
        if chunks > 1 && self.may_share() {
            use rayon::prelude::*;
            return self.install(|| (0..chunks).into_par_iter().try_for_each_init(state, several));
        }
        let mut state = state();
        (0..chunks).try_for_each(|chunk| several(&mut state, chunk))
    }

    /// `work(0)`, …, `work(count − 1)` in order, on the threads of this run: for a front's own work between calls.
    pub fn map<T: Send>(
        &self,
        count: usize,
        work: impl Fn(usize) -> T + Sync + Send,
    ) -> Result<Vec<T>, Cancelled> {
        let checked = |i: usize| {
            if i.is_multiple_of(1024) {
                self.check()?;
            }
            Ok(work(i))
        };
        #[cfg(feature = "threads")]
        if count > 64 && self.may_share() {
            use rayon::prelude::*;
            return self.install(|| (0..count).into_par_iter().with_min_len(64).map(checked).collect());
        }
        (0..count).map(checked).collect()
    }

    /// `make(0)`, …, `make(count − 1)` in order; for quick work, which is not cancelled.
    pub(crate) fn collect<T: Send>(&self, count: usize, make: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        #[cfg(feature = "threads")]
        if count > QUICK && self.may_share() {
            use rayon::prelude::*;
            return self.install(|| (0..count).into_par_iter().with_min_len(QUICK).map(make).collect());
        }
        (0..count).map(make).collect()
    }

    /// The same, without what is `None`.
    pub(crate) fn collect_some<T: Send>(
        &self,
        count: usize,
        make: impl Fn(usize) -> Option<T> + Sync + Send,
    ) -> Vec<T> {
        #[cfg(feature = "threads")]
        if count > QUICK && self.may_share() {
            use rayon::prelude::*;
            return self
                .install(|| (0..count).into_par_iter().with_min_len(QUICK).filter_map(make).collect());
        }
        (0..count).filter_map(make).collect()
    }

    /// Does `work` on every item.
    pub(crate) fn for_each<T: Send>(&self, items: &mut [T], work: impl Fn(&mut T) + Sync + Send) {
        #[cfg(feature = "threads")]
        if items.len() > 4 && self.may_share() {
            use rayon::prelude::*;
            return self.install(|| items.par_iter_mut().with_min_len(4).for_each(work));
        }
        items.iter_mut().for_each(work);
    }

    /// Sorts by a total order, so that the result is the same for any number of threads.
    pub(crate) fn sort<T: Send>(
        &self,
        items: &mut [T],
        order: impl Fn(&T, &T) -> std::cmp::Ordering + Sync + Send,
    ) {
        #[cfg(feature = "threads")]
        if items.len() > QUICK && self.may_share() {
            use rayon::prelude::*;
            return self.install(|| items.par_sort_unstable_by(order));
        }
        items.sort_unstable_by(order);
    }

    /// Whether work may go to other threads than the calling one.
    #[cfg(feature = "threads")]
    fn may_share(&self) -> bool {
        self.threads != Some(1)
    }

    /// Runs `work` inside the library's pool with the threads asked for.
    #[cfg(feature = "threads")]
    fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match pool::with_threads(self.threads) {
            Some(pool) => pool.install(work),
            // No thread can be made here (a sandbox, a limit): the calling thread's pool still gives the answer.
            None => work(),
        }
    }
}

impl std::fmt::Debug for Run<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run").field("threads", &self.threads).finish_non_exhaustive()
    }
}

/// The library's own threads.
#[cfg(feature = "threads")]
mod pool {
    use rayon::{ThreadPool, ThreadPoolBuilder};
    use std::sync::{Arc, Mutex, PoisonError};

    struct Kept {
        process: u32,
        threads: usize,
        pool: Arc<ThreadPool>,
    }

    /// More threads than this, or than there are cores, gain nothing, and thousands take minutes to be made.
    pub(super) const MOST: usize = 256;

    static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

    /// The pool with this many threads (all cores for `None`); the last one used is kept.
    pub(super) fn with_threads(threads: Option<usize>) -> Option<Arc<ThreadPool>> {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        let threads = threads.map_or_else(cores, |threads| threads.min(cores().max(MOST)));
        // A forked child has the pool's memory without its threads.
        let process = std::process::id();
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = kept.as_ref().filter(|k| k.process == process && k.threads == threads) {
            return Some(Arc::clone(&kept.pool));
        }
        let named = |i| format!("footpoint-{i}");
        let pool = Arc::new(ThreadPoolBuilder::new().num_threads(threads).thread_name(named).build().ok()?);
        let old = kept.replace(Kept { process, threads, pool: Arc::clone(&pool) });
        if let Some(old) = old.filter(|old| old.process != process) {
            // Waiting for the parent's threads would never end.
            std::mem::forget(old);
        }
        Some(pool)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn every_block_is_done_once_and_progress_reaches_the_total() {
        for threads in [0, 1, 2, 5] {
            let seen = Mutex::new(vec![0; 3000]);
            let last = AtomicUsize::new(0);
            let report = |p: Progress| {
                assert_eq!(p.total, 3000);
                last.fetch_max(p.done, Ordering::Relaxed);
            };
            let run = Run::new().threads(threads).progress(&report);
            run.for_each_group(
                1000,
                |_| 3,
                || (),
                |(), group| {
                    for i in 3 * group..3 * group + 3 {
                        seen.lock().unwrap()[i] += 1;
                    }
                },
            )
            .unwrap();
            assert!(seen.lock().unwrap().iter().all(|&count| count == 1));
            assert_eq!(last.load(Ordering::Relaxed), 3000);
        }
    }

    #[test]
    #[cfg(feature = "threads")]
    fn threads_are_bounded() {
        let pool = pool::with_threads(Some(usize::MAX)).unwrap();
        assert!((pool::MOST..10_000).contains(&pool.current_num_threads()));
    }

    #[test]
    fn one_thread_is_the_caller() {
        let caller = std::thread::current().id();
        let here = || std::thread::current().id() == caller;
        let run = Run::new().threads(1);
        run.for_each_group(1000, |_| 1, || (), |(), _| assert!(here())).unwrap();
        assert!(run.map(5000, |_| here()).unwrap().into_iter().all(|here| here));
        assert!(run.collect(5000, |_| here()).into_iter().all(|here| here));
        assert_eq!(run.collect_some(5000, |_| here().then_some(())).len(), 5000);
        run.for_each(&mut [0; 5000], |_| assert!(here()));
        let mut items: Vec<usize> = (0..5000).rev().collect();
        run.sort(&mut items, |a, b| {
            assert!(here());
            a.cmp(b)
        });
        assert_eq!(items[..3], [0, 1, 2]);
    }

    #[test]
    fn cancelling_stops_the_work() {
        let flag = AtomicBool::new(false);
        let done = AtomicUsize::new(0);
        let result = Run::new().threads(1).cancel(&flag).for_each_group(
            100_000,
            |_| 1,
            || (),
            |(), _| {
                done.fetch_add(1, Ordering::Relaxed);
                flag.store(true, Ordering::Relaxed);
            },
        );
        assert_eq!(result, Err(Cancelled));
        assert!(done.load(Ordering::Relaxed) < 1000);
    }
}
