//! Half turns of limbs about themselves, which move none of their points when the hinge bends the other way.
//!
//! With rotations R_z(a) R_y(b) R_x(c) of the upper link, R_x(θ) of the lower one, and all points on their z axes,
//!
//! ```text
//! R_z(a) R_y(b) R_x(c) R_z(π) = R_z(a + π) R_y(−b) R_x(−c),      R_z(π) R_x(−θ) = R_x(θ) R_z(π)
//! ```
//!
//! so that (a + π, −b, −c, −θ) is another pose of the same points. A straight limb does not show which of the two it is in.

use crate::tree::KinematicTree;
use crate::{Axis, Joint};
use std::f64::consts::PI;

/// Joints of an upper link and of the hinge below it.
const UPPER: [Joint; 3] = [Joint::Rotate(Axis::Z), Joint::Rotate(Axis::Y), Joint::Rotate(Axis::X)];
const HINGE: [Joint; 1] = [Joint::Rotate(Axis::X)];

/// Coordinates of each limb that has two such poses: three of its upper link, one of its hinge.
#[must_use]
pub fn half_turns(tree: &KinematicTree) -> Vec<[usize; 4]> {
    let links = tree.links();
    let limb = |lower: usize| {
        let [x, y, _] = links[lower].offset;
        let upper = links[lower].parent.filter(|&upper| links[upper].plain_joints() == Some(&UPPER[..]))?;
        let first = tree.first_dof(upper);
        let is_hinge = links[lower].plain_joints() == Some(&HINGE[..]) && [x, y] == [0.0; 2];
        is_hinge.then(|| [first, first + 1, first + 2, tree.first_dof(lower)])
    };
    (0..links.len()).filter_map(limb).collect()
}

/// The other pose of a limb.
#[must_use]
pub fn half_turned(pose: &[f64], [z, y, x, hinge]: [usize; 4]) -> Vec<f64> {
    let mut other = pose.to_vec();
    other[z] -= PI.copysign(pose[z]);
    for place in [y, x, hinge] {
        other[place] = -pose[place];
    }
    other
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{cf28, h32};
    use crate::{Plan, Proportions, point_positions};
    use sinew_core::lanes::Isa;

    #[test]
    fn a_half_turn_moves_points_of_feet_only() {
        for tree in [h32(&Proportions::default()), cf28(&Proportions::default())] {
            let names = tree.dof_names();
            let limbs = half_turns(&tree);
            let hinges: Vec<&str> = limbs.iter().map(|[.., hinge]| names[*hinge].as_str()).collect();
            assert!(
                ["l_forearm.rx", "r_forearm.rx", "l_shin.rx"].iter().all(|name| hinges.contains(name)),
                "{hinges:?}"
            );
            let pose: Vec<f64> = (0..tree.dof()).map(|k| 0.7 * (1.3 * k as f64).sin()).collect();
            let plan = Plan::with_all_points(&tree);
            let points = |pose: &[f64]| {
                let mut points = vec![0.0; 3 * tree.points().len()];
                point_positions(&plan, Isa::baseline(), pose, &mut points);
                points
            };
            for limb in limbs {
                let other = half_turned(&pose, limb);
                assert!((other[limb[3]] + pose[limb[3]]).abs() < 1e-15);
                let both = points(&pose).into_iter().zip(points(&other)).collect::<Vec<_>>();
                for (point, both) in tree.points().iter().zip(both.chunks(3)) {
                    let apart = both.iter().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    let is_of_foot = ["Toe", "Heel"].iter().any(|end| point.name.ends_with(end));
                    assert!(apart < 1e-12 || is_of_foot, "{} {apart}", point.name);
                }
            }
        }
    }
}
