//! Which angles a body has under which names.
//!
//! OpenSim turns a ball joint about its right axis, then its forward axis, then its up axis: flexion, adduction, rotation. On the left, adduction and rotation have the opposite sign, so that
//! both sides read alike. Knee flexion is positive.
//!
//! | OpenSim | ISB, where it differs | link relative to |
//! |---|---|---|
//! | `pelvis_tilt`, `pelvis_list`, `pelvis_rotation` | `pelvic_tilt`, `pelvic_obliquity`, `pelvic_rotation` | pelvis to the ground |
//! | `pelvis_tx`, `pelvis_ty`, `pelvis_tz` | | middle of the hips, metres, Y up as in the marker files |
//! | `lumbar_extension`, `lumbar_bending`, `lumbar_rotation` (spine) | `trunk_flexion`, `trunk_bending`, `trunk_rotation` (thorax) | pelvis |
//! | `hip_flexion_r` …, `knee_angle_r`, `ankle_angle_r` | | thigh to pelvis, shin, foot |
//! | `r_foot_ry` | `ankle_inversion_r` | foot to shin |
//! | `arm_flex_r`, `arm_add_r`, `arm_rot_r` (to the shoulder girdle) | `shoulder_plane_r`, `shoulder_elevation_r`, `shoulder_rotation_r` (to the thorax) | upper arm |
//! | `elbow_flex_r` | | forearm to upper arm |
//! | `head_rz`, `head_ry`, `head_rx` (to the spine) | `neck_flexion`, `neck_bending`, `neck_rotation` (to the thorax) | head |
//!
//! The thorax is the link `girdle` where the spine has one: as the spine, turned about its long axis so that it is square to the line of the shoulders, which is what keypoints show of a thorax.
//!
//! Every other degree of freedom has its own name with `_` for the dot (`girdle_rz`). Bodies with other link names are written that way throughout. An angle that the body's
//! joints cannot change is left out (`lumbar_extension`, for a spine that bends and turns only).

use crate::decomposition::AngleSequence;
use crate::link_angles::{CoordinateSource, JointTurn, LinkAngles};
use crate::pelvis::{ISB_PELVIS, ISB_SIGNS, OPENSIM_PELVIS};
use sinew_body::{Axis, Joint, KinematicTree};

/// Whose definitions angles follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Convention {
    /// Coordinates of OpenSim's models of gait.
    #[default]
    OpenSim,
    /// The International Society of Biomechanics: Wu et al. 2002 and 2005; Grood & Suntay 1983.
    Isb,
}

impl Convention {
    /// Names of the conventions, as the setting takes them.
    pub const NAMES: [&'static str; 2] = ["opensim", "isb"];

    /// The convention of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::OpenSim, Self::Isb].into_iter().find(|convention| convention.name() == name)
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

const RIGHT_AXIS: Joint = Joint::Rotate(Axis::X);
const FORWARD_AXIS: Joint = Joint::Rotate(Axis::Y);

/// Columns that are being listed, and the degrees of freedom that they use.
struct Listed<'a> {
    body: &'a KinematicTree,
    columns: Vec<(Vec<String>, CoordinateSource)>,
    used: Vec<bool>,
}

impl Listed<'_> {
    /// Angles of a link relative to another, whose own joints have no other names then.
    fn ball(&mut self, names: [String; 3], [link, base]: [Option<usize>; 2], sequence: AngleSequence, signs: [f64; 3]) {
        self.angles(names, [link, base], sequence, signs);
        link.into_iter().for_each(|link| self.uses(link));
    }

    /// Angles of a link relative to another.
    fn angles(
        &mut self,
        names: [String; 3],
        [link, base]: [Option<usize>; 2],
        sequence: AngleSequence,
        signs: [f64; 3],
    ) {
        let Some(link) = link else { return };
        let turns = turns(self.body, link, base);
        let mut angles = LinkAngles { link, turns, sequence, signs, kept: [true; 3] };
        angles.kept = movable(self.body.dof(), &angles);
        let kept = names.into_iter().zip(angles.kept).filter_map(|(name, kept)| kept.then_some(name)).collect();
        self.columns.push((kept, CoordinateSource::Angles(angles)));
    }

