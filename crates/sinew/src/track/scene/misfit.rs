//! How badly a pose fits the keypoints of a frame, and a pose that fits them better.

use super::{Scene, WORST};
use crate::setup;
use sinew_body::half_turns::half_turned;
use sinew_core::density::LogDensity as _;
use sinew_observe::cameras::offsets::Sighted;

/// What a half turn of a limb must gain, nats: a hinge 5° beyond its range loses as much.
const TURN_GAIN: f64 = 0.125;

impl Scene {
    /// A pose that fits what is seen clearly better than one of that misfit; the pose of the set-up counts where the person was away. A limb that is turned by half a turn about itself and bends
    /// backward fits as well, so limits of joints count, too.
    pub(super) fn better_pose(&self, people: &Sighted, estimate: &[f64], away: bool, misfit: f64) -> Option<Vec<f64>> {
        let fitted = |former| setup::pose_of(&self.setup, &self.cameras, &self.layout, people, former);
        let start = &self.setup.start_pose;
        let known = if away { Some(start.clone()) } else { None };
        [known, fitted(None), fitted(Some(estimate)), fitted(Some(start))]
            .into_iter()
            .flatten()
            .filter(|pose| pose.len() == estimate.len())
            .map(|pose| (self.misfit_within_limits(&pose), pose))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(better, _)| *better < 0.7 * misfit)
            .map(|(_, pose)| pose)
    }

    /// The estimate with those limbs turned by half a turn about themselves that bend backward, where that explains the frame better.
    ///
    /// A limb that hangs straight may turn either way, and what it bent by was chance. The path with the limb turned in every frame is as likely under a walk in its angles and shows the same points, so
    /// that limits alone tell the two apart.
    pub(super) fn turned_back(&self, estimate: &[f64]) -> Option<Vec<f64>> {
        let loss = |pose: &[f64]| 0.5 * self.squares(pose)[0] - self.limits.log_density(pose);
        if self.limits.log_density(estimate) > -TURN_GAIN {
            return None;
        }
        let (mut best, before) = (estimate.to_vec(), loss(estimate));
        let mut least = before;
        for &limb in &self.half_turns {
            let turned = half_turned(&best, limb);
            let after = loss(&turned);
            if after < least - TURN_GAIN {
                (best, least) = (turned, after);
            }
        }
        (least < before).then_some(best)
    }

    /// How badly a pose fits the keypoints of the current frame, exchanged sides put right; 0 without any.
    pub(super) fn misfit(&self, state: &[f64]) -> f64 {
        let [sum, count] = self.squares(state);
        sum / count
    }

    /// The same with the squares of how far joints are beyond their limits.
    fn misfit_within_limits(&self, state: &[f64]) -> f64 {
        let [sum, count] = self.squares(state);
        (sum - 2.0 * self.limits.log_density(state)) / count
    }

    /// Sum of squared distances of the keypoints from a pose, in noise variances, and their number, at least 1.
    fn squares(&self, state: &[f64]) -> [f64; 2] {
        let points = self.points(state);
        let (expected, straight) = (self.expected(&points), self.model.straight(&self.frame(&points)));
        let (mut sum, mut count) = (0.0, 0.0);
        for ((view, seen), expected) in self.model.views.iter().zip(&straight).zip(&expected) {
            for (d, e) in seen.iter().zip(expected) {
                let Some(d) = d else { continue };
                let square = e.map_or(f64::INFINITY, |e| (d.pixel[0] - e[0]).powi(2) + (d.pixel[1] - e[1]).powi(2));
                sum += (square / view.sigma_px.powi(2)).min(WORST);
                count += 1.0;
            }
        }
        [sum, f64::max(count, 1.0)]
    }
}
