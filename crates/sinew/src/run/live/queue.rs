//! Frames that wait to be tracked: few. When there are more, who sends them waits; in a run that keeps up with a clock the newest ones stay.

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
    /// Whether frames that come faster than they are tracked are skipped.
    skips: bool,
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
    /// Without frames.
    pub(super) fn new(skips: bool) -> Self {
        Self { skips, ..Self::default() }
    }

    /// What is shared, for this thread alone.
    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a frame once there is room, or in place of the oldest; false where nobody takes frames any more.
    pub(super) fn push(&self, views: Views) -> bool {
        let mut state = self.state();
        if self.skips && state.waiting.len() == MOST {
            state.waiting.pop_front();
            state.skipped += 1;
        }
        let is_full = |state: &mut State| state.waiting.len() == MOST && !state.is_closed;
        state = self.changed.wait_while(state, is_full).unwrap_or_else(PoisonError::into_inner);
        if state.is_closed {
            return false;
        }
        state.waiting.push_back(views);
        self.changed.notify_all();
        true
    }

    /// No more frames come, or nobody takes them any more.
    pub(super) fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
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
                self.changed.notify_all();
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
        let queue = Queue::new(true);
        assert!((0..10).all(|number| queue.push(Views { number, seen: vec![] })));
        queue.close();
        let rest: Vec<u64> = std::iter::from_fn(|| queue.next(|| false, |_| {})).map(|views| views.number).collect();
        assert_eq!((rest, queue.state().skipped), (vec![6, 7, 8, 9], 6));
        assert!(!queue.push(Views::default()) && queue.next(|| true, |_| {}).is_none());
    }

    #[test]
    fn a_fast_sender_waits_for_room() {
        let queue = Queue::new(false);
        let taken = std::thread::scope(|scope| {
            let sender = scope.spawn(|| (0..).take_while(|&number| queue.push(Views { number, seen: vec![] })).count());
            let taken: Vec<u64> = (0..100).filter_map(|_| queue.next(|| false, |_| {})).map(|v| v.number).collect();
            queue.close();
            assert!((100..=100 + MOST).contains(&sender.join().unwrap()));
            taken
        });
        assert!(taken.into_iter().eq(0..100) && queue.state().skipped == 0);
    }
}
