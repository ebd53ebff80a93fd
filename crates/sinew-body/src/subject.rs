//! The sizes of a subject from measured points: segment lengths, widths, and the offsets of the face and foot points.
//!
//! 1. [`from_distances`]: robust medians over the frames of the distances between joints, left and right pooled. What no distance tells keeps its default ratio to
//!    what was measured, and is listed.
//! 2. [`refine`]: all frames' poses and the sizes s together, by rounds of: fit every pose ([`fit_pose`]); then one Gauss–Newton step on s in which the poses move
//!    along. Points are linear in s at fixed angles, `P = P₀(q) + S(q) s`, so the step solves
//!
//! ```text
//! (Σ_f SᵀWS − SᵀWJ (JᵀWJ + λ)⁻¹ JᵀWS + prior) δs = Σ_f SᵀW r − SᵀWJ (JᵀWJ + λ)⁻¹ JᵀW r + prior
//! ```
//!
//! with J the derivatives by the angles of frame f and W Huber's weights over σ². The prior is a Gaussian around the sizes of step 1: it decides what poses and
//! sizes could trade (a head that always looks 5° lower has other face offsets).
//!
//! Lengths come out unbiased by noise, which medians of distances are not quite: noise of σ per axis adds σ²/length.

use crate::fit::{self, Target, fit_pose, measured};
use crate::initial::initial_pose;
use crate::kinematics::{Plan, point_jacobian, point_positions};
use crate::standard::Proportions;
use crate::tree::KinematicTree;
use nalgebra::{DMatrix, DVector};
use sinew_core::lanes::Isa;

const ISA: Isa = Isa::baseline();

/// A size: its name, whether it is a length (else a coordinate of an offset), and its place.
type Size = (&'static str, bool, fn(&mut Proportions) -> &mut f64);

/// Everything that [`refine`] may change. Points in the plane of symmetry have no x.
const SIZES: [Size; 28] = [
    ("spine", true, |p| &mut p.spine),
    ("shoulder_height", true, |p| &mut p.shoulder_height),
    ("shoulder_half_width", true, |p| &mut p.shoulder_half_width),
    ("hip_half_width", true, |p| &mut p.hip_half_width),
    ("pelvis_drop", true, |p| &mut p.pelvis_drop),
    ("upper_arm", true, |p| &mut p.upper_arm),
    ("forearm", true, |p| &mut p.forearm),
    ("thigh", true, |p| &mut p.thigh),
    ("shin", true, |p| &mut p.shin),
    ("head_top.y", false, |p| &mut p.head_top[1]),
    ("head_top.z", false, |p| &mut p.head_top[2]),
    ("nose.y", false, |p| &mut p.nose[1]),
    ("nose.z", false, |p| &mut p.nose[2]),
    ("eye.x", false, |p| &mut p.eye[0]),
    ("eye.y", false, |p| &mut p.eye[1]),
    ("eye.z", false, |p| &mut p.eye[2]),
    ("ear.x", false, |p| &mut p.ear[0]),
    ("ear.y", false, |p| &mut p.ear[1]),
    ("ear.z", false, |p| &mut p.ear[2]),
    ("heel.x", false, |p| &mut p.heel[0]),
    ("heel.y", false, |p| &mut p.heel[1]),
    ("heel.z", false, |p| &mut p.heel[2]),
    ("big_toe.x", false, |p| &mut p.big_toe[0]),
    ("big_toe.y", false, |p| &mut p.big_toe[1]),
    ("big_toe.z", false, |p| &mut p.big_toe[2]),
    ("small_toe.x", false, |p| &mut p.small_toe[0]),
    ("small_toe.y", false, |p| &mut p.small_toe[1]),
    ("small_toe.z", false, |p| &mut p.small_toe[2]),
];

/// Sizes with what is known about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The sizes, metres.
    pub proportions: Proportions,
    /// Names of those that no measurement told; they were scaled with the others.
    pub unmeasured: Vec<&'static str>,
    /// Mean ratio of the measured lengths to those of the default body.
    pub scale: f64,
}

