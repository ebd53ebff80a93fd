//! A synthetic recording: truth, cameras and what a detector saw.
//!
//! In memory, and as the text of the files that `sinew track` and other programs read.

use crate::calibration_error::{CalibrationError, as_they_are, lags_frames};
use crate::detector::{Detections, DetectorNoise, detect};
use crate::ring::{Ring, around};
use crate::walker::{Gait, Walker, walker_states};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_body::{KinematicTree, Proportions};
use sinew_core::random::Stage;
use sinew_formats::openpose::Keypoint;
use sinew_formats::{Layout, calib_toml, layout, trc};
use sinew_observe::{Camera, Error};
use std::fmt::Write as _;
use std::io;

/// What to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Duration, seconds; the first is spent standing still.
    pub duration_s: f64,
    /// Frames per second.
    pub rate_hz: f64,
    /// Size of the walker.
    pub proportions: Proportions,
    /// Cameras.
    pub ring: Ring,
    /// How far cameras are from their calibration.
    pub calibration: CalibrationError,
    /// Errors of the detector.
    pub noise: DetectorNoise,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            duration_s: 4.0,
            rate_hz: 30.0,
            proportions: Proportions::default(),
            ring: Ring::default(),
            calibration: CalibrationError::NONE,
            noise: DetectorNoise::DETECTOR_LIKE,
        }
    }
}

/// A person walks through virtual cameras, and everything is known.
#[derive(Clone, Debug, PartialEq)]
pub struct SyntheticRecording {
    /// Body of the person, H32.
    pub body: KinematicTree,
    /// True state of the body in each frame.
    pub states: Vec<Vec<f64>>,
    /// True positions of all points of the body.
    pub truth: Trajectories,
    /// Cameras, as their calibration has them.
    pub cameras: Vec<Camera>,
    /// True constant offset of each camera's detections, pixels.
    pub offsets_px: Vec<[f64; 2]>,
    /// How late each camera's clock is, frames.
    pub lags_frames: Vec<f64>,
    /// Layout of the keypoints, BODY_25B.
    pub layout: Layout,
    /// For each camera, frame and point of the layout, the detected keypoint.
    pub keypoints: Vec<Vec<Vec<Option<Keypoint>>>>,
    /// Frames per second.
    pub rate_hz: f64,
}

/// The walker of a script: body, states and where its points are.
fn walk(script: &Script) -> (KinematicTree, Vec<Vec<f64>>, Trajectories) {
    let gait = Gait { duration_s: script.duration_s, proportions: script.proportions, ..Gait::default() };
    let walker = Walker::new(gait);
    let states = walker_states(&walker, script.rate_hz);
    let truth = points_of_states(&walker.body, &states);
    (walker.body, states, truth)
}

impl SyntheticRecording {
    /// Records the walker of a script; the same seed gives the same recording on every machine.
    ///
    /// # Errors
    /// As [`around`]: a ring whose numbers are not finite and positive.
    pub fn new(script: &Script, seed: u64) -> Result<Self, Error> {
        let (body, states, truth) = walk(script);
        Self::from_motion(body, states, truth, script, seed)
    }

    /// Records the walker of a script before the cameras of a session, whose differences from their calibration come from the session's seed.
    #[must_use]
    pub fn in_session(script: &Script, cameras: &[Camera], session_seed: u64, seed: u64) -> Self {
        let (body, states, truth) = walk(script);
        Self::before(cameras.to_vec(), session_seed, (body, states, truth), script, seed)
    }

    /// Records any motion of a body: `truth` holds the points that the detector sees and that estimates are compared with, either the points of the body in its states or
    /// recorded joints that the body only follows. Duration and proportions of the script do not matter.
    ///
    /// # Errors
    /// As [`around`].
    pub fn from_motion(
        body: KinematicTree,
        states: Vec<Vec<f64>>,
        truth: Trajectories,
        script: &Script,
        seed: u64,
    ) -> Result<Self, Error> {
        Ok(Self::before(around(&truth, &script.ring)?, seed, (body, states, truth), script, seed))
    }

