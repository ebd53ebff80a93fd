//! Parts of the variance of each point's position by source (cameras, lengths, places, biases, lags), for everything that is constant over a recording.
//!
//! A draw δ of what is constant (truth less the value used) moves the points of the body by x = X (J δ) + L δ: J is the answer of the filter's pose to it, X the derivative of the points by the pose, L that by the lengths and, of points that are where detectors see them, by their places. With x = x₁ + … + x₅, the parts of cameras, lengths, places, biases and lags,
//! the part of a source in the variance of x is cov(x_f, x): the parts add to the variance. A part is negative where the errors of a source cancel those of another. All are means over frames and draws, and sums over the three axes.

use serde::{Deserialize, Serialize};
use sinew_body::point_derivatives::{Neighbours, PointDerivatives, lengthened};
use sinew_body::{KinematicTree, Proportions};
use sinew_dynamics::lasting_scales::LastingDraws;
use sinew_observe::lasting::lasting_errors::LastingErrors;
use std::ops::Range;

/// Sources of what is constant.
pub const SOURCES: usize = 5;

/// Parts of the variance of a point's position, square metres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointSources {
    /// Name of the point.
    pub point: String,
    /// From the cameras.
    pub cameras_m2: f64,
    /// From the lengths of the body.
    pub lengths_m2: f64,
    /// From the places of keypoints on their links.
    pub places_m2: f64,
    /// From biases of the detectors.
    pub biases_m2: f64,
    /// From lags of the cameras.
    pub lags_m2: f64,
}

impl PointSources {
    /// The same with each part changed.
    pub(super) fn map(self, change: impl Fn(f64) -> f64) -> Self {
        let [cameras_m2, lengths_m2, places_m2, biases_m2, lags_m2] = self.parts().map(change);
        Self { point: self.point, cameras_m2, lengths_m2, places_m2, biases_m2, lags_m2 }
    }

    /// In the order of the fields.
    #[must_use]
    pub const fn parts(&self) -> [f64; SOURCES] {
        [self.cameras_m2, self.lengths_m2, self.places_m2, self.biases_m2, self.lags_m2]
    }
}

/// A frame: its pose, and how the pose answers to what is constant.
struct AnsweringPose<'a> {
    pose: &'a [f64],
    response: &'a [f64],
}

/// Frames that are taken, at most.
const FRAMES: usize = 16;

/// Which numbers belong to each source.
fn families(errors: &LastingErrors) -> [Range<usize>; SOURCES] {
    [0..errors.lengths().start, errors.lengths(), errors.places(), errors.biases(), errors.lags()]
}

/// The parts of all points of the body that `build` makes of sizes, with the lengths that were found; `poses` are poses, each with how it answers to what is constant, d × p, row after row; `keypoint_at` says which keypoint a point is at.
pub(super) fn point_sources(
    build: impl Fn(&Proportions) -> KinematicTree,
    sizes: &Proportions,
    errors: &LastingErrors,
    found: &LastingDraws,
    poses: &[(&[f64], &[f64])],
    keypoint_at: impl Fn(&str) -> Option<usize>,
) -> Vec<PointSources> {
    let frames: Vec<_> = poses.iter().map(|&(pose, response)| AnsweringPose { pose, response }).collect();
    let names: Vec<String> = build(sizes).points().iter().map(|point| point.name.clone()).collect();
    let indices: Vec<usize> = (0..names.len()).collect();
    let body = Neighbours::new(build, &lengthened(sizes, &found.mean[errors.lengths()]), &indices);
    let points: Vec<_> = names.into_iter().map(|name| (keypoint_at(&name), name)).collect();
    sources(errors, &body, &points, &frames, &found.errors)
}

/// The parts of the points of `body`, in some frames, for draws of what is constant; `points` have the keypoint that each is at, and its name.
fn sources(
    errors: &LastingErrors,
    body: &Neighbours,
    points: &[(Option<usize>, String)],
    frames: &[AnsweringPose<'_>],
    draws: &[Vec<f64>],
) -> Vec<PointSources> {
    let deviations = centred(draws);
    let mut sums = vec![[0.0; SOURCES]; points.len()];
    let taken: Vec<&AnsweringPose<'_>> = frames.iter().step_by(frames.len().div_ceil(FRAMES).max(1)).collect();
    for frame in &taken {
        let at = body.at(frame.pose);
        let moved = families(errors).map(|family| moves(errors, &at, points, frame, &deviations, family));
        for (row, n) in (0..3 * points.len()).flat_map(|row| (0..draws.len()).map(move |draw| (row, draw))) {
            let parts = [0, 1, 2, 3, 4].map(|source: usize| moved[source][row * draws.len() + n]);
            let all: f64 = parts.iter().sum();
            sums[row / 3].iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * all);
        }
    }
    let count = (taken.len() * draws.len()).max(1) as f64;
    let named = |((_, point), sums): (&(Option<usize>, String), [f64; SOURCES])| {
        let [cameras_m2, lengths_m2, places_m2, biases_m2, lags_m2] = sums.map(|sum| sum / count);
        PointSources { point: point.clone(), cameras_m2, lengths_m2, places_m2, biases_m2, lags_m2 }
    };
    points.iter().zip(sums).map(named).collect()
}

