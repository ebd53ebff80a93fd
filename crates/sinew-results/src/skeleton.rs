//! `motion.bvh`: the motion of the mean pose on a skeleton in T-pose, for Blender.
//!
//! The arms of the standard bodies hang at the zero pose; the rest pose of the file turns every link `…upper_arm` by a right angle about y, away from the trunk. Other
//! bodies rest in their zero pose. A BVH joint keeps its place in its parent, so that translations of links other than the root are not shown.

use super::partial::{FilePlace, PartialFile};
use crate::Error;
use crate::estimate::RunInfo;
use crate::problem::{Problem, check_length};
use sinew_formats::bvh::{self, export::Skeleton};
use sinew_setup::posed_body::{Pose, t_pose};

pub(crate) struct SkeletonFile {
    skeleton: Skeleton,
    frame_time_s: f64,
    pub(crate) before: Option<Vec<f64>>,
    root: usize,
    pub(crate) file: PartialFile,
}

impl SkeletonFile {
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo) -> Result<Self, Error> {
        let skeleton = Skeleton::new(&info.body, &t_pose(&info.body));
        let frame_time_s = info.fps.recip();
        let file = place.file("motion.bvh", |out| bvh::write_header(out, &skeleton.joints, frame_time_s, 0))?;
        let root = info.body.links().iter().position(|link| link.parent.is_none()).unwrap_or_default();
        Ok(Self { skeleton, frame_time_s, before: None, root, file })
    }

    pub(crate) fn append(&mut self, pose: &Pose) -> Result<(), Error> {
        let row = self.skeleton.channels(&pose.rotations, pose.origins[self.root], self.before.as_deref());
        self.file.write(|out| bvh::write_frame(out, &row))?;
        self.before = Some(row);
        Ok(())
    }

    /// Takes up the channels of the frame before.
    pub(crate) fn remember(&mut self, before: Option<Vec<f64>>) -> Result<(), Problem> {
        let channels = self.skeleton.joints.iter().map(|joint| joint.channels.len()).sum();
        check_length(before.as_ref().map_or(channels, Vec::len), channels)?;
        self.before = before;
        Ok(())
    }

    pub(crate) fn finish(mut self, frames: u64) -> Result<PartialFile, Error> {
        let frames = u32::try_from(frames).unwrap_or(u32::MAX);
        self.file.rewrite_start(|out| bvh::write_header(out, &self.skeleton.joints, self.frame_time_s, frames))?;
        Ok(self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::KinematicTree;
    use sinew_body::{Proportions, standard};
    use sinew_setup::posed_body::pose;

    /// The file's own kinematics must place every joint and tip where the body has it.
    fn check(body: &KinematicTree, state: &[f64]) {
        let skeleton = Skeleton::new(body, &t_pose(body));
        let pose = pose(body, state);
        let row = skeleton.channels(&pose.rotations, pose.origins[0], None);
        let names =
            skeleton.joints.iter().flat_map(|joint| [Some(joint.name.clone()), joint.end_site.map(|_| String::new())]);
        let mut compared = 0;
        for (name, point) in names.flatten().zip(bvh::forward_kinematics(&skeleton.joints, &row)) {
            let point = bvh::world_from_bvh(point);
            if let Some(link) = body.link_index(&name) {
                compared += 1;
                for k in 0..3 {
                    assert!(
                        (point[k] - pose.origins[link][k]).abs() < 1e-9,
                        "{name}: {point:?} {:?}",
                        pose.origins[link]
                    );
                }
            }
        }
        assert_eq!(compared, body.links().len(), "{:?}", missing(&skeleton, body));
    }

    fn missing<'a>(skeleton: &Skeleton, body: &'a KinematicTree) -> Vec<&'a str> {
        let names = body.links().iter().map(|link| link.name.as_str());
        names.filter(|name| skeleton.joints.iter().all(|joint| joint.name != *name)).collect()
    }

    /// What Blender draws: a bone from a joint to the mean of its children, joined to them where they begin there, a stump where it has no length (its limit is a millimetre).
    #[test]
    fn bones_are_joined_and_have_a_length() {
        for body in [standard::h32(&Proportions::default()), standard::cf28(&Proportions::default())] {
            let joints = Skeleton::new(&body, &t_pose(&body)).joints;
            for (index, joint) in joints.iter().enumerate() {
                let children = joints.iter().filter(|child| child.parent == Some(index)).map(|child| child.offset);
                let ends: Vec<[f64; 3]> = children.chain(joint.end_site).collect();
                let length = ends.first().map_or(0.0, |[x, y, z]| x.hypot(*y).hypot(*z));
                assert!(length > 1e-3 && ends.iter().all(|end| *end == ends[0]), "{}: {ends:?}", joint.name);
            }
        }
    }

    #[test]
    fn joints_are_where_the_body_has_them() {
        for body in [standard::h32(&Proportions::default()), standard::cf28(&Proportions::default())] {
            for seed in 1..20 {
                let state: Vec<f64> = (0..body.dof()).map(|i| ((seed * (i + 3)) as f64 * 0.7).sin()).collect();
                check(&body, &state);
            }
        }
    }

    #[test]
    fn arms_rest_level() {
        let body = standard::h32(&Proportions::default());
        let skeleton = Skeleton::new(&body, &t_pose(&body));
        let zero = vec![0.0; skeleton.joints.iter().map(|joint| joint.channels.len()).sum()];
        let points = bvh::forward_kinematics(&skeleton.joints, &zero);
        let reach =
            points.iter().map(|p| bvh::world_from_bvh(*p)[0]).fold([0.0_f64; 2], |[a, b], x| [a.min(x), b.max(x)]);
        assert!((reach[0] + 0.74).abs() < 1e-9 && (reach[1] - 0.74).abs() < 1e-9, "{reach:?}");
    }
}