/// All sizes times a factor.
#[must_use]
pub fn scaled(proportions: &Proportions, factor: f64) -> Proportions {
    let mut p = *proportions;
    for (_, _, size) in SIZES {
        *size(&mut p) *= factor;
    }
    p
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|x| x.is_finite());
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[n / 2]),
        n => Some(0.5 * (values[n / 2 - 1] + values[n / 2])),
    }
}

/// Sizes from the distances of points whose `names` are those of the standard bodies; each frame has one entry per name.
#[must_use]
pub fn from_distances(names: &[&str], frames: &[Vec<Option<[f64; 3]>>]) -> Measured {
    let at = |frame: &[Option<[f64; 3]>], name: &str| {
        let k = names.iter().position(|n| *n == name)?;
        frame.get(k).copied().flatten()
    };
    let between = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let middle = |frame: &[Option<[f64; 3]>], a: &str, b: &str| {
        let (a, b) = (at(frame, a)?, at(frame, b)?);
        Some([0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k])))
    };
    let length = |a: &str, b: &str| median(frames.iter().filter_map(|f| Some(between(at(f, a)?, at(f, b)?))).collect());
    let both = |a: &str, b: &str| {
        let sides: Vec<f64> =
            ["L", "R"].iter().filter_map(|s| length(&format!("{s}{a}"), &format!("{s}{b}"))).collect();
        (!sides.is_empty()).then(|| sides.iter().sum::<f64>() / sides.len() as f64)
    };
    let shoulders = |f: &[Option<[f64; 3]>]| middle(f, "LShoulder", "RShoulder");
    let hips = |f: &[Option<[f64; 3]>]| middle(f, "LHip", "RHip").or_else(|| at(f, "MidHip"));
    let trunk = median(frames.iter().filter_map(|f| Some(between(shoulders(f)?, hips(f)?))).collect());
    let neck = median(
        frames
            .iter()
            .filter_map(|f| {
                let (neck, top, bottom) = (at(f, "Neck")?, shoulders(f)?, hips(f)?);
                let length = between(top, bottom);
                Some((0..3).map(|k| (neck[k] - top[k]) * (top[k] - bottom[k])).sum::<f64>() / length)
            })
            .collect(),
    );

    let default = Proportions::default();
    let default_trunk = default.pelvis_drop + default.shoulder_height;
    let found = [
        (both("Shoulder", "Elbow"), default.upper_arm),
        (both("Elbow", "Wrist"), default.forearm),
        (both("Hip", "Knee"), default.thigh),
        (both("Knee", "Ankle"), default.shin),
        (length("LShoulder", "RShoulder").map(|w| 0.5 * w), default.shoulder_half_width),
        (length("LHip", "RHip").map(|w| 0.5 * w), default.hip_half_width),
        (trunk, default_trunk),
    ];
    let (mut sum, mut of) = (0.0, 0.0);
    for (found, default) in found {
        if let Some(found) = found {
            sum += found;
            of += default;
        }
    }
    let scale = if of > 0.0 && sum > 0.0 { sum / of } else { 1.0 };
    let mut p = scaled(&default, scale);
    let mut unmeasured = vec![];
    let mut set = |name, place: &mut f64, found: Option<f64>| match found {
        Some(found) => *place = found,
        None => unmeasured.push(name),
    };
    let [upper_arm, forearm, thigh, shin, shoulder, hip, _] = found;
    set("upper_arm", &mut p.upper_arm, upper_arm.0);
    set("forearm", &mut p.forearm, forearm.0);
    set("thigh", &mut p.thigh, thigh.0);
    set("shin", &mut p.shin, shin.0);
    set("shoulder_half_width", &mut p.shoulder_half_width, shoulder.0);
    set("hip_half_width", &mut p.hip_half_width, hip.0);
    let ratio = trunk.map(|t| t / default_trunk);
    set("pelvis_drop", &mut p.pelvis_drop, ratio.map(|r| r * default.pelvis_drop));
    set("shoulder_height", &mut p.shoulder_height, ratio.map(|r| r * default.shoulder_height));
    let above = neck.unwrap_or(scale * (default.spine - default.shoulder_height));
    p.spine = p.shoulder_height + above;
    if neck.is_none() {
        unmeasured.push("spine");
    }
    let seen = |name: &str| frames.iter().any(|f| at(f, name).is_some());
    let either = |name: &str| seen(&format!("L{name}")) || seen(&format!("R{name}"));
    for (name, measured) in [
        ("head_top", seen("Head")),
        ("nose", seen("Nose")),
        ("eye", either("Eye")),
        ("ear", either("Ear")),
        ("heel", either("Heel")),
        ("big_toe", either("BigToe")),
        ("small_toe", either("SmallToe")),
    ] {
        if !measured {
            unmeasured.push(name);
        }
    }
    Measured { proportions: p, unmeasured, scale }
}

