//! The frames of a live run: some for the set-up, then the one at hand.

use super::answering::Answering;
use super::error::LiveError;
use super::queue::{Queue, State};
use crate::Error;
use crate::formats::Layout;
use crate::input::live::{LiveCameras, LiveRecording, Views};
use crate::input::source::{FrameSource, InputHashes};
use crate::observe::Camera;
use crate::observe::association::Person;
use crate::run::listener::Listener;
use crate::track::job::live::Arrivals;
use sinew_input::Error as InputError;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Frames that come.
pub(super) struct Source<'a> {
    recording: LiveRecording,
    queue: &'a Queue,
    answering: &'a Answering,
    listener: &'a dyn Listener,
    stop: Arc<AtomicBool>,
    /// A frame that was taken from the queue and is not tracked yet.
    ahead: Option<Views>,
    /// Frames that were replaced before tracking began.
    skipped_before: Option<u64>,
    has_begun: bool,
    /// Frames that never came.
    missing: u64,
}

impl<'a> Source<'a> {
    /// Waits for the first frame.
    ///
    /// # Errors
    /// [`LiveError::NoFrame`].
    pub(super) fn opened(
        cameras: LiveCameras,
        queue: &'a Queue,
        answering: &'a Answering,
        listener: &'a dyn Listener,
    ) -> Result<Self, Error> {
        let stop = listener.stop();
        let first = waited(queue, &stop, listener).ok_or(LiveError::NoFrame)?;
        let layout = queue.state().layout.clone().ok_or(LiveError::NoFrame)?;
        Ok(Self {
            recording: LiveRecording::new(cameras, layout),
            queue,
            answering,
            listener,
            stop,
            ahead: Some(first),
            skipped_before: None,
            has_begun: false,
            missing: 0,
        })
    }

    fn next(&mut self) -> Option<Views> {
        self.ahead.take().or_else(|| waited(self.queue, &self.stop, self.listener))
    }

    /// Keeps a number of frames for the set-up, from the first one on that shows somebody in two cameras.
    ///
    /// # Errors
    /// [`LiveError::SetupCutShort`] where no more come.
    pub(super) fn first_frames(&mut self, count: u64) -> Result<Range<u64>, Error> {
        let enough = self.recording.cameras().len().min(2);
        let mut range: Option<Range<u64>> = None;
        loop {
            let found = range.as_ref().map_or(0, |range| range.end - range.start);
            let views = self.next().ok_or(LiveError::SetupCutShort { found, expected: count })?;
            let number = views.number;
            match &mut range {
                None if views.with_people() < enough => continue,
                None => {
                    self.listener.note(&format!("set-up from frames {number}..{}", number + count));
                    range = Some(number..number + 1);
                }
                Some(range) if number >= range.start + count => {
                    self.ahead = Some(views);
                    return Ok(range.start..range.start + count);
                }
                Some(range) => range.end = number + 1,
            }
            self.recording.keep(views);
        }
    }
}

/// The next frame in the queue, once there is one; what is refused is said meanwhile.
fn waited(queue: &Queue, stop: &AtomicBool, listener: &dyn Listener) -> Option<Views> {
    let say = |state: &mut State| listener.warnings(&state.refusals.take_unsaid());
    queue.next(|| stop.load(Ordering::Relaxed), say)
}

impl Arrivals for Source<'_> {
    fn skipped(&self) -> u64 {
        self.queue.state().skipped - self.skipped_before.unwrap_or(0)
    }

    fn arrive(&mut self) -> Option<u64> {
        if self.skipped_before.is_none() {
            self.recording.forget();
            // What came while the set-up was made belongs to no result.
            self.skipped_before = Some(self.queue.state().skipped);
        }
        let views = self.next()?;
        let number = views.number;
        if !self.has_begun {
            self.listener.note(&format!("tracking from frame {number}"));
        }
        self.has_begun = true;
        self.recording.take(views);
        Some(number)
    }

    fn bridged(&mut self, frames: u64) {
        self.missing += frames;
    }
}

impl FrameSource for Source<'_> {
    fn cameras(&self) -> &[Camera] {
        self.recording.cameras()
    }

    fn layout(&self) -> &Layout {
        self.recording.layout()
    }

    fn frames(&self) -> Range<u64> {
        self.recording.frames()
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, InputError> {
        self.recording.people(number)
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.recording.warnings();
        let skipped = self.skipped();
        let state = self.queue.state();
        if skipped > 0 {
            warnings.push(format!(
                "{skipped} frames came faster than they could be tracked; they were skipped, the motion prior bridges them, and the results are not complete"
            ));
        }
        let lost = self.missing.saturating_sub(skipped);
        if lost > 0 {
            warnings.push(format!("{lost} frames never came; the motion prior bridges them"));
        }
        warnings.extend(state.warnings.iter().cloned());
        warnings.extend(state.refusals.warnings());
        let dropped = self.answering.dropped();
        if let Some(why) = self.answering.failed() {
            warnings.push(format!("nobody reads the answers any more ({why}); {dropped} were dropped"));
        } else if dropped > 0 {
            warnings.push(format!("{dropped} answers were dropped, since they were read too slowly"));
        }
        warnings
    }

    fn input_hashes(&self) -> InputHashes {
        self.recording.input_hashes()
    }
}
