//! Cameras that are late: what they show is put on time.

use crate::setup::Setup;
use sinew_observe::clocks::on_time::on_time;
use sinew_observe::clocks::point_velocity::RunningVelocities;
use sinew_observe::{Camera, Detection, View};
use sinew_results::problem::{Problem, check_length};

/// How late each camera is, and how the keypoints move: a late camera shows them where they were.
pub(super) struct Clocks {
    lags_s: Vec<f64>,
    velocities: RunningVelocities,
}

impl Clocks {
    /// The clocks of a set-up's cameras, before keypoints that stand still, in frames at `fps` a second.
    pub(super) fn new(setup: &Setup, cameras: &[Camera], keypoints: usize, fps: f64) -> Self {
        let lags_s = cameras.iter().map(|camera| setup.lag_s(camera)).collect();
        Self { lags_s, velocities: RunningVelocities::new(keypoints, fps.recip()) }
    }

    /// Whether no camera is late.
    pub(super) fn are_right(&self) -> bool {
        self.lags_s.iter().all(|lag| *lag == 0.0)
    }

    /// Moves what late cameras show to where the keypoints have gone since, if they are at these places.
    pub(super) fn correct(&self, detections: &mut [Vec<Option<Detection>>], views: &[View], points: &[f64]) {
        for ((seen, view), lag) in detections.iter_mut().zip(views).zip(&self.lags_s) {
            *seen = on_time(&view.camera, seen, points, self.velocities.known(), *lag);
        }
    }

    /// Takes in where the keypoints are in a frame that was tracked.
    pub(super) fn note(&mut self, points: &[f64], restarted: bool) {
        if restarted {
            self.velocities.restart();
        }
        self.velocities.next(points);
    }

    pub(super) fn save(&self) -> Vec<f64> {
        self.velocities.save()
    }

    /// Takes up what was saved; nothing moves before the first frame.
    pub(super) fn restore(&mut self, saved: &[f64]) -> Result<(), Problem> {
        check_length(saved.len(), if saved.is_empty() { 0 } else { self.velocities.saved() })?;
        if !saved.is_empty() {
            self.velocities.restore(saved);
        }
        Ok(())
    }
}