/// How to refine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Rounds of poses and sizes.
    pub rounds: usize,
    /// Expected distance of a measured point from the body, per axis, metres.
    pub sigma_m: f64,
    /// Prior standard deviation of a length, metres.
    pub length_sd_m: f64,
    /// Prior standard deviation of a coordinate of an offset, metres.
    pub offset_sd_m: f64,
    /// Prior standard deviation of a degree of freedom's change from frame to frame.
    pub change_sd: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { rounds: 6, sigma_m: 0.02, length_sd_m: 0.05, offset_sd_m: 0.03, change_sd: 1.0 }
    }
}

/// Sizes and poses that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// The sizes, metres.
    pub proportions: Proportions,
    /// Pose of each frame; `None` where its points did not tell one.
    pub poses: Vec<Option<Vec<f64>>>,
}

/// Poses of all frames for one body, each started from the frame before or, where that fits badly, afresh.
#[must_use]
pub fn fit_poses(
    tree: &KinematicTree,
    frames: &[Vec<Option<Target>>],
    starts: &[Option<Vec<f64>>],
    config: &fit::Config,
) -> Vec<Option<Vec<f64>>> {
    let plan = Plan::with_all_points(tree);
    let mut previous: Option<Vec<f64>> = None;
    frames
        .iter()
        .enumerate()
        .map(|(f, targets)| {
            let start = starts.get(f).cloned().flatten();
            let fresh = || initial_pose(tree, targets).map(|pose| near(tree, &pose, previous.as_deref()));
            let start = start.or_else(|| previous.clone()).or_else(fresh)?;
            let mut found = fit_pose(&plan, targets, &start, config);
            if found.rms_m > 0.05 * extent(targets)
                && let Some(fresh) = initial_pose(tree, targets)
            {
                let again = fit_pose(&plan, targets, &near(tree, &fresh, previous.as_deref()), config);
                if again.rms_m < found.rms_m {
                    found = again;
                }
            }
            if !found.rms_m.is_finite() {
                return None;
            }
            previous = Some(found.pose.clone());
            Some(found.pose)
        })
        .collect()
}

/// The same pose with angles within half a turn of another's.
fn near(tree: &KinematicTree, pose: &[f64], other: Option<&[f64]>) -> Vec<f64> {
    let Some(other) = other else { return pose.to_vec() };
    let turn = std::f64::consts::TAU;
    pose.iter()
        .zip(other)
        .zip(tree.joints())
        .map(|((q, o), (_, joint))| match joint {
            crate::tree::Joint::Rotate(_) => q - turn * ((q - o) / turn).round(),
            crate::tree::Joint::Translate(_) => *q,
        })
        .collect()
}