    /// The angle of one joint.
    fn hinge(&mut self, name: String, link: usize, joint: usize, sign: f64) {
        let dof = self.body.first_dof(link) + joint;
        let Joint::Rotate(axis) = self.body.links()[link].joints[joint] else { return };
        let turns = vec![JointTurn { axis, dof, sign }];
        let (sequence, signs) = (AngleSequence::Hinge, [1.0; 3]);
        let angles = LinkAngles { link, turns, sequence, signs, kept: [true, false, false] };
        self.columns.push((vec![name], CoordinateSource::Angles(angles)));
        self.used[dof] = true;
    }

    fn uses(&mut self, link: usize) {
        let first = self.body.first_dof(link);
        self.used[first..first + self.body.links()[link].joints.len()].fill(true);
    }

    fn trunk(&mut self, convention: Convention) {
        let find = |name: &str| self.body.link_index(name);
        let (Some(spine), Some(pelvis), Some(left), Some(right)) =
            (find("spine"), find("pelvis"), find("l_thigh"), find("r_thigh"))
        else {
            return;
        };
        let parent = |link: usize| self.body.links()[link].parent;
        if parent(pelvis) != Some(spine) && parent(spine) != Some(pelvis) {
            return;
        }
        let sequence = AngleSequence::FlexionAdductionRotation;
        // OpenSim turns about axes of the ground, in an order in which tilt and list depend on where somebody faces.
        let (names, order, signs) = match convention {
            Convention::OpenSim => (OPENSIM_PELVIS, sequence, [1.0; 3]),
            Convention::Isb => (ISB_PELVIS, AngleSequence::RotationObliquityTilt, ISB_SIGNS),
        };
        self.ball(names.map(str::to_owned), [Some(pelvis), None], order, signs);
        let places = ["pelvis_tx", "pelvis_ty", "pelvis_tz"].map(str::to_owned);
        self.columns.push((places.to_vec(), CoordinateSource::Middle([left, right])));
        let (names, link, sign) = match convention {
            Convention::OpenSim => (["lumbar_extension", "lumbar_bending", "lumbar_rotation"], Some(spine), 1.0),
            Convention::Isb => (["trunk_flexion", "trunk_bending", "trunk_rotation"], thorax(self.body), -1.0),
        };
        self.angles(names.map(str::to_owned), [link, Some(pelvis)], sequence, [sign, 1.0, 1.0]);
        self.uses(pelvis);
        self.uses(spine);
    }

    /// The limbs of a side: the prefix of its links, the suffix of its names, and the sign of what is mirrored.
    fn limbs(&mut self, (prefix, suffix, sign): (&str, &str, f64), convention: Convention) {
        let find = |body: &KinematicTree, name: &str| body.link_index(&format!("{prefix}{name}"));
        let named = |names: [&str; 3]| names.map(|name| format!("{name}{suffix}"));
        let mirrored = [1.0, sign, sign];
        let sequence = AngleSequence::FlexionAdductionRotation;
        if let Some(thigh) = find(self.body, "thigh").filter(|&link| is_ball(self.body, link)) {
            let base = self.body.links()[thigh].parent;
            let names = named(["hip_flexion", "hip_adduction", "hip_rotation"]);
            self.ball(names, [Some(thigh), base], sequence, mirrored);
        }
        if let Some(arm) = find(self.body, "upper_arm").filter(|&link| is_ball(self.body, link)) {
            match thorax(self.body).filter(|_| convention == Convention::Isb) {
                None => {
                    let base = self.body.links()[arm].parent;
                    self.ball(named(["arm_flex", "arm_add", "arm_rot"]), [Some(arm), base], sequence, mirrored);
                }
                Some(thorax) => {
                    let names = named(["shoulder_plane", "shoulder_elevation", "shoulder_rotation"]);
                    let sequence =
                        if sign > 0.0 { AngleSequence::RightElevation } else { AngleSequence::LeftElevation };
                    self.ball(names, [Some(arm), Some(thorax)], sequence, [sign, -sign, sign]);
                }
            }
        }
        let hinges = [("shin", "knee_angle", -1.0), ("foot", "ankle_angle", 1.0), ("forearm", "elbow_flex", 1.0)];
        for (name, angle, own) in hinges {
            let joints = |link: usize| self.body.links()[link].joints.as_slice();
            let Some(link) = find(self.body, name).filter(|&link| joints(link).first() == Some(&RIGHT_AXIS)) else {
                continue;
            };
            let tilts = name == "foot" && joints(link) == [RIGHT_AXIS, FORWARD_AXIS];
            self.hinge(format!("{angle}{suffix}"), link, 0, own);
            if tilts && convention == Convention::Isb {
                self.hinge(format!("ankle_inversion{suffix}"), link, 1, sign);
            }
        }
    }

