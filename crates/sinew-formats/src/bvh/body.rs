//! The skeleton of a BVH file as a body, and its frames as states.

use super::hierarchy::{Bvh, BvhJoint, Channel, world_from_bvh};
use crate::{Error, Place};
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};

const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Rotation of the file's axes (Y up) in the world (Z up).
const WORLD_FROM_BVH: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];

impl Bvh {
    /// The body: a link for each joint, a point of its name where it begins, and one named `<joint>_End` at an end site. `unit_m` is the length of
    /// the file's unit, metres (0.01 where it has centimetres). The world has z up, as everywhere else: the roots have a rest rotation.
    ///
    /// # Errors
    /// Names that are used twice, lengths that are not finite.
    ///
    /// ```
    /// use sinew_formats::bvh;
    /// let text = "HIERARCHY\nROOT Hip\n{\nOFFSET 0 90 0\nCHANNELS 3 Zrotation Yrotation Xrotation\nEnd Site\n{\nOFFSET 0 80 0\n}\n}\n\
    ///             MOTION\nFrames: 1\nFrame Time: .04\n0 0 90\n";
    /// let file = bvh::read("walk.bvh", text)?;
    /// let body = file.body(0.01)?;
    /// let state = file.state(0, 0.01).ok_or("a frame")?;
    /// let (_, origin) = body.link_frames(&state)[0];
    /// assert!((origin[2] - 0.9).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn body(&self, unit_m: f64) -> Result<KinematicTree, Error> {
        let metres = |offset: [f64; 3]| offset.map(|x| unit_m * x);
        let link = |joint: &BvhJoint| {
            let joints = in_order(joint).map(|(_, channel)| match channel {
                Channel::Position(axis) => Joint::Translate(AXES[axis]),
                Channel::Rotation(axis) => Joint::Rotate(AXES[axis]),
            });
            let is_root = joint.parent.is_none();
            let offset = metres(if is_root { world_from_bvh(joint.offset) } else { joint.offset });
            Link { rest: is_root.then_some(WORLD_FROM_BVH), ..Link::new(&*joint.name, joint.parent, offset, joints.collect()) }
        };
        let points = self.joints.iter().enumerate().flat_map(|(link, joint)| {
            let end = joint.end_site.map(|end| Point { name: format!("{}_End", joint.name), link, offset: metres(end) });
            [Some(Point { name: joint.name.clone(), link, offset: [0.0; 3] }), end].into_iter().flatten()
        });
        KinematicTree::new(self.joints.iter().map(link).collect(), points.collect())
            .map_err(|reason| Error::Body { place: Place::file("skeleton"), reason })
    }

    /// State of [`Bvh::body`] in a frame, metres and radians.
    #[must_use]
    pub fn state(&self, frame: usize, unit_m: f64) -> Option<Vec<f64>> {
        let values = self.frames.get(frame)?;
        let mut first = 0;
        let mut state = Vec::with_capacity(values.len());
        for joint in &self.joints {
            for (k, channel) in in_order(joint) {
                let value = *values.get(first + k)?;
                state.push(if matches!(channel, Channel::Position(_)) { unit_m * value } else { value.to_radians() });
            }
            first += joint.channels.len();
        }
        Some(state)
    }
}

/// Channels of a joint with their places: positions, which the format adds to the offset, before rotations.
fn in_order(joint: &BvhJoint) -> impl Iterator<Item = (usize, Channel)> + '_ {
    let channels = || joint.channels.iter().copied().enumerate();
    let is_position = |(_, channel): &(usize, Channel)| matches!(channel, Channel::Position(_));
    channels().filter(is_position).chain(channels().filter(move |channel| !is_position(channel)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::read;
    use sinew_body::{Isa, Plan, point_positions_each};

    /// Positions after rotations, an end site, a branch: the points of the body are those of the format's own kinematics, in our axes.
    #[test]
    fn points_of_the_body_are_those_of_the_file() {
        let text = "HIERARCHY\nROOT Hip\n{\nOFFSET 1 2 3\nCHANNELS 6 Zrotation Xposition Yposition Xrotation Zposition Yrotation\nJOINT Knee\n{\n\
                    OFFSET 0 -4 1\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 -4 0\n}\n}\nJOINT Arm\n{\nOFFSET 1 5 0\nCHANNELS 0\nEnd Site\n\
                    {\nOFFSET 3 0 0\n}\n}\n}\nMOTION\nFrames: 1\nFrame Time: .04\n30 1 2 40 3 -50 70\n";
        let file = read("a.bvh", text).unwrap();
        let body = file.body(0.1).unwrap();
        let found = point_positions_each(&Plan::with_all_points(&body), Isa::baseline(), &file.state(0, 0.1).unwrap());
        for ((name, expected), (point, found)) in
            file.positions(0).unwrap().iter().zip(body.points().iter().zip(found.as_chunks::<3>().0))
        {
            assert_eq!(name, &point.name);
            let expected = world_from_bvh(*expected).map(|x| 0.1 * x);
            assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-12), "{name}: {found:?}, {expected:?}");
        }
    }
}
