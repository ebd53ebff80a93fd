//! A first pose from one camera: the body keeps its sizes, and its depth follows from them.
//!
//! 1. Distance: the largest ratio of a segment's length in the image to its length in the body (the segment least foreshortened) says how far away it is.
//! 2. From standing poses there, turned to eight headings, the joint angles are fitted to the pixels ([`fit_pixels`]) with a prior about the standing pose; the best
//!    fit wins. What one view does not show (which leg is in front) is decided by the prior only.

use sinew_body::{KinematicTree, Plan, point_positions};
use sinew_core::lanes::Isa;
use sinew_observe::keypoints::pixel_fit::{PixelFit, fit_pixels};
use sinew_observe::{Detection, View};

const HEADINGS: usize = 8;
const STEPS: usize = 60;
/// Standard deviations about the standing pose: position in metres, heading, other angles in radians.
const PLACE_SD_M: f64 = 2.0;
const HEADING_SD: f64 = 1.5;
const ANGLE_SD: f64 = 0.5;

/// Segments that show the size of the body.
const SEGMENTS: [(&str, &str); 10] = [
    ("LHip", "LKnee"),
    ("RHip", "RKnee"),
    ("LKnee", "LAnkle"),
    ("RKnee", "RAnkle"),
    ("LShoulder", "LHip"),
    ("RShoulder", "RHip"),
    ("LShoulder", "LElbow"),
    ("RShoulder", "RElbow"),
    ("LShoulder", "RHip"),
    ("RShoulder", "LHip"),
];

/// Fits a pose to the detections (one entry per point of the tree) of one camera; `None` where no segment of the body is seen.
#[must_use]
pub fn pose_from_one_view(tree: &KinematicTree, view: &View, detections: &[Option<Detection>]) -> Option<PixelFit> {
    let plan = Plan::with_all_points(tree);
    let mut rest = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), &vec![0.0; tree.dof()], &mut rest);
    let at = |k: usize| [rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]];
    let pixel = |k: usize| Some(detections.get(k).copied().flatten()?.pixel);
    let pixels_per_metre = SEGMENTS
        .iter()
        .filter_map(|(a, b)| {
            let (a, b) = (tree.point_index(a)?, tree.point_index(b)?);
            let (p, q) = (pixel(a)?, pixel(b)?);
            let length = (0..3).map(|k| (at(a)[k] - at(b)[k]).powi(2)).sum::<f64>().sqrt();
            Some((p[0] - q[0]).hypot(p[1] - q[1]) / length)
        })
        .max_by(f64::total_cmp)
        .filter(|x| *x > 0.0)?;
    let depth = view.camera.intrinsics.fx / pixels_per_metre;
    let seen: Vec<(usize, [f64; 2])> = (0..plan.points()).filter_map(|k| Some((k, pixel(k)?))).collect();
    let count = seen.len() as f64;
    let middle = [0, 1].map(|a: usize| seen.iter().map(|(_, p)| p[a]).sum::<f64>() / count);
    let middle = view.camera.undistort(middle).ok()?;
    let [x, y] = view.camera.normalised_from_pixel(middle);
    let in_camera = [x * depth, y * depth, depth];
    let centre = view.camera.centre();
    let place =
        [0, 1, 2].map(|k: usize| centre[k] + (0..3).map(|i| view.camera.rotation[i][k] * in_camera[i]).sum::<f64>());
    let rest_middle = [0, 1, 2].map(|a: usize| seen.iter().map(|(k, _)| at(*k)[a]).sum::<f64>() / count);
    let dof = tree.dof();
    let sd: Vec<f64> = (0..dof)
        .map(|j| match j {
            0..3 => PLACE_SD_M,
            3 => HEADING_SD,
            _ => ANGLE_SD,
        })
        .collect();
    (0..HEADINGS)
        .map(|h| {
            let heading = std::f64::consts::TAU * h as f64 / HEADINGS as f64 - std::f64::consts::PI;
            let (s, c) = heading.sin_cos();
            let mut start = vec![0.0; dof];
            start[0] = place[0] - (c * rest_middle[0] - s * rest_middle[1]);
            start[1] = place[1] - (s * rest_middle[0] + c * rest_middle[1]);
            start[2] = place[2] - rest_middle[2];
            start[3] = heading;
            fit_pixels(&plan, std::slice::from_ref(view), &[detections.to_vec()], &start, &sd, STEPS)
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}
