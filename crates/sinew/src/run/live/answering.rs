//! The thread that writes answers, so that nobody who reads slowly holds up the tracking.
//!
//! Some lines wait for a slow reader; when there are more, the oldest are dropped and counted. The result folder has every frame all the same.

use std::collections::VecDeque;
use std::io::Write;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Lines that wait at most.
const MOST: usize = 256;

/// How long a line may take to leave before tracking continues: a reader that keeps up takes it at once.
const AT_ONCE: Duration = Duration::from_millis(1);

/// How long the end of a run waits for a reader.
const LAST_WAIT: Duration = Duration::from_secs(2);

/// Where answers are posted.
#[derive(Clone, Default)]
pub(super) struct Answering {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    posted: Condvar,
    written: Condvar,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<String>,
    is_writing: bool,
    is_closed: bool,
    dropped: u64,
    failed: Option<String>,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Answering {
    /// Writes to a stream from now on, on a thread that nobody waits for: a write may never return.
    pub(super) fn begin(stream: impl Write + Send + 'static) -> Self {
        let answering = Self::default();
        let shared = Arc::clone(&answering.shared);
        std::thread::spawn(move || write_all(&shared, stream));
        answering
    }

    /// Adds a line, in place of the oldest where too many wait.
    pub(super) fn post(&self, line: String) {
        let mut state = self.shared.state();
        if state.failed.is_some() {
            state.dropped += 1;
            return;
        }
        if state.waiting.len() == MOST {
            state.waiting.pop_front();
            state.dropped += 1;
        }
        state.waiting.push_back(line);
        drop(state);
        self.shared.posted.notify_one();
    }

    /// As [`Answering::post`]; where nothing else waits, the line leaves before this returns.
    pub(super) fn post_at_once(&self, line: String) {
        self.post(line);
        let state = self.shared.state();
        if state.waiting.len() == 1 && !state.is_writing {
            let is_busy = |state: &mut State| !state.waiting.is_empty() || state.is_writing;
            let waited = self.shared.written.wait_timeout_while(state, AT_ONCE, is_busy);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
    }

    /// Lines that nobody took in time.
    pub(super) fn dropped(&self) -> u64 {
        self.shared.state().dropped
    }

    /// Why nobody takes answers any more.
    pub(super) fn failed(&self) -> Option<String> {
        self.shared.state().failed.clone()
    }

    /// Waits for the lines that are left, not forever.
    pub(super) fn end(&self) {
        let mut state = self.shared.state();
        state.is_closed = true;
        self.shared.posted.notify_one();
        let until = Instant::now() + LAST_WAIT;
        while (state.is_writing || !state.waiting.is_empty()) && state.failed.is_none() {
            let Some(left) = until.checked_duration_since(Instant::now()) else { return };
            let (next, _) = self.shared.written.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner);
            state = next;
        }
    }
}

fn write_all(shared: &Shared, mut stream: impl Write) {
    let mut state = shared.state();
    loop {
        let Some(line) = state.waiting.pop_front() else {
            if state.is_closed {
                return;
            }
            state = shared.posted.wait(state).unwrap_or_else(PoisonError::into_inner);
            continue;
        };
        state.is_writing = true;
        drop(state);
        let written = stream.write_all(line.as_bytes()).and_then(|()| stream.flush());
        state = shared.state();
        state.is_writing = false;
        if let Err(error) = written {
            state.dropped += 1 + state.waiting.len() as u64;
            state.waiting.clear();
            state.failed = Some(error.to_string());
        }
        shared.written.notify_all();
        if state.failed.is_some() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// A writer that takes one line each time the test lets it.
    struct Gate {
        open: Receiver<()>,
        taken: Sender<String>,
    }

    impl Write for Gate {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.open.recv().map_err(|_| std::io::ErrorKind::BrokenPipe)?;
            self.taken.send(String::from_utf8_lossy(bytes).into_owned()).map_err(|_| std::io::ErrorKind::BrokenPipe)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_slow_reader_gets_the_newest_lines_and_is_not_waited_for() {
        let ((open, gate), (taken, lines)) = (channel(), channel());
        let answering = Answering::begin(Gate { open: gate, taken });
        let posted = MOST + 50;
        answering.post_at_once("0".into());
        while !answering.shared.state().is_writing {
            std::thread::yield_now();
        }
        (1..posted).for_each(|number| answering.post_at_once(number.to_string()));
        let dropped = answering.dropped() as usize;
        (0..posted).for_each(|_| open.send(()).unwrap());
        answering.end();
        let lines: Vec<usize> = lines.try_iter().map(|line| line.parse().unwrap()).collect();
        // One line was being written when the others were posted.
        assert_eq!(lines.len() + dropped, posted);
        assert_eq!((lines[0], dropped), (0, posted - 1 - MOST));
        assert!(lines[1..].iter().copied().eq(posted - MOST..posted));
    }

    #[test]
    fn a_reader_who_goes_away_is_noticed() {
        let ((open, gate), (taken, _)) = (channel::<()>(), channel());
        drop(open);
        let answering = Answering::begin(Gate { open: gate, taken });
        (0..5).for_each(|number| answering.post_at_once(number.to_string()));
        answering.end();
        assert!(answering.failed().is_some() && answering.dropped() == 5);
    }
}
