//! What a BVH file holds: joints, channels and their motion.

use crate::Warning;
use crate::rotation::{IDENTITY, Matrix, about_axis, apply, product};

/// A column of the motion table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Translation along axis 0, 1 or 2.
    Position(usize),
    /// Rotation about axis 0, 1 or 2, degrees.
    Rotation(usize),
}

pub(super) const CHANNEL_NAMES: [(&str, Channel); 6] = [
    ("Xposition", Channel::Position(0)),
    ("Yposition", Channel::Position(1)),
    ("Zposition", Channel::Position(2)),
    ("Xrotation", Channel::Rotation(0)),
    ("Yrotation", Channel::Rotation(1)),
    ("Zrotation", Channel::Rotation(2)),
];

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub struct BvhJoint {
    /// Name.
    pub name: String,
    /// Index of the parent, smaller than this joint's own; `None` for a root.
    pub parent: Option<usize>,
    /// Origin in the parent's frame.
    pub offset: [f64; 3],
    /// Columns of the motion table, in order.
    pub channels: Vec<Channel>,
    /// Tip of a joint without children, in its own frame.
    pub end_site: Option<[f64; 3]>,
}

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Joints, parents before children.
    pub joints: Vec<BvhJoint>,
    /// Duration of a frame, seconds.
    pub frame_time_s: f64,
    /// One row per frame, with the channels of all joints in order.
    pub frames: Vec<Vec<f64>>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

impl Bvh {
    /// Columns of the motion table.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.joints.iter().map(|joint| joint.channels.len()).sum()
    }

    /// Names of the points that [`Bvh::positions`] returns: every joint, followed by its end site as `<joint>_End`.
    #[must_use]
    pub fn point_names(&self) -> Vec<String> {
        let with_end = |joint: &BvhJoint| {
            let end = joint.end_site.map(|_| format!("{}_End", joint.name));
            [Some(joint.name.clone()), end]
        };
        self.joints.iter().flat_map(with_end).flatten().collect()
    }

    /// Names and positions of all joints and end sites in a frame, in units and axes of the file.
    #[must_use]
    pub fn positions(&self, frame: usize) -> Option<Vec<(String, [f64; 3])>> {
        let values = self.frames.get(frame)?;
        Some(self.point_names().into_iter().zip(forward_kinematics(&self.joints, values)).collect())
    }
}

/// Positions of all joints and end sites for one row of the motion table; missing values count as 0.
#[must_use]
pub fn forward_kinematics(joints: &[BvhJoint], values: &[f64]) -> Vec<[f64; 3]> {
    let mut values = values.iter().copied();
    let mut frames = Vec::with_capacity(joints.len());
    let mut points = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint.parent.and_then(|parent| frames.get(parent).copied());
        let (parent_rotation, parent_origin) = parent.unwrap_or((IDENTITY, [0.0; 3]));
        let (shift, local) = local_transform(joint, &mut values);
        let origin = add(parent_origin, apply(&parent_rotation, shift));
        let rotation = product(&parent_rotation, &local);
        frames.push((rotation, origin));
        points.push(origin);
        points.extend(joint.end_site.map(|end| add(origin, apply(&rotation, end))));
    }
    points
}

/// Origin and rotation of a joint in its parent's frame; takes the values of its channels, and missing ones as 0.
pub fn local_transform(joint: &BvhJoint, values: &mut impl Iterator<Item = f64>) -> ([f64; 3], Matrix) {
    let mut shift = joint.offset;
    let mut rotation = IDENTITY;
    for &channel in &joint.channels {
        let value = values.next().unwrap_or_default();
        match channel {
            Channel::Position(axis) => shift.iter_mut().skip(axis).take(1).for_each(|v| *v += value),
            Channel::Rotation(axis) => rotation = product(&rotation, &about_axis(axis, value.to_radians())),
        }
    }
    (shift, rotation)
}

fn add([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + x, b + y, c + z]
}

/// From the world (Z up) to the axes of the file (Y up).
#[must_use]
pub const fn bvh_from_world([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, -y]
}

/// From the axes of the file (Y up) to the world (Z up).
#[must_use]
pub const fn world_from_bvh([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -z, y]
}
