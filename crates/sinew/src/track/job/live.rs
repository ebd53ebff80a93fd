//! A run on frames that come while they are tracked.
//!
//! ```text
//! set-up ──▶ wait for a frame ──▶ track it, and those before it that never came ──▶ answer ──▶ result folder
//!                   ▲                                                                               │
//!                   └───────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! With a fixed lag a frame is answered and written when that number of frames has come after it, and the last ones at the end.
//!
//! Every frame is recorded before the next one is waited for, and answered before it is written. A frame that did not come is tracked as one that no camera saw, so that the
//! motion prior takes its step and the results have every number. The source does not come again, so there are no checkpoints. The end of the source or an
//! interrupt completes the results.

use super::begin::{Begun, begun};
use super::ending::{Clock, Finish, Outcome};
use super::inputs::file_hashes;
use super::keeper::Keeper;
use super::run_info::run_info;
use super::watch::Watch;
use crate::Error;
use crate::config::Resolved;
use crate::input::source::FrameSource;
use crate::track::pipeline::{KeepFrames, Pipeline};
use sinew_results::estimate::{FrameEstimate, RunInfo};
use sinew_results::{Claim, ResultFolder};
use sinew_tracking::posterior::Posterior;
use std::ops::{ControlFlow, Range};

/// A source whose frames come while they are tracked.
pub trait Arrivals: FrameSource {
    /// Waits for the next frame and gives its number, which rises; none at the end of the source.
    fn arrive(&mut self) -> Option<u64>;

    /// Hears how many frames that never came were tracked before the one that arrived last.
    fn bridged(&mut self, frames: u64);

    /// Frames since the first that were skipped because others came after them.
    fn skipped(&self) -> u64;
}

/// Takes what is known of each frame as soon as it is.
pub trait Answers {
    /// Before the first frame.
    fn begin(&mut self, info: &RunInfo);
    /// A frame, before it is written.
    fn frame(&mut self, estimate: &FrameEstimate);
}

/// Tracks the frames of a source into a claimed folder until there are no more. The set-up is made from frames that the source has already, if it is not given.
///
/// # Errors
/// As [`super::track`]; `Ok(None)` where no frame came.
pub fn track_live<S: Arrivals>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    watch: &mut Watch<'_>,
    answers: &mut dyn Answers,
) -> Result<Option<Outcome>, Error> {
    let mut clock = Clock::started();
    let config = resolved.track();
    let settings = resolved.settings()?;
    let of_settings = file_hashes(resolved)?;
    ResultFolder::refuse_others(&claim)?;
    let Begun { mut source, setup, checkpoint, .. } = begun(source, setup_frames, resolved, &config, &settings, watch)?;
    let (tree, cameras) = (setup.tree(), source.cameras().to_vec());
    let mut pipeline = Pipeline::new(&setup, &tree, &cameras, source.layout(), settings.clone())?;
    clock.set_up_is_done();
    let Some(first) = source.source_mut().arrive() else { return Ok(None) };
    ResultFolder::begin(&claim)?;
    let info = run_info(&config, &settings, &setup, &pipeline, cameras, first, checkpoint.setup_toml.clone());
    answers.begin(&info);
    let mut keeper = Keeper::open(claim, info, checkpoint, &config, &pipeline)?;
    let (mut next, mut arrived, mut tracked) = (first, Some(first), Ok(()));
    while let (Some(number), false) = (arrived, watch.is_stopped()) {
        let mut kept = 0;
        let answering = Answering { keeper: &mut keeper, answers, watch, kept: &mut kept };
        tracked = pipeline.track(source.source_mut(), next..number + 1, answering);
        source.source_mut().bridged(kept.min(number - next));
        if tracked.is_err() {
            break;
        }
        next = number + 1;
        arrived = source.source_mut().arrive();
    }
    if tracked.as_ref().is_err_and(|error| keeper.checkpoint.done == 0 || error.file().is_some()) {
        return tracked.map(|()| None);
    }
    keeper.take_rest(|estimate| answers.frame(estimate))?;
    clock.tracking_is_done();
    let Keeper { results, checkpoint, .. } = keeper;
    let done = checkpoint.done;
    let skipped = source.source_mut().skipped();
    let complete = tracked.is_ok() && skipped == 0;
    let finish = Finish { complete, skipped, warnings: checkpoint.warnings, before: 0, done };
    let summary = finish.summary(results, &pipeline, &of_settings, &source, &config, &clock)?;
    tracked?;
    let ms_per_frame = clock.ms_per_frame(done);
    Ok(Some(Outcome { summary, ms_per_frame, body: tree, girth: setup.girth, colours: None }))
}

/// Answers each frame, then keeps it.
struct Answering<'a, 'w> {
    keeper: &'a mut Keeper,
    answers: &'a mut dyn Answers,
    watch: &'a Watch<'w>,
    kept: &'a mut u64,
}

impl KeepFrames for Answering<'_, '_> {
    fn seed(&mut self, seed: u64) {
        self.keeper.seed(seed);
    }

    fn known(&mut self, estimate: &FrameEstimate) {
        if !self.keeper.is_late() {
            self.answers.frame(estimate);
        }
    }

    fn keep(&mut self, estimate: FrameEstimate, _: &Posterior<'_>) -> Result<(), Error> {
        let Self { keeper, answers, kept, .. } = self;
        **kept += 1;
        let is_late = keeper.is_late();
        keeper.take(estimate, |estimate| {
            if is_late {
                answers.frame(estimate);
            }
        })
    }

    /// An interrupt ends the run in a gap, too.
    fn flow(&mut self) -> ControlFlow<()> {
        self.watch.flow()
    }
}