    fn head(&mut self) {
        let find = |name: &str| self.body.link_index(name);
        let head = find("head").filter(|&head| is_ball(self.body, head));
        let (Some(head), Some(thorax)) = (head, thorax(self.body)) else { return };
        let names = ["neck_flexion", "neck_bending", "neck_rotation"].map(str::to_owned);
        self.ball(names, [Some(head), Some(thorax)], AngleSequence::FlexionAdductionRotation, [-1.0, 1.0, 1.0]);
    }

    /// Everything that has no name yet.
    fn rest(&mut self) {
        let names = self.body.dof_names();
        for link in 0..self.body.links().len() {
            for (joint, kind) in self.body.links()[link].joints.iter().enumerate() {
                let dof = self.body.first_dof(link) + joint;
                if self.used[dof] {
                    continue;
                }
                let name = names[dof].replace('.', "_").split_whitespace().collect::<Vec<_>>().join("_");
                match kind {
                    Joint::Rotate(_) => self.hinge(name, link, joint, 1.0),
                    Joint::Translate(_) => self.columns.push((vec![name], CoordinateSource::Length { dof })),
                }
            }
        }
    }
}

/// Columns and where they come from.
#[must_use]
pub fn columns(body: &KinematicTree, convention: Convention) -> Vec<(Vec<String>, CoordinateSource)> {
    let mut listed = Listed { body, columns: vec![], used: vec![false; body.dof()] };
    listed.trunk(convention);
    listed.limbs(("r_", "_r", 1.0), convention);
    listed.limbs(("l_", "_l", -1.0), convention);
    if convention == Convention::Isb {
        listed.head();
    }
    listed.rest();
    listed.columns
}

fn is_ball(body: &KinematicTree, link: usize) -> bool {
    let joints = &body.links()[link].joints;
    joints.len() == 3 && joints.iter().all(|joint| matches!(joint, Joint::Rotate(_)))
}

/// The link that stands for the thorax.
fn thorax(body: &KinematicTree) -> Option<usize> {
    let spine = body.link_index("spine")?;
    Some(body.link_index("girdle").filter(|&girdle| body.links()[girdle].parent == Some(spine)).unwrap_or(spine))
}

/// What turns a link relative to another, or to the ground: joints of the other and of its parents backwards, joints of the link and its parents forwards.
fn turns(body: &KinematicTree, link: usize, base: Option<usize>) -> Vec<JointTurn> {
    let chain = |link: Option<usize>| {
        let mut links: Vec<usize> = std::iter::successors(link, |&link| body.links()[link].parent).collect();
        links.reverse();
        links
    };
    let [to, from] = [chain(Some(link)), chain(base)];
    let common = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let own = |&link: &usize| {
        let joints = body.links()[link].joints.iter().enumerate();
        joints.filter_map(move |(k, joint)| match joint {
            Joint::Rotate(axis) => Some(JointTurn { axis: *axis, dof: body.first_dof(link) + k, sign: 1.0 }),
            Joint::Translate(_) => None,
        })
    };
    let back: Vec<JointTurn> =
        from[common..].iter().flat_map(own).map(|turn| JointTurn { sign: -1.0, ..turn }).collect();
    back.into_iter().rev().chain(to[common..].iter().flat_map(own)).collect()
}

/// States in which it is looked at what joints change.
const TRIED: usize = 5;

