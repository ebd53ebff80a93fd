//! BVH skeleton and channels of a kinematic tree.
//!
//! A BVH file shows the body with all channels 0 in its *rest pose*, which for us is the T-pose, while our links have
//! frames of their own. With `A` the turn from world axes to file axes, `Q_i` the world rotation of link i in the rest
//! pose and `R_i` in a frame, the file's joint i turns by
//!
//! ```text
//! G_i = A R_i Q_iᵀ Aᵀ,      B_i = G_parentᵀ G_i = R_z R_y R_x,      OFFSET_i = A Q_parent offset_i
//! ```
//!
//! so that `G_parent OFFSET_i = A R_parent offset_i`: bones keep their places. Angles are the nearest to the
//! frame before, so that curves do not jump.

use super::{Channel, Joint, bvh_from_world};
use crate::rotation::{IDENTITY, Matrix, apply, product, to_zyx, transpose};
use sinew_body::KinematicTree;

/// Axes of the file from axes of the world.
const FILE_FROM_WORLD: Matrix = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];

/// Shorter end sites are left out: programs draw them as bones without direction.
const MIN_TIP_M: f64 = 1e-6;

/// Skeleton of a tree, and what is needed to make its channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Joints, depth first.
    pub joints: Vec<Joint>,
    /// Link of each joint.
    links: Vec<usize>,
    /// `Q_iᵀ Aᵀ` of each link.
    rest: Vec<Matrix>,
}

impl Skeleton {
    /// Makes the skeleton from a tree and the world rotation of each link in the rest pose; links beyond the end of
    /// `rest` have no rotation there.
    ///
    /// Each link becomes a joint at its origin. A link without children ends at the point of the body that lies farthest
    /// from its origin. The root gets position channels.
    #[must_use]
    pub fn new(tree: &KinematicTree, rest: &[Matrix]) -> Self {
        let rest_of = |link: usize| rest.get(link).copied().unwrap_or(IDENTITY);
        let links = depth_first(tree);
        let mut joints: Vec<Joint> = Vec::with_capacity(links.len());
        for &index in &links {
            let Some(link) = tree.links().get(index) else { continue };
            // Adding 0 turns −0 into 0.
            let in_rest =
                |link: usize, offset: [f64; 3]| bvh_from_world(apply(&rest_of(link), offset)).map(|v| v + 0.0);
            let rotations = [2, 1, 0].map(Channel::Rotation);
            let (offset, channels) = match link.parent {
                Some(parent) => (in_rest(parent, link.offset), rotations.to_vec()),
                None => ([0.0; 3], [0, 1, 2].map(Channel::Position).into_iter().chain(rotations).collect()),
            };
            let has_children = tree.links().iter().any(|other| other.parent == Some(index));
            let tip = if has_children { None } else { farthest_point(tree, index) };
            joints.push(Joint {
                name: link.name.replace(['{', '}'], "").split_whitespace().collect::<Vec<_>>().join("_"),
                parent: link.parent.and_then(|parent| links.iter().position(|&link| link == parent)),
                offset,
                channels,
                end_site: tip.map(|tip| in_rest(index, tip)),
            });
        }
        let rest = (0..tree.links().len()).map(|link| transpose(&product(&FILE_FROM_WORLD, &rest_of(link)))).collect();
        Self { joints, links, rest }
    }

    /// Row of the motion table for a pose: world rotation of each link and the root's origin in the world.
    ///
    /// `previous` is the row before, if there is one. Links without a rotation keep that of the rest pose.
    #[must_use]
    pub fn channels(&self, rotations: &[Matrix], root: [f64; 3], previous: Option<&[f64]>) -> Vec<f64> {
        let turn = |link: usize| match (rotations.get(link), self.rest.get(link)) {
            (Some(rotation), Some(rest)) => product(&product(&FILE_FROM_WORLD, rotation), rest),
            _ => IDENTITY,
        };
        let mut row: Vec<f64> = Vec::new();
        for (joint, &link) in self.joints.iter().zip(&self.links) {
            let global = turn(link);
            let local = match joint.parent.and_then(|parent| self.links.get(parent)) {
                Some(&parent) => product(&transpose(&turn(parent)), &global),
                None => {
                    row.extend(bvh_from_world(root));
                    global
                }
            };
            let before = previous.and_then(|row_before| row_before.get(row.len()..row.len() + 3));
            row.extend(nearest_angles(to_zyx(&local).map(f64::to_degrees), before).map(|angle| angle + 0.0));
        }
        row
    }
}

