//! A simulated recording as a source of frames, and its set-up.

use sinew::Error;
use sinew::input::in_memory::InMemory;
use sinew::input::source::FrameSource as _;
use sinew::setup::{self, Setup, SetupRequest};
use sinew_simulate::recording::SyntheticRecording;

/// The keypoints of a recording.
#[must_use]
pub fn source(recording: &SyntheticRecording) -> InMemory {
    let SyntheticRecording { cameras, layout, keypoints, .. } = recording.clone();
    InMemory { cameras, layout, keypoints }
}

/// The set-up of a recording from all its frames, with its motion and with what lasts.
///
/// # Errors
/// Nobody in the frames, or calibrations that do not fit.
pub fn set_up(source: &mut InMemory, request: &SetupRequest, fps: f64, seed: u64) -> Result<Setup, Error> {
    let (cameras, layout, frames) = (source.cameras.clone(), source.layout.clone(), source.frames());
    let people: Vec<_> = frames.clone().map(|number| Ok::<_, Error>((number, source.people(number)?))).collect();
    let (mut setup, _) = setup::set_up(&cameras, &layout, request, people)?;
    let tree = setup.tree();
    setup.motion_sd = Some(setup::measure_motion(&setup, &tree, source, frames.clone(), fps)?);
    setup::measure_lasting(&mut setup, source, frames, fps, seed)?;
    Ok(setup)
}
