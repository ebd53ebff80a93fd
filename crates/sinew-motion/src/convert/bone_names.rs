//! `motion.bvh` with names of bones, and a heading at rest, that retargeting looks for.
//!
//! | ours | `mixamo` | `unreal` | `rigify` |
//! |---|---|---|---|
//! | `root` | Hips | pelvis | spine |
//! | `spine`, `torso` | Spine | spine_01 | spine.001 |
//! | `girdle`, `girdle_r_upper_arm` (or clavicles) | LeftShoulder, RightShoulder | clavicle_l, clavicle_r | shoulder.L, shoulder.R |
//! | `l_upper_arm`, `l_forearm` | LeftArm, LeftForeArm | upperarm_l, lowerarm_l | upper_arm.L, forearm.L |
//! | `l_thigh`, `l_shin`, `l_foot` | LeftUpLeg, LeftLeg, LeftFoot | thigh_l, calf_l, foot_l | thigh.L, shin.L, foot.L |
//! | `head` | Head | head | spine.006 |
//!
//! Bones that only lead to a thigh (`pelvis`, `pelvis_r_thigh`) are named after both ends, which in Rigify is a bone of its own; `spine_head` keeps its name, as no character has the like. The rest pose of ours looks along −z of the file; characters look along +z, which Blender turns to its front view. With R the half turn about y, a joint's turn B becomes R B Rᵀ, which changes the sign of its angles about x and z, that of the root B Rᵀ, and an offset (x, y, z) becomes (−x, y, −z). Poses in the world stay.

use super::content::{Content, Motion};
use super::error::MotionError;
use sinew_formats::bvh::{Bvh, Channel};
use sinew_formats::rotation::{about_axis, product, to_zyx};
use std::f64::consts::PI;

/// Programs whose names bones can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoneNames {
    /// Mixamo's, which most retargeting in Blender and Unreal's templates know.
    Mixamo,
    /// Bones of Unreal's mannequin.
    Unreal,
    /// Bones of Rigify's human in Blender.
    Rigify,
}

/// Our names, and the names that Mixamo, Unreal and Rigify have.
const NAMES: [(&str, [&str; 3]); 20] = [
    ("root", ["Hips", "pelvis", "spine"]),
    ("spine", ["Spine", "spine_01", "spine.001"]),
    ("torso", ["Spine", "spine_01", "spine.001"]),
    ("girdle", ["LeftShoulder", "clavicle_l", "shoulder.L"]),
    ("girdle_r_upper_arm", ["RightShoulder", "clavicle_r", "shoulder.R"]),
    ("l_clavicle", ["LeftShoulder", "clavicle_l", "shoulder.L"]),
    ("r_clavicle", ["RightShoulder", "clavicle_r", "shoulder.R"]),
    ("l_upper_arm", ["LeftArm", "upperarm_l", "upper_arm.L"]),
    ("r_upper_arm", ["RightArm", "upperarm_r", "upper_arm.R"]),
    ("l_forearm", ["LeftForeArm", "lowerarm_l", "forearm.L"]),
    ("r_forearm", ["RightForeArm", "lowerarm_r", "forearm.R"]),
    ("l_thigh", ["LeftUpLeg", "thigh_l", "thigh.L"]),
    ("r_thigh", ["RightUpLeg", "thigh_r", "thigh.R"]),
    ("l_shin", ["LeftLeg", "calf_l", "shin.L"]),
    ("r_shin", ["RightLeg", "calf_r", "shin.R"]),
    ("l_foot", ["LeftFoot", "foot_l", "foot.L"]),
    ("r_foot", ["RightFoot", "foot_r", "foot.R"]),
    ("head", ["Head", "head", "spine.006"]),
    ("pelvis", ["Hips_LeftUpLeg", "pelvis_thigh_l", "pelvis.L"]),
    ("pelvis_r_thigh", ["Hips_RightUpLeg", "pelvis_thigh_r", "pelvis.R"]),
];

/// Bones without which a skeleton is none of ours.
const OURS: [&str; 3] = ["root", "l_thigh", "r_thigh"];

impl BoneNames {
    fn of(self, name: &str) -> Option<&'static str> {
        let column = self as usize;
        NAMES.iter().find(|(own, _)| *own == name).map(|(_, names)| names[column])
    }
}

/// Renames the bones of a motion of ours and turns its rest pose to the front.
///
/// # Errors
/// A motion that is no skeleton of ours.
pub fn rename_bones(motion: &mut Motion, names: BoneNames) -> Result<(), MotionError> {
    let refused = || MotionError::OtherBones { wanted: OURS.join(", ") };
    let Content::Skeleton(skeleton) = &mut motion.content else { return Err(refused()) };
    let has = |name: &str| skeleton.joints.iter().any(|joint| joint.name == name);
    let rotations = [2, 1, 0].map(Channel::Rotation);
    let is_ours = skeleton.joints.iter().all(|joint| joint.channels.ends_with(&rotations));
    if !is_ours || !OURS.iter().all(|name| has(name)) {
        return Err(refused());
    }
    turn_to_front(skeleton);
    for joint in &mut skeleton.joints {
        if let Some(name) = names.of(&joint.name) {
            name.clone_into(&mut joint.name);
        }
    }
    Ok(())
}

