//! The skeleton of an ASF file, and where its bones end in a pose.

use crate::rotation::{IDENTITY, Matrix, about_axis, apply, product, transpose};

/// Metres in an inch.
const INCH_M: f64 = 0.0254;

/// A degree of freedom of the root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RootChannel {
    /// Translation along axis 0, 1 or 2, file units.
    Translation(usize),
    /// Rotation about axis 0, 1 or 2.
    Rotation(usize),
}

/// A bone.
#[derive(Clone, Debug, PartialEq)]
pub struct AsfBone {
    /// Name.
    pub name: String,
    /// Index of the parent, smaller than this bone's own; `None` for bones of the root.
    pub parent: Option<usize>,
    /// Direction in the rest pose, global axes.
    pub direction: [f64; 3],
    /// Length, file units.
    pub length: f64,
    /// Rotation `C` of the axis frame.
    pub axis: Matrix,
    /// Axes (0, 1, 2) of the rotations in the motion file, in its order.
    pub dof: Vec<usize>,
    /// Order in which fixed axes are turned about.
    pub order: [usize; 3],
}

/// A skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Asf {
    /// Value of `:units length`.
    pub length_unit: f64,
    /// Whether angles of both files are in degrees.
    pub degrees: bool,
    /// Root channels in the order of the motion file.
    pub root_channels: Vec<RootChannel>,
    /// Order in which the root's fixed axes are turned about.
    pub root_order: [usize; 3],
    /// Position of the root in the rest pose, file units.
    pub root_position: [f64; 3],
    /// Rotation of the root in the rest pose.
    pub root_axis: Matrix,
    /// Bones, parents before children.
    pub bones: Vec<AsfBone>,
}

impl Asf {
    /// Metres per file unit.
    #[must_use]
    pub fn metres_per_unit(&self) -> f64 {
        INCH_M / self.length_unit
    }

    /// Values per frame: the root's channels, then each bone's.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.root_channels.len() + self.bones.iter().map(|bone| bone.dof.len()).sum::<usize>()
    }

    /// Names of the points that [`Asf::bone_ends_m`] returns: `root`, then every bone.
    #[must_use]
    pub fn point_names(&self) -> Vec<&str> {
        std::iter::once("root").chain(self.bones.iter().map(|bone| bone.name.as_str())).collect()
    }

    /// Position of the root and of the end of every bone, metres, axes of the file (Y up); missing values count as 0.
    #[must_use]
    pub fn bone_ends_m(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let mut values = values.iter().copied();
        let radians = |value: f64| if self.degrees { value.to_radians() } else { value };
        let mut position = self.root_position;
        let mut angles = [0.0; 3];
        for &channel in &self.root_channels {
            let value = values.next().unwrap_or_default();
            match channel {
                RootChannel::Translation(axis) => position.iter_mut().skip(axis).take(1).for_each(|v| *v += value),
                RootChannel::Rotation(axis) => set(&mut angles, axis, radians(value)),
            }
        }
        let turned = |axis: &Matrix, motion: Matrix| product(&product(axis, &motion), &transpose(axis));
        let root_rotation = turned(&self.root_axis, fixed_axes(self.root_order, angles));
        let mut frames: Vec<(Matrix, [f64; 3])> = Vec::with_capacity(self.bones.len());
        for bone in &self.bones {
            let parent = bone.parent.and_then(|parent| frames.get(parent).copied());
            let (parent_rotation, start) = parent.unwrap_or((root_rotation, position));
            let mut angles = [0.0; 3];
            for &axis in &bone.dof {
                set(&mut angles, axis, radians(values.next().unwrap_or_default()));
            }
            let rotation = product(&parent_rotation, &turned(&bone.axis, fixed_axes(bone.order, angles)));
            let [x, y, z] = apply(&rotation, bone.direction.map(|v| v * bone.length));
            let [a, b, c] = start;
            frames.push((rotation, [a + x, b + y, c + z]));
        }
        let ends = frames.into_iter().map(|(_, end)| end);
        let scale = self.metres_per_unit();
        std::iter::once(position).chain(ends).map(|point| point.map(|v| v * scale)).collect()
    }
}

fn set(angles: &mut [f64; 3], axis: usize, value: f64) {
    angles.iter_mut().skip(axis).take(1).for_each(|angle| *angle = value);
}

/// Rotation about the fixed axes in that order, by the angle of each axis.
pub(super) fn fixed_axes(order: [usize; 3], angles: [f64; 3]) -> Matrix {
    order.into_iter().fold(IDENTITY, |turned, axis| {
        product(&about_axis(axis, angles.get(axis).copied().unwrap_or_default()), &turned)
    })
}
