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

use crate::JointAngles;
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

/// The angles of a body and its keypoints.
pub struct Visibility {
    angles: JointAngles,
    /// The keypoints that are points of the body.
    plan: Plan,
    /// Whether each degree of freedom is a rotation.
    rotates: Vec<bool>,
}

impl Visibility {
    /// For keypoints that are points of the body; `None` where there are none.
    #[must_use]
    pub fn new(angles: JointAngles, body: &KinematicTree, keypoints: &[String]) -> Option<Self> {
        let points: Vec<usize> = keypoints.iter().filter_map(|name| body.point_index(name)).collect();
        let is_known = !points.is_empty() && points.len() == keypoints.len();
        let rotates = body.joints().map(|(_, joint)| matches!(joint, Joint::Rotate(_))).collect();
        is_known.then(|| Self { angles, plan: Plan::new(body, &points), rotates })
    }

    /// Whether each angle is seen in a state, where these of the keypoints are seen; `None` for states that are no numbers.
    #[must_use]
    pub fn seen(&self, state: &[f64], keypoints: &[usize]) -> Option<Vec<bool>> {
        let inverse = self.inverse_root(state, keypoints)?;
        let dof = self.rotates.len();
        let sd = |gradient: &Vec<f64>| {
            let row = |i: usize| (0..=i).map(|j| inverse[i * dof + j] * gradient[j]).sum::<f64>();
            (0..dof).map(|i| row(i).powi(2)).sum::<f64>().sqrt()
        };
        Some(self.gradients(state).iter().map(|own| sd(own) <= SEEN_DEG.to_radians()).collect())
    }

    /// Whether each angle is seen in a state by cameras that show the keypoints at these pixels (camera by camera, NaN where one is missing); `None` where no camera is given.
    #[must_use]
    pub fn seen_by(&self, state: &[f64], pixels: &[[f64; 3]]) -> Option<Vec<bool>> {
        let count = self.plan.points();
        let is_seen = |point: &usize| pixels.iter().skip(*point).step_by(count).any(|pixel| pixel[0].is_finite());
        let is_whole = !pixels.is_empty() && pixels.len().is_multiple_of(count);
        is_whole.then(|| self.seen(state, &(0..count).filter(is_seen).collect::<Vec<_>>())).flatten()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Convention;
    use sinew_body::{Proportions, standard};

    const FEET: [&str; 6] = ["LHeel", "LBigToe", "LSmallToe", "RHeel", "RBigToe", "RSmallToe"];

    /// Names of the angles that are seen with the keypoints of COCO and some of the feet, at some angles of the body, radians.
    fn seen(feet: &[&str], bent: &[(&str, f64)]) -> Vec<String> {
        let body = standard::h32(&Proportions::default());
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let names = angles.names().to_vec();
        let others = sinew_formats::layout::find("COCO_17").unwrap().points.into_iter().flatten();
        let keypoints: Vec<String> = others.chain(feet.iter().map(|name| (*name).to_owned())).collect();
        let mut state = vec![0.0; body.dof()];
        for (name, angle) in bent {
            state[body.dof_names().iter().position(|own| own == name).unwrap()] = *angle;
        }
        let visibility = Visibility::new(angles, &body, &keypoints).unwrap();
        let found = visibility.seen(&state, &(0..keypoints.len()).collect::<Vec<_>>()).unwrap();
        names.into_iter().zip(found).filter(|(_, seen)| *seen).map(|(name, _)| name).collect()
    }

    #[test]
    fn a_straight_limb_does_not_show_its_turn_and_a_bent_one_does() {
        let bent = [("r_forearm.rx", 1.0), ("r_shin.rx", -1.0)];
        let straight = seen(&[], &[]);
        let flexed = seen(&[], &bent);
        for (name, is_straight) in
            [("arm_rot_r", false), ("hip_rotation_r", false), ("knee_angle_r", true), ("arm_flex_r", true)]
        {
            assert_eq!(straight.iter().any(|own| own == name), is_straight, "{name}");
            assert!(flexed.iter().any(|own| own == name), "{name}");
        }
        // The other side is straight still, and feet show the turn of a straight leg.
        assert!(!flexed.iter().any(|own| own == "arm_rot_l" || own == "hip_rotation_l"));
        let with_feet = seen(&FEET, &[]);
        assert!(with_feet.iter().any(|own| own == "hip_rotation_l") && !with_feet.iter().any(|own| own == "arm_rot_l"));
    }

    /// Two cameras that see two keypoints each.
    #[test]
    fn a_keypoint_is_seen_where_one_camera_sees_it() {
        let body = standard::h32(&Proportions::default());
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let keypoints = ["LHip", "RHip", "Neck"].map(str::to_owned);
        let visibility = Visibility::new(angles, &body, &keypoints).unwrap();
        let state = vec![0.0; body.dof()];
        let [seen, missing] = [[1.0; 3], [f64::NAN; 3]];
        let by = |pixels: &[[f64; 3]]| visibility.seen_by(&state, pixels);
        assert_eq!(by(&[seen, missing, missing, missing, seen, missing]), visibility.seen(&state, &[0, 1]));
        assert_eq!((by(&[]), by(&[seen])), (None, None));
        assert!(Visibility::new(visibility.angles.clone(), &body, &[]).is_none());
    }

    #[test]
    fn angles_of_which_only_the_sum_shows_are_not_seen() {
        let all = seen(&FEET, &[]);
        for name in ["lumbar_rotation", "girdle_rz", "head_rz"] {
            assert!(!all.iter().any(|own| own == name), "{name}");
        }
        assert!(all.iter().any(|own| own == "pelvis_rotation"));
    }
}
