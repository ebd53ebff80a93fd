//! The person in some evenly spaced frames, from which what is constant is measured.

use super::measured_mistakes::{limb_pairs, mistakes};
use super::pose_fit::straight_pose_of;
use super::stored::Setup;
use crate::Error;
use sinew_body::bundle::within_half_a_turn;
use sinew_body::point_derivatives::Neighbours;
use sinew_body::{KinematicTree, Plan};
use sinew_core::lanes::Isa;
use sinew_formats::Layout;
use sinew_input::source::FrameSource;
use sinew_observe::association::following::{Following, follow};
use sinew_observe::cameras::offsets::{self, CameraNoise, Sighted};
use sinew_observe::clocks::point_velocity::{keypoint_velocities, reach};
use sinew_observe::keypoints::bystanders::elsewhere;
use sinew_observe::keypoints::straightened::straightened;
use sinew_observe::{Camera, Detection, KeypointModel, Noise, association};
use std::ops::Range;

/// Frames looked at, at most.
const FRAMES: usize = 120;
/// Time between frames, seconds, up to which the fit of a pose starts from the pose of the frame before.
const SOON_S: f64 = 0.5;
/// Probability of a gross outlier.
const OUTLIER: f64 = 0.02;

/// A frame that is looked at.
pub(super) struct Looked {
    pub number: u64,
    /// Counts on where the person was lost before, as between recordings that follow each other.
    pub stretch: usize,
    pub detections: Vec<Vec<Option<Detection>>>,
    /// As in [`sinew_observe::KeypointFrame`].
    pub elsewhere: Vec<Vec<f64>>,
    pub pose: Vec<f64>,
    /// Velocity of each point as the cameras saw it, metres a second; `velocities` are those of the body.
    pub seen_velocities: Vec<Option<[f64; 3]>>,
    pub velocities: Vec<[f64; 3]>,
    /// Detections as cameras that are not late would have made them.
    pub on_time: Vec<Vec<Option<Detection>>>,
}

/// What the cameras of a set-up are taken to see of some points of a body.
pub(super) fn observed_by(setup: &Setup, tree: &KinematicTree, cameras: &[Camera], points: &[usize]) -> KeypointModel {
    KeypointModel {
        plan: Plan::new(tree, points).into(),
        views: setup.views(cameras),
        noise: Noise::OutlierFloor { outlier: OUTLIER },
        model_error_m: setup.model_error_m,
        least_confidence: offsets::Config::default().least_confidence,
        mistakes: mistakes(tree, points, setup.camera.iter()),
        isa: Isa::baseline(),
    }
}

/// Frames that follow each other with the sides of limbs put right, by which poses are found.
pub(super) fn straight(frames: &[Sighted], tree: &KinematicTree, layout: &Layout) -> Vec<Sighted> {
    let shared = tree.points().iter().enumerate().filter_map(|(p, point)| Some((p, layout.index(&point.name)?)));
    let (points, keypoints): (Vec<usize>, Vec<usize>) = shared.unzip();
    let named = |pairs: Vec<(usize, usize)>| pairs.into_iter().map(|(l, r)| (keypoints[l], keypoints[r])).collect();
    let limbs: Vec<Vec<(usize, usize)>> = limb_pairs(tree, &points).into_iter().map(named).collect();
    straightened(frames, &limbs)
}

/// [`straight`] of frames of these numbers, in runs between which more than `gap` frames lie: what a limb did before says nothing of its side then.
fn straight_runs(
    frames: &[(u64, Sighted, Vec<Vec<f64>>)],
    gap: u64,
    tree: &KinematicTree,
    layout: &Layout,
) -> Vec<Sighted> {
    let in_run = |run: &[(u64, Sighted, Vec<Vec<f64>>)]| {
        let sighted: Vec<Sighted> = run.iter().map(|(_, sighted, _)| sighted.clone()).collect();
        straight(&sighted, tree, layout)
    };
    frames.chunk_by(|(before, ..), (after, ..)| after - before <= gap).flat_map(in_run).collect()
}