/// Largest side of the box around the measured points, metres.
fn extent(targets: &[Option<Target>]) -> f64 {
    let range = |k: usize| {
        let values = measured(targets).map(|(_, t)| t.position[k]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    (0..3).map(range).fold(0.0, f64::max)
}

/// Refines sizes and poses of the body that `build` makes, given the measured points of each frame (one entry per point of the body).
#[must_use]
pub fn refine(
    build: fn(&Proportions) -> KinematicTree,
    start: &Proportions,
    frames: &[Vec<Option<Target>>],
    config: &Config,
) -> Subject {
    let weight = config.sigma_m.powi(-2);
    let huber_m = 2.0 * config.sigma_m;
    let damping = config.change_sd.powi(-2);
    let frames: Vec<Vec<Option<Target>>> = frames
        .iter()
        .map(|f| f.iter().map(|t| t.map(|t| Target { weight: t.weight * weight, ..t })).collect())
        .collect();
    let coarse = fit::Config { damping, huber_m, steps: 30, tolerance: 1e-5 };
    let mut proportions = *start;
    let mut poses = vec![];
    for _ in 0..config.rounds {
        let tree = build(&proportions);
        poses = fit_poses(&tree, &frames, &poses, &coarse);
        let (mut normal, mut right) = prior(start, &proportions, config);
        for (targets, pose) in frames.iter().zip(&poses) {
            if let Some(pose) = pose {
                add_frame(build, &proportions, targets, pose, damping, huber_m, &mut normal, &mut right);
            }
        }
        let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { break };
        let mut next = proportions;
        for ((_, length, size), step) in SIZES.iter().zip(step.iter()) {
            let place = size(&mut next);
            *place += step;
            if *length {
                *place = place.max(1e-3);
            }
        }
        if !step.iter().all(|x| x.is_finite()) {
            break;
        }
        proportions = next;
        if step.amax() < 1e-5 {
            break;
        }
    }
    let poses = fit_poses(&build(&proportions), &frames, &poses, &coarse);
    Subject { proportions, poses }
}

fn prior(start: &Proportions, now: &Proportions, config: &Config) -> (DMatrix<f64>, DVector<f64>) {
    let mut normal = DMatrix::zeros(SIZES.len(), SIZES.len());
    let mut right = DVector::zeros(SIZES.len());
    let (mut start, mut now) = (*start, *now);
    for (i, (_, length, size)) in SIZES.iter().enumerate() {
        let weight = if *length { config.length_sd_m } else { config.offset_sd_m }.powi(-2);
        normal[(i, i)] = weight;
        right[i] = weight * (*size(&mut start) - *size(&mut now));
    }
    (normal, right)
}

/// Adds a frame's share of the equations for the sizes, its pose eliminated.
#[allow(clippy::too_many_arguments)]
fn add_frame(
    build: fn(&Proportions) -> KinematicTree,
    proportions: &Proportions,
    targets: &[Option<Target>],
    pose: &[f64],
    damping: f64,
    huber_m: f64,
    normal: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
) {
    let tree = build(proportions);
    let plan = Plan::with_all_points(&tree);
    let (n, dof) = (3 * plan.points(), plan.dof());
    let (mut positions, mut jacobian) = (vec![0.0; n], vec![0.0; n * dof]);
    point_jacobian(&plan, ISA, pose, &mut positions, &mut jacobian);
    // Points are linear in every size: a difference of any length is the derivative.
    let by_size: Vec<Vec<f64>> = SIZES
        .iter()
        .map(|(_, _, size)| {
            let mut longer = *proportions;
            *size(&mut longer) += 1.0;
            let mut moved = vec![0.0; n];
            point_positions(&Plan::with_all_points(&build(&longer)), ISA, pose, &mut moved);
            moved.iter().zip(&positions).map(|(a, b)| a - b).collect()
        })
        .collect();
    let seen: Vec<(usize, Target)> = measured(targets).filter(|(k, _)| *k < plan.points()).collect();
    let mut j = DMatrix::zeros(dof, 3 * seen.len());
    let mut s = DMatrix::zeros(SIZES.len(), 3 * seen.len());
    let mut r = DVector::zeros(3 * seen.len());
    for (i, (k, target)) in seen.iter().enumerate() {
        let residual = [0, 1, 2].map(|a: usize| target.position[a] - positions[3 * k + a]);
        let distance = residual.iter().map(|x| x * x).sum::<f64>().sqrt();
        let root = (target.weight * (huber_m / distance).min(1.0)).sqrt();
        for a in 0..3 {
            let (row, column) = (3 * k + a, 3 * i + a);
            r[column] = root * residual[a];
            for d in 0..dof {
                j[(d, column)] = root * jacobian[row * dof + d];
            }
            for (size, moved) in by_size.iter().enumerate() {
                s[(size, column)] = root * moved[row];
            }
        }
    }
    let mut pose_normal = &j * j.transpose();
    for d in 0..dof {
        pose_normal[(d, d)] += damping;
    }
    let Some(pose_normal) = pose_normal.cholesky() else { return };
    let cross = &j * s.transpose();
    let solved = pose_normal.solve(&cross);
    *normal += &s * s.transpose() - cross.transpose() * &solved;
    *right += &s * &r - solved.transpose() * (&j * &r);
}
