//! Robust likelihood of detected keypoints in any number of calibrated cameras.
//!
//! A *sighting* is one keypoint in one camera. With the residual r (pixels) between the detection, freed of its detector's constant bias, and the distorted
//! projection of the body's point, and s the sighting's standard deviation per axis, its density is one of [`Noise`]:
//!
//! ```text
//! outlier floor    p = (1 − ε) / (2π s²) · exp(−r²/2s²) + ε / A             A: area of the image
//! Student t        p = 1 / (2π s²) · (1 + r²/(ν s²))^(−(ν + 2)/2)           in two dimensions
//! ```
//!
//! s² has three sources: the camera's pixel noise σ², larger for keypoints of lower confidence than usual, `σ² c₀/c`; and the model error τ (metres), since a
//! keypoint is not a joint of the body: at depth z it is `τ f/z` pixels. A point's model error is one displacement in space, the same for all n cameras that see
//! it, and not n independent ones; n sightings with the variance `⅔ n τ²` together know the point's position to τ in each direction, so that is what each gets. Depths for this are taken at the
//! predicted pose when the frame is bound: s does not depend on the state.
//!
//! A missing keypoint drops out. A point behind a camera, or beyond the domain of its lens, counts as an outlier there: its floor (for Student t the density at 1000 s), gradient 0, so that one wrong
//! camera cannot veto every pose.

use crate::camera::{Camera, MIN_DEPTH_M};
use crate::keypoint_likelihood::{KeypointLikelihood, Noise, Sighting};
use crate::lane_projection::LaneCameras;
use crate::model::ObservationModel;
use sinew_body::Plan;
use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use std::sync::Arc;

/// One detected keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Image position, pixels.
    pub pixel: [f64; 2],
    /// The detector's confidence, 0 to 1.
    pub confidence: f64,
}

/// A camera with what the set-up pass found out about its detections.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The camera, as it is rather than as it was calibrated.
    pub camera: Camera,
    /// Constant bias of its detector for each point (observed − projected), pixels; none where it is empty.
    pub bias_px: Vec<[f64; 2]>,
    /// Standard deviation per axis of a detection of usual confidence, pixels.
    pub sigma_px: f64,
    /// Usual confidence c₀.
    pub usual_confidence: f64,
}

impl View {
    /// Bias of the detector for a point, pixels.
    #[must_use]
    pub fn bias_of(&self, point: usize) -> [f64; 2] {
        self.bias_px.get(point).copied().unwrap_or_default()
    }
}

/// The keypoints of a body in a set of cameras.
#[derive(Clone, Debug)]
pub struct KeypointModel {
    /// The body; its points are the keypoints.
    pub plan: Arc<Plan>,
    /// The cameras.
    pub views: Vec<View>,
    /// Shape of the density.
    pub noise: Noise,
    /// Distance between a keypoint and the body's point, per axis, metres.
    pub model_error_m: f64,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Instruction set for the kernels.
    pub isa: Isa,
}

/// What was detected in one frame, and where the points are expected.
#[derive(Clone, Copy, Debug)]
pub struct KeypointFrame<'a> {
    /// For each view, for each point of the plan, its detection if any.
    pub detections: &'a [Vec<Option<Detection>>],
    /// Predicted world positions of the points, three numbers each, metres.
    pub predicted: &'a [f64],
}

/// Depth of a point in a camera, metres.
fn depth(camera: &Camera, p: &[f64]) -> f64 {
    let row = camera.rotation[2];
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + camera.translation[2]
}

impl KeypointModel {
    /// Variance s² per axis, square pixels, of a detection in a view: of a point that is expected at `point_in_world` and seen by `cameras` cameras.
    #[must_use]
    pub fn variance_px2(&self, view: usize, confidence: f64, cameras: usize, point_in_world: &[f64]) -> f64 {
        let by_model = self.model_error_m.powi(2) * self.by_model_error(view, cameras, point_in_world);
        self.noise_px2(view, confidence) + by_model
    }

    /// The part of it that is noise of the detector.
    #[must_use]
    pub fn noise_px2(&self, view: usize, confidence: f64) -> f64 {
        let View { sigma_px, usual_confidence, .. } = &self.views[view];
        sigma_px.powi(2) * usual_confidence / confidence.max(0.01)
    }

    /// The rest over the variance of the model error, square pixels for a square metre.
    #[must_use]
    pub fn by_model_error(&self, view: usize, cameras: usize, point_in_world: &[f64]) -> f64 {
        let camera = &self.views[view].camera;
        let scale = camera.intrinsics.fx / depth(camera, point_in_world).max(MIN_DEPTH_M);
        2.0 / 3.0 * cameras as f64 * scale * scale
    }

    /// Detections of a point that count, with their views.
    pub(crate) fn seen(&self, detections: &[Vec<Option<Detection>>], point: usize) -> Vec<(usize, Detection)> {
        let in_view = |(c, points): (usize, &Vec<Option<Detection>>)| Some((c, points.get(point).copied().flatten()?));
        let counts = |d: &Detection| d.confidence >= self.least_confidence && d.pixel.iter().all(|x| x.is_finite());
        detections.iter().enumerate().filter_map(in_view).filter(|(_, d)| counts(d)).collect()
    }

    /// A detection as the likelihood takes it, and the logarithm of its density's peak.
    fn sighting(&self, camera: usize, point: usize, detection: Detection, variance: f64) -> (Sighting, f64) {
        let view = &self.views[camera];
        let peak = 1.0 / (std::f64::consts::TAU * variance);
        let (shape, log_peak) = match self.noise {
            Noise::OutlierFloor { outlier } => {
                let area = view.camera.image_size_px[0] * view.camera.image_size_px[1];
                (outlier / (area * (1.0 - outlier) * peak), ((1.0 - outlier) * peak).ln())
            }
            Noise::StudentT { degrees } => (1.0 / (degrees * variance), peak.ln()),
        };
        let i = &view.camera.intrinsics;
        let ([u, v], [du, dv]) = (detection.pixel, view.bias_of(point));
        let pixel = [u - du - i.cx, v - dv - i.cy];
        (Sighting { camera, pixel, information: 1.0 / variance, shape }, log_peak)
    }
}

impl ObservationModel for KeypointModel {
    type Frame<'a> = KeypointFrame<'a>;
    type Bound = Lanes<KeypointLikelihood>;

    fn bind(&self, frame: KeypointFrame<'_>) -> Self::Bound {
        let mut sightings = vec![];
        let mut first = vec![0];
        let mut constant = 0.0;
        for &k in self.plan.order() {
            let seen = self.seen(frame.detections, k);
            let cameras = seen.len();
            for (c, detection) in seen {
                let expected = &frame.predicted[3 * k..3 * k + 3];
                let variance = self.variance_px2(c, detection.confidence, cameras, expected);
                let (sighting, log_peak) = self.sighting(c, k, detection, variance);
                constant += log_peak;
                sightings.push(sighting);
            }
            first.push(sightings.len());
        }
        let leaf = KeypointLikelihood {
            plan: Arc::clone(&self.plan),
            cameras: LaneCameras::new(self.views.iter().map(|view| &view.camera)),
            sightings,
            first,
            noise: self.noise,
            constant,
        };
        Lanes { leaf, isa: self.isa }
    }
}
