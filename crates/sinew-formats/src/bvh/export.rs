//! BVH skeleton and channels of a kinematic tree.
//!
//! A BVH file shows the body with all channels 0 in its *rest pose*, which for us is the T-pose, while our links have
//! frames of their own. With `A` the turn from world axes to file axes, `Q_i` the world rotation of link i in the rest
//! pose and `R_i` in a frame, the file's joint of link i turns by
//!
//! ```text
//! G_i = A R_i Q_iᵀ Aᵀ,      B_i = G_parentᵀ G_i = R_z R_y R_x,      OFFSET_i = A Q_parent offset_i
//! ```
//!
//! so that `G_parent OFFSET_i = A R_parent offset_i`: bones keep their places. Angles are the nearest to the
//! frame before, so that curves do not jump.
//!
//! Programs draw a joint as one bone, from its origin to the mean of its children's. Every bone therefore ends where all
//! its children begin, and none is without length:
//!
//! - a link with several children is one joint for each of them, all at its origin and with its rotation; the one to the
//!   largest branch has the link's name, another one is called `<link>_<child>`;
//! - a link whose origin is that of its parent begins where the parent begins;
//! - the root of a body with branches is a joint `root` of its own, below the origin of the first link;
//! - a link without children ends at the point of the body that lies farthest from its origin.

use super::hierarchy::{BvhJoint, Channel, bvh_from_world};
use crate::rotation::{IDENTITY, Matrix, apply, product, to_zyx, transpose};
use sinew_body::KinematicTree;

/// Axes of the file from axes of the world.
const FILE_FROM_WORLD: Matrix = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];

/// Shorter bones are not written, since programs draw them without direction.
const MIN_BONE_M: f64 = 1e-3;

/// Length of bones that nothing in the body gives: to the root, and of a link without children and points.
const BONE_M: f64 = 0.1;

/// Name of the root of a body with branches.
const ROOT: &str = "root";

/// Skeleton of a tree, and what is needed to make its channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Joints, depth first.
    pub joints: Vec<BvhJoint>,
    /// Link whose rotation each joint has.
    links: Vec<usize>,
    /// `Q_iᵀ Aᵀ` of each link.
    rest: Vec<Matrix>,
    /// Place of the root joint in the frame of the first link, metres.
    base: [f64; 3],
}

impl Skeleton {
    /// Makes the skeleton from a tree and the world rotation of each link in the rest pose; links beyond the end of
    /// `rest` have no rotation there. The root gets position channels.
    #[must_use]
    pub fn new(tree: &KinematicTree, rest: &[Matrix]) -> Self {
        let mut growing = Growing::new(tree, rest);
        let mut base = [0.0; 3];
        if let Some(root) = tree.links().iter().position(|link| link.parent.is_none()) {
            base = growing.base(root);
            if base == [0.0; 3] {
                growing.grow(root, None, [0.0; 3]);
            } else {
                let joint = growing.push(ROOT.into(), root, None, [0.0; 3]);
                growing.grow(root, Some(joint), growing.in_rest(root, base.map(|x| -x)));
            }
        }
        let Growing { joints, links, rest_of, .. } = growing;
        let rest = rest_of.iter().map(|rest| transpose(&product(&FILE_FROM_WORLD, rest))).collect();
        Self { joints, links, rest, base }
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
                    let base = rotations.get(link).map_or(self.base, |rotation| apply(rotation, self.base));
                    row.extend(bvh_from_world([0, 1, 2].map(|k| root[k] + base[k])));
                    global
                }
            };
            let before = previous.and_then(|row_before| row_before.get(row.len()..row.len() + 3));
            row.extend(nearest_angles(to_zyx(&local).map(f64::to_degrees), before).map(|angle| angle + 0.0));
        }
        row
    }
}

/// A skeleton while joints are added to it, depth first.
struct Growing<'a> {
    tree: &'a KinematicTree,
    /// World rotation of each link in the rest pose.
    rest_of: Vec<Matrix>,
    children: Vec<Vec<usize>>,
    /// Links of each link's branch, itself included.
    branch: Vec<usize>,
    joints: Vec<BvhJoint>,
    links: Vec<usize>,
}

