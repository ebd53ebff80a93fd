//! What is known beforehand of everything that is constant over a recording.
//!
//! | numbers | prior, standard deviations | source |
//! |---|---|---|
//! | a camera | s × (0.2° a turn, 5 mm, 0.3 % of the focal length, 2 mrad of the principal point, 0.02 of k1), heavy tails; ln s ~ N(0, 1) | a calibration with a board or a wand from a few metres |
//! | a length of the body | 10 % of the default body's, about it | 5–6 % among adults, and a joint that is defined otherwise |
//! | a point's place on its link | s per axis; ln s ~ N(ln 10 mm, 0.8²) | keypoints against joints of markers: Needham et al., Scientific Reports 11 (2021) 20673: 1–15 mm at ankles, 30–50 mm at hips |
//! | the same of hips | s per axis; ln s ~ N(ln 20 mm, 0.8²) | the same: 30–50 mm in space |
//! | the same of points of head and feet, about the default body's | s per axis; ln s ~ N(ln 15 mm, 0.8²) | besides, 5 % of the length of a foot and the height of a head among adults |
//! | a bias of a camera's detector for a point | s per axis, one for each kind of keypoint, heavy tails; ln s ~ N(ln 10 mm, 0.8²), of hips N(ln 20 mm, 0.8²) | the same |
//! | the lag of a camera's clock | s frames, heavy tails; ln s ~ N(ln 0.15, 1) | cameras with one trigger are less than 0.02 of a frame off, clips that were cut to whole frames 0.29 (uniform in ± ½); in between |
//!
//! Places of left and right joints are independent here; `mirrored_places` makes them alike.

use sinew_body::point_derivatives::{lengthened, lengths};
use sinew_body::{KinematicTree, Proportions};
use sinew_dynamics::lasting_scales::{LastingPrior, PriorCluster, ScalePrior, alike};
use sinew_observe::cameras::camera_error::NUMBERS;
use sinew_observe::lasting::lasting_errors::LastingErrors;

/// Units of a camera's numbers, in the order of [`sinew_observe::cameras::camera_error`].
pub const CAMERA_UNITS: [f64; NUMBERS] = [3.5e-3, 3.5e-3, 3.5e-3, 5e-3, 5e-3, 5e-3, 3e-3, 2e-3, 2e-3, 0.02];
const LENGTH_SHARE: f64 = 0.1;
const POINTS: ScalePrior = ScalePrior { median: 0.010, log_sd: 0.8 };
const HIPS_ASIDE: ScalePrior = ScalePrior { median: 0.020, log_sd: 0.8 };
const ENDS: ScalePrior = ScalePrior { median: 0.015, log_sd: 0.8 };
const LATE_FRAMES: ScalePrior = ScalePrior { median: 0.15, log_sd: 1.0 };

/// Mean of 1/w for w ~ Gamma(2, 2): variance of a heavy tail, Student's t with four degrees of freedom, over that of a Gaussian.
pub const HEAVY: f64 = 2.0;

/// Names of the scales: that of the cameras, three of places, one for each kind of keypoint, that of lags.
pub(super) const SCALES: [&str; 11] = [
    "cameras",
    "places_m",
    "places_head_feet_m",
    "places_hips_m",
    "bias_head_m",
    "bias_trunk_m",
    "bias_arms_m",
    "bias_legs_m",
    "bias_feet_m",
    "bias_hips_m",
    "lags_s",
];
const PLACES: [usize; 3] = [1, 2, 3];
const FIRST_KIND: usize = 4;
const KINDS: usize = 6;
const HIPS: usize = 5;
const LAGS: usize = FIRST_KIND + KINDS;

/// Names of the scales of biases, by [`kind`].
pub const KIND_SCALES: [&str; KINDS] = [SCALES[4], SCALES[5], SCALES[6], SCALES[7], SCALES[8], SCALES[9]];

/// Name of the scale of lags.
pub const LAG_SCALE: &str = SCALES[LAGS];

/// Which kind of keypoint a point of the body is.
#[must_use]
pub fn kind(point: &str) -> usize {
    let is = |parts: &[&str]| parts.iter().any(|part| point.contains(part));
    match () {
        () if is(&["Eye", "Ear", "Nose", "Head"]) => 0,
        () if is(&["Elbow", "Wrist"]) => 2,
        () if is(&["Knee", "Ankle"]) => 3,
        () if is(&["Heel", "Toe"]) => 4,
        () if is(&["Hip"]) => HIPS,
        () => 1,
    }
}

/// Whether a keypoint stands for no joint, as points of head and feet.
#[must_use]
pub fn stands_for_no_joint(point: &str) -> bool {
    matches!(kind(point), 0 | 4)
}

/// Which scale the place of a point has: the sizes of heads and feet differ, too, and no detector sees the middle of a hip.
#[must_use]
pub(super) fn place_scale(point: &str) -> usize {
    match kind(point) {
        0 | 4 => PLACES[1],
        HIPS => PLACES[2],
        _ => PLACES[0],
    }
}

