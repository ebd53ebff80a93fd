//! What is known beforehand of everything that is constant over a recording.
//!
//! | numbers | prior, standard deviations | source |
//! |---|---|---|
//! | a camera | s × (0.2° a turn, 5 mm, 0.3 % of the focal length, 2 mrad of the principal point, 0.02 of k1), heavy tails; ln s ~ N(0, 1) | a calibration with a board or a wand from a few metres |
//! | a length of the body | 10 % of the default body's, about it | 5–6 % among adults, and a joint that is defined otherwise |
//! | a point's place on its link | s per axis; ln s ~ N(ln 10 mm, 0.8²) | keypoints against joints of markers: Needham et al., Scientific Reports 11 (2021) 20673: 1–15 mm at ankles, 30–50 mm at hips |
//! | a bias of a camera's detector for a point | s per axis, one for each kind of keypoint, heavy tails; ln s ~ N(ln 10 mm, 0.8²) | the same |

use sinew_body::Proportions;
use sinew_body::point_derivatives::lengths;
use sinew_dynamics::lasting_scales::{LastingPrior, PriorCluster, ScalePrior, alike};
use sinew_observe::camera_error::NUMBERS;
use sinew_observe::lasting_errors::LastingErrors;

/// Units of a camera's numbers, in the order of [`sinew_observe::camera_error`].
pub const CAMERA_UNITS: [f64; NUMBERS] = [3.5e-3, 3.5e-3, 3.5e-3, 5e-3, 5e-3, 5e-3, 3e-3, 2e-3, 2e-3, 0.02];
const LENGTH_SHARE: f64 = 0.1;
const POINTS: ScalePrior = ScalePrior { median: 0.010, log_sd: 0.8 };

/// Mean of 1/w for w ~ Gamma(2, 2): variance of a heavy tail, Student's t with four degrees of freedom, over that of a Gaussian.
pub const HEAVY: f64 = 2.0;

/// Names of the scales: that of the cameras, that of places, and one for each kind of keypoint.
pub(super) const SCALES: [&str; 7] =
    ["cameras", "places_m", "bias_head_m", "bias_trunk_m", "bias_arms_m", "bias_legs_m", "bias_feet_m"];
pub(super) const PLACES: usize = 1;
const FIRST_KIND: usize = 2;
const KINDS: usize = SCALES.len() - FIRST_KIND;

/// Names of the scales of biases, by [`kind`].
pub const KIND_SCALES: [&str; KINDS] = [SCALES[2], SCALES[3], SCALES[4], SCALES[5], SCALES[6]];

/// Which kind of keypoint a point of the body is.
#[must_use]
pub fn kind(point: &str) -> usize {
    let is = |parts: &[&str]| parts.iter().any(|part| point.contains(part));
    match () {
        () if is(&["Eye", "Ear", "Nose", "Head"]) => 0,
        () if is(&["Elbow", "Wrist"]) => 2,
        () if is(&["Knee", "Ankle"]) => 3,
        () if is(&["Heel", "Toe"]) => 4,
        () => 1,
    }
}

/// The prior, for a subject whose lengths are given; g counts from them.
#[must_use]
pub fn prior(errors: &LastingErrors, points: &[String], subject: &Proportions) -> LastingPrior {
    let mut clusters = vec![];
    for camera in 0..errors.cameras {
        let numbers = errors.camera(camera).zip(CAMERA_UNITS).map(|(place, unit)| (place, 0.0, unit)).collect();
        clusters.push(PriorCluster { numbers, scale: Some(0), heavy_tails: true });
    }
    let usual = lengths(&Proportions::default());
    let length = |(place, (usual, own)): (usize, (&f64, f64))| (place, usual - own, LENGTH_SHARE * usual);
    let numbers = errors.lengths().zip(usual.iter().zip(lengths(subject))).map(length).collect();
    clusters.push(PriorCluster { numbers, scale: None, heavy_tails: false });
    clusters.push(PriorCluster { numbers: alike(errors.places(), 1.0), scale: Some(PLACES), heavy_tails: false });
    for of in 0..KINDS {
        for (point, _) in points.iter().enumerate().filter(|(_, name)| kind(name) == of) {
            for camera in 0..errors.cameras {
                let numbers = alike(errors.bias(camera, point), 1.0);
                clusters.push(PriorCluster { numbers, scale: Some(FIRST_KIND + of), heavy_tails: true });
            }
        }
    }
    let mut scales = vec![POINTS; SCALES.len()];
    scales[0] = ScalePrior { median: 1.0, log_sd: 1.0 };
    LastingPrior { clusters, scales }
}
