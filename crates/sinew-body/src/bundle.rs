//! Sizes and poses of a subject together: bundle adjustment over joint angles (Triggs, McLauchlan, Hartley & Fitzgibbon 2000, §6.1).
//!
//! [`refine`] alternates: fit every pose ([`fit_pose`]); then one Gauss–Newton step on the sizes s in which the poses move along. Points are linear in s at fixed
//! angles, `P = P₀(q) + S(q) s`, so the step solves
//!
//! ```text
//! (Σ_f SᵀWS − SᵀWJ (JᵀWJ + λ)⁻¹ JᵀWS + prior) δs = Σ_f SᵀW r − SᵀWJ (JᵀWJ + λ)⁻¹ JᵀW r + prior
//! ```
//!
//! with J the derivatives by the angles of frame f and W Huber's weights over σ². The prior is a Gaussian around the sizes given at first: it decides what poses and
//! sizes could trade (a head that always looks 5° lower has other face offsets). What feet and ankles could trade the definition of the zero pose decides: steps keep the feet in their rest orientation
//! (the module `foot`) to first order, and after every step they are brought to it.

use crate::fit::{self, Target, fit_pose, measured};
use crate::foot::{FootPoints, levelled, rest_turn};
use crate::initial::initial_pose;
use crate::kinematics::{Plan, point_jacobian, point_positions};
use crate::sizes::SIZES;
use crate::standard::Proportions;
use crate::tree::{Joint, KinematicTree};
use nalgebra::{DMatrix, DVector};
use sinew_core::lanes::Isa;

const ISA: Isa = Isa::baseline();