/// Which of the angles of a link relative to another ever differ from 0.
fn movable(dof: usize, angles: &LinkAngles) -> [bool; 3] {
    let mut kept = [false; 3];
    for tried in 1..=TRIED {
        let state: Vec<f64> = (0..dof).map(|dof| 0.4 * ((1.3 * tried as f64) * (dof + 1) as f64).sin()).collect();
        for (kept, angle) in kept.iter_mut().zip(angles.raw(&state, None)) {
            *kept |= angle.abs() > 1e-9;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::JointAngles;
    use sinew_body::{Link, Proportions, standard};

    fn names(body: &KinematicTree, convention: Convention) -> Vec<String> {
        columns(body, convention).into_iter().flat_map(|(names, _)| names).collect()
    }

    #[test]
    fn the_standard_body_has_the_names_of_opensim() {
        let names = names(&standard::h32(&Proportions::default()), Convention::OpenSim);
        let expected = "pelvis_tilt pelvis_list pelvis_rotation pelvis_tx pelvis_ty pelvis_tz lumbar_bending lumbar_rotation \
            hip_flexion_r hip_adduction_r hip_rotation_r arm_flex_r arm_add_r arm_rot_r knee_angle_r ankle_angle_r elbow_flex_r \
            hip_flexion_l hip_adduction_l hip_rotation_l arm_flex_l arm_add_l arm_rot_l knee_angle_l ankle_angle_l elbow_flex_l \
            head_rz head_ry head_rx girdle_rz l_foot_ry r_foot_ry";
        assert_eq!(names, expected.split_whitespace().collect::<Vec<_>>());
    }

    /// A name that both have means the same in both.
    #[test]
    fn names_differ_where_definitions_do() {
        for body in [standard::h32(&Proportions::default()), standard::cf28(&Proportions::default())] {
            let [opensim, isb] = [Convention::OpenSim, Convention::Isb]
                .map(|convention| JointAngles::new(&body, &[], false, convention));
            let state: Vec<f64> = (0..body.dof()).map(|dof| 0.6 * (1.7 * dof as f64 + 0.4).sin()).collect();
            let values = [&opensim, &isb].map(|angles| {
                let mut raw = vec![0.0; angles.raw_count()];
                angles.raw(&state, None, &mut raw);
                (0..angles.names().len())
                    .map(|k| (angles.names()[k].clone(), angles.signed(k, &raw)))
                    .collect::<Vec<_>>()
            });
            let mut shared = 0;
            for (name, value) in &values[0] {
                if let Some((_, other)) = values[1].iter().find(|(own, _)| own == name) {
                    assert!((value - other).abs() < 1e-12, "{name}");
                    shared += 1;
                }
            }
            assert!(shared > 10 && values[0].len() == values[1].len(), "{shared}");
            assert!(values[0].iter().any(|(name, _)| name.starts_with("arm")));
            assert!(
                !values[1]
                    .iter()
                    .any(|(name, _)| ["arm", "head", "lumbar", "pelvis_tilt"].iter().any(|own| name.starts_with(own)))
            );
        }
    }

    #[test]
    fn a_layout_without_feet_has_no_angles_of_ankles() {
        let body = standard::h32(&Proportions::default());
        let shown = |layout: &str| {
            let points = sinew_formats::layout::find(layout).unwrap().points;
            let keypoints: Vec<String> = points.into_iter().flatten().collect();
            JointAngles::new(&body, &keypoints, false, Convention::OpenSim).names().to_vec()
        };
        let [with, without] = ["BODY_25B", "COCO_17"].map(shown);
        let is_of_foot = |name: &&String| name.contains("ankle") || name.contains("foot");
        assert_eq!(with, JointAngles::new(&body, &[], false, Convention::OpenSim).names());
        assert_eq!(with.iter().filter(is_of_foot).count(), 4);
        assert_eq!(without, with.iter().filter(|name| !is_of_foot(name)).cloned().collect::<Vec<_>>());
    }

    #[test]
    fn other_bodies_keep_their_names() {
        let link = Link::new("arm", None, [0.0; 3], vec![RIGHT_AXIS, Joint::Translate(Axis::Z)]);
        let body = KinematicTree::new(vec![link], vec![]).unwrap();
        for convention in [Convention::OpenSim, Convention::Isb] {
            assert_eq!(names(&body, convention), ["arm_rx", "arm_tz"]);
        }
    }
}
