//! A walker before four cameras whose clocks are set, as files.
//!
//! The walk is sampled finely (`FINE_HZ`); each camera shows it at the times of its own clock, interpolated on that grid, so that lags are exact whatever the frame rate.

use crate::support::outcome::Outcome;
use crate::support::program::write_recording;
use sinew::core::random::Stage;
use sinew::formats::calib_toml;
use sinew_body::points::{Trajectories, points_of_states};
use sinew_simulate::calibration_error::{CalibrationError, as_they_are};
use sinew_simulate::detector::{DetectorNoise, detect};
use sinew_simulate::recording::{body_25b, keypoint_files, write_trc};
use sinew_simulate::ring::{Ring, around};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::path::Path;

/// Samples of the walk in a second, at least; times of frames are among them.
const FINE_HZ: f64 = 960.0;
/// Cameras.
pub(super) const CAMERAS: usize = 4;

/// How the clocks of four cameras run: frames that each is late in frame 0, and frames that it falls behind in a million.
#[derive(Clone, Debug)]
pub(super) struct Clocks {
    pub(super) lags: [f64; CAMERAS],
    pub(super) ppm: [f64; CAMERAS],
}

impl Clocks {
    /// One camera, another for each seed, is late.
    pub(super) fn one_late(seed: u64, lag: f64) -> Self {
        Self { lags: at(seed, lag), ppm: [0.0; CAMERAS] }
    }

    /// One camera, another for each seed, falls behind.
    pub(super) fn one_drifting(seed: u64, ppm: f64) -> Self {
        Self { lags: at(seed, 0.4), ppm: at(seed, ppm) }
    }

    /// Random lags, up to half a frame: clips that were cut to whole frames.
    pub(super) fn random(seed: u64) -> Self {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let lags = std::array::from_fn(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        });
        Self { lags, ppm: [0.0; CAMERAS] }
    }

    /// All in step.
    pub(super) const IN_STEP: Self = Self { lags: [0.0; CAMERAS], ppm: [0.0; CAMERAS] };
}

/// A number for one camera, another for each seed, and 0 for the others.
fn at(seed: u64, number: f64) -> [f64; CAMERAS] {
    std::array::from_fn(|camera| if camera as u64 == seed % CAMERAS as u64 { number } else { 0.0 })
}

/// What is recorded.
pub(super) struct Walk {
    pub(super) seed: u64,
    pub(super) fps: f64,
    pub(super) seconds: f64,
    /// Whether the walker stays on the spot, as on a treadmill.
    pub(super) treadmill: bool,
    pub(super) clocks: Clocks,
}

impl Walk {
    /// Writes Calib.toml, keypoints and truth.trc of the recording.
    pub(super) fn write(&self, folder: &Path) -> Outcome<()> {
        let step = (FINE_HZ / self.fps).ceil();
        // The first second, in which the walker stands, is left out; a margin on both sides, since clocks are late.
        let margin_s = 1.5;
        let gait = Gait { duration_s: self.seconds + 2.0 * margin_s + 1.0, still_s: 0.0, ..Gait::default() };
        let walker = Walker::new(gait);
        let states = walker_states(&walker, step * self.fps);
        let mut fine = points_of_states(&walker.body, &states);
        if self.treadmill {
            stay(&mut fine, &states);
        }
        let frames = (self.seconds * self.fps).round() as usize;
        let at_time = |frame: f64| -> Vec<[f64; 3]> {
            let place = ((frame + margin_s * self.fps) * step).max(0.0);
            let (before, share) = (place.floor() as usize, place.fract());
            let [a, b] = [before, before + 1].map(|k| &fine.frames[k.min(fine.frames.len() - 1)]);
            a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|k: usize| (1.0 - share) * a[k] + share * b[k])).collect()
        };
        let shown = |lag: f64, ppm: f64| Trajectories {
            names: fine.names.clone(),
            // What this camera shows in its frame g, the others show in f with g = f + lag + ppm f.
            frames: (0..frames).map(|own| at_time((own as f64 - lag) / (1.0 + 1e-6 * ppm))).collect(),
        };
        let truth = shown(0.0, 0.0);
        let cameras = around(&truth, &Ring::default())?;
        let error = CalibrationError { lag_frames: 0.0, ..CalibrationError::USUAL };
        let as_they_are = as_they_are(&cameras, &error, &Stage::new(self.seed, "calibration"));
        let mut keypoints = vec![];
        for (index, camera) in as_they_are.iter().enumerate() {
            let motion = shown(self.clocks.lags[index], self.clocks.ppm[index]);
            let stage = Stage::new(self.seed * CAMERAS as u64 + index as u64, "sync");
            let one = std::slice::from_ref(camera);
            keypoints.extend(detect(&motion, &body_25b(), (one, &[]), &noise(), stage).keypoints);
        }
        if folder.exists() {
            std::fs::remove_dir_all(folder)?;
        }
        write_recording(folder, &calib_toml::write(&cameras), "pose", keypoint_files(&cameras, &keypoints))?;
        let mut trc = vec![];
        write_trc(&mut trc, "truth.trc", &truth, self.fps)?;
        Ok(std::fs::write(folder.join("truth.trc"), trc)?)
    }
}

/// A detector whose errors last for some frames, with a bias of each keypoint in each camera.
fn noise() -> DetectorNoise {
    DetectorNoise { bias_px: 3.0, persistence: 0.6, swapped: 0.01, ..DetectorNoise::DETECTOR_LIKE }
}

/// Takes the mean way forward away, so that the walker stays on the spot.
fn stay(motion: &mut Trajectories, states: &[Vec<f64>]) {
    let (Some(first), Some(last)) = (states.first(), states.last()) else { return };
    let count = (states.len() - 1).max(1) as f64;
    let step = [0, 1].map(|axis: usize| (last[axis] - first[axis]) / count);
    for (index, frame) in motion.frames.iter_mut().enumerate() {
        for point in frame {
            (point[0], point[1]) = (point[0] - index as f64 * step[0], point[1] - index as f64 * step[1]);
        }
    }
}
