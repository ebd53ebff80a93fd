//! The settings of a tracking run as one plain value: what is tracked, from where and to where. How it is tracked is in [`super::settings`].

use super::common::*;
use super::resolved::Resolved;
use crate::Error;
use crate::methods::About;
use sinew_input::footage::{Footage, FootageFiles, Init};
use sinew_input::recording::RecordingOptions;
use sinew_input::recording::given::GivenRecording;
use sinew_setup::KnownSetup;
use sinew_setup::shared_cameras::SharedCameras;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is tracked, from where and to where. A field without a description holds the value of the setting of its name.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the help of a setting says what it is")]
pub struct TrackConfig {
    pub calibration: Option<PathBuf>,
    pub keypoints: Option<PathBuf>,
    /// Cameras and keypoints in memory, in place of these two.
    pub given: Option<Arc<GivenRecording>>,
    pub silhouettes: Option<PathBuf>,
    pub images: Option<PathBuf>,
    pub mask_scale: Option<f64>,
    pub init: Option<Init>,
    /// What to take from the recording.
    pub recording: RecordingOptions,
    /// Frames per second, where they are given; else [`ASSUMED_FPS`] are assumed ([`TrackConfig::fps`]).
    pub fps: Option<f64>,
    pub any_size: bool,
    pub people: People,
    /// Number of the person to track, from 1 on.
    pub person: Option<usize>,
    pub subject: Option<String>,
    pub up_axis: Option<String>,
    pub up: Option<String>,
    pub body: String,
    pub setup: Option<PathBuf>,
    /// What that file holds, where it was read before.
    pub known_setup: Option<Arc<KnownSetup>>,
    /// Cameras that other recordings share.
    pub shared_cameras: Option<Arc<SharedCameras>>,
    pub setup_frames: Option<Range<u64>>,
    /// Result folder of a standing trial.
    pub standing: Option<PathBuf>,
    pub smooth: bool,
    pub lag_frames: u64,
    pub method: &'static About,
    pub seed: u64,
    pub threads: Option<usize>,
    /// Where diagnostics fail.
    pub limits: sinew_results::Limits,
    pub out: PathBuf,
    /// Seconds.
    pub checkpoint_every: f64,
    pub force: bool,
}

impl Resolved {
    /// The settings of a tracking run.
    #[must_use]
    pub fn track(&self) -> TrackConfig {
        let trial = self.trial_folder().and_then(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
        let default_out = || Path::new("sinew-out").join(trial.unwrap_or_else(|| "trial".into()));
        TrackConfig {
            calibration: self.of(&CALIBRATION),
            keypoints: self.of(&KEYPOINTS),
            given: self.given.clone(),
            silhouettes: self.of(&SILHOUETTES),
            images: self.of(&IMAGES),
            mask_scale: self.of(&MASK_SCALE),
            init: self.of(&INIT),
            recording: RecordingOptions {
                layout: self.of(&LAYOUT),
                confidence_scale: self.of(&CONFIDENCE_SCALE),
                image_scale: self.of(&IMAGE_SCALE),
                frames: self.of(&FRAMES),
                cameras: self.of(&CAMERAS),
                trim: self.of(&TRIM),
                lag: self.of(&LAG).unwrap_or_default(),
                read_before: Arc::clone(&self.read_before),
            },
            fps: self.of(&FPS),
            any_size: self.of(&ANY_SIZE),
            person: self.of(&PERSON),
            people: self.of(&PEOPLE),
            subject: self.of(&SUBJECT),
            up_axis: self.of(&UP_AXIS),
            up: self.of(&UP),
            body: self.of(&BODY),
            setup: self.of(&SETUP),
            known_setup: self.known_setup.clone(),
            shared_cameras: self.shared_cameras.clone(),
            setup_frames: self.of(&SETUP_FRAMES),
            standing: self.of(&STATIC),
            smooth: self.of(&SMOOTH),
            lag_frames: self.of(&LAG_FRAMES),
            method: self.method(),
            seed: self.of(&SEED),
            threads: self.of(&THREADS),
            limits: sinew_results::Limits {
                r_hat: self.of(&MAX_R_HAT),
                r_hat_share: self.of(&MAX_R_HAT_SHARE),
                divergent_share: self.of(&MAX_DIVERGENT_SHARE),
                ess: self.of(&MIN_ESS),
            },
            out: self.of(&OUT).unwrap_or_else(default_out),
            checkpoint_every: self.of(&CHECKPOINT_EVERY),
            force: self.of(&FORCE),
        }
    }
}

impl TrackConfig {
    /// The recording, open, with the calibration file that was named or found.
    ///
    /// # Errors
    /// Files that cannot be read or do not fit.
    pub fn footage(&self, calibration: &Path) -> Result<Footage<'static>, Error> {
        let files = FootageFiles {
            calibration,
            keypoints: self.keypoints.as_deref(),
            given: self.given.as_deref(),
            silhouettes: self.silhouettes.as_deref(),
            images: self.images.as_deref(),
            mask_scale: self.mask_scale,
            init: self.init.as_ref(),
            has_setup: self.setup.is_some(),
            needs_gradients: self.method.needs_gradients.then_some(self.method.name),
        };
        Ok(Footage::open(&files, &self.recording)?)
    }

    /// Frames per second, given or assumed.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.fps.unwrap_or(ASSUMED_FPS)
    }
}
