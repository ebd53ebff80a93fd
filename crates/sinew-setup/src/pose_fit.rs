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
use sinew_observe::cameras::offsets::{self, CameraNoise, Sighted};
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SetupRequest;
    use crate::pass::{camera_setup, unmeasured};
    use sinew_body::point_derivatives::Neighbours;
    use sinew_body::standard::h32;
    use sinew_formats::layout;
    use std::f64::consts::PI;

    struct Scene {
        setup: Setup,
        cameras: Vec<Camera>,
        layout: Layout,
        tree: KinematicTree,
        body: Neighbours,
    }

    impl Scene {
        /// Three cameras around somebody of the usual size.
        fn new() -> Self {
            let places = [[3.0, 3.0, 1.5], [-3.0, 3.0, 1.2], [0.0, -4.0, 1.6]];
            let camera = |(k, place): (usize, [f64; 3])| {
                Camera::look_at(&format!("cam_{k}"), [1920.0, 1080.0], 1500.0, place, [0.0, 0.0, 1.0]).unwrap()
            };
            let cameras: Vec<Camera> = places.into_iter().enumerate().map(camera).collect();
            let layout = layout::find("BODY_25B").unwrap().clone();
            let noise = CameraNoise { offset_px: [0.0; 2], sigma_px: 3.0, usual_confidence: 0.8, residuals: 90 };
            let known = cameras.iter().map(|camera| camera_setup(camera, &noise, &[])).collect();
            let setup = unmeasured(&layout, &SetupRequest::default(), known);
            let tree = setup.tree();
            let points: Vec<usize> = (0..tree.points().len()).collect();
            let body = Neighbours::new(h32, &setup.proportions, &points);
            Self { setup, cameras, layout, tree, body }
        }

        fn at(&self, name: &str) -> usize {
            self.tree.dof_names().iter().position(|own| own == name).unwrap()
        }

        /// Keypoints of a pose without errors; `exchanged` points have the name of the other side.
        fn seen(&self, pose: &[f64], exchanged: &[&str]) -> Sighted {
            let positions = self.points(pose);
            let detected = |camera: &Camera| {
                let mut seen = vec![None; self.layout.points.len()];
                for (point, position) in self.tree.points().iter().zip(&positions) {
                    let is_exchanged = exchanged.iter().any(|name| point.name.ends_with(name));
                    let other = match (is_exchanged, point.name.split_at(1)) {
                        (true, ("L", name)) => format!("R{name}"),
                        (true, ("R", name)) => format!("L{name}"),
                        _ => point.name.clone(),
                    };
                    if let Some(k) = self.layout.index(&other) {
                        seen[k] = camera.project(*position).pixel().map(|at| Detection::new(at, 0.8));
                    }
                }
                seen
            };
            self.cameras.iter().map(detected).collect()
        }

        fn found(&self, both: (&Sighted, &Sighted), former: Option<&[f64]>) -> Vec<f64> {
            straight_pose_of(&self.setup, &self.cameras, &self.layout, both, former).unwrap()
        }

        /// Standing, elbows bent by an angle.
        fn standing(&self, elbow: f64) -> Vec<f64> {
            let mut pose = vec![0.0; self.tree.dof_names().len()];
            pose[self.at("pelvis.tz")] = 0.9;
            pose[self.at("l_forearm.rx")] = elbow;
            pose[self.at("r_forearm.rx")] = elbow;
            pose
        }

        /// Largest distance of a point in two poses, metres.
        fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
            let both = self.points(a).into_iter().zip(self.points(b));
            both.map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()).fold(0.0, f64::max)
        }

        fn points(&self, pose: &[f64]) -> Vec<[f64; 3]> {
            self.body.at(pose).positions.as_chunks().0.to_vec()
        }
    }

    /// An arm that is turned half round, its elbow bent backward, has its points where the true arm has them.
    #[test]
    fn an_elbow_does_not_stay_bent_backward() {
        let scene = Scene::new();
        let truth = scene.standing(0.7);
        let seen = scene.seen(&truth, &[]);
        let mut former = truth.clone();
        let [z, y, x, elbow] =
            ["l_upper_arm.rz", "l_upper_arm.ry", "l_upper_arm.rx", "l_forearm.rx"].map(|name| scene.at(name));
        (former[z], former[y], former[x], former[elbow]) = (truth[z] + PI, -truth[y], -truth[x], -truth[elbow]);
        assert!(scene.apart(&former, &truth) < 1e-9);
        let kept = pose_of(&scene.setup, &scene.cameras, &scene.layout, &seen, Some(&former)).unwrap();
        assert!((kept[elbow] + 0.7).abs() < 0.05, "{}", kept[elbow]);
        let found = scene.found((&seen, &seen), Some(&former));
        assert!((found[elbow] - 0.7).abs() < 0.05, "{}", found[elbow]);
    }

    /// Whether the sides were put right by mistake or were wrong before: the names that fit the body are taken.
    #[test]
    fn sides_are_as_the_body_fits_them() {
        let scene = Scene::new();
        let truth = scene.standing(0.7);
        let right = scene.seen(&truth, &[]);
        let wrong = scene.seen(&truth, &["Elbow", "Wrist"]);
        for both in [(&right, &wrong), (&wrong, &right)] {
            let found = scene.found(both, Some(&truth));
            assert!(scene.apart(&found, &truth) < 0.03, "{}", scene.apart(&found, &truth));
        }
        let found = pose_of(&scene.setup, &scene.cameras, &scene.layout, &wrong, Some(&truth)).unwrap();
        assert!(scene.apart(&found, &truth) > 0.1);
    }
}
