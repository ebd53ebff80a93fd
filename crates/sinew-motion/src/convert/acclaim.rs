//! An Acclaim motion as a BVH skeleton: same bones, same rest pose, metres.
//!
//! Bone i of an ASF file starts where its parent ends, lies along its direction in the rest pose, and turns by `C M Cᵀ` relative to its parent (C its axis, M the
//! motion about fixed axes). A BVH joint turns the same way about its own origin, so joint i stands at the start of bone i and its tip is the bone's end. Both
//! files have Y up.

use sinew_formats::amc::Amc;
use sinew_formats::asf::{Asf, RootChannel};
use sinew_formats::bvh::{Bvh, BvhJoint, Channel};
use sinew_formats::rotation::{IDENTITY, Matrix, about_axis, product, to_zyx, transpose};

const ROTATIONS: [Channel; 3] = [Channel::Rotation(2), Channel::Rotation(1), Channel::Rotation(0)];

/// Rotation about fixed axes, in the given order.
fn about_fixed(order: [usize; 3], angles: [f64; 3]) -> Matrix {
    order.iter().fold(IDENTITY, |turn, &axis| product(&about_axis(axis, angles[axis]), &turn))
}

/// The skeleton with all its frames.
pub(super) fn skeleton_of(asf: &Asf, amc: &Amc, rate_hz: f64) -> Bvh {
    let scale = asf.metres_per_unit();
    let tip = |bone: usize| asf.bones[bone].direction.map(|v| v * asf.bones[bone].length * scale);
    let has_children = |bone: usize| asf.bones.iter().any(|other| other.parent == Some(bone));
    // A joint comes after its parent and before the next branch, as a BVH file lists them.
    let order = depth_first(asf);
    let place = |bone: usize| order.iter().position(|&other| other == bone).map_or(0, |at| at + 1);
    let positions = [0, 1, 2].map(Channel::Position);
    let mut joints = vec![BvhJoint {
        name: "root".into(),
        parent: None,
        offset: [0.0; 3],
        channels: positions.into_iter().chain(ROTATIONS).collect(),
        end_site: None,
    }];
    joints.extend(order.iter().map(|&index| {
        let bone = &asf.bones[index];
        BvhJoint {
            name: bone.name.clone(),
            parent: Some(bone.parent.map_or(0, place)),
            offset: bone.parent.map_or([0.0; 3], tip),
            channels: ROTATIONS.to_vec(),
            end_site: (!has_children(index)).then(|| tip(index)),
        }
    }));
    let frames = amc.frames.iter().map(|frame| row(asf, &order, &frame.values, scale)).collect();
    Bvh { joints, frame_time_s: rate_hz.recip(), frames, warnings: Vec::new() }
}

fn depth_first(asf: &Asf) -> Vec<usize> {
    let mut order = Vec::with_capacity(asf.bones.len());
    let children =
        |parent: Option<usize>| (0..asf.bones.len()).rev().filter(move |&bone| asf.bones[bone].parent == parent);
    let mut pending: Vec<usize> = children(None).collect();
    while let Some(bone) = pending.pop() {
        order.push(bone);
        pending.extend(children(Some(bone)));
    }
    order
}

fn row(asf: &Asf, order: &[usize], values: &[f64], scale: f64) -> Vec<f64> {
    let radians = |value: f64| if asf.degrees { value.to_radians() } else { value };
    let mut values = values.iter().copied();
    let mut position = asf.root_position;
    let mut angles = [0.0; 3];
    for &channel in &asf.root_channels {
        let value = values.next().unwrap_or_default();
        match channel {
            RootChannel::Translation(axis) => position[axis] += value,
            RootChannel::Rotation(axis) => angles[axis] = radians(value),
        }
    }
    let turned = |axis: &Matrix, motion: Matrix| product(&product(axis, &motion), &transpose(axis));
    let degrees = |turn: Matrix| to_zyx(&turn).map(f64::to_degrees);
    let root = degrees(turned(&asf.root_axis, about_fixed(asf.root_order, angles)));
    let mut bone_angles = Vec::with_capacity(asf.bones.len());
    for bone in &asf.bones {
        let mut angles = [0.0; 3];
        for &axis in &bone.dof {
            angles[axis] = radians(values.next().unwrap_or_default());
        }
        bone_angles.push(degrees(turned(&bone.axis, about_fixed(bone.order, angles))));
    }
    let mut row: Vec<f64> = position.iter().map(|v| v * scale).chain(root).collect();
    row.extend(order.iter().flat_map(|&bone| bone_angles[bone]));
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::bvh::forward_kinematics;
    use sinew_formats::{amc, asf};

    const ASF: &str = ":version 1.10\n:name VICON\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n:bonedata\n  begin\n    id 1\n    name thigh\n    direction 0.3 -0.9 0.3\n    length 7.0\n    axis 10 -20 30 XYZ\n    dof rx ry rz\n    limits (-160 20)\n           (-70 70)\n           (-60 70)\n  end\n  begin\n    id 2\n    name spine\n    direction 0 1 0\n    length 5\n    axis 0 0 0 XYZ\n  end\n  begin\n    id 3\n    name shin\n    direction 0.1 -1 0\n    length 6\n    axis 5 0 40 XYZ\n    dof rx\n    limits (-10 170)\n  end\n:hierarchy\n  begin\n    root thigh spine\n    thigh shin\n  end\n";
    const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 10 20 30\nthigh 15 -25 35\nshin 50\n2\nroot 1 2 3 -10 120 30\nthigh 95 -25 5\nshin 20\n";

    #[test]
    fn joints_and_tips_are_where_the_bones_end() {
        let asf = asf::read("a.asf", ASF).unwrap();
        let amc = amc::read("a.amc", AMC, &asf).unwrap();
        let bvh = skeleton_of(&asf, &amc, 120.0);
        for (frame, row) in amc.frames.iter().zip(&bvh.frames) {
            let ends = asf.bone_ends_m(&frame.values);
            let points: Vec<_> = bvh.point_names().into_iter().zip(forward_kinematics(&bvh.joints, row)).collect();
            let end_of = |bone: &str| ends[asf.point_names().iter().position(|name| *name == bone).unwrap()];
            let find = |name: &str| points.iter().find(|(found, _)| found == name).unwrap().1;
            // The shin starts where the thigh ends; tips end bones without children.
            for (name, bone) in [("root", "root"), ("shin", "thigh"), ("spine_End", "spine"), ("shin_End", "shin")] {
                for k in 0..3 {
                    assert!(
                        (find(name)[k] - end_of(bone)[k]).abs() < 1e-9,
                        "{name}: {:?} {:?}",
                        find(name),
                        end_of(bone)
                    );
                }
            }
        }
    }
}
