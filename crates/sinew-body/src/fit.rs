//! Pose from points and orientations: nonlinear least squares on the joint angles by Levenberg–Marquardt.
//!
//! ```text
//! min_q  Σ_k v_k ρ(|J_k − P_k(q)|) + Σ_b w_b 4 sin²(θ_b(q)/2) + λ |q − q_previous|²
//! ```
//!
//! over the points k and the links b that were measured, with θ_b the angle between the orientation of a link and the measured one, and ρ the square or, beyond [`Config::huber_m`], Huber's continuation of it. Each step solves
//! `(JᵀVJ + λ + μ diag) δ = JᵀV r − λ (q − q_previous)`; μ falls after a success and rises after a failure (Marquardt 1963; Nielsen's rule is not needed here).
//! The starting pose comes from [`initial_pose`](crate::initial::initial_pose) or from the frame before.
//!
//! ```
//! use sinew_body::{fit, initial::initial_pose, standard::h32, Plan, Proportions, point_positions};
//! use sinew_core::lanes::Isa;
//!
//! let body = h32(&Proportions::default());
//! let plan = Plan::with_all_points(&body);
//! let mut truth = vec![0.1; body.dof()];
//! truth[3] = 2.5; // heading
//! let mut points = vec![0.0; 3 * plan.points()];
//! point_positions(&plan, Isa::baseline(), &truth, &mut points);
//!
//! let targets: Vec<_> = points.chunks(3).map(|p| Some(fit::Target { position: [p[0], p[1], p[2]], weight: 1.0 })).collect();
//! let start = initial_pose(&body, &targets).unwrap();
//! let config = fit::Config { damping: 0.0, ..fit::Config::default() };
//! let found = fit::fit_pose(&plan, &targets, &start, &config);
//! assert!(found.rms_m < 1e-6);
//! ```

use crate::kinematics::{Plan, point_jacobian, point_positions};
use crate::rotation::{Matrix, is_rotation};
use crate::tree::KinematicTree;
use nalgebra::{DMatrix, DVector};
use sinew_core::lanes::Isa;

/// Where a point was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// World position, metres.
    pub position: [f64; 3],
    /// Weight v of its squared distance.
    pub weight: f64,
}

/// How a link was measured to be turned, by an inertial sensor for example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Index of the link.
    pub link: usize,
    /// Its rotation, world from link.
    pub rotation: Matrix,
    /// Weight w of its squared angle, m²/rad² beside points of weight 1.
    pub weight: f64,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// λ: weight of the squared change of each degree of freedom since the previous pose.
    pub damping: f64,
    /// Distance from which on a point pulls with constant force, metres.
    pub huber_m: f64,
    /// Steps at most.
    pub steps: usize,
    /// The fit ends when a step changes no degree of freedom by more (radians, metres).
    pub tolerance: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { damping: 1e-4, huber_m: f64::INFINITY, steps: 100, tolerance: 1e-9 }
    }
}

/// A fitted pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The state.
    pub pose: Vec<f64>,
    /// Root of the weighted mean squared distance over the measured points, metres; NaN without any.
    pub rms_m: f64,
    /// Root of the weighted mean squared angle over the measured orientations, radians, where there are any.
    pub rms_rad: Option<f64>,
    /// Steps taken.
    pub steps: usize,
    /// Whether the last step was below the tolerance.
    pub converged: bool,
}

/// Instruction set for fitting: the one that every machine has, so that a fit is the same everywhere.
const ISA: Isa = Isa::baseline();

const FIRST_MU: f64 = 1e-3;
const LARGEST_MU: f64 = 1e12;

/// What pulls a point, or the step to it from another, towards a target.
struct Pull {
    point: usize,
    from: Option<usize>,
    target: [f64; 3],
    weight: f64,
    huber_m: f64,
}

