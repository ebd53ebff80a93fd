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
//! s² has four sources: the camera's pixel noise σ², larger for keypoints of lower confidence than usual, `σ² c₀/c`; what interpolation adds to a keypoint ([`Detection::extra_px`]); and the model error τ (metres), since a
//! keypoint is not a joint of the body: at depth z it is `τ f/z` pixels. A point's model error is one displacement in space, the same for all n cameras that see
//! it, and not n independent ones; n sightings with the variance `⅔ n τ²` together know the point's position to τ in each direction, so that is what each gets. Depths for this are taken at the
//! predicted pose when the frame is bound: s does not depend on the state.
//!
//! What a detector takes for something else ([`Mistakes`]) are components of the density: a pair of limbs whose sides it has exchanged ([`crate::keypoints::exchanged_limbs`]), and, beside the outlier floor, a keypoint of somebody else: with
//! probability π it lies as their keypoints of that name do, `p = (1 − ε − π) core + ε/A + π e`, e their mean density at the detection.
//!
//! A missing keypoint drops out. A point behind a camera, or beyond the domain of its lens, counts as an outlier there: its floor (for Student t the density at 1000 s), gradient 0, so that one wrong
//! camera cannot veto every pose.

use crate::cameras::camera::{Camera, MIN_DEPTH_M};
use crate::cameras::lane_projection::LaneCameras;
use crate::keypoints::exchanged_limbs::{Doubts, LEAST, Member};
use crate::keypoints::keypoint_likelihood::KeypointLikelihood;
use crate::keypoints::mistakes::Mistakes;
use crate::keypoints::sighting::{Noise, Sighting};
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
    /// Standard deviation per axis of what comes on top of the detector's noise, pixels; 0 for a keypoint that was not interpolated.
    pub extra_px: f64,
}

impl Detection {
    /// What a detector found.
    #[must_use]
    pub const fn new(pixel: [f64; 2], confidence: f64) -> Self {
        Self { pixel, confidence, extra_px: 0.0 }
    }

    /// Its numbers: u, v, confidence, extra pixels.
    #[must_use]
    pub const fn to_array(self) -> [f64; 4] {
        [self.pixel[0], self.pixel[1], self.confidence, self.extra_px]
    }

    /// The detection of these numbers.
    #[must_use]
    pub const fn from_array([u, v, confidence, extra_px]: [f64; 4]) -> Self {
        Self { pixel: [u, v], confidence, extra_px }
    }
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
    /// What detectors take for something else.
    pub mistakes: Mistakes,
    /// Instruction set for the kernels.
    pub isa: Isa,
}

