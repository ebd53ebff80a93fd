//! The bodies that come with the project: CF28 of Choo & Fleet and H32 for real recordings.
//!
//! Both stand upright at the zero pose with hanging arms: x right, y forward, z up; limbs extend along −z. Elbow flexion is positive, knee flexion negative about
//! x. Sizes are [`Proportions`], data of a subject.

use crate::tree::{Axis, Joint, KinematicTree, Link, Point};

/// Segment lengths and point offsets of a subject, metres; left and right are mirrored. `Default`: an adult of 1.75 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportions {
    /// Spine origin (waist) to neck base.
    pub spine: f64,
    /// Spine origin to the line of the shoulders.
    pub shoulder_height: f64,
    /// Half the distance of the shoulders.
    pub shoulder_half_width: f64,
    /// Half the distance of the hips.
    pub hip_half_width: f64,
    /// Spine origin down to the centre of the hips.
    pub pelvis_drop: f64,
    /// Shoulder to elbow.
    pub upper_arm: f64,
    /// Elbow to wrist.
    pub forearm: f64,
    /// Hip to knee.
    pub thigh: f64,
    /// Knee to ankle.
    pub shin: f64,
    /// Head top in the head's frame (origin: neck base).
    pub head_top: [f64; 3],
    /// Nose in the head's frame.
    pub nose: [f64; 3],
    /// Right eye in the head's frame; the left is mirrored in x.
    pub eye: [f64; 3],
    /// Right ear in the head's frame; the left is mirrored.
    pub ear: [f64; 3],
    /// Right heel in the foot's frame (origin: ankle); the left is mirrored.
    pub heel: [f64; 3],
    /// Right big toe in the foot's frame; the left is mirrored.
    pub big_toe: [f64; 3],
    /// Right small toe in the foot's frame; the left is mirrored.
    pub small_toe: [f64; 3],
}

impl Proportions {
    /// Longest size that files and callers may give, metres: bodies add sizes, and a sum of any finite ones may be infinite.
    pub const LONGEST_M: f64 = 1e6;

    /// Whether every size is a number of at most so many metres; [`f64::MAX`] asks for finite ones.
    #[must_use]
    pub fn are_within(&self, most_m: f64) -> bool {
        let Self { spine, shoulder_height, shoulder_half_width, hip_half_width, pelvis_drop, .. } = *self;
        let Self { upper_arm, forearm, thigh, shin, head_top, nose, eye, ear, heel, big_toe, small_toe, .. } = *self;
        let trunk = [spine, shoulder_height, shoulder_half_width, hip_half_width, pelvis_drop];
        let limbs = [upper_arm, forearm, thigh, shin];
        let places = [head_top, nose, eye, ear, heel, big_toe, small_toe];
        trunk.iter().chain(&limbs).chain(places.iter().flatten()).all(|size| size.abs() <= most_m)
    }
}

impl Default for Proportions {
    fn default() -> Self {
        Self {
            spine: 0.48,
            shoulder_height: 0.42,
            shoulder_half_width: 0.18,
            hip_half_width: 0.09,
            pelvis_drop: 0.10,
            upper_arm: 0.30,
            forearm: 0.26,
            thigh: 0.43,
            shin: 0.42,
            head_top: [0.0, 0.0, 0.25],
            nose: [0.0, 0.10, 0.12],
            eye: [0.03, 0.09, 0.15],
            ear: [0.075, 0.0, 0.13],
            heel: [0.0, -0.05, -0.06],
            big_toe: [-0.02, 0.17, -0.06],
            small_toe: [0.05, 0.14, -0.06],
        }
    }
}

/// Height of the spine origin above the ground at the zero pose, for an adult of 1.75 m (ankles at 0.07 m), metres.
pub const STANDING_HEIGHT_M: f64 = 1.02;

fn link(name: &str, parent: Option<usize>, offset: [f64; 3], rotations: &[Axis]) -> Link {
    Link::new(name, parent, offset, rotations.iter().map(|&a| Joint::Rotate(a)).collect())
}

fn point(name: &str, link: usize, offset: [f64; 3]) -> Point {
    Point { name: name.into(), link, offset }
}

