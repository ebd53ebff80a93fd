//! The threads that the settings ask for: pools of them, and runs beside each other.

use crate::Error;
use crate::config::TrackConfig;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// How many threads the settings ask for, or the system grants.
#[must_use]
pub fn wanted(config: &TrackConfig) -> usize {
    config.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()))
}

/// Runs in a pool of that many threads: in the one that it is called from, if it has as many.
///
/// # Errors
/// [`Error::Threads`] where the system grants none; errors of what is run.
pub fn with_threads<T: Send, E: From<Error> + Send>(
    threads: usize,
    run: impl FnOnce() -> Result<T, E> + Send,
) -> Result<T, E> {
    if rayon::current_thread_index().is_some() && rayon::current_num_threads() == threads {
        return run();
    }
    pool(threads)?.install(run)
}

/// A pool of that many threads.
///
/// # Errors
/// [`Error::Threads`] where the system grants none.
pub fn pool(threads: usize) -> Result<ThreadPool, Error> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(Error::Threads)
}

/// Does `one(i)` for every i below `count`, `workers` of them at a time, and returns what they came to in order.
///
/// Nothing is begun after one that `ends`; what was not begun is `None`.
pub fn beside_each_other<T: Send>(
    count: usize,
    workers: usize,
    one: impl Fn(usize) -> T + Sync,
    ends: impl Fn(&T) -> bool + Sync,
) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let came_to: Mutex<Vec<Option<T>>> = Mutex::new((0..count).map(|_| None).collect());
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return;
            }
            let outcome = one(index);
            if ends(&outcome) {
                next.store(count, Ordering::Relaxed);
            }
            came_to.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(outcome);
        }
    };
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    came_to.into_inner().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_come_in_order() {
        for workers in [1, 2, 5] {
            let squares = beside_each_other(9, workers, |index| index * index, |_| false);
            assert_eq!(squares, (0..9).map(|index| Some(index * index)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn nothing_is_begun_after_an_end() {
        let one_by_one = beside_each_other(9, 1, |index| index, |index| *index == 3);
        assert_eq!(one_by_one, [Some(0), Some(1), Some(2), Some(3), None, None, None, None, None]);
    }
}