/// Places that points are expected at, metres, from those that the subject's body has them at: what the set-up fitted to the data is no prior.
#[must_use]
pub fn expected_places(
    build: impl Fn(&Proportions) -> KinematicTree,
    points: &[String],
    subject: &Proportions,
) -> Vec<[f64; 3]> {
    let usual = Proportions::default();
    let longer: Vec<f64> = lengths(subject).iter().zip(lengths(&usual)).map(|(own, usual)| own - usual).collect();
    let [own, usual] = [build(subject), build(&lengthened(&usual, &longer))];
    let offset = |tree: &KinematicTree, name: &str| Some(tree.points()[tree.point_index(name)?].offset);
    let between = |name: &String| {
        let (own, usual) = offset(&own, name).zip(offset(&usual, name))?;
        Some([0, 1, 2].map(|axis: usize| usual[axis] - own[axis]))
    };
    points.iter().map(|name| between(name).unwrap_or_default()).collect()
}

/// The prior, for a subject whose lengths are given, with its points expected at `places`, of which `tied` are equal to another one; g counts from them. Frames are `frame_s` seconds apart.
#[must_use]
pub fn prior(
    errors: &LastingErrors,
    points: &[String],
    subject: &Proportions,
    places: &[[f64; 3]],
    tied: usize,
    frame_s: f64,
) -> LastingPrior {
    let LastingPrior { mut clusters, scales: camera_scales } = camera_prior(errors.cameras);
    let usual = lengths(&Proportions::default());
    let length = |(place, (usual, own)): (usize, (&f64, f64))| (place, usual - own, LENGTH_SHARE * usual);
    let numbers = errors.lengths().zip(usual.iter().zip(lengths(subject))).map(length).collect();
    clusters.push(PriorCluster { numbers, scale: None, heavy_tails: false, tied: 0 });
    for scale in PLACES {
        let own = |(point, name): (usize, &String)| (place_scale(name) == scale).then_some(point);
        let place = |point| errors.place(point).zip(places[point]).map(|(place, mean)| (place, mean, 1.0));
        let numbers = points.iter().enumerate().filter_map(own).flat_map(place).collect();
        let tied = if scale == PLACES[1] { tied } else { 0 };
        clusters.push(PriorCluster { numbers, scale: Some(scale), heavy_tails: false, tied });
    }
    for of in 0..KINDS {
        for (point, _) in points.iter().enumerate().filter(|(_, name)| kind(name) == of) {
            for camera in 0..errors.cameras {
                let numbers = alike(errors.bias(camera, point), 1.0);
                clusters.push(PriorCluster { numbers, scale: Some(FIRST_KIND + of), heavy_tails: true, tied: 0 });
            }
        }
    }
    for place in errors.lags() {
        let numbers = vec![(place, 0.0, 1.0)];
        clusters.push(PriorCluster { numbers, scale: Some(LAGS), heavy_tails: true, tied: 0 });
    }
    let mut scales = vec![POINTS; SCALES.len()];
    scales[..camera_scales.len()].copy_from_slice(&camera_scales);
    scales[PLACES[1]] = ENDS;
    scales[PLACES[2]] = HIPS_ASIDE;
    scales[FIRST_KIND + HIPS] = HIPS_ASIDE;
    scales[LAGS] = ScalePrior { median: LATE_FRAMES.median * frame_s, ..LATE_FRAMES };
    LastingPrior { clusters, scales }
}

/// The prior of cameras alone, whose numbers come first.
#[must_use]
pub fn camera_prior(cameras: usize) -> LastingPrior {
    let errors = LastingErrors { cameras, lengths: 0, points: 0 };
    let numbers = |camera| errors.camera(camera).zip(CAMERA_UNITS).map(|(place, unit)| (place, 0.0, unit)).collect();
    let cluster = |camera| PriorCluster { numbers: numbers(camera), scale: Some(0), heavy_tails: true, tied: 0 };
    let scales = vec![ScalePrior { median: 1.0, log_sd: 1.0 }];
    LastingPrior { clusters: (0..cameras).map(cluster).collect(), scales }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::point_derivatives::length_names;
    use sinew_body::standard::h32;

    #[test]
    fn sizes_that_were_fitted_to_head_and_feet_are_not_expected() {
        let usual = Proportions::default();
        let mut subject = lengthened(&usual, &vec![0.02; length_names().len()]);
        subject.heel[1] -= 0.03;
        let points = ["LKnee", "LHeel", "Neck"].map(str::to_owned);
        let places = expected_places(h32, &points, &subject);
        assert_eq!(places[0], [0.0; 3]);
        assert!((places[1][1] - 0.03).abs() < 1e-12 && places[2] == [0.0; 3]);
        let errors = LastingErrors { cameras: 1, lengths: length_names().len(), points: 3 };
        let prior = prior(&errors, &points, &subject, &places, 0, 0.02);
        let found = prior.clusters.iter().flat_map(|cluster| cluster.numbers.iter().map(|n| (cluster.scale, *n)));
        let place = errors.place(1).start + 1;
        let (scale, (_, mean, _)) = found.into_iter().find(|(_, number)| number.0 == place).unwrap();
        assert_eq!((scale, mean), (Some(PLACES[1]), places[1][1]));
    }
}