fn mirrored([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-x, y, z]
}

/// A link that moves freely: translations, then rotations about z, y, x.
fn free(name: &str) -> Link {
    use Axis::{X, Y, Z};
    let joints = [X, Y, Z].map(Joint::Translate).into_iter().chain([Z, Y, X].map(Joint::Rotate)).collect();
    Link { joints, ..link(name, None, [0.0; 3], &[]) }
}

/// Left and right arm, the links after the girdle.
fn arms(p: &Proportions, girdle: usize) -> [Link; 4] {
    use Axis::{X, Y, Z};
    [
        link("l_upper_arm", Some(girdle), [-p.shoulder_half_width, 0.0, 0.0], &[Z, Y, X]),
        link("l_forearm", Some(girdle + 1), [0.0, 0.0, -p.upper_arm], &[X]),
        link("r_upper_arm", Some(girdle), [p.shoulder_half_width, 0.0, 0.0], &[Z, Y, X]),
        link("r_forearm", Some(girdle + 3), [0.0, 0.0, -p.upper_arm], &[X]),
    ]
}

/// Left and right leg, links 8 to 11.
fn legs(p: &Proportions, pelvis: usize) -> [Link; 4] {
    use Axis::{X, Y, Z};
    [
        link("l_thigh", Some(pelvis), [-p.hip_half_width, 0.0, -p.pelvis_drop], &[Z, Y, X]),
        link("l_shin", Some(8), [0.0, 0.0, -p.thigh], &[X]),
        link("r_thigh", Some(pelvis), [p.hip_half_width, 0.0, -p.pelvis_drop], &[Z, Y, X]),
        link("r_shin", Some(10), [0.0, 0.0, -p.thigh], &[X]),
    ]
}

fn cf28_links(p: &Proportions) -> Vec<Link> {
    use Axis::{X, Y, Z};
    let mut links = vec![
        free("spine"),
        link("head", Some(0), [0.0, 0.0, p.spine], &[Z, Y, X]),
        link("girdle", Some(0), [0.0, 0.0, p.shoulder_height], &[Z]),
    ];
    links.extend(arms(p, 2));
    links.push(link("pelvis", Some(0), [0.0; 3], &[Z, Y]));
    links.extend(legs(p, 7));
    links
}

/// Joint centres that both bodies share, under the names of the keypoint layouts.
fn joint_points(p: &Proportions, girdle: usize, pelvis: usize) -> Vec<Point> {
    let side = |sign: f64, [shoulder, elbow, wrist, hip, knee, ankle]: [&str; 6], links: [usize; 4]| {
        [
            point(shoulder, girdle, [sign * p.shoulder_half_width, 0.0, 0.0]),
            point(elbow, links[0], [0.0, 0.0, -p.upper_arm]),
            point(wrist, links[1], [0.0, 0.0, -p.forearm]),
            point(hip, pelvis, [sign * p.hip_half_width, 0.0, -p.pelvis_drop]),
            point(knee, links[2], [0.0, 0.0, -p.thigh]),
            point(ankle, links[3], [0.0, 0.0, -p.shin]),
        ]
    };
    let right =
        side(1.0, ["RShoulder", "RElbow", "RWrist", "RHip", "RKnee", "RAnkle"], [girdle + 3, girdle + 4, 10, 11]);
    let left = side(-1.0, ["LShoulder", "LElbow", "LWrist", "LHip", "LKnee", "LAnkle"], [girdle + 1, girdle + 2, 8, 9]);
    right.into_iter().chain(left).collect()
}

fn built(links: Vec<Link>, points: Vec<Point>) -> KinematicTree {
    KinematicTree::new(links, points).expect("the built-in bodies are valid for every finite size")
}

/// Body of Choo & Fleet (2001): 28 degrees of freedom, 17 markers (spec: 6 spine, 3 head, 1 girdle, 3 + 1 each arm, 2 pelvis, 3 + 1 each leg).
///
/// # Panics
/// If a size is not finite.
#[must_use]
pub fn cf28(p: &Proportions) -> KinematicTree {
    let mut points = vec![
        point("Head", 1, p.head_top),
        point("Nose", 1, p.nose),
        point("Neck", 0, [0.0, 0.0, p.spine]),
        point("Spine", 0, [0.0; 3]),
        point("MidHip", 7, [0.0, 0.0, -p.pelvis_drop]),
    ];
    points.extend(joint_points(p, 2, 7));
    built(cf28_links(p), points)
}