    fn before(
        cameras: Vec<Camera>,
        cameras_seed: u64,
        (body, states, truth): (KinematicTree, Vec<Vec<f64>>, Trajectories),
        script: &Script,
        seed: u64,
    ) -> Self {
        let layout = body_25b();
        let stage = Stage::new(seed, "synthetic recording");
        let true_cameras = as_they_are(&cameras, &script.calibration, &Stage::new(cameras_seed, "calibration"));
        let lags_frames = lags_frames(cameras.len(), &script.calibration, &Stage::new(seed, "lags"));
        let Detections { offsets_px, keypoints } =
            detect(&truth, &layout, (&true_cameras, &lags_frames), &script.noise, stage);
        let rate_hz = script.rate_hz;
        Self { body, states, truth, cameras, offsets_px, lags_frames, layout, keypoints, rate_hz }
    }

    /// The calibration as text of `Calib.toml`.
    #[must_use]
    pub fn calibration_toml(&self) -> String {
        calib_toml::write(&self.cameras)
    }

    /// Name, below the folder of keypoints, and text of every keypoint file: `C1_json/C1.0000.json`, ….
    pub fn keypoint_files(&self) -> impl Iterator<Item = (String, String)> + '_ {
        keypoint_files(&self.cameras, &self.keypoints)
    }

    /// Writes the true points as TRC.
    ///
    /// # Errors
    /// Errors of the stream.
    pub fn write_truth_trc(&self, out: &mut impl io::Write) -> io::Result<()> {
        write_trc(out, "truth.trc", &self.truth, self.rate_hz)
    }
}

/// Name, below the folder of keypoints, and text of the keypoint files of some cameras, each with its frames.
pub fn keypoint_files<'a>(
    cameras: &'a [Camera],
    keypoints: &'a [Vec<Vec<Option<Keypoint>>>],
) -> impl Iterator<Item = (String, String)> + 'a {
    cameras.iter().zip(keypoints).flat_map(|(camera, frames)| {
        let name = &camera.name;
        frames.iter().enumerate().map(move |(f, keypoints)| {
            (format!("{name}_json/{name}.{f:04}.json"), keypoint_json(&[keypoints.as_slice()]))
        })
    })
}

/// Layout of the keypoints, BODY_25B.
#[must_use]
pub fn body_25b() -> Layout {
    layout::find("BODY_25B").unwrap_or(Layout { name: "BODY_25B".into(), points: Vec::new() })
}

/// Text of an OpenPose-style keypoint file of some people; a missing keypoint is `0, 0, 0`.
#[must_use]
pub fn keypoint_json(people: &[&[Option<Keypoint>]]) -> String {
    let mut text = String::from("{\"version\": 1.3, \"people\": [");
    for (i, keypoints) in people.iter().enumerate() {
        text.push_str(if i == 0 { "{\"pose_keypoints_2d\": [" } else { ", {\"pose_keypoints_2d\": [" });
        for (k, keypoint) in keypoints.iter().enumerate() {
            let separator = if k == 0 { "" } else { ", " };
            let (x, y, c) = keypoint.map_or((0.0, 0.0, 0.0), |point| (point.x, point.y, point.confidence));
            // Writing to a String cannot fail.
            let _ = write!(text, "{separator}{x}, {y}, {c}");
        }
        text.push_str("]}");
    }
    text.push_str("]}\n");
    text
}