fn depth_first(tree: &KinematicTree) -> Vec<usize> {
    let roots = tree.links().iter().enumerate().filter(|(_, link)| link.parent.is_none()).map(|(i, _)| i);
    let mut pending: Vec<usize> = roots.collect();
    pending.reverse();
    let mut order = Vec::with_capacity(tree.links().len());
    while let Some(index) = pending.pop() {
        order.push(index);
        let children = tree.links().iter().enumerate().filter(|(_, link)| link.parent == Some(index));
        let first_child = pending.len();
        pending.extend(children.map(|(child, _)| child));
        pending.split_at_mut(first_child).1.reverse();
    }
    order
}

fn farthest_point(tree: &KinematicTree, link: usize) -> Option<[f64; 3]> {
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let own = tree.points().iter().filter(|point| point.link == link).map(|point| point.offset);
    own.filter(|&offset| length(offset) > MIN_TIP_M).max_by(|a, b| length(*a).total_cmp(&length(*b)))
}

/// Of all angles that mean the same rotation, those nearest to the angles before.
fn nearest_angles([z, y, x]: [f64; 3], before: Option<&[f64]>) -> [f64; 3] {
    let Some(&[bz, by, bx]) = before else { return [z, y, x] };
    let near = |angle: f64, target: f64| angle + 360.0 * ((target - angle) / 360.0).round();
    let candidates =
        [[z, y, x], [z + 180.0, 180.0 - y, x + 180.0]].map(|[z, y, x]| [near(z, bz), near(y, by), near(x, bx)]);
    let distance = |[z, y, x]: [f64; 3]| (z - bz).abs() + (y - by).abs() + (x - bx).abs();
    let [first, second] = candidates;
    if distance(second) < distance(first) { second } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::forward_kinematics;
    use crate::rotation::{about_axis, from_rodrigues};
    use sinew_body::{Link, Point};

    /// Root with two branches; links are given breadth first, which a BVH file cannot keep.
    fn tree() -> KinematicTree {
        let link = |name: &str, parent, offset| Link { name: name.into(), parent, offset, joints: Vec::new() };
        let links = vec![
            link("pelvis", None, [0.0; 3]),
            link("left", Some(0), [-0.1, 0.0, -0.1]),
            link("right", Some(0), [0.1, 0.0, -0.1]),
            link("left_shin", Some(1), [0.0, 0.0, -0.4]),
        ];
        let point = |name: &str, link, offset| Point { name: name.into(), link, offset };
        let points = vec![point("RKnee", 2, [0.0, 0.0, -0.4]), point("LAnkle", 3, [0.0, 0.05, -0.4])];
        KinematicTree::new(links, points).unwrap()
    }

    #[test]
    fn bones_lie_where_the_tree_has_them() {
        let tree = tree();
        let rest = [IDENTITY, about_axis(1, 1.2), IDENTITY, about_axis(1, 1.2)];
        let skeleton = Skeleton::new(&tree, &rest);
        let rotations = [[0.3, -2.0, 0.5], [1.0, 0.2, -3.0], [0.1, 0.1, 0.1], [-2.0, 1.0, 0.4]].map(from_rodrigues);
        let root = [1.0, 2.0, 0.9];
        let row = skeleton.channels(&rotations, root, None);
        let points = forward_kinematics(&skeleton.joints, &row);

        let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let left = add(root, apply(&rotations[0], [-0.1, 0.0, -0.1]));
        let shin = add(left, apply(&rotations[1], [0.0, 0.0, -0.4]));
        let ankle = add(shin, apply(&rotations[3], [0.0, 0.05, -0.4]));
        let right = add(root, apply(&rotations[0], [0.1, 0.0, -0.1]));
        let knee = add(right, apply(&rotations[2], [0.0, 0.0, -0.4]));
        let expected = [root, left, shin, ankle, right, knee];
        assert_eq!(points.len(), expected.len());
        for (found, expected) in points.into_iter().zip(expected) {
            for (a, b) in found.into_iter().zip(bvh_from_world(expected)) {
                assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn the_rest_pose_has_no_angles() {
        let rest = [IDENTITY, about_axis(1, 1.2), about_axis(0, 0.3), IDENTITY];
        let row = Skeleton::new(&tree(), &rest).channels(&rest, [0.0; 3], None);
        assert!(row.iter().all(|angle| angle.abs() < 1e-12), "{row:?}");
    }

    #[test]
    fn angles_do_not_jump() {
        assert_eq!(nearest_angles([-179.0, 0.0, 0.0], Some(&[179.0, 0.0, 0.0])), [181.0, 0.0, 0.0]);
        assert_eq!(nearest_angles([-170.0, 80.0, -170.0], Some(&[5.0, 95.0, 5.0])), [10.0, 100.0, 10.0]);
    }
}