/// Standard body for real people: 32 degrees of freedom, and the face and foot points of keypoint detectors.
///
/// It takes the poses of CF28 with two-axis feet, but its root is the pelvis. What joint centres cannot show is the turn of the spine about itself, between hips and shoulders. In CF28 this turns the root, which hips, girdle and
/// head undo: all three angles of the root change along a curve. Here three angles about the same axis change (`spine.rz`, `girdle.rz`, `head.rz`), along a straight line, which Gaussian priors and constant metrics describe
/// (docs/evidence/coverage.md).
///
/// # Panics
/// If a size is not finite.
#[must_use]
pub fn h32(p: &Proportions) -> KinematicTree {
    use Axis::{X, Y, Z};
    let mut links = vec![
        free("pelvis"),
        link("spine", Some(0), [0.0; 3], &[Y, Z]),
        link("head", Some(1), [0.0, 0.0, p.spine], &[Z, Y, X]),
        link("girdle", Some(1), [0.0, 0.0, p.shoulder_height], &[Z]),
    ];
    links.extend(arms(p, 3));
    links.extend(legs(p, 0));
    links.push(link("l_foot", Some(9), [0.0, 0.0, -p.shin], &[X, Y]));
    links.push(link("r_foot", Some(11), [0.0, 0.0, -p.shin], &[X, Y]));
    let mut points = joint_points(p, 3, 0);
    for (side, foot, place) in [("R", 13, (|o| o) as fn([f64; 3]) -> [f64; 3]), ("L", 12, mirrored)] {
        points.extend([
            point(&format!("{side}BigToe"), foot, place(p.big_toe)),
            point(&format!("{side}SmallToe"), foot, place(p.small_toe)),
            point(&format!("{side}Heel"), foot, place(p.heel)),
            point(&format!("{side}Eye"), 2, place(p.eye)),
            point(&format!("{side}Ear"), 2, place(p.ear)),
        ]);
    }
    points.extend([
        point("Neck", 1, [0.0, 0.0, p.spine]),
        point("Head", 2, p.head_top),
        point("Nose", 2, p.nose),
        point("MidHip", 0, [0.0, 0.0, -p.pelvis_drop]),
    ]);
    built(links, points)
}

/// The fifteen joints of pose evaluation, by point name: pelvis, neck base, then the twelve of the limbs: shoulders, elbows, wrists, hips, knees, ankles; last the head top.
pub const EVALUATION_JOINTS: [&str; 15] = [
    "MidHip",
    "Neck",
    "LShoulder",
    "RShoulder",
    "LElbow",
    "RElbow",
    "LWrist",
    "RWrist",
    "LHip",
    "RHip",
    "LKnee",
    "RKnee",
    "LAnkle",
    "RAnkle",
    "Head",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Plan, point_positions};
    use sinew_core::lanes::Isa;

    /// At the zero pose every point whose name begins with a side is the mirror image in x of its fellow, and all others lie in the middle.
    #[test]
    fn bodies_are_mirrored() {
        for tree in [cf28(&Proportions::default()), h32(&Proportions::default())] {
            let plan = Plan::with_all_points(&tree);
            let mut at = vec![0.0; 3 * plan.points()];
            point_positions(&plan, Isa::baseline(), &vec![0.0; tree.dof()], &mut at);
            for (k, point) in tree.points().iter().enumerate() {
                let other = match (point.name.strip_prefix('L'), point.name.strip_prefix('R')) {
                    (Some(rest), _) => format!("R{rest}"),
                    (_, Some(rest)) => format!("L{rest}"),
                    _ => point.name.clone(),
                };
                let mirror = tree.point_index(&other).expect("both sides");
                let [x, y, z] = [at[3 * mirror], at[3 * mirror + 1], at[3 * mirror + 2]];
                assert_eq!(at[3 * k..3 * k + 3], [-x, y, z], "{}", point.name);
            }
        }
    }
}
