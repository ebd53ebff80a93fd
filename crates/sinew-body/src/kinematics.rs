//! Forward kinematics and the backward sweep over lanes.
//!
//! A [`Plan`] is a [`KinematicTree`](crate::KinematicTree) flattened for evaluation. It works in a caller's workspace ([`Plan::pass`]), on one state or on a block of eight:
//!
//! 1. [`Plan::forward`] walks from the root outwards, computes the frame of each link (columns of `R`, origin `p`) and the world axis `u` of each degree of freedom, and shows
//!    the caller the position `P` of each point. The caller answers with a force `g = ∂E/∂P`; f and n sum the forces and moments about the *world* origin of each link's points.
//! 2. [`Plan::pullback`] walks back. Children's f and n are added to their parents' without any shift, and
//!
//! ```text
//! revolute j of link b:      ∂E/∂q_j = u_j · (n_b − p_b × f_b)
//! translation j of link b:   ∂E/∂q_j = u_j · f_b
//! ```
//!
//! [`Plan::sweep`] does both, for the built-in bodies in straight-line code that the build script writes. Points never go through memory. Cost O(links + points + degrees of freedom); nothing is allocated. [`Plan::gauss_newton`] gives the curvature.

mod gauss_newton;
mod jacobian;
mod plan;
mod positions;
mod straight_line;
mod structure;
mod sweep;
mod vector;
mod visit;

pub use gauss_newton::Inform;
pub use jacobian::{point_jacobian, point_jacobian_each};
pub use plan::Plan;
pub use positions::{point_positions, point_positions_block, point_positions_each, point_positions_into};
pub use vector::V3;
pub use visit::{Pass, Visit};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{Proportions, cf28, h32};
    use crate::tree::{Axis, Joint, KinematicTree, Link, Point};
    use sinew_core::lanes::Isa;

    fn positions(tree: &KinematicTree, q: &[f64]) -> Vec<[f64; 3]> {
        let plan = Plan::with_all_points(tree);
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(&plan, Isa::best(), q, &mut out);
        out.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// Positions at the zero pose (K1).
    #[test]
    fn at_the_zero_pose_points_lie_at_the_cumulative_offsets() {
        for tree in [cf28(&Proportions::default()), h32(&Proportions::default())] {
            for (point, found) in tree.points().iter().zip(positions(&tree, &vec![0.0; tree.dof()])) {
                let mut expected = point.offset;
                let mut link = Some(point.link);
                while let Some(index) = link {
                    for (e, o) in expected.iter_mut().zip(tree.links()[index].offset) {
                        *e += o;
                    }
                    link = tree.links()[index].parent;
                }
                assert!(distance(expected, found) < 1e-14, "{}", point.name);
            }
        }
    }

    /// Rigid invariance (K2).
    #[test]
    fn turning_and_shifting_the_root_moves_every_point_rigidly() {
        let tree = h32(&Proportions::default());
        let mut q: Vec<f64> = (0..tree.dof()).map(|j| 0.3 * (j as f64).sin()).collect();
        q[3..6].fill(0.0);
        let before = positions(&tree, &q);
        let origin = [q[0], q[1], q[2]];
        q[3] = 0.7;
        for (x, shift) in q.iter_mut().zip([0.1, -2.0, 0.4]) {
            *x += shift;
        }
        let (s, c) = 0.7_f64.sin_cos();
        for (a, b) in before.into_iter().zip(positions(&tree, &q)) {
            let (x, y) = (a[0] - origin[0], a[1] - origin[1]);
            let expected = [c * x - s * y + origin[0] + 0.1, s * x + c * y + origin[1] - 2.0, a[2] + 0.4];
            assert!(distance(expected, b) < 1e-12);
        }
    }

    /// Order of the rotations of a link (K3).
    #[test]
    fn rotations_act_left_to_right_as_listed() {
        let half_turn = std::f64::consts::FRAC_PI_2;
        let link = Link::new("root", None, [0.0; 3], [Axis::Z, Axis::Y, Axis::X].map(Joint::Rotate).to_vec());
        let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .iter()
            .enumerate()
            .map(|(k, &offset)| Point { name: k.to_string(), link: 0, offset })
            .collect();
        let tree = KinematicTree::new(vec![link], points).expect("valid");
        let cases = [
            ([half_turn, 0.0, 0.0], [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            ([0.0, half_turn, 0.0], [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
            ([0.0, 0.0, half_turn], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
            ([half_turn, half_turn, 0.0], [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        ];
        for (q, expected) in cases {
            for (found, expected) in positions(&tree, &q).into_iter().zip(expected) {
                assert!(distance(found, expected) < 1e-15);
            }
        }
    }

    #[test]
    fn a_link_may_translate_after_it_has_rotated() {
        let joints = vec![Joint::Rotate(Axis::Z), Joint::Translate(Axis::X), Joint::Rotate(Axis::Z)];
        let tree = KinematicTree::new(
            vec![Link::new("a", None, [0.0; 3], joints)],
            vec![Point { name: "p".into(), link: 0, offset: [1.0, 0.0, 0.0] }],
        )
        .expect("valid");
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!(distance(positions(&tree, &[quarter, 2.0, quarter])[0], [-1.0, 2.0, 0.0]) < 1e-15);
        let plan = Plan::with_all_points(&tree);
        let (mut p, mut jacobian) = ([0.0; 3], [0.0; 9]);
        point_jacobian(&plan, Isa::best(), &[quarter, 2.0, quarter], &mut p, &mut jacobian);
        let expected = [-2.0, 0.0, 0.0, -1.0, 1.0, -1.0, 0.0, 0.0, 0.0];
        assert!(jacobian.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{jacobian:?}");
    }
}
