//! Which angles the keypoints of a frame show, whatever else is known.
//!
//! An interval says how well an angle is known from all frames and from the motion. Where a leg is straight, its turn about itself moves no joint centre, and what is known of it comes from earlier
//! frames and from how fast it may change. So it is asked what this frame's keypoints alone would say, were the pose otherwise unknown. With the derivatives J of the seen keypoints
//! in space by the degrees of freedom, at the mean pose,
//!
//! ```text
//! A = Jᵀ J / e² + W        sd² = gᵀ A⁻¹ g
//! ```
//!
//! e = 2 cm is an error of a keypoint in space (of the detector and of its place on the body), W lets each rotation be unknown by 1 rad and each translation by 1 m, and g is the gradient of the angle. An angle is
//! seen where sd is at most 20°: for a turn about a limb's own axis, where a keypoint lies at least 6 cm beside it. What moves only together with other angles (spine and girdle
//! about the same axis) is not seen. Without keypoints nothing is said.

use crate::results::estimate::{FrameEstimate, RunInfo};
use crate::results::joint_angles::JointAngles;
use sinew_body::{Joint, KinematicTree, Plan, point_jacobian};
use sinew_core::lanes::Isa;
use sinew_dynamics::factor::{cholesky, inverse_lower};

/// Error e of a keypoint in space, metres.
const ERROR_M: f64 = 0.02;
/// What each degree of freedom may be off by, radians or metres.
const UNKNOWN: f64 = 1.0;
/// Standard deviation up to which an angle is seen.
const SEEN_DEG: f64 = 20.0;
/// Difference for gradients, radians.
const DIFFERENCE: f64 = 1e-6;

pub(crate) struct Visibility {
    angles: JointAngles,
    /// The keypoints that are points of the body.
    plan: Plan,
    cameras: usize,
    /// Whether each degree of freedom is a rotation.
    rotates: Vec<bool>,
    is_known: bool,
}

impl Visibility {
    pub(crate) fn new(info: &RunInfo) -> Self {
        let body: &KinematicTree = &info.body;
        let points: Vec<usize> = info.keypoints.iter().filter_map(|name| body.point_index(name)).collect();
        let is_known = !info.has_masks && !points.is_empty() && points.len() == info.keypoints.len();
        Self {
            angles: info.angles.clone(),
            plan: Plan::new(body, &points),
            cameras: info.cameras.len(),
            rotates: body.joints().map(|(_, joint)| matches!(joint, Joint::Rotate(_))).collect(),
            is_known,
        }
    }

    /// Whether each angle is seen; `None` where that is not known.
    pub(crate) fn seen(&self, estimate: &FrameEstimate) -> Vec<Option<bool>> {
        let count = self.angles.names().len();
        let keypoints = self.plan.points();
        if !self.is_known || estimate.seen.len() != self.cameras * keypoints {
            return vec![None; count];
        }
        let is_seen =
            |point: &usize| (0..self.cameras).any(|camera| estimate.seen[camera * keypoints + point][0].is_finite());
        let points: Vec<usize> = (0..keypoints).filter(is_seen).collect();
        let Some(inverse) = self.inverse_root(&estimate.mean_state, &points) else { return vec![None; count] };
        let dof = self.rotates.len();
        let sd = |gradient: &Vec<f64>| {
            let row = |i: usize| (0..=i).map(|j| inverse[i * dof + j] * gradient[j]).sum::<f64>();
            (0..dof).map(|i| row(i).powi(2)).sum::<f64>().sqrt()
        };
        self.gradients(&estimate.mean_state).iter().map(|own| Some(sd(own) <= SEEN_DEG.to_radians())).collect()
    }

    /// L⁻¹ of A = L Lᵀ.
    fn inverse_root(&self, state: &[f64], seen: &[usize]) -> Option<Vec<f64>> {
        let dof = self.rotates.len();
        let mut positions = vec![0.0; 3 * self.plan.points()];
        let mut jacobian = vec![0.0; positions.len() * dof];
        point_jacobian(&self.plan, Isa::baseline(), state, &mut positions, &mut jacobian);
        let mut information = vec![0.0; dof * dof];
        (0..dof).for_each(|i| information[i * dof + i] = UNKNOWN.powi(-2));
        for row in seen.iter().flat_map(|point| jacobian[3 * point * dof..][..3 * dof].chunks_exact(dof)) {
            for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                let into = &mut information[i * dof..][..dof];
                into.iter_mut().zip(row).for_each(|(x, b)| *x += a * b / ERROR_M.powi(2));
            }
        }
        let factor = cholesky("what keypoints show", &information, dof).ok()?;
        Some(inverse_lower(&factor.lower, dof))
    }

    /// Gradient of each angle by the state.
    fn gradients(&self, state: &[f64]) -> Vec<Vec<f64>> {
        let raw = |state: &[f64], before: Option<&[f64]>| {
            let mut raw = vec![0.0; self.angles.raw_count()];
            self.angles.raw(state, before, &mut raw);
            raw
        };
        let here = raw(state, None);
        let count = self.angles.names().len();
        let mut gradients = vec![vec![0.0; state.len()]; count];
        let mut moved = state.to_vec();
        for dof in (0..state.len()).filter(|&dof| self.rotates[dof]) {
            moved[dof] = state[dof] + DIFFERENCE;
            let there = raw(&moved, Some(&here));
            moved[dof] = state[dof];
            for (angle, gradient) in gradients.iter_mut().enumerate() {
                let change = self.angles.signed(angle, &there) - self.angles.signed(angle, &here);
                gradient[dof] = change / DIFFERENCE;
            }
        }
        gradients
    }
}