/// What was detected in one frame, and where the points are expected.
#[derive(Clone, Copy, Debug)]
pub struct KeypointFrame<'a> {
    /// For each view, for each point of the plan, its detection if any.
    pub detections: &'a [Vec<Option<Detection>>],
    /// For each view, for each point, the density (1/px²) at its detection of other people's keypoints of that name; empty where there is nobody else.
    pub elsewhere: &'a [Vec<f64>],
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
    pub fn variance_px2(&self, view: usize, seen: &Detection, cameras: usize, point_in_world: &[f64]) -> f64 {
        let by_model = self.model_error_m.powi(2) * self.by_model_error(view, cameras, point_in_world);
        self.noise_px2(view, seen) + by_model
    }

    /// The part of it that is noise of the detector, or comes from interpolation.
    #[must_use]
    pub fn noise_px2(&self, view: usize, seen: &Detection) -> f64 {
        let View { sigma_px, usual_confidence, .. } = &self.views[view];
        sigma_px.powi(2) * usual_confidence / seen.confidence.max(0.01) + seen.extra_px.powi(2)
    }

    /// The rest over the variance of the model error, square pixels for a square metre.
    #[must_use]
    pub fn by_model_error(&self, view: usize, cameras: usize, point_in_world: &[f64]) -> f64 {
        let camera = &self.views[view].camera;
        let scale = camera.intrinsics.fx / depth(camera, point_in_world).max(MIN_DEPTH_M);
        2.0 / 3.0 * cameras as f64 * scale * scale
    }

    /// The detection of a point in a view, if it counts.
    fn counted(&self, frame: &KeypointFrame<'_>, view: usize, point: usize) -> Option<Detection> {
        let counts = |d: &Detection| d.confidence >= self.least_confidence && d.pixel.iter().all(|x| x.is_finite());
        frame.detections.get(view)?.get(point).copied().flatten().filter(counts)
    }

    /// How many cameras see each point.
    pub(crate) fn seen_by(&self, frame: &KeypointFrame<'_>) -> Vec<usize> {
        let views = |point| (0..self.views.len()).filter(|&view| self.counted(frame, view, point).is_some()).count();
        (0..self.plan.points()).map(views).collect()
    }

    /// The detection of a view's point `named` as one of `point`, and the logarithm of its density's peak; `seen_by` are the cameras that see each point.
    pub(crate) fn sighting(
        &self,
        frame: &KeypointFrame<'_>,
        seen_by: &[usize],
        camera: usize,
        [named, point]: [usize; 2],
    ) -> Option<(Sighting, f64)> {
        let detection = self.counted(frame, camera, named)?;
        let view = &self.views[camera];
        let expected = &frame.predicted[3 * point..3 * point + 3];
        let variance = self.variance_px2(camera, &detection, seen_by[point].max(1), expected);
        let peak = 1.0 / (std::f64::consts::TAU * variance);
        let (shape, log_peak) = match self.noise {
            Noise::OutlierFloor { outlier } => {
                let area = view.camera.image_size_px[0] * view.camera.image_size_px[1];
                let density = frame.elsewhere.get(camera).and_then(|densities| densities.get(named));
                let [elsewhere, density] =
                    density.map_or([0.0; 2], |density| [self.mistakes.elsewhere(camera), *density]);
                let core = (1.0 - outlier - elsewhere) * peak;
                ((outlier / area + elsewhere * density) / core, core.ln())
            }
            Noise::StudentT { degrees } => (1.0 / (degrees * variance), peak.ln()),
        };
        let i = &view.camera.intrinsics;
        let ([u, v], [du, dv]) = (detection.pixel, view.bias_of(point));
        let pixel = [u - du - i.cx, v - dv - i.cy];
        Some((Sighting { camera, pixel, information: 1.0 / variance, shape }, log_peak))
    }

    /// How far a sighting is from where its camera shows a point of the world, pixels.
    fn offset(&self, sighting: &Sighting, at: &[f64]) -> Option<[f64; 2]> {
        let camera = &self.views[sighting.camera].camera;
        let [u, v] = camera.project([at[0], at[1], at[2]]).pixel()?;
        let i = &camera.intrinsics;
        Some([sighting.pixel[0] + i.cx - u, sighting.pixel[1] + i.cy - v])
    }

    /// A pair of limbs in a camera, as named and exchanged; `None` where the camera never exchanges them or shows neither.
    fn paired(&self, frame: &KeypointFrame<'_>, seen_by: &[usize], camera: usize, limb: usize) -> Option<Paired> {
        let q = self.mistakes.exchanged(camera);
        let mut paired = Paired { points: vec![], log_peak: [0.0; 2], log_odds: (q / (1.0 - q)).ln() };
        for &(left, right) in &self.mistakes.limbs[limb] {
            for (own, other) in [(left, right), (right, left)] {
                let ways = [own, other].map(|named| self.sighting(frame, seen_by, camera, [named, own]));
                for ((way, sign), sum) in ways.iter().zip([-1.0, 1.0]).zip(&mut paired.log_peak) {
                    let Some((sighting, log_peak)) = way else { continue };
                    *sum += log_peak;
                    let at = &frame.predicted[3 * own..3 * own + 3];
                    let (log_factor, _) = self.noise.at(sighting, self.offset(sighting, at));
                    paired.log_odds += sign * (log_peak + log_factor);
                }
                paired.points.push((own, ways.map(|way| way.map(|(sighting, _)| sighting))));
            }
        }
        let is_seen = paired.points.iter().any(|(_, ways)| ways.iter().any(Option::is_some));
        (q > 0.0 && is_seen).then_some(paired)
    }

    /// For each view and pair of limbs that it shows, the probability that it has exchanged their sides, were the points where `frame` predicts them.
    #[must_use]
    pub fn exchanged(&self, frame: &KeypointFrame<'_>) -> Vec<Vec<Option<f64>>> {
        let seen_by = self.seen_by(frame);
        let probability = |camera: usize, limb: usize| {
            let paired = self.paired(frame, &seen_by, camera, limb)?;
            Some(1.0 / (1.0 + (-paired.log_odds).exp()))
        };
        let in_view = |camera| (0..self.mistakes.limbs.len()).map(|limb| probability(camera, limb)).collect();
        (0..self.views.len()).map(in_view).collect()
    }

    /// Whether most cameras that see a pair of limbs have exchanged it, were the points where `frame` predicts them: it is then rather the pose that has.
    #[must_use]
    pub fn is_turned(&self, frame: &KeypointFrame<'_>) -> bool {
        let exchanged = self.exchanged(frame);
        (0..self.mistakes.limbs.len()).any(|limb| {
            let seen: Vec<f64> = exchanged.iter().filter_map(|view| view[limb]).collect();
            seen.len() > 1 && 2 * seen.iter().filter(|probability| **probability > 0.5).count() > seen.len()
        })
    }

    /// The detections with the sides of limbs put right where they are more probably exchanged than not ([`KeypointModel::exchanged`]).
    #[must_use]
    pub fn straight(&self, frame: &KeypointFrame<'_>) -> Vec<Vec<Option<Detection>>> {
        let mut detections = frame.detections.to_vec();
        for (seen, probabilities) in detections.iter_mut().zip(self.exchanged(frame)) {
            let exchanged = |probability: &Option<f64>| probability.is_some_and(|p| p > 0.5);
            for (limb, _) in self.mistakes.limbs.iter().zip(&probabilities).filter(|(_, p)| exchanged(p)) {
                limb.iter().for_each(|&(left, right)| seen.swap(left, right));
            }
        }
        detections
    }

    /// For each view and point with a detection, the probability that it is somebody else's, were the points where `frame` predicts them; none in views without others.
    #[must_use]
    pub fn elsewhere(&self, frame: &KeypointFrame<'_>) -> Vec<Vec<f64>> {
        let seen_by = self.seen_by(frame);
        let probability = |camera: usize, point: usize| {
            let density = frame.elsewhere.get(camera)?.get(point)?;
            let (sighting, log_peak) = self.sighting(frame, &seen_by, camera, [point, point])?;
            let at = &frame.predicted[3 * point..3 * point + 3];
            let (log_factor, _) = self.noise.at(&sighting, self.offset(&sighting, at));
            Some(self.mistakes.elsewhere(camera) * density / (log_peak + log_factor).exp())
        };
        let in_view = |camera| (0..self.plan.points()).filter_map(|point| probability(camera, point)).collect();
        (0..self.views.len()).map(in_view).collect()
    }
}