fn turn_to_front(skeleton: &mut Bvh) {
    let half = |[x, y, z]: [f64; 3]| [0.0 - x, y, 0.0 - z];
    for joint in &mut skeleton.joints {
        joint.offset = half(joint.offset);
        joint.end_site = joint.end_site.map(half);
    }
    let back = about_axis(1, -PI);
    let mut before: Option<[f64; 3]> = None;
    for row in &mut skeleton.frames {
        let mut first = 0;
        for joint in &skeleton.joints {
            first += joint.channels.len();
            let [z, y, x] = [3, 2, 1].map(|from_end| first - from_end);
            if joint.parent.is_some() {
                row[z] = 0.0 - row[z];
                row[x] = 0.0 - row[x];
                continue;
            }
            let [turn_z, turn_y, turn_x] =
                [(2, row[z]), (1, row[y]), (0, row[x])].map(|(axis, degrees)| about_axis(axis, degrees.to_radians()));
            let turned = product(&product(&product(&turn_z, &turn_y), &turn_x), &back);
            let angles = near(to_zyx(&turned).map(f64::to_degrees), before);
            [row[z], row[y], row[x]] = angles;
            before = Some(angles);
        }
    }
}

/// The angles of a turn that are nearest to what was before, so that curves do not jump.
fn near([z, y, x]: [f64; 3], before: Option<[f64; 3]>) -> [f64; 3] {
    let Some(before) = before else { return [z, y, x] };
    let wound = |angles: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| angles[k] + 360.0 * ((before[k] - angles[k]) / 360.0).round())
    };
    let far = |angles: &[f64; 3]| angles.iter().zip(before).map(|(angle, before)| (angle - before).abs()).sum::<f64>();
    let [one, other] = [[z, y, x], [z + 180.0, 180.0 - y, x + 180.0]].map(wound);
    if far(&other) < far(&one) { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::super::format::Format;
    use super::*;
    use sinew_body::{Proportions, standard};
    use sinew_formats::bvh::export::Skeleton;
    use sinew_formats::bvh::forward_kinematics;

    /// H32 in some poses, its rest pose being the zero pose.
    fn motion() -> Motion {
        let body = standard::h32(&Proportions::default());
        let joints = Skeleton::new(&body, &[]).joints;
        let channels: usize = joints.iter().map(|joint| joint.channels.len()).sum();
        let frame = |k: usize| (0..channels).map(|c| 40.0 * ((c * 7 + k) as f64 * 0.37).sin()).collect();
        let skeleton = Bvh { joints, frame_time_s: 0.1, frames: (0..30).map(frame).collect(), warnings: vec![] };
        let content = Content::Skeleton(skeleton);
        Motion { format: Format::Bvh, rate_hz: 10.0, start_frame: 1, content, warnings: vec![] }
    }

    fn skeleton(motion: &Motion) -> &Bvh {
        let Content::Skeleton(skeleton) = &motion.content else { panic!("no skeleton") };
        skeleton
    }

    #[test]
    fn poses_stay_and_the_rest_pose_looks_ahead() {
        let before = motion();
        for names in [BoneNames::Mixamo, BoneNames::Unreal, BoneNames::Rigify] {
            let mut after = motion();
            rename_bones(&mut after, names).unwrap();
            let (before, after) = (skeleton(&before), skeleton(&after));
            for (old, new) in before.frames.iter().zip(&after.frames) {
                let points = [forward_kinematics(&before.joints, old), forward_kinematics(&after.joints, new)];
                for (old, new) in points[0].iter().zip(&points[1]) {
                    assert!((0..3).all(|k| (old[k] - new[k]).abs() < 1e-12), "{old:?} {new:?}");
                }
            }
            let jump = |pair: &[Vec<f64>]| pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(after.frames.windows(2).all(|pair| jump(pair) < 60.0));
            // Left is at +x where somebody looks along +z, and toes are ahead.
            let place = |name: &str| after.joints.iter().position(|joint| joint.name == name).unwrap();
            let left = BoneNames::of(names, "l_upper_arm").unwrap();
            assert!(after.joints[place(left)].offset[0] > 0.1);
            assert!(after.joints[place(BoneNames::of(names, "l_foot").unwrap())].end_site.unwrap()[2] > 0.1);
        }
    }

    #[test]
    fn names_are_those_that_programs_know_and_none_is_there_twice() {
        let mut renamed = motion();
        rename_bones(&mut renamed, BoneNames::Mixamo).unwrap();
        let mut names: Vec<&str> = skeleton(&renamed).joints.iter().map(|joint| joint.name.as_str()).collect();
        for name in
            ["Hips", "Spine", "Head", "LeftShoulder", "RightArm", "LeftForeArm", "RightUpLeg", "LeftLeg", "LeftFoot"]
        {
            assert!(names.contains(&name), "{name}: {names:?}");
        }
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
        // A skeleton that has these names is none of ours any more.
        assert!(rename_bones(&mut renamed, BoneNames::Mixamo).is_err());
    }
}