/// Draws less their mean, p × n, row after row.
fn centred(draws: &[Vec<f64>]) -> Vec<f64> {
    let count = draws.first().map_or(0, Vec::len);
    let row = |number: usize| {
        let mean = draws.iter().map(|draw| draw[number]).sum::<f64>() / draws.len() as f64;
        draws.iter().map(move |draw| draw[number] - mean)
    };
    (0..count).flat_map(row).collect()
}

/// By how much the numbers of a source move the points, 3 a point, × n.
fn moves(
    errors: &LastingErrors,
    at: &PointDerivatives,
    points: &[(Option<usize>, String)],
    frame: &AnsweringPose<'_>,
    deviations: &[f64],
    family: Range<usize>,
) -> Vec<f64> {
    let (p, dof) = (errors.count(), frame.pose.len());
    let n = deviations.len() / p;
    let add = |to: &mut [f64], by: f64, row: &[f64]| to.iter_mut().zip(row).for_each(|(x, d)| *x += by * d);
    let mut states = vec![0.0; dof * n];
    for (j, state) in states.chunks_exact_mut(n).enumerate() {
        family.clone().for_each(|place| add(state, frame.response[j * p + place], &deviations[place * n..][..n]));
    }
    let mut moved = vec![0.0; at.positions.len() * n];
    for (row, point) in moved.chunks_exact_mut(n).enumerate() {
        states.chunks_exact(n).enumerate().for_each(|(j, state)| add(point, at.by_pose[row * dof + j], state));
        let by_length = &at.by_length[row * errors.lengths..][..errors.lengths];
        let lengths = errors.lengths().zip(by_length).filter(|(place, _)| family.contains(place));
        let places = points[row / 3].0.into_iter().flat_map(|keypoint| errors.place(keypoint));
        let places = places.zip(&at.link_axes[3 * row..]).filter(|(place, _)| family.contains(place));
        lengths.chain(places).for_each(|(place, by)| add(point, *by, &deviations[place * n..][..n]));
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::point_derivatives::length_names;
    use sinew_body::standard::h32;

    const DRAWS: usize = 64;

    /// Draws in which `moved` numbers are ± 1 cm each, and all others nothing.
    fn draws(errors: &LastingErrors, moved: &[usize]) -> Vec<Vec<f64>> {
        let draw = |i: usize| {
            let mut g = vec![0.0; errors.count()];
            moved.iter().for_each(|&place| g[place] = if i.is_multiple_of(2) { 0.01 } else { -0.01 });
            g
        };
        (0..DRAWS).map(draw).collect()
    }

    /// A body of which only the root answers: along x, by the first number of the camera, of the first bias, `bias` times that, and by the lag. Its nose is at the second keypoint.
    fn found(moved: &[usize], bias: f64) -> Vec<PointSources> {
        let errors = LastingErrors { cameras: 1, lengths: length_names().len(), points: 2 };
        let names = ["MidHip", "Nose"];
        let tree = h32(&Proportions::default());
        let body = Neighbours::new(h32, &Proportions::default(), &names.map(|name| tree.point_index(name).unwrap()));
        let (pose, p) = (vec![0.0; 32], errors.count());
        let mut response = vec![0.0; 32 * p];
        response[0] = 2.0;
        response[errors.bias(0, 0).start] = bias;
        response[errors.lag(0)] = 5.0;
        let moved: Vec<usize> = moved
            .iter()
            .map(|&k| [0, errors.bias(0, 0).start, errors.lengths().start, errors.place(1).start, errors.lag(0)][k])
            .collect();
        let frames = [AnsweringPose { pose: &pose, response: &response }];
        let points = [(None, names[0].to_owned()), (Some(1), names[1].to_owned())];
        sources(&errors, &body, &points, &frames, &draws(&errors, &moved))
    }

    fn is_near(found: [f64; SOURCES], expected: [f64; SOURCES]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} for {expected:?}");
    }

    #[test]
    fn cameras_alone_are_all_there_is() {
        for point in found(&[0], 3.0) {
            is_near(point.parts(), [4e-4, 0.0, 0.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn sources_that_move_together_share_and_those_against_each_other_take_away() {
        for point in found(&[0, 1], 3.0) {
            is_near(point.parts(), [1e-3, 0.0, 0.0, 1.5e-3, 0.0]);
        }
        for point in found(&[0, 1], -1.0) {
            is_near(point.parts(), [2e-4, 0.0, 0.0, -1e-4, 0.0]);
        }
    }

    #[test]
    fn a_lag_that_a_pose_answers_to_is_a_source_of_its_own() {
        for point in found(&[4], 3.0) {
            is_near(point.parts(), [0.0, 0.0, 0.0, 0.0, 25e-4]);
        }
    }

    #[test]
    fn lengths_move_the_points_beyond_the_pose() {
        let [hips, nose] = &found(&[2], 0.0)[..] else { panic!("two points") };
        is_near(hips.parts(), [0.0; SOURCES]);
        // The first length is the spine's, which bears the head.
        is_near(nose.parts(), [0.0, 1e-4, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_place_moves_a_point_that_is_where_the_detector_sees_it() {
        let [hips, nose] = &found(&[3], 0.0)[..] else { panic!("two points") };
        is_near(hips.parts(), [0.0; SOURCES]);
        is_near(nose.parts(), [0.0, 0.0, 1e-4, 0.0, 0.0]);
    }
}