/// Writes trajectories as TRC; frames count from 1, time from 0.
///
/// # Errors
/// Errors of the stream.
pub fn write_trc(out: &mut impl io::Write, file_name: &str, motion: &Trajectories, rate_hz: f64) -> io::Result<()> {
    let header = trc::Header::new(file_name, rate_hz, motion.names.clone());
    let count = u32::try_from(motion.frames.len()).map_err(io::Error::other)?;
    trc::write_header(out, &header, count)?;
    for (frame, number) in motion.frames.iter().zip(1_i64..) {
        let points: Vec<_> = frame.iter().map(|&point| Some(trc::trc_from_world(point))).collect();
        trc::write_frame(out, number, (number - 1) as f64 / rate_hz, &points)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::pixel;
    use sinew_formats::openpose;

    #[test]
    fn the_subject_is_inside_all_views_in_every_frame() {
        for duration_s in [1.0, 4.0, 8.0] {
            let recording = SyntheticRecording::new(&Script { duration_s, ..Script::default() }, 1).unwrap();
            for camera in &recording.cameras {
                for (f, frame) in recording.truth.frames.iter().enumerate() {
                    for (name, &point) in recording.truth.names.iter().zip(frame) {
                        let [u, v] = pixel(camera, point).unwrap();
                        let inside = (0.0..1280.0).contains(&u) && (0.0..960.0).contains(&v);
                        assert!(inside, "{name} is at ({u}, {v}) in {} frame {f} of {duration_s} s", camera.name);
                    }
                }
            }
        }
    }

    #[test]
    fn recordings_of_a_session_have_the_same_cameras_and_other_detections() {
        let script = Script { duration_s: 1.5, calibration: CalibrationError::USUAL, ..Script::default() };
        let first = SyntheticRecording::new(&script, 5).unwrap();
        assert_eq!(SyntheticRecording::in_session(&script, &first.cameras, 5, 5), first);
        let other = SyntheticRecording::in_session(&script, &first.cameras, 5, 6);
        assert_eq!(other.calibration_toml(), first.calibration_toml());
        assert_ne!(other.keypoints, first.keypoints);
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        let bytes = |seed| {
            let recording = SyntheticRecording::new(&Script { duration_s: 1.5, ..Script::default() }, seed).unwrap();
            let mut bytes = recording.calibration_toml().into_bytes();
            recording.write_truth_trc(&mut bytes).unwrap();
            for (name, text) in recording.keypoint_files() {
                bytes.extend(name.bytes().chain(text.bytes()));
            }
            bytes
        };
        assert!(bytes(1) == bytes(1));
        assert!(bytes(1) != bytes(2));
    }

    #[test]
    fn files_hold_what_memory_holds() {
        let recording = SyntheticRecording::new(&Script { duration_s: 1.2, ..Script::default() }, 3).unwrap();
        let files: Vec<_> = recording.keypoint_files().collect();
        assert_eq!((files.len(), files[0].0.as_str()), (4 * 36, "C1_json/C1.0000.json"));
        let options =
            openpose::OpenposeOptions { layout: Some(&recording.layout), ..openpose::OpenposeOptions::default() };
        let memory = recording.keypoints.iter().flatten();
        for ((name, text), expected) in files.iter().zip(memory) {
            let frame = openpose::read(name, text, &options).unwrap();
            assert_eq!(&frame.people[0].keypoints, expected);
        }
        let calibration = calib_toml::read("Calib.toml", &recording.calibration_toml()).unwrap();
        assert_eq!(calibration.warnings, []);
        assert_eq!(calibration.cameras.len(), 4);
        let mut file = Vec::new();
        recording.write_truth_trc(&mut file).unwrap();
        let truth = trc::read("truth.trc", std::str::from_utf8(&file).unwrap()).unwrap();
        let head = truth.marker_index("Head").unwrap();
        let point = truth.point_in_world(30, head).unwrap();
        let column = recording.truth.index("Head").unwrap();
        assert_eq!(point, recording.truth.frames[30][column]);
    }

    #[test]
    fn people_are_listed_in_one_file() {
        let point = Some(Keypoint { x: 1.5, y: 2.0, confidence: 0.5 });
        let text = keypoint_json(&[&[point, None], &[]]);
        assert_eq!(
            text,
            "{\"version\": 1.3, \"people\": [{\"pose_keypoints_2d\": [1.5, 2, 0.5, 0, 0, 0]}, {\"pose_keypoints_2d\": []}]}\n"
        );
    }
}
