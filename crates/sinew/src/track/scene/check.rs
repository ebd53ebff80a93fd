//! A frame's keypoints held against what the model says of them: what [`Predictive`](sinew_setup::predictive::Predictive) counts.

use super::Scene;
use sinew_core::estimators::mean;
use sinew_observe::cameras::offsets::{CameraNoise, Sighted, point_from_views};
use sinew_observe::cameras::triangulate::Refined;
use sinew_observe::{Camera, Detection};
use sinew_setup::predictive::{LIMBS, Residual};

/// A residual that its own leverage hides says nothing.
const HIDDEN: f64 = 0.9;

/// Left and right.
const SIDES: [&str; 2] = ["L", "R"];

/// A point in space with the cameras that its residuals belong to.
type Met = Option<(Refined, Vec<usize>)>;

impl Scene {
    /// Detections that the likelihood uses.
    fn used(&self, detection: Option<Detection>) -> Option<Detection> {
        let usable =
            |d: &Detection| d.confidence >= self.model.least_confidence && d.pixel.iter().all(|x| x.is_finite());
        detection.filter(usable)
    }

    /// Holds the keypoints of a frame, their sides put right, against its posterior: its mean state and some draws.
    pub(super) fn check(&mut self, number: u64, seen: &Sighted, state: &[f64], draws: &[Vec<f64>]) {
        let points = self.points(state);
        let drawn: Vec<_> = draws.iter().map(|draw| self.expected(&self.points(draw))).collect();
        let cameras = self.model.views.len();
        let met: Vec<[[Met; 2]; 2]> = LIMBS.iter().map(|(_, ends)| self.ends_of(seen, *ends)).collect();
        for c in 0..cameras {
            let residual = |k: usize| {
                let detection = self.used(seen[c][k])?;
                let cameras = seen.iter().filter(|seen| self.used(seen[k]).is_some()).count();
                let at = points.get(3 * k..3 * k + 3)?;
                let sd_px = self.model.variance_px2(c, &detection, cameras, at).sqrt();
                let about = |expected: &Vec<Vec<Option<[f64; 2]>>>| {
                    expected[c][k].map_or([f64::INFINITY; 2], |[u, v]| [detection.pixel[0] - u, detection.pixel[1] - v])
                };
                Residual::of(sd_px, &drawn.iter().map(about).collect::<Vec<_>>())
            };
            let residuals: Vec<Option<Residual>> = (0..self.keypoint.len()).map(residual).collect();
            let view = &self.model.views[c];
            let squares: Vec<f64> = met.iter().flatten().flatten().flatten().flat_map(|m| between(m, c)).collect();
            let mean = mean(&squares) / view.sigma_px.powi(2);
            let disagreement = (!squares.is_empty()).then_some(mean);
            self.predictive.camera(number, c, &residuals, disagreement);
        }
        for (limb, sides) in met.iter().enumerate() {
            let (mut keypoints_m, mut body_m) = (0.0, 0.0);
            for (side, [a, b]) in SIDES.iter().zip(sides) {
                let (Some((a, _)), Some((b, _))) = (a, b) else { continue };
                let Some(body) = self.body_length(LIMBS[limb].1, side, &points) else { continue };
                keypoints_m += unbiased_length(a, b);
                body_m += body;
            }
            self.predictive.limb(limb, keypoints_m, body_m);
        }
    }

    /// Index, among the keypoints of the body, of the one of that name and side.
    fn place(&self, side: &str, name: &str) -> Option<usize> {
        let wanted = format!("{side}{name}");
        self.keypoint.iter().position(|&k| self.layout.points[k].as_deref() == Some(wanted.as_str()))
    }

    /// Both ends of a limb, left and right, in space.
    fn ends_of(&self, seen: &Sighted, ends: [&str; 2]) -> [[Met; 2]; 2] {
        let noise = |view: &sinew_observe::View| CameraNoise::without_offset(view.sigma_px, view.usual_confidence);
        let noise: Vec<CameraNoise> = self.model.views.iter().map(noise).collect();
        let cameras: Vec<Camera> = self.model.views.iter().map(|view| view.camera.clone()).collect();
        let least = self.model.least_confidence;
        SIDES.map(|side| ends.map(|name| point_from_views(&cameras, &noise, seen, self.place(side, name)?, least)))
    }

    /// Length of a limb in the pose whose points are given.
    fn body_length(&self, ends: [&str; 2], side: &str, points: &[f64]) -> Option<f64> {
        let [a, b] = ends.map(|name| self.place(side, name));
        let (a, b) = (points.get(3 * a?..3 * a? + 3)?, points.get(3 * b?..3 * b? + 3)?);
        Some(a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    }
}

/// Squared residuals of a point in a camera, square pixels, each divided by the share of its variance that it shows.
fn between((point, used): &(Refined, Vec<usize>), camera: usize) -> Vec<f64> {
    let Some(i) = used.iter().position(|c| *c == camera) else { return vec![] };
    let Some(residual) = point.residual_px[i] else { return vec![] };
    let axes = residual.iter().zip(point.leverage[i]).filter(|(_, h)| *h < HIDDEN);
    axes.map(|(r, h)| r * r / (1.0 - h)).collect()
}

/// Distance of two points less what their errors add to it: half the variance across it over the distance.
fn unbiased_length(a: &Refined, b: &Refined) -> f64 {
    let along: [f64; 3] = std::array::from_fn(|i| a.point[i] - b.point[i]);
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let covariance = |i: usize, j: usize| a.covariance[i][j] + b.covariance[i][j];
    let trace: f64 = (0..3).map(|i| covariance(i, i)).sum();
    let ahead: f64 =
        (0..9).map(|ij| along[ij / 3] * covariance(ij / 3, ij % 3) * along[ij % 3]).sum::<f64>() / (length * length);
    length - 0.5 * (trace - ahead) / length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(at: [f64; 3], sd: [f64; 3]) -> Refined {
        let covariance = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { sd[i] * sd[i] } else { 0.0 }));
        Refined { point: at, covariance, residual_px: vec![Some([3.0, 4.0])], leverage: vec![[0.0, 0.75]] }
    }

    #[test]
    fn noise_across_a_limb_makes_it_longer_and_noise_along_it_does_not() {
        let a = point([0.0; 3], [0.01, 0.02, 0.03]);
        let b = point([0.4, 0.0, 0.0], [0.0; 3]);
        let expected = 0.4 - 0.5 * (0.0004 + 0.0009) / 0.4;
        assert!((unbiased_length(&a, &b) - expected).abs() < 1e-15);
    }

    #[test]
    fn residuals_count_for_what_they_show() {
        let point = (point([0.0; 3], [0.0; 3]), vec![2]);
        assert_eq!(between(&point, 2), [9.0, 64.0]);
        assert!(between(&point, 0).is_empty());
    }
}