/// Fits the pose to the measured points (one entry per point of the plan; `None` and non-finite ones do not count), starting from and damped towards `previous`.
///
/// Entries beyond the plan's points and degrees of freedom are ignored; a short `previous` counts as zeros.
#[must_use]
pub fn fit_pose(plan: &Plan, targets: &[Option<Target>], previous: &[f64], config: &Config) -> Fit {
    fit(plan, &pulls(targets, plan.points(), config), previous, config)
}

/// [`fit_pose`] with orientations of links besides; those of links that the body lacks, or that are no rotations, do not count.
///
/// ```
/// use sinew_body::fit::{Config, Orientation, fit_oriented};
/// use sinew_body::{Proportions, rotation, standard::h32};
///
/// let body = h32(&Proportions::default());
/// let shin = body.link_index("r_shin").ok_or("no shin")?;
/// let bent = Orientation { link: shin, rotation: rotation::about([1.0, 0.0, 0.0], -0.5), weight: 1.0 };
/// let found = fit_oriented(&body, &[], &[bent], &vec![0.0; body.dof()], &Config::default());
/// assert!(found.rms_rad.is_some_and(|angle| angle < 1e-3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn fit_oriented(
    tree: &KinematicTree,
    targets: &[Option<Target>],
    orientations: &[Orientation],
    previous: &[f64],
    config: &Config,
) -> Fit {
    let is_usable = |o: &&Orientation| {
        o.weight > 0.0 && o.weight.is_finite() && o.link < tree.links().len() && is_rotation(&o.rotation)
    };
    let usable: Vec<&Orientation> = orientations.iter().filter(is_usable).collect();
    let plan = Plan::with_all_points(&tree.with_frames_shown(usable.iter().map(|o| o.link)));
    let mut pulls = pulls(targets, tree.points().len(), config);
    for (k, Orientation { rotation, weight, .. }) in usable.iter().enumerate() {
        let origin = tree.points().len() + 4 * k;
        // |R − R'|² = 8 sin²(θ/2), a third of it an axis.
        pulls.extend((0..3).map(|axis| Pull {
            point: origin + 1 + axis,
            from: Some(origin),
            target: rotation.map(|row| row[axis]),
            weight: 0.5 * weight,
            huber_m: f64::INFINITY,
        }));
    }
    let found = fit(&plan, &pulls, previous, config);
    let frames = tree.link_frames(&found.pose);
    let total: f64 = usable.iter().map(|o| o.weight).sum();
    let squares = usable.iter().map(|o| o.weight * angle_between(&frames[o.link].0, &o.rotation).powi(2)).sum::<f64>();
    Fit { rms_rad: (total > 0.0).then(|| (squares / total).sqrt()), ..found }
}

/// Angle of the rotation between two, radians.
fn angle_between(a: &Matrix, b: &Matrix) -> f64 {
    let squares: f64 = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2)).sum();
    2.0 * (squares / 8.0).sqrt().min(1.0).asin()
}

fn fit(plan: &Plan, pulls: &[Pull], previous: &[f64], config: &Config) -> Fit {
    let dof = plan.dof();
    let mut previous = previous.to_vec();
    previous.resize(dof, 0.0);
    let n = 3 * plan.points();
    let (mut positions, mut jacobian) = (vec![0.0; n], vec![0.0; n * dof]);
    let mut pose = previous.clone();
    point_jacobian(plan, ISA, &pose, &mut positions, &mut jacobian);
    let mut cost = total(pulls, &positions, &pose, &previous, config);
    let mut mu = FIRST_MU;
    let (mut steps, mut converged) = (0, false);
    let (mut normal, mut gradient) = equations(pulls, &positions, &jacobian, &pose, &previous, config);
    while steps < config.steps && mu < LARGEST_MU {
        steps += 1;
        let mut damped = normal.clone();
        for j in 0..dof {
            // Degrees of freedom that no point depends on get a unit of their own.
            damped[(j, j)] += mu * normal[(j, j)].max(1e-6);
        }
        // Positive definite by the damping, unless something is not finite.
        let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else { break };
        let next: Vec<f64> = pose.iter().zip(step.iter()).map(|(q, d)| q + d).collect();
        point_positions(plan, ISA, &next, &mut positions);
        let next_cost = total(pulls, &positions, &next, &previous, config);
        if next_cost.is_nan() || next_cost > cost {
            mu *= 4.0;
            continue;
        }
        pose = next;
        cost = next_cost;
        mu = (0.2 * mu).max(1e-12);
        if step.amax() < config.tolerance {
            converged = true;
            break;
        }
        point_jacobian(plan, ISA, &pose, &mut positions, &mut jacobian);
        (normal, gradient) = equations(pulls, &positions, &jacobian, &pose, &previous, config);
    }
    converged |= mu >= LARGEST_MU;
    point_positions(plan, ISA, &pose, &mut positions);
    Fit { rms_m: rms(pulls, &positions), rms_rad: None, pose, steps, converged }
}

