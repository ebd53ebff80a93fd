//! A simulated recording as a source of frames.

use sinew::input::in_memory::InMemory;
use sinew_simulate::recording::SyntheticRecording;

/// The keypoints of a recording.
#[must_use]
pub fn source(recording: &SyntheticRecording) -> InMemory {
    let SyntheticRecording { cameras, layout, keypoints, .. } = recording.clone();
    InMemory { cameras, layout, keypoints }
}