/// The person in some of the frames of `numbers`, `fps` a second; `shared` are the points of the body that are keypoints, and which.
pub(super) fn looked_at(
    setup: &Setup,
    source: &mut dyn FrameSource,
    tree: &KinematicTree,
    shared: &[(usize, usize)],
    numbers: Range<u64>,
    fps: f64,
) -> Result<Vec<Looked>, Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let (points, keypoints): (Vec<usize>, Vec<usize>) = shared.iter().copied().unzip();
    let model = observed_by(setup, tree, &cameras, &points);
    let stride = (numbers.end - numbers.start).div_ceil(FRAMES as u64).max(1);
    let config = association::Config::default();
    let mut following = Following { person: setup.person, ..Following::default() };
    let mut found_in: Vec<(u64, Sighted, Vec<Vec<f64>>)> = vec![];
    let (mut lost_for, mut begins): (_, Vec<u64>) = (0, vec![]);
    // Frames near those that are looked at, from which velocities come.
    let mut near: Vec<(u64, Sighted)> = vec![];
    for number in numbers.clone() {
        let people = source.people(number)?;
        let found = follow(&mut following, &cameras, &people, None, &config);
        let after = (number - numbers.start) % stride;
        if !found.is_present() {
            lost_for += 1;
            continue;
        }
        if lost_for > config.lost_frames {
            begins.push(number);
        }
        lost_for = 0;
        if after.min(stride - after) <= reach(fps) {
            near.push((number, found.people.clone()));
        }
        if after != 0 {
            continue;
        }
        let elsewhere = elsewhere(&model, [&people, &source.others(number)?], &found, &keypoints, &config);
        found_in.push((number, found.people, elsewhere));
    }
    let noise: Vec<CameraNoise> =
        model.views.iter().map(|view| CameraNoise::without_offset(view.sigma_px, view.usual_confidence)).collect();
    let as_they_are: Vec<Camera> = model.views.iter().map(|view| view.camera.clone()).collect();
    let mut looked: Vec<Looked> = vec![];
    let straight = straight_runs(&found_in, 2 * stride, tree, &layout);
    for ((number, sighted, elsewhere), straight) in found_in.into_iter().zip(straight) {
        let former = looked.last().filter(|frame| (number - frame.number) as f64 <= SOON_S * fps);
        let former = former.map(|frame| frame.pose.as_slice());
        let both = (&sighted, &straight);
        let Some(pose) = straight_pose_of(setup, &cameras, &layout, both, former) else { continue };
        let pose = looked.last().map_or_else(|| pose.clone(), |frame| within_half_a_turn(tree, &pose, &frame.pose));
        let by_point =
            |seen: &Vec<Option<Detection>>| keypoints.iter().map(|&k| seen.get(k).copied().flatten()).collect();
        let detections: Vec<Vec<_>> = sighted.iter().map(by_point).collect();
        let at = near.partition_point(|(other, _)| *other < number);
        let rate_and_least = (fps, model.least_confidence);
        let seen_velocities = keypoint_velocities((&as_they_are, &noise), &near, at, &keypoints, rate_and_least);
        let (velocities, on_time) = (vec![], detections.clone());
        let stretch = begins.partition_point(|begin| *begin <= number);
        looked.push(Looked { number, stretch, detections, elsewhere, pose, seen_velocities, velocities, on_time });
    }
    Ok(looked)
}

/// Mean of the body's points over the frames; of a pose where there are none.
pub(super) fn middle(body: &Neighbours, frames: &[Looked], otherwise: &[f64]) -> [f64; 3] {
    let poses: Vec<&[f64]> = frames.iter().map(|frame| frame.pose.as_slice()).collect();
    let poses = if poses.is_empty() { vec![otherwise] } else { poses };
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for pose in poses {
        for point in body.at(pose).positions.chunks_exact(3) {
            sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
            count += 1.0;
        }
    }
    sum.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::Proportions;
    use sinew_body::standard::h32;
    use sinew_formats::layout;

    /// Somebody whose left side is on the left in ten frames, and after a gap on the right in ten others. As one run the sides look exchanged.
    #[test]
    fn sides_of_limbs_are_not_carried_over_a_gap() {
        let (tree, layout) = (h32(&Proportions::default()), layout::find("BODY_25B").unwrap());
        let frame = |number: u64| {
            let mut view: Vec<Option<Detection>> = vec![None; layout.points.len()];
            let [near, far] = if number < 10 { [100.0, 300.0] } else { [300.0, 100.0] };
            for (row, (left, right)) in layout.left_right_pairs().into_iter().enumerate() {
                let at = |u: f64| Some(Detection::new([u, 20.0 * row as f64], 0.9));
                (view[left], view[right]) = (at(near), at(far));
            }
            (if number < 10 { number } else { number + 20 }, vec![view], vec![])
        };
        let frames: Vec<_> = (0..20).map(frame).collect();
        let seen: Vec<Sighted> = frames.iter().map(|(_, sighted, _)| sighted.clone()).collect();
        assert_eq!(straight_runs(&frames, 2, &tree, &layout), seen);
        assert_ne!(straight_runs(&frames, 30, &tree, &layout), seen);
    }
}
