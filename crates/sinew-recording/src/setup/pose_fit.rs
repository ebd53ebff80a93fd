//! The pose of a frame, fitted to points in space.

use super::one_camera;
use super::own_body::{self, POSE};
use super::space_points::points_in_space;
use super::stored::Setup;
use crate::body_limits::body_limits;
use sinew_body::fit::{Fit, Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::motion_ranges::motion_ranges;
use sinew_body::{KinematicTree, Plan};
use sinew_core::density::LogDensity as _;
use sinew_core::lanes::Isa;
use sinew_formats::Layout;
use sinew_observe::offsets::{self, CameraNoise, Sighted};
use sinew_observe::{Camera, Detection};

/// Usual distance of a point in space from the body, per axis, metres.
const SIGMA_M: f64 = 0.02;

/// The pose of one frame of the tracked person, afresh or from a former pose; `None` where too little is seen.
#[must_use]
pub fn pose_of(
    setup: &Setup,
    cameras: &[Camera],
    layout: &Layout,
    sighted: &Sighted,
    former: Option<&[f64]>,
) -> Option<Vec<f64>> {
    let views = setup.views(cameras);
    if let ([view], [seen]) = (&views[..], &sighted[..]) {
        let tree = setup.tree();
        let by_point = |k: &Option<usize>| k.and_then(|k| seen.get(k).copied().flatten());
        let detections: Vec<Option<Detection>> = places(&tree, layout).iter().map(by_point).collect();
        return one_camera::pose_from_one_view(&tree, view, &detections).map(|fit| fit.pose);
    }
    fit_of(setup, cameras, layout, sighted, former).map(|fit| fit.pose)
}

/// For each point of a body its keypoint.
fn places(tree: &KinematicTree, layout: &Layout) -> Vec<Option<usize>> {
    tree.points().iter().map(|p| layout.index(&p.name)).collect()
}

/// As [`pose_of`] where sides of limbs were put right by what they did in neighbouring frames, which may be a mistake: from a former pose, afresh, or as the sides are named, whichever fits best
/// within the limits of joints.
#[must_use]
pub(super) fn straight_pose_of(
    setup: &Setup,
    cameras: &[Camera],
    layout: &Layout,
    (named, straight): (&Sighted, &Sighted),
    former: Option<&[f64]>,
) -> Option<Vec<f64>> {
    if cameras.len() < 2 {
        return pose_of(setup, cameras, layout, straight, former);
    }
    let tree = setup.tree();
    let limits = body_limits(motion_ranges(&tree), Isa::baseline()).ok();
    let beyond = |fit: &Fit| limits.as_ref().map_or(0.0, |limits| -limits.log_density(&fit.pose));
    let first = fit_of(setup, cameras, layout, straight, former);
    if named == straight && first.as_ref().is_some_and(|fit| beyond(fit) < 1.0) {
        return first.map(|fit| fit.pose);
    }
    let misfit = |fit: &Fit| 0.5 * tree.points().len() as f64 * (fit.rms_m / SIGMA_M).powi(2) + beyond(fit);
    let afresh = [straight, named].map(|sighted| fit_of(setup, cameras, layout, sighted, None));
    let all = afresh.into_iter().chain([first]).flatten();
    all.min_by(|a, b| misfit(a).total_cmp(&misfit(b))).map(|fit| fit.pose)
}

/// The pose that fits points in space, which at least two cameras give.
fn fit_of(
    setup: &Setup,
    cameras: &[Camera],
    layout: &Layout,
    sighted: &Sighted,
    former: Option<&[f64]>,
) -> Option<Fit> {
    let tree = setup.tree();
    let place = places(&tree, layout);
    let views = setup.views(cameras);
    let noise: Vec<CameraNoise> =
        views.iter().map(|view| CameraNoise::without_offset(view.sigma_px, view.usual_confidence)).collect();
    let used: Vec<Camera> = views.into_iter().map(|v| v.camera).collect();
    let points = points_in_space(&used, &noise, sighted, offsets::Config::default().least_confidence);
    let targets: Vec<Option<Target>> = place
        .iter()
        .map(|k| points.get((*k)?).copied().flatten().map(|(position, _)| Target { position, weight: 1.0 }))
        .collect();
    let start = match former {
        Some(pose) => Some(pose.to_vec()),
        None => initial_pose(&tree, &targets),
    };
    let Some(start) = start else { return own_body::pose(&tree, &targets, None) };
    let found = fit_pose(&Plan::with_all_points(&tree), &targets, &start, &POSE);
    found.rms_m.is_finite().then_some(found)
}
