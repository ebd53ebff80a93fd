//! The set-up pass: everything that tracking needs to know before the first frame.
//!
//! [`set_up`] reads the people of some frames once, in order, and returns a [`Setup`], one plain value that is saved as `setup.toml`:
//!
//! 1. the tracked person is found by agreement of the cameras and followed ([`sinew_observe::association`]); of what he shows, an evenly spaced part is kept;
//! 2. one constant offset and the scatter of the detections, camera by camera, before any pose is known ([`sinew_observe::offsets`]);
//! 3. points in space, from which the sizes of the subject and the poses of the frames follow ([`sinew_body::subject`]);
//! 4. the model error: joints of the body are not keypoints of a detector ([`shape`]);
//! 5. the pose of the first frame.
//!
//! With one camera there are no points in space: offsets stay 0, the body keeps its default sizes, and the pose is fitted to pixels, its depth told by the size of
//! the body ([`one_camera`]).

mod collect;
pub mod one_camera;
pub mod shape;
mod stored;
mod warning;

pub use collect::{Collected, Request, collect};
pub use stored::{Body, CameraSetup, Setup};
pub use warning::Warning;

use crate::Error;
use sinew_formats::Layout;
use sinew_formats::openpose::Person;
use sinew_observe::association::Person as Pixels;
use sinew_observe::offsets::{self, CameraNoise};
use sinew_observe::{Camera, Detection};

/// A frame's people, camera by camera, as the keypoint reader gives them, in the form that association takes.
#[must_use]
pub fn detections(people: &[Vec<Person>]) -> Vec<Vec<Pixels>> {
    let person = |person: &Person| {
        let detection = |k: sinew_formats::openpose::Keypoint| Detection { pixel: [k.x, k.y], confidence: k.confidence };
        person.keypoints.iter().map(|k| k.map(detection)).collect()
    };
    people.iter().map(|people| people.iter().map(person).collect()).collect()
}

/// Sets up the tracking of a person in calibrated cameras from the frames of an iterator (number, people of each camera), which must come in order.
///
/// # Errors
/// Those of the iterator; no person found; a person behind the cameras.
pub fn set_up(
    cameras: &[Camera],
    layout: &Layout,
    request: &Request,
    frames: impl IntoIterator<Item = Result<(u64, Vec<Vec<Pixels>>), Error>>,
) -> Result<(Setup, Vec<Warning>), Error> {
    let collected = collect(cameras, layout, request, frames)?;
    let mut warnings = vec![];
    let noise = offsets::estimate(cameras, &collected.sighted(), &request.offsets);
    let shape = shape::measure(cameras, layout, request, &noise, &collected, &mut warnings)?;
    let setup = Setup {
        schema: stored::SCHEMA,
        body: request.body,
        layout: layout.name.clone(),
        person: request.person,
        up_axis: shape.up_axis.into(),
        model_error_m: shape.model_error_m,
        start_frame: shape.start_frame,
        start_pose: shape.start_pose,
        step_size: None,
        leapfrog_steps: None,
        motion_sd: None,
        proportions: shape.proportions,
        camera: cameras.iter().zip(&noise).map(|(camera, n)| camera_setup(camera, n, &noise)).collect(),
    };
    Ok((setup, warnings))
}

/// Scatter assumed where nothing was seen and nothing can be borrowed, pixels.
const UNKNOWN_SIGMA_PX: f64 = 10.0;

fn camera_setup(camera: &Camera, noise: &CameraNoise, all: &[CameraNoise]) -> CameraSetup {
    let usual = |of: fn(&CameraNoise) -> f64, otherwise: f64| {
        let own = of(noise);
        if own.is_finite() {
            return own;
        }
        let mut known: Vec<f64> = all.iter().map(of).filter(|x| x.is_finite()).collect();
        if known.is_empty() { otherwise } else { offsets::median(&mut known) }
    };
    CameraSetup {
        name: camera.name.clone(),
        offset_px: noise.offset_px,
        sigma_px: usual(|n| n.sigma_px, UNKNOWN_SIGMA_PX),
        usual_confidence: usual(|n| n.usual_confidence, 0.7),
    }
}