/// A pair of limbs in a camera.
struct Paired {
    /// Points with the keypoint of their own name and of their partner's.
    points: Vec<(usize, [Option<Sighting>; 2])>,
    /// Sums of the peaks' logarithms, as named and exchanged.
    log_peak: [f64; 2],
    /// Log odds of exchanged sides at the predicted points.
    log_odds: f64,
}

impl ObservationModel for KeypointModel {
    type Frame<'a> = KeypointFrame<'a>;
    type Bound = Lanes<KeypointLikelihood>;

    fn bind(&self, frame: KeypointFrame<'_>) -> Self::Bound {
        let (seen_by, points) = (self.seen_by(&frame), self.plan.points());
        let mut place = vec![0; points];
        self.plan.order().iter().enumerate().for_each(|(k, &point)| place[point] = k);
        let (mut log_odds, mut members, mut constant) = (vec![], vec![], 0.0);
        let mut is_doubted = vec![false; self.views.len() * points];
        for camera in 0..self.views.len() {
            let q = self.mistakes.exchanged(camera);
            for limb in 0..self.mistakes.limbs.len() {
                let Some(paired) = self.paired(&frame, &seen_by, camera, limb) else { continue };
                constant += (1.0 - q).ln();
                if paired.log_odds < LEAST {
                    continue;
                }
                constant += paired.log_peak[0];
                for (point, [straight, crossed]) in paired.points {
                    is_doubted[camera * points + point] = true;
                    members.push(Member { point: place[point], doubt: log_odds.len(), straight, crossed });
                }
                log_odds.push((q / (1.0 - q)).ln() + paired.log_peak[1] - paired.log_peak[0]);
            }
        }
        let mut sightings = vec![];
        let mut first = vec![0];
        for &k in self.plan.order() {
            for camera in (0..self.views.len()).filter(|camera| !is_doubted[camera * points + k]) {
                if let Some((sighting, log_peak)) = self.sighting(&frame, &seen_by, camera, [k, k]) {
                    constant += log_peak;
                    sightings.push(sighting);
                }
            }
            first.push(sightings.len());
        }
        let leaf = KeypointLikelihood {
            plan: Arc::clone(&self.plan),
            cameras: LaneCameras::new(self.views.iter().map(|view| &view.camera)),
            doubts: Doubts::new(log_odds, members, points),
            sightings,
            first,
            noise: self.noise,
            constant,
        };
        Lanes { leaf, isa: self.isa }
    }
}
