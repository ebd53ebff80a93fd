//! Frames that wait to be tracked: few, and when there are more, the newest ones.

use super::refusals::Refusals;
use crate::formats::Layout;
use crate::input::live::Views;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Frames that wait at most: a frame that took three times as long as usual costs none.
pub(super) const MOST: usize = 4;

/// How often a wait looks for an interrupt.
const PATIENCE: Duration = Duration::from_millis(50);

/// Between the thread that reads and the one that tracks.
#[derive(Default)]
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

/// What is shared.
#[derive(Default)]
pub(super) struct State {
    waiting: VecDeque<Views>,
    /// Frames that were replaced by newer ones.
    pub(super) skipped: u64,
    /// Layout of the keypoints, once it is known.
    pub(super) layout: Option<Layout>,
    /// What is refused so far.
    pub(super) refusals: Refusals,
    /// What to say of the input.
    pub(super) warnings: Vec<String>,
    is_closed: bool,
}

impl Queue {
    /// What is shared, for this thread alone.
    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a frame, in place of the oldest where too many wait.
    pub(super) fn push(&self, views: Views) {
        let mut state = self.state();
        if state.waiting.len() == MOST {
            state.waiting.pop_front();
            state.skipped += 1;
        }
        state.waiting.push_back(views);
        self.changed.notify_one();
    }

    /// No more frames come.
    pub(super) fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_one();
    }

    /// The oldest frame that waits, once there is one; none where no more come or `stopped`. `meanwhile` is called now and then.
    pub(super) fn next(&self, stopped: impl Fn() -> bool, mut meanwhile: impl FnMut(&mut State)) -> Option<Views> {
        let mut state = self.state();
        loop {
            meanwhile(&mut state);
            if stopped() {
                return None;
            }
            if let Some(views) = state.waiting.pop_front() {
                return Some(views);
            }
            if state.is_closed {
                return None;
            }
            let (next, _) = self.changed.wait_timeout(state, PATIENCE).unwrap_or_else(PoisonError::into_inner);
            state = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_frames_wait_and_the_others_are_counted() {
        let queue = Queue::default();
        (0..10).for_each(|number| queue.push(Views { number, seen: vec![] }));
        queue.close();
        let rest: Vec<u64> = std::iter::from_fn(|| queue.next(|| false, |_| {})).map(|views| views.number).collect();
        assert_eq!((rest, queue.state().skipped), (vec![6, 7, 8, 9], 6));
        queue.push(Views::default());
        assert!(queue.next(|| true, |_| {}).is_none());
    }
}
