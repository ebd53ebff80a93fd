//! The second half of the set-up: points in space, sizes, poses and the model error.
//!
//! The model error is the distance, per axis, between where the detectors' keypoints lie in space and the points of the fitted body. Its variance is what the
//! residuals of the fit have beyond the noise of the triangulated points,
//!
//! ```text
//! m² = median over points of  (1.4826 · median |J − P − b|)² · n/(n − d)  −  mean of the points' own variances
//! ```
//!
//! after each point's constant bias b in the frame of its link; n counts the coordinates of a frame and d the degrees of freedom of the body, which take their
//! share of the residuals.

use super::collect::{Collected, SetupRequest};
use super::model_error::model_error_m;
use super::scale::check_scale;
use super::segment_lengths;
use super::setup_error::SetupError;
use super::space_points::{Points, points_in_space};
use super::stored::Body;
use super::up_axis::up_axis;
use super::upward::{Upward, upward};
use super::warning::SetupWarning;
use sinew_body::fit::Target;
use sinew_body::{KinematicTree, Plan, Proportions, bundle, point_positions, subject};
use sinew_core::estimators::mean;
use sinew_core::lanes::Isa;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::cameras::offsets::CameraNoise;

/// What points in space show.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredShape {
    /// Sizes of the subject.
    pub proportions: Proportions,
    /// Distance between a keypoint and the body's point, per axis, metres.
    pub model_error_m: f64,
    /// Number of the first frame with a pose.
    pub start_frame: u64,
    /// State of the body in that frame.
    pub start_pose: Vec<f64>,
    /// World axis that points from feet to head.
    pub up_axis: &'static str,
    /// Mean distance of the fitted body from the points, metres.
    pub fit_error_m: f64,
    /// Mean distance for each point of the body, metres; NaN where it was not seen.
    pub point_error_m: Vec<(String, f64)>,
}

/// Measures the subject in the collected frames.
///
/// # Errors
/// No frame shows enough of the person for a pose.
pub fn measure(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
    warnings: &mut Vec<SetupWarning>,
) -> Result<MeasuredShape, SetupError> {
    let stride = collected.spread.len().div_ceil(request.shape_frames.max(1)).max(1);
    let frames: Vec<(u64, Points)> = collected
        .spread
        .iter()
        .step_by(stride)
        .map(|(n, s)| (*n, points_in_space(cameras, noise, s, request.offsets.least_confidence)))
        .collect();
    let names: Vec<&str> = layout.points.iter().map(|p| p.as_deref().unwrap_or("")).collect();
    let bare: Vec<Vec<Option<[f64; 3]>>> =
        frames.iter().map(|(_, points)| points.iter().map(|p| p.map(|(p, _)| p)).collect()).collect();
    let measured = subject::from_distances(&names, &bare);
    if !request.any_size {
        check_scale(cameras, measured.scale)?;
        if !matches!(request.body, Body::File(_)) {
            segment_lengths::check(&measured, &layout.name)?;
        }
    }
    let up_axis = up_axis(layout, &frames);
    warnings.extend(oddities(up_axis, frames.len(), upward(layout, &frames), &measured));
    let build = request.body.builder();
    let tree = build(&measured.proportions);
    let targets = targets(&tree, layout, &frames);
    let subject = bundle::refine(build, &measured.proportions, &targets, &bundle::Config::default());
    let tree = build(&subject.proportions);
    let Residuals { by_point: residuals, mut variances, fitted } = residuals(&tree, &targets, &subject.poses, &frames);
    let Some((start_frame, start_pose)) =
        frames.iter().zip(&subject.poses).find_map(|((n, _), pose)| Some((*n, pose.clone()?)))
    else {
        return Err(SetupError::NoPose);
    };
    let length = |r: &[f64; 3]| r.iter().map(|x| x * x).sum::<f64>().sqrt();
    let point_error_m: Vec<(String, f64)> = tree
        .points()
        .iter()
        .zip(&residuals)
        .map(|(p, r)| (p.name.clone(), r.iter().map(length).sum::<f64>() / r.len() as f64))
        .collect();
    let all: Vec<f64> = residuals.iter().flatten().map(length).collect();
    let coordinates: Vec<f64> = residuals.iter().flatten().flatten().copied().collect();
    let model_error_m = model_error_m(&coordinates, (fitted * tree.dof()) as f64, &mut variances);
    Ok(MeasuredShape {
        proportions: subject.proportions,
        model_error_m,
        start_frame,
        start_pose,
        up_axis,
        fit_error_m: mean(&all),
        point_error_m,
    })
}

/// For each frame and point of the body, the point in space.
fn targets(tree: &KinematicTree, layout: &Layout, frames: &[(u64, Points)]) -> Vec<Vec<Option<Target>>> {
    let index: Vec<Option<usize>> = tree.points().iter().map(|p| layout.index(&p.name)).collect();
    let frame = |(_, points): &(u64, Points)| {
        let target = |k: &Option<usize>| {
            let (position, _) = points.get((*k)?).copied().flatten()?;
            Some(Target { position, weight: 1.0 })
        };
        index.iter().map(target).collect()
    };
    frames.iter().map(frame).collect()
}

/// Angle from the z axis up to which a world counts as level, degrees, and in standard deviations of what points up.
const LEVEL_DEG: f64 = 15.0;
const LEVEL_SD: f64 = 3.0;

/// Warnings about the axis of the world and about sizes that nothing measured.
fn oddities(
    up_axis: &'static str,
    frames: usize,
    upward: Option<Upward>,
    measured: &subject::Measured,
) -> Vec<SetupWarning> {
    let sizes = measured.unmeasured.clone();
    let axis = match upward.map(|up| (up.tilt_deg(), up.sd_deg)) {
        _ if up_axis != "+z" => Some(SetupWarning::FeetAboveHead { frames, up_axis }),
        Some((tilt_deg, sd_deg)) if tilt_deg > LEVEL_DEG && tilt_deg > LEVEL_SD * sd_deg => {
            Some(SetupWarning::Unlevel { tilt_deg, sd_deg })
        }
        _ => None,
    };
    axis.into_iter().chain((!sizes.is_empty()).then_some(SetupWarning::Unmeasured { sizes })).collect()
}

/// How far the points in space lie from the points of the fitted body.
struct Residuals {
    /// For each point of the body, metres.
    by_point: Vec<Vec<[f64; 3]>>,
    /// Variances of the points in space, per axis, square metres.
    variances: Vec<f64>,
    /// Frames with a pose.
    fitted: usize,
}

fn residuals(
    tree: &KinematicTree,
    targets: &[Vec<Option<Target>>],
    poses: &[Option<Vec<f64>>],
    frames: &[(u64, Points)],
) -> Residuals {
    let plan = Plan::with_all_points(tree);
    let mut found = Residuals { by_point: vec![vec![]; tree.points().len()], variances: vec![], fitted: 0 };
    let mut at = vec![0.0; 3 * plan.points()];
    for ((targets, pose), (_, points)) in targets.iter().zip(poses).zip(frames) {
        let Some(pose) = pose else { continue };
        found.fitted += 1;
        point_positions(&plan, Isa::baseline(), pose, &mut at);
        for (k, target) in targets.iter().enumerate() {
            if let Some(t) = target {
                found.by_point[k].push([0, 1, 2].map(|a: usize| t.position[a] - at[3 * k + a]));
            }
        }
        found.variances.extend(points.iter().flatten().map(|(_, v)| *v));
    }
    found
}