/// How far a step may turn the feet out of their rest orientation, radians: little beside what any measurement says.
const LEVEL_SD: f64 = 1e-4;

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
pub struct BundleSolution {
    /// The sizes, metres.
    pub proportions: Proportions,
    /// Pose of each frame; `None` where its points did not determine one.
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
            let fresh = || initial_pose(tree, targets).map(|pose| turned(tree, pose, previous.as_deref()));
            let start = start.or_else(|| previous.clone()).or_else(fresh)?;
            let mut found = fit_pose(&plan, targets, &start, config);
            if found.rms_m > 0.05 * extent(targets)
                && let Some(fresh) = initial_pose(tree, targets)
            {
                let again = fit_pose(&plan, targets, &turned(tree, fresh, previous.as_deref()), config);
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
#[must_use]
pub fn within_half_a_turn(tree: &KinematicTree, pose: &[f64], other: &[f64]) -> Vec<f64> {
    let turn = std::f64::consts::TAU;
    pose.iter()
        .zip(other)
        .zip(tree.joints())
        .map(|((q, o), (_, joint))| match joint {
            Joint::Rotate(_) => q - turn * ((q - o) / turn).round(),
            Joint::Translate(_) => *q,
        })
        .collect()
}

fn turned(tree: &KinematicTree, pose: Vec<f64>, other: Option<&[f64]>) -> Vec<f64> {
    match other {
        Some(other) => within_half_a_turn(tree, &pose, other),
        None => pose,
    }
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
) -> BundleSolution {
    let weight = config.sigma_m.powi(-2);
    let huber_m = 2.0 * config.sigma_m;
    let damping = config.change_sd.powi(-2);
    let frames: Vec<Vec<Option<Target>>> = frames
        .iter()
        .map(|f| f.iter().map(|t| t.map(|t| Target { weight: t.weight * weight, ..t })).collect())
        .collect();
    let coarse = fit::Config { damping, huber_m, steps: 30, tolerance: 1e-5 };
    let feet = FootPoints::measured(&build(start), &frames);
    let mut proportions = levelled(start, start, feet);
    let mut poses = vec![];
    for _ in 0..config.rounds {
        let tree = build(&proportions);
        poses = fit_poses(&tree, &frames, &poses, &coarse);
        let (mut normal, mut right) = prior(start, &proportions, config);
        let plans = Plans::new(build, &proportions);
        for (targets, pose) in frames.iter().zip(&poses) {
            if let Some(pose) = pose {
                add_frame(&plans, targets, pose, damping, huber_m, &mut normal, &mut right);
            }
        }
        keep_feet_level(&mut normal, start, &proportions, feet);
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
        proportions = levelled(&next, start, feet);
        if step.amax() < 1e-5 {
            break;
        }
    }
    let poses = fit_poses(&build(&proportions), &frames, &poses, &coarse);
    BundleSolution { proportions, poses }
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

/// Forbids steps that turn the feet out of the rest orientation that `now` has.
fn keep_feet_level(normal: &mut DMatrix<f64>, start: &Proportions, now: &Proportions, feet: FootPoints) {
    const DIFFERENCE_M: f64 = 1e-6;
    let turn = |i: usize, by: f64| {
        let mut moved = *now;
        *SIZES[i].2(&mut moved) += by;
        rest_turn(&moved, start, feet)
    };
    let gradients = DMatrix::from_fn(SIZES.len(), 2, |i, k| {
        (turn(i, DIFFERENCE_M)[k] - turn(i, -DIFFERENCE_M)[k]) / (2.0 * DIFFERENCE_M)
    });
    normal.gemm(LEVEL_SD.powi(-2), &gradients, &gradients.transpose(), 1.0);
}

/// All points of a body, and of bodies in which one size after the other is a metre larger.
struct Plans {
    own: Plan,
    longer: Vec<Plan>,
}

impl Plans {
    fn new(build: fn(&Proportions) -> KinematicTree, proportions: &Proportions) -> Self {
        let longer = SIZES.iter().map(|(_, _, size)| {
            let mut longer = *proportions;
            *size(&mut longer) += 1.0;
            Plan::with_all_points(&build(&longer))
        });
        Self { own: Plan::with_all_points(&build(proportions)), longer: longer.collect() }
    }
}

/// Adds a frame's share of the equations for the sizes, its pose eliminated.
fn add_frame(
    plans: &Plans,
    targets: &[Option<Target>],
    pose: &[f64],
    damping: f64,
    huber_m: f64,
    normal: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
) {
    let plan = &plans.own;
    let (n, dof) = (3 * plan.points(), plan.dof());
    let (mut positions, mut jacobian) = (vec![0.0; n], vec![0.0; n * dof]);
    point_jacobian(plan, ISA, pose, &mut positions, &mut jacobian);
    // Points are linear in every size: a difference of any length is the derivative.
    let by_size: Vec<Vec<f64>> = (plans.longer.iter())
        .map(|longer| {
            let mut moved = vec![0.0; n];
            point_positions(longer, ISA, pose, &mut moved);
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
        for (a, residual) in residual.iter().enumerate() {
            let (row, column) = (3 * k + a, 3 * i + a);
            r[column] = root * residual;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Axis, Link};

    #[test]
    fn angles_are_brought_within_half_a_turn_and_places_are_left() {
        let joints = vec![Joint::Translate(Axis::X), Joint::Rotate(Axis::Z), Joint::Rotate(Axis::X)];
        let link = Link::new("only", None, [0.0; 3], joints);
        let tree = KinematicTree::new(vec![link], vec![]).expect("valid");
        let turn = std::f64::consts::TAU;
        let found = within_half_a_turn(&tree, &[9.0, 0.5, -1.0 - 2.0 * turn], &[-9.0, 3.0 * turn, 1.0]);
        assert!(found.iter().zip([9.0, 0.5 + 3.0 * turn, -1.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(turned(&tree, vec![9.0, 7.0, -8.0], None), [9.0, 7.0, -8.0]);
    }

    /// A pull on the toes alone turns the feet, unless steps keep them level: then they only get longer.
    #[test]
    fn a_step_keeps_the_feet_level() {
        let start = Proportions::default();
        let feet = FootPoints { heel: true, big_toe: true, small_toe: true };
        let mut pulled = start;
        for toe in [&mut pulled.big_toe, &mut pulled.small_toe] {
            *toe = [toe[0], toe[1] + 0.02, toe[2] - 0.02];
        }
        let difference =
            |(_, _, size): &(_, _, fn(&mut Proportions) -> &mut f64)| *size(&mut pulled) - *size(&mut start.clone());
        let right = DVector::from_iterator(SIZES.len(), SIZES.iter().map(difference));
        let stepped = |normal: DMatrix<f64>| {
            let mut next = start;
            let step = normal.cholesky().expect("positive definite").solve(&right);
            SIZES.iter().zip(step.iter()).for_each(|((_, _, size), step)| *size(&mut next) += step);
            next
        };
        let free = DMatrix::identity(SIZES.len(), SIZES.len());
        let mut level = free.clone();
        keep_feet_level(&mut level, &start, &start, feet);
        assert!(rest_turn(&stepped(free), &start, feet)[0] < -0.05);
        let kept = stepped(level);
        assert!(rest_turn(&kept, &start, feet).iter().all(|turn| turn.abs() < 2e-3), "{kept:?}");
        assert!(kept.big_toe[1] > start.big_toe[1] + 0.015, "{kept:?}");
    }

    #[test]
    fn the_extent_is_the_longest_side() {
        let target = |position| Some(Target { position, weight: 1.0 });
        let targets = [target([1.0, -2.0, 0.5]), None, target([0.5, 1.5, 0.0]), target([1.5, 0.0, 2.0])];
        assert_eq!(extent(&targets), 3.5);
        assert_eq!(extent(&[]), 0.0);
    }
}