/// What the measured points among the first `count` pull.
fn pulls(targets: &[Option<Target>], count: usize, config: &Config) -> Vec<Pull> {
    let pull = |(point, target): (usize, Target)| {
        let Target { position, weight } = target;
        Pull { point, from: None, target: position, weight, huber_m: config.huber_m }
    };
    measured(targets).filter(|(k, _)| *k < count).map(pull).collect()
}

/// The measured points with their indices.
pub(crate) fn measured(targets: &[Option<Target>]) -> impl Iterator<Item = (usize, Target)> + '_ {
    let usable = |t: &Target| t.weight > 0.0 && t.weight.is_finite() && t.position.iter().all(|x| x.is_finite());
    targets.iter().enumerate().filter_map(move |(k, t)| t.filter(usable).map(|t| (k, t)))
}

impl Pull {
    /// Target minus position, component a.
    fn residual(&self, positions: &[f64], a: usize) -> f64 {
        self.target[a] - self.of(positions, |point| 3 * point + a)
    }

    /// A quantity of the point, or its difference to that of the other.
    fn of(&self, values: &[f64], place: impl Fn(usize) -> usize) -> f64 {
        let value = values[place(self.point)];
        self.from.map_or(value, |from| value - values[place(from)])
    }

    fn distance(&self, positions: &[f64]) -> f64 {
        (0..3).map(|a| self.residual(positions, a).powi(2)).sum::<f64>().sqrt()
    }
}

fn total(pulls: &[Pull], positions: &[f64], pose: &[f64], previous: &[f64], config: &Config) -> f64 {
    let points: f64 = pulls
        .iter()
        .map(|pull| {
            let (d, h) = (pull.distance(positions), pull.huber_m);
            pull.weight * if d <= h { d * d } else { h * (2.0 * d - h) }
        })
        .sum();
    points + config.damping * pose.iter().zip(previous).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
}

fn equations(
    pulls: &[Pull],
    positions: &[f64],
    jacobian: &[f64],
    pose: &[f64],
    previous: &[f64],
    config: &Config,
) -> (DMatrix<f64>, DVector<f64>) {
    let dof = pose.len();
    let mut rows = DMatrix::zeros(dof, 3 * pulls.len());
    let mut residual = DVector::zeros(3 * pulls.len());
    for (i, pull) in pulls.iter().enumerate() {
        let share = (pull.huber_m / pull.distance(positions)).min(1.0);
        let root = (pull.weight * share).sqrt();
        for a in 0..3 {
            for j in 0..dof {
                rows[(j, 3 * i + a)] = root * pull.of(jacobian, |point| (3 * point + a) * dof + j);
            }
            residual[3 * i + a] = root * pull.residual(positions, a);
        }
    }
    let mut normal = &rows * rows.transpose();
    let mut gradient = &rows * residual;
    for j in 0..dof {
        normal[(j, j)] += config.damping;
        gradient[j] -= config.damping * (pose[j] - previous[j]);
    }
    (normal, gradient)
}