impl<'a> Growing<'a> {
    fn new(tree: &'a KinematicTree, rest: &[Matrix]) -> Self {
        let count = tree.links().len();
        let (mut children, mut branch) = (vec![vec![]; count], vec![1; count]);
        // Parents come before their children.
        for (link, parent) in tree.links().iter().enumerate().rev().filter_map(|(i, link)| Some((i, link.parent?))) {
            children[parent].insert(0, link);
            branch[parent] += branch[link];
        }
        let rest_of = (0..count).map(|link| rest.get(link).copied().unwrap_or(IDENTITY)).collect();
        Self { tree, rest_of, children, branch, joints: vec![], links: vec![] }
    }

    /// An offset in a link, in file axes and the rest pose; adding 0 turns −0 into 0.
    fn in_rest(&self, link: usize, offset: [f64; 3]) -> [f64; 3] {
        bvh_from_world(apply(&self.rest_of[link], offset)).map(|v| v + 0.0)
    }

    fn offset(&self, link: usize) -> [f64; 3] {
        self.tree.links()[link].offset
    }

    /// Place of a joint below the first link at which all branches can begin; 0 where the link itself is a bone.
    fn base(&self, root: usize) -> [f64; 3] {
        let children = &self.children[root];
        if let [] | [_] = children[..]
            && children.iter().all(|&child| length(self.offset(child)) > MIN_BONE_M)
        {
            return [0.0; 3];
        }
        let below: Vec<[f64; 3]> = children.iter().map(|&child| self.offset(child)).filter(|o| o[2] < 0.0).collect();
        let mean = [0, 1, 2].map(|k| below.iter().map(|offset| offset[k]).sum::<f64>() / below.len().max(1) as f64);
        if length(mean) > MIN_BONE_M { mean } else { [0.0, 0.0, -BONE_M] }
    }

    fn push(&mut self, name: String, link: usize, parent: Option<usize>, offset: [f64; 3]) -> usize {
        let rotations = [2, 1, 0].map(Channel::Rotation);
        let channels = match parent {
            Some(_) => rotations.to_vec(),
            None => [0, 1, 2].map(Channel::Position).into_iter().chain(rotations).collect(),
        };
        self.joints.push(BvhJoint { name, parent, offset, channels, end_site: None });
        self.links.push(link);
        self.joints.len() - 1
    }

    /// Adds the bones of a link and of all below it: they begin at `start` from the joint `parent`.
    fn grow(&mut self, link: usize, parent: Option<usize>, start: [f64; 3]) {
        let name = written(&self.tree.links()[link].name);
        let bones: Vec<usize> =
            self.children[link].iter().copied().filter(|&child| length(self.offset(child)) > MIN_BONE_M).collect();
        // The first of the largest.
        let largest = bones.iter().rev().copied().max_by_key(|&child| self.branch[child]);
        if self.children[link].is_empty() {
            let joint = self.push(name, link, parent, start);
            self.joints[joint].end_site = Some(self.tip(link, start));
            return;
        }
        for child in self.children[link].clone() {
            if !bones.contains(&child) {
                self.grow(child, parent, start);
                continue;
            }
            let is_largest = Some(child) == largest;
            let child_name = || self.unused(format!("{name}_{}", written(&self.tree.links()[child].name)));
            let name = if is_largest { name.clone() } else { child_name() };
            let joint = self.push(name, link, parent, start);
            self.grow(child, Some(joint), self.in_rest(link, self.offset(child)));
        }
    }

    /// Where a link without children ends.
    fn tip(&self, link: usize, start: [f64; 3]) -> [f64; 3] {
        let own = self.tree.points().iter().filter(|point| point.link == link).map(|point| point.offset);
        let farthest = own.max_by(|a, b| length(*a).total_cmp(&length(*b))).filter(|&tip| length(tip) > MIN_BONE_M);
        match (farthest, length(start)) {
            (Some(tip), _) => self.in_rest(link, tip),
            (None, from) if from > MIN_BONE_M => start.map(|x| x * BONE_M / from),
            (None, _) => [0.0, BONE_M, 0.0],
        }
    }

