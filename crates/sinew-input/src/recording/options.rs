//! What to take from a recording.

use super::read_frames::ReadFrames;
use crate::lag::ClockLag;
use std::ops::Range;
use std::sync::Arc;

/// What to take from a recording.
#[derive(Clone, Debug)]
pub struct RecordingOptions {
    /// Name of a layout or path of a mapping file; guessed if `None`.
    pub layout: Option<String>,
    /// Confidence that means certainty.
    pub confidence_scale: f64,
    /// Size of the images over that of the calibrated ones.
    pub image_scale: f64,
    /// Frames to take, by number; all if `None`.
    pub frames: Option<Range<u64>>,
    /// Cameras to take, by name; all if `None`.
    pub cameras: Option<Vec<String>>,
    /// Whether cameras may begin and end apart.
    pub trim: bool,
    /// How late cameras are: frame f of such a camera is in its file numbered f + lag, or between two files. Beginnings and ends that differ by lags are trimmed.
    pub lag: Vec<(String, ClockLag)>,
    /// What was read before, by this recording or another one of the same files.
    pub read_before: Arc<ReadFrames>,
}

impl Default for RecordingOptions {
    fn default() -> Self {
        Self {
            layout: None,
            confidence_scale: 1.0,
            image_scale: 1.0,
            frames: None,
            cameras: None,
            trim: false,
            lag: vec![],
            read_before: Arc::default(),
        }
    }
}
