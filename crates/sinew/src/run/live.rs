//! Tracking while frames come: lines in, a line out for each frame, and the usual folder at the end.
//!
//! ```text
//! stream ──▶ reading ──▶ queue (few frames) ──▶ one run ──▶ answering (few lines) ──▶ stream
//!               └──────────── what is refused ────────────────┘
//! ```
//!
//! Reading and answering are threads of their own: neither a burst of frames nor a slow reader holds up the tracking, or makes memory grow. A burst waits where it comes from, or, in a run that keeps up with a clock, loses all but its newest frames.

mod answer;
mod answering;
pub(crate) mod error;
mod lines;
mod place;
mod queue;
mod reading;
mod refusals;
mod source;

pub use error::LiveError;
pub use place::{LivePlace, Streams};

use super::read_from;
use crate::Error;
use crate::config::common::{FRAMES, IMAGES, INIT, KEYPOINTS, LAG, SETUP_FRAMES, SILHOUETTES, SMOOTH, TRIM};
use crate::config::{Resolved, TrackConfig};
use crate::input::live::LiveCameras;
use crate::methods::hmc;
use crate::run::claimed::claimed;
use crate::run::former_results::refuse_people;
use crate::run::listener::{Listener, watched};
use crate::run::threads::{wanted, with_threads};
use crate::track::job::live::{Answers, track_live};
use crate::track::job::{self, Outcome};
use answering::Answering;
use queue::Queue;
use reading::Reading;
use sinew_results::estimate::{FrameEstimate, RunInfo};
use sinew_results::people::forget_people;
use sinew_results::refuse_inputs;
use source::Source;
use std::path::PathBuf;
use std::sync::Arc;

/// Seconds of frames for the set-up, where nobody says how many.
pub const SETUP_S: f64 = 5.0;

/// Seconds that may be missing between two frames.
const MOST_MISSING_S: f64 = 60.0;

/// What a live run is to do.
pub struct LiveRequest {
    /// Where frames come from.
    pub place: LivePlace,
    /// The streams of the process, for [`LivePlace::Standard`].
    pub standard: Streams,
    /// Seconds of frames for the set-up; [`SETUP_S`] if `None`.
    pub setup_s: Option<f64>,
    /// Whether frames that come faster than they are tracked are skipped, so that answers are of now; else they wait where they come from.
    pub skips: bool,
    /// File of settings that was named, which the run must not replace.
    pub settings_file: Option<PathBuf>,
}

/// Times the updates that chains which disagree take, where the settings do not say: the next frames must not wait.
const PATIENCE: usize = 1;

/// Tracks frames as they come into the folder of the settings.
///
/// # Errors
/// [`Error`], with what was done kept in the folder where anything was.
pub fn track(resolved: &Resolved, request: LiveRequest, listener: &dyn Listener) -> Result<Outcome, Error> {
    let resolved = &resolved.clone().with_default(&hmc::PATIENCE, PATIENCE);
    let config = resolved.track();
    let LiveRequest { place, standard, setup_s, skips, settings_file } = request;
    let calibration = check(resolved, &config)?;
    let read_from = read_from(&config, &calibration, settings_file.as_deref());
    refuse_inputs(&config.out, &read_from)?;
    job::check_settings(resolved)?;
    let cameras = LiveCameras::open(&calibration, &config.recording)?;
    let layout = cameras.named_layout(&config.recording)?;
    let claim = claimed(&config, &read_from, listener)?;
    refuse_people(&config, &read_from, |_| Ok(()))?;
    let streams = match place {
        LivePlace::Standard => standard,
        LivePlace::Tcp(address) => place::connected(address, listener)?,
    };
    let fps = config.fps();
    let answering = Answering::begin(streams.answers);
    let queue = Arc::new(Queue::new(skips));
    queue.state().layout.clone_from(&layout);
    let reading = Reading {
        cameras: cameras.clone(),
        layout,
        most_ahead: (MOST_MISSING_S * fps).ceil() as u64,
        queue: Arc::clone(&queue),
        answering: answering.clone(),
    };
    reading.begin(streams.frames);
    let frames = (config.setup.is_none()).then(|| (setup_s.unwrap_or(SETUP_S) * fps).ceil().max(1.0) as u64);
    let mut source = Source::opened(cameras, &queue, &answering, listener)?;
    let setup_frames = match frames {
        Some(frames) => source.first_frames(frames)?,
        None => 0..0,
    };
    let mut answers = Tracking { answering: &answering, queue: &queue };
    let ended = watched(listener, |watch| {
        let run = || track_live(&mut source, setup_frames, resolved, claim, watch, &mut answers);
        with_threads(wanted(&config), run)
    });
    queue.close();
    if let Ok(Some(Outcome { summary, .. })) = &ended {
        answering.post(answer::end(summary, queue.state().skipped, answering.dropped()));
    }
    answering.end();
    let outcome = ended?.ok_or(LiveError::NoFrame)?;
    if outcome.summary.complete {
        forget_people(&config.out, 0)?;
    }
    Ok(outcome)
}

/// Settings that a live run can carry out; the calibration.
fn check(resolved: &Resolved, config: &TrackConfig) -> Result<PathBuf, Error> {
    let observed = [KEYPOINTS.key, SILHOUETTES.key, IMAGES.key, INIT.key];
    let later = [FRAMES.key, SETUP_FRAMES.key, TRIM.key, LAG.key, SMOOTH.key];
    if let Some(setting) = observed.into_iter().chain(later).find(|key| resolved.is_given(key)) {
        return Err(LiveError::OfFiles(setting).into());
    }
    config.calibration.clone().ok_or(Error::NothingToTrack { calibration: false, observation: true })
}

/// Posts what is known of a frame.
struct Tracking<'a> {
    answering: &'a Answering,
    queue: &'a Queue,
}

impl Answers for Tracking<'_> {
    fn begin(&mut self, info: &RunInfo) {
        self.answering.post(answer::begin(info));
    }

    fn frame(&mut self, estimate: &FrameEstimate) {
        let skipped = self.queue.state().skipped;
        self.answering.post_at_once(answer::frame(estimate, skipped));
    }
}
