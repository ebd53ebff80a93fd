//! What is noted of a frame once it is tracked, until it is described.

use super::scene::Shown;
use sinew_observe::Detection;
use sinew_tracking::StepInfo;

/// What a frame's description needs beside its draws.
pub(super) struct Noted {
    /// Number of the frame.
    pub number: u64,
    /// What the tracker says.
    pub info: StepInfo,
    /// What the frame shows.
    pub shown: Shown,
    /// Cameras whose masks show the person.
    pub silhouettes: usize,
}

impl Noted {
    /// What was seen of the person ([`sinew_results::estimate::FrameEstimate::seen`]).
    pub(super) fn seen(&self) -> Vec<[f64; 3]> {
        let one = |d: &Option<Detection>| d.map_or([f64::NAN; 3], |d| [d.pixel[0], d.pixel[1], d.confidence]);
        self.shown.detections.iter().flatten().map(one).collect()
    }

    /// Cameras that saw the person.
    pub(super) fn cameras(&self) -> usize {
        let by_keypoints = self.shown.detections.iter().filter(|points| points.iter().any(Option::is_some)).count();
        by_keypoints.max(self.silhouettes)
    }
}
