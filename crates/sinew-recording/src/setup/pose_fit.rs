//! The pose of a frame, fitted to points in space.

use super::one_camera;
use super::own_body::{self, POSE};
use super::space_points::points_in_space;
use super::stored::Setup;
use sinew_body::Plan;
use sinew_body::fit::{Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_formats::Layout;
use sinew_observe::offsets::{self, CameraNoise, Sighted};
use sinew_observe::{Camera, Detection};

/// The pose of one frame of the tracked person, afresh or from a former pose; `None` where too little is seen.
#[must_use]
pub fn pose_of(
    setup: &Setup,
    cameras: &[Camera],
    layout: &Layout,
    sighted: &Sighted,
    former: Option<&[f64]>,
) -> Option<Vec<f64>> {
    let tree = setup.tree();
    let place: Vec<Option<usize>> = tree.points().iter().map(|p| layout.index(&p.name)).collect();
    let views = setup.views(cameras);
    if let ([view], [seen]) = (&views[..], &sighted[..]) {
        let detections: Vec<Option<Detection>> =
            place.iter().map(|k| k.and_then(|k| seen.get(k).copied().flatten())).collect();
        return one_camera::pose_from_one_view(&tree, view, &detections).map(|fit| fit.pose);
    }
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
    let Some(start) = start else { return own_body::pose(&tree, &targets, None).map(|fit| fit.pose) };
    let found = fit_pose(&Plan::with_all_points(&tree), &targets, &start, &POSE);
    found.rms_m.is_finite().then_some(found.pose)
}
