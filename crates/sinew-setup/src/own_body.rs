//! A body that the subject is not measured with, in the set-up pass: its poses and its model error.
//!
//! The body keeps the sizes of its file, or has the subject's. In each frame its pose is fitted to the points in space, from a first pose by way of its trunk and limbs
//! ([`sinew_body::initial`]), from that of the frame before, and, where it is built unlike the standard bodies, from eight headings. The model error per axis is
//!
//! ```text
//! m² = (1.4826 · median |J − P|)² · n/(n − d)  −  median of the points' own variances
//! ```
//!
//! over all points J in space and the fitted points P of the body, n coordinates and d degrees of freedom of the poses.

use super::collect::{Collected, SetupRequest};
use super::model_error::model_error_m;
use super::space_points::{Points, points_in_space};
use sinew_body::fit::{self, Fit, Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::{Axis, Joint, KinematicTree, Plan, point_positions};
use sinew_core::lanes::Isa;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::cameras::offsets::CameraNoise;

/// A few outliers must not bend a first pose.
pub(super) const POSE: fit::Config = fit::Config { damping: 1e-4, huber_m: 0.05, steps: 100, tolerance: 1e-9 };

/// Points that a pose needs.
const FEWEST: usize = 4;
/// Headings tried where nothing else suggests one.
const HEADINGS: usize = 8;

/// What the frames show about a body.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedBody {
    /// Distance between a keypoint and the body's point, per axis, metres.
    pub model_error_m: f64,
    /// Number of the first frame with a pose.
    pub start_frame: u64,
    /// State of the body in that frame.
    pub start_pose: Vec<f64>,
}

/// Fits the body to the collected frames; `None` where no frame shows enough of it.
#[must_use]
pub fn measure(
    tree: &KinematicTree,
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Option<FittedBody> {
    let plan = Plan::with_all_points(tree);
    let index: Vec<Option<usize>> = tree.points().iter().map(|p| layout.index(&p.name)).collect();
    let stride = collected.spread.len().div_ceil(request.shape_frames.max(1)).max(1);
    let mut first: Option<(u64, Vec<f64>)> = None;
    let mut former: Option<Vec<f64>> = None;
    let (mut residuals, mut variances, mut taken) = (vec![], vec![], 0.0);
    let mut at = vec![0.0; 3 * plan.points()];
    for (number, sighted) in collected.spread.iter().step_by(stride) {
        let points: Points = points_in_space(cameras, noise, sighted, request.offsets.least_confidence);
        let seen = |k: &Option<usize>| points.get((*k)?).copied().flatten();
        let target = |k: &Option<usize>| seen(k).map(|(position, _)| Target { position, weight: 1.0 });
        let targets: Vec<Option<Target>> = index.iter().map(target).collect();
        let Some(fit) = pose(tree, &targets, former.as_deref()) else { continue };
        point_positions(&plan, Isa::baseline(), &fit.pose, &mut at);
        for (p, target) in at.chunks_exact(3).zip(&targets) {
            residuals.extend(target.iter().flat_map(|t| (0..3).map(|a| t.position[a] - p[a])));
        }
        variances.extend(index.iter().filter_map(seen).map(|(_, variance)| variance));
        taken += tree.dof() as f64;
        first.get_or_insert_with(|| (*number, fit.pose.clone()));
        former = Some(fit.pose);
    }
    let (start_frame, start_pose) = first?;
    let model_error_m = model_error_m(&residuals, taken, &mut variances);
    Some(FittedBody { model_error_m, start_frame, start_pose })
}

/// The pose that fits the targets best, one for each point of the body or `None`; `former` is that of another frame.
#[must_use]
pub fn pose(tree: &KinematicTree, targets: &[Option<Target>], former: Option<&[f64]>) -> Option<Fit> {
    if targets.iter().flatten().count() < FEWEST {
        return None;
    }
    let plan = Plan::with_all_points(tree);
    let mut starts: Vec<Vec<f64>> = initial_pose(tree, targets).into_iter().collect();
    starts.extend(former.map(<[f64]>::to_vec));
    if starts.is_empty() {
        starts = upright(tree, &plan, targets);
    }
    starts
        .iter()
        .map(|start| fit_pose(&plan, targets, start, &POSE))
        .filter(|fit| fit.rms_m.is_finite())
        .min_by(|a, b| a.rms_m.total_cmp(&b.rms_m))
}

/// The zero pose turned to some headings about the root's z axis and moved to the targets, as far as the root can do that.
fn upright(tree: &KinematicTree, plan: &Plan, targets: &[Option<Target>]) -> Vec<Vec<f64>> {
    let Some(root) = tree.links().first() else { return vec![] };
    let count = targets.iter().flatten().count().max(1) as f64;
    let turn = root.joints.iter().position(|joint| *joint == Joint::Rotate(Axis::Z));
    let axes = [Axis::X, Axis::Y, Axis::Z];
    (0..if turn.is_some() { HEADINGS } else { 1 })
        .map(|h| {
            let mut start = vec![0.0; tree.dof()];
            if let Some(turn) = turn {
                start[turn] = std::f64::consts::TAU * h as f64 / HEADINGS as f64;
            }
            let mut at = vec![0.0; 3 * plan.points()];
            point_positions(plan, Isa::baseline(), &start, &mut at);
            for (dof, joint) in root.joints.iter().enumerate() {
                // Translations after a rotation go along turned axes; the fit settles them.
                if let Joint::Translate(axis) = joint
                    && turn.is_none_or(|turn| dof < turn)
                {
                    let a = axes.iter().position(|x| x == axis).unwrap_or(0);
                    let away = |(p, t): (&[f64], &Option<Target>)| t.map(|t| t.position[a] - p[a]);
                    start[dof] = at.chunks_exact(3).zip(targets).filter_map(away).sum::<f64>() / count;
                }
            }
            start
        })
        .collect()
}