    /// A name that no link and no joint has.
    fn unused(&self, mut name: String) -> String {
        let is_used = |name: &str| {
            let links = self.tree.links().iter().any(|link| written(&link.name) == name);
            links || self.joints.iter().any(|joint| joint.name == name)
        };
        while is_used(&name) {
            name.push('_');
        }
        name
    }
}

/// A name as a file can have it.
fn written(name: &str) -> String {
    name.replace(['{', '}'], "").split_whitespace().collect::<Vec<_>>().join("_")
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
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
        let link = |name: &str, parent, offset| Link::new(name, parent, offset, Vec::new());
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
        let names = ["root", "pelvis", "left", "left_shin", "pelvis_right", "right"];
        assert_eq!(skeleton.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), names);
        let points = forward_kinematics(&skeleton.joints, &row);

        let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let base = add(root, apply(&rotations[0], [0.0, 0.0, -0.1]));
        let left = add(root, apply(&rotations[0], [-0.1, 0.0, -0.1]));
        let shin = add(left, apply(&rotations[1], [0.0, 0.0, -0.4]));
        let ankle = add(shin, apply(&rotations[3], [0.0, 0.05, -0.4]));
        let right = add(root, apply(&rotations[0], [0.1, 0.0, -0.1]));
        let knee = add(right, apply(&rotations[2], [0.0, 0.0, -0.4]));
        let expected = [base, root, left, shin, ankle, root, right, knee];
        assert_eq!(points.len(), expected.len());
        for (found, expected) in points.into_iter().zip(expected) {
            for (a, b) in found.into_iter().zip(bvh_from_world(expected)) {
                assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
            }
        }
    }

    /// The ends of a body that has everything: branches at one place, children at their parent's origin, and nothing that shows where the last link ends.
    #[test]
    fn every_bone_ends_where_its_children_begin() {
        let link = |name: &str, parent, offset| Link::new(name, parent, offset, Vec::new());
        let links = vec![
            link("pelvis", None, [0.0; 3]),
            link("spine", Some(0), [0.0; 3]),
            link("girdle", Some(1), [0.0, 0.0, 0.4]),
            link("head", Some(1), [0.0, 0.0, 0.5]),
            link("left arm", Some(2), [-0.2, 0.0, 0.0]),
            link("right arm", Some(2), [0.2, 0.0, 0.0]),
            link("girdle_right_arm", Some(5), [0.3, 0.0, 0.0]),
        ];
        let skeleton = Skeleton::new(&KinematicTree::new(links, vec![]).unwrap(), &[]);
        let names: Vec<&str> = skeleton.joints.iter().map(|joint| joint.name.as_str()).collect();
        let expected = [
            "root",
            "spine",
            "girdle_left_arm",
            "left_arm",
            "girdle",
            "right_arm",
            "girdle_right_arm",
            "spine_head",
            "head",
        ];
        assert_eq!(names, expected);
        for (index, joint) in skeleton.joints.iter().enumerate() {
            let ends = skeleton.joints.iter().filter(|child| child.parent == Some(index)).map(|child| child.offset);
            let ends: Vec<[f64; 3]> = ends.chain(joint.end_site).collect();
            assert!(!ends.is_empty() && ends.iter().all(|end| *end == ends[0] && length(*end) > 0.01), "{joint:?}");
        }
    }

    #[test]
    fn the_rest_pose_has_no_angles() {
        let rest = [IDENTITY, about_axis(1, 1.2), about_axis(0, 0.3), IDENTITY];
        let row = Skeleton::new(&tree(), &rest).channels(&rest, [0.0; 3], None);
        let (place, angles) = row.split_at(3);
        // The root lies 0.1 m below the first link.
        assert!(place[1] == -0.1 && angles.iter().all(|angle| angle.abs() < 1e-12), "{row:?}");
    }

    #[test]
    fn angles_do_not_jump() {
        assert_eq!(nearest_angles([-179.0, 0.0, 0.0], Some(&[179.0, 0.0, 0.0])), [181.0, 0.0, 0.0]);
        assert_eq!(nearest_angles([-170.0, 80.0, -170.0], Some(&[5.0, 95.0, 5.0])), [10.0, 100.0, 10.0]);
    }
}