fn rms(pulls: &[Pull], positions: &[f64]) -> f64 {
    let of_points = || pulls.iter().filter(|pull| pull.from.is_none());
    let weight: f64 = of_points().map(|pull| pull.weight).sum();
    (of_points().map(|pull| pull.weight * pull.distance(positions).powi(2)).sum::<f64>() / weight).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::initial::initial_pose;
    use crate::standard::{Proportions, cf28, h32};

    fn targets(plan: &Plan, q: &[f64]) -> Vec<Option<Target>> {
        let mut p = vec![0.0; 3 * plan.points()];
        point_positions(plan, Isa::best(), q, &mut p);
        p.chunks(3).map(|p| Some(Target { position: [p[0], p[1], p[2]], weight: 1.0 })).collect()
    }

    fn walking(tree: &KinematicTree, heading: f64) -> Vec<f64> {
        let mut q = vec![0.0; tree.dof()];
        q[..6].copy_from_slice(&[0.3, -1.2, 1.0, heading, 0.1, -0.1]);
        for (name, value) in [
            ("l_upper_arm.ry", 0.9),
            ("l_upper_arm.rx", -0.4),
            ("l_forearm.rx", 0.8),
            ("r_upper_arm.ry", -1.2),
            ("r_upper_arm.rx", 0.7),
            ("r_forearm.rx", 0.3),
            ("l_thigh.rx", 0.6),
            ("l_shin.rx", -0.7),
            ("r_thigh.rx", -0.2),
            ("r_thigh.ry", -0.1),
            ("r_shin.rx", -0.1),
            ("girdle.rz", 0.1),
        ] {
            let names = tree.dof_names();
            let j = names.iter().position(|n| n == name).expect("a degree of freedom of the body");
            q[j] = value;
        }
        q
    }

    /// Three points on a body that can only move along x and z: the minimum is a weighted mean.
    #[test]
    fn a_sliding_body_is_fitted_in_closed_form() {
        use crate::tree::{Axis, Joint, Link, Point};
        let joints = vec![Joint::Translate(Axis::X), Joint::Translate(Axis::Z)];
        let root = Link::new("root", None, [0.0; 3], joints);
        let offsets = [[0.0; 3], [1.0, 0.0, 0.5], [0.0, 2.0, -1.0]];
        let point = |(k, &offset): (usize, &[f64; 3])| Point { name: format!("{k}"), link: 0, offset };
        let tree = KinematicTree::new(vec![root], offsets.iter().enumerate().map(point).collect()).unwrap();
        let plan = Plan::with_all_points(&tree);
        let measured = [([0.3, 0.1, 0.2], 1.0), ([1.5, -0.2, 0.4], 2.0), ([0.1, 2.3, -0.9], 4.0)];
        let targets: Vec<_> =
            measured.map(|(position, weight)| Some(Target { position, weight })).into_iter().chain([None]).collect();
        let (damping, previous) = (3.0, [-0.5, 0.25]);
        let config = Config { damping, ..Config::default() };
        let found = fit_pose(&plan, &targets, &previous, &config);
        for (j, axis) in [0, 2].into_iter().enumerate() {
            let pulls = measured.iter().zip(offsets).map(|((p, w), o)| w * (p[axis] - o[axis])).sum::<f64>();
            let expected = (pulls + damping * previous[j]) / (7.0 + damping);
            assert!((found.pose[j] - expected).abs() < 1e-9, "{} for {expected}", found.pose[j]);
        }
        let square = |(k, (p, w)): (usize, &([f64; 3], f64))| {
            let at = [offsets[k][0] + found.pose[0], offsets[k][1], offsets[k][2] + found.pose[1]];
            w * (0..3).map(|a| (p[a] - at[a]).powi(2)).sum::<f64>()
        };
        let rms = (measured.iter().enumerate().map(square).sum::<f64>() / 7.0).sqrt();
        assert!((found.rms_m - rms).abs() < 1e-12 && found.converged && found.steps < 10, "{found:?}");
        // A short pose counts as zeros; one step is one step, and not the end.
        let short = fit_pose(&plan, &targets, &[-0.5], &Config { steps: 1, ..config });
        assert_eq!((short.pose.len(), short.steps, short.converged), (2, 1, false));
        assert_eq!(fit_pose(&plan, &targets, &previous, &Config { steps: 0, ..config }).pose, previous);
        // Weights that are no weights do not count.
        let odd = |weight: f64| [targets[0], targets[1].map(|t| Target { weight, ..t }), targets[2]];
        let without = fit_pose(&plan, &[targets[0], None, targets[2]], &previous, &config);
        for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(fit_pose(&plan, &odd(weight), &previous, &config), without, "{weight}");
        }
    }

    #[test]
    fn the_objective_is_squares_up_to_the_bound_and_lines_beyond() {
        let target = |x: f64, weight: f64| Target { position: [x, 0.0, 0.0], weight };
        let config = Config { damping: 0.25, huber_m: 0.5, ..Config::default() };
        let pulls = pulls(&[Some(target(0.3, 2.0)), Some(target(-2.0, 3.0))], 2, &config);
        let found = total(&pulls, &[0.0; 6], &[1.0, 2.0], &[1.0, -1.0], &config);
        let expected = 2.0 * 0.09 + 3.0 * 0.5 * (2.0 * 2.0 - 0.5) + 0.25 * 9.0;
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }

    /// With Huber's continuation and damping: the slopes of the objective, written out, vanish where the fit ends.
    #[test]
    fn a_robust_fit_is_a_minimum_of_its_objective() {
        let tree = cf28(&Proportions::default());
        let plan = Plan::with_all_points(&tree);
        let truth = walking(&tree, 0.4);
        let mut targets = targets(&plan, &truth);
        for (k, target) in targets.iter_mut().flatten().enumerate() {
            target.weight = 1.0 + 0.3 * (k % 4) as f64;
            target.position[k % 3] += if k % 5 == 0 { 0.3 } else { 0.02 };
        }
        let config = Config { damping: 0.05, huber_m: 0.04, steps: 1000, ..Config::default() };
        let previous: Vec<f64> = truth.iter().map(|q| q - 0.05).collect();
        let found = fit_pose(&plan, &targets, &previous, &config);
        let objective = |pose: &[f64]| {
            let mut at = vec![0.0; 3 * plan.points()];
            point_positions(&plan, Isa::baseline(), pose, &mut at);
            let one = |(p, t): (&[f64], &Option<Target>)| {
                let t = t.unwrap();
                let d = (0..3).map(|a| (p[a] - t.position[a]).powi(2)).sum::<f64>().sqrt();
                t.weight * if d < 0.04 { d * d } else { 0.04 * (2.0 * d - 0.04) }
            };
            let change: f64 = pose.iter().zip(&previous).map(|(a, b)| (a - b).powi(2)).sum();
            at.chunks(3).zip(&targets).map(one).sum::<f64>() + 0.05 * change
        };
        for j in 0..tree.dof() {
            let moved = |by: f64| {
                let mut pose = found.pose.clone();
                pose[j] += by;
                objective(&pose)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(slope.abs() < 1e-6, "{}: {slope}", tree.dof_names()[j]);
        }
        assert!(found.converged, "{} steps", found.steps);
    }

    /// Two measured orientations of one hinge: the minimum is the direction of their weighted sum.
    #[test]
    fn a_hinge_between_two_orientations_is_fitted_in_closed_form() {
        use crate::rotation::about;
        use crate::tree::{Axis, Joint, Link};
        let axis = [0.6, 0.0, 0.8];
        let hinge = Link::new("hinge", None, [0.0; 3], vec![Joint::Rotate(Axis::along(axis).unwrap())]);
        let tree = KinematicTree::new(vec![hinge], vec![]).unwrap();
        let measured = [(0.3, 1.0), (1.1, 3.0)];
        let orientations =
            measured.map(|(angle, weight)| Orientation { link: 0, rotation: about(axis, angle), weight });
        let config = Config { damping: 0.0, ..Config::default() };
        let found = fit_oriented(&tree, &[], &orientations, &[0.0], &config);
        let sum = |of: fn(f64) -> f64| measured.iter().map(|(angle, weight)| weight * of(*angle)).sum::<f64>();
        let expected = sum(f64::sin).atan2(sum(f64::cos));
        assert!((found.pose[0] - expected).abs() < 1e-9, "{} for {expected}", found.pose[0]);
        let squares = measured.iter().map(|(angle, weight)| weight * (angle - expected).powi(2)).sum::<f64>();
        assert!((found.rms_rad.unwrap() - (squares / 4.0).sqrt()).abs() < 1e-9);
        // What is no rotation, of no link or without weight does not count.
        let [first, _] = orientations;
        for odd in [
            Orientation { link: 1, ..first },
            Orientation { rotation: [[f64::NAN; 3]; 3], ..first },
            Orientation { rotation: [[1.0; 3]; 3], ..first },
            Orientation { weight: f64::NAN, ..first },
        ] {
            let without = fit_oriented(&tree, &[], &[odd], &[0.2], &config);
            assert_eq!((without.pose, without.rms_rad), (vec![0.2], None));
        }
    }

    /// Fitting a body to its own points recovers them (K15), from every heading.
    #[test]
    fn a_body_is_fitted_to_its_own_points_from_any_heading() {
        for tree in [cf28(&Proportions::default()), h32(&Proportions::default())] {
            let plan = Plan::with_all_points(&tree);
            for heading in 0..12 {
                let truth = walking(&tree, 0.55 * f64::from(heading) - 3.0);
                let targets = targets(&plan, &truth);
                let start = initial_pose(&tree, &targets).unwrap();
                let found = fit_pose(&plan, &targets, &start, &Config { damping: 0.0, ..Config::default() });
                assert!(found.converged && found.rms_m < 1e-6, "heading {heading}: {} m", found.rms_m);
                let elbow = tree.first_dof(tree.link_index("l_forearm").unwrap());
                assert!((found.pose[elbow] - 0.8).abs() < 1e-4, "{}", found.pose[elbow]);
            }
        }
    }

    #[test]
    fn missing_points_leave_the_rest_in_place() {
        let tree = h32(&Proportions::default());
        let plan = Plan::with_all_points(&tree);
        let truth = walking(&tree, 1.0);
        let mut few = targets(&plan, &truth);
        for name in ["LWrist", "RKnee", "Nose", "LEar", "RHeel"] {
            few[tree.point_index(name).unwrap()] = None;
        }
        few[0] = Some(Target { position: [f64::NAN; 3], weight: 1.0 });
        let found = fit_pose(&plan, &few, &initial_pose(&tree, &few).unwrap(), &Config::default());
        assert!(found.rms_m < 2e-3, "{}", found.rms_m);
        let none = fit_pose(&plan, &vec![None; plan.points()], &truth, &Config::default());
        assert_eq!(none.pose, truth);
        assert!(none.rms_m.is_nan());
    }

    #[test]
    fn one_wrong_point_moves_a_robust_fit_little() {
        let tree = h32(&Proportions::default());
        let plan = Plan::with_all_points(&tree);
        let truth = walking(&tree, -2.0);
        let mut wrong = targets(&plan, &truth);
        let hip = tree.point_index("RHip").unwrap();
        if let Some(t) = &mut wrong[hip] {
            t.position[0] += 0.5;
        }
        let mut expected = vec![0.0; 3 * plan.points()];
        point_positions(&plan, Isa::best(), &truth, &mut expected);
        let moved = |huber_m| {
            let found = fit_pose(&plan, &wrong, &truth, &Config { huber_m, damping: 1e-6, ..Config::default() });
            let mut at = vec![0.0; 3 * plan.points()];
            point_positions(&plan, Isa::best(), &found.pose, &mut at);
            at.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let (squares, robust) = (moved(f64::INFINITY), moved(0.005));
        assert!(robust < 0.03 && squares > 5.0 * robust, "{robust} m, {squares} m with squares");
    }
}
