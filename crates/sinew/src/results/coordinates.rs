//! `angles.mot`: the coordinates of the mean pose under OpenSim's names.
//!
//! Only joints of the body that OpenSim has, too.
//!
//! OpenSim turns a ball joint about its right axis, then its forward axis, then its up axis: flexion, adduction, rotation. The angles of a link relative to its parent
//! are taken in that order from the rotation `R_x R_y R_z` (our x is right, y forward, z up), whatever order the body uses. On the left, adduction and rotation
//! have the opposite sign, so that both sides read alike. Knee flexion is positive.
//!
//! | coordinates | link relative to |
//! |---|---|
//! | `pelvis_tilt`, `pelvis_list`, `pelvis_rotation` | pelvis to the ground |
//! | `pelvis_tx`, `pelvis_ty`, `pelvis_tz` | middle of the hips, metres, Y up as in the marker files |
//! | `lumbar_extension`, `lumbar_bending`, `lumbar_rotation` | spine to pelvis |
//! | `hip_flexion_r` …, `knee_angle_r`, `ankle_angle_r` | thigh, shin, foot |
//! | `arm_flex_r` …, `elbow_flex_r` | upper arm to shoulder girdle, forearm |
//!
//! Every other degree of freedom is written under its own name with `_` for the dot (`head_rz`), degrees or metres. Bodies with other link names are written that way
//! throughout. An angle that the body's joints cannot change is left out (of `lumbar_extension`, for a spine that bends and turns only), and so is one of a link of which neither
//! keypoints nor masks show anything (`ankle_angle_r`, for a layout without feet).

use super::partial::{PartialFile, Place};
use super::pose::{Pose, pose};
use crate::Error;
use crate::results::estimate::{FrameEstimate, RunInfo};
use crate::results::problem::{Problem, check_length};
use sinew_body::{Joint, KinematicTree};
use sinew_formats::rotation::{Matrix, product, transpose};
use sinew_formats::{mot, trc};
use std::f64::consts::{PI, TAU};

/// One or three columns of the file.
#[derive(Clone, Debug, PartialEq)]
enum Source {
    /// Middle of the origins of two links, axes of the marker files.
    Middle([usize; 2]),
    /// Angles of a link relative to another (or the ground), with their signs, and which of them the joints change.
    Ball { link: usize, base: Option<usize>, signs: [f64; 3], kept: [bool; 3] },
    /// A rotation of the state, with its sign.
    Angle { dof: usize, sign: f64 },
    /// A translation of the state.
    Length { dof: usize },
}

/// Columns and where they come from.
fn columns(body: &KinematicTree) -> Vec<(Vec<String>, Source)> {
    let mut columns: Vec<(Vec<String>, Source)> = Vec::new();
    let mut used = vec![false; body.dof()];
    let own = |link: usize| body.first_dof(link)..body.first_dof(link) + body.links()[link].joints.len();
    let names = |names: [&str; 3], side: &str| names.map(|name| format!("{name}{side}")).to_vec();
    if let (Some(spine), Some(pelvis), Some(left), Some(right)) =
        (body.link_index("spine"), body.link_index("pelvis"), body.link_index("l_thigh"), body.link_index("r_thigh"))
        && (body.links()[pelvis].parent == Some(spine) || body.links()[spine].parent == Some(pelvis))
    {
        let plain = [1.0; 3];
        columns.push((
            names(["pelvis_tilt", "pelvis_list", "pelvis_rotation"], ""),
            Source::Ball { link: pelvis, base: None, signs: plain, kept: [true; 3] },
        ));
        columns.push((names(["pelvis_tx", "pelvis_ty", "pelvis_tz"], ""), Source::Middle([left, right])));
        let kept = movable(body, spine, pelvis);
        let lumbar = names(["lumbar_extension", "lumbar_bending", "lumbar_rotation"], "");
        let lumbar = lumbar.into_iter().zip(kept).filter_map(|(name, kept)| kept.then_some(name)).collect();
        columns.push((lumbar, Source::Ball { link: spine, base: Some(pelvis), signs: plain, kept }));
        own(spine).chain(own(pelvis)).for_each(|dof| used[dof] = true);
    }
    for (prefix, side, sign) in [("r_", "_r", 1.0), ("l_", "_l", -1.0)] {
        let link = |name: &str| body.link_index(&format!("{prefix}{name}"));
        let balls = [
            ("thigh", ["hip_flexion", "hip_adduction", "hip_rotation"]),
            ("upper_arm", ["arm_flex", "arm_add", "arm_rot"]),
        ];
        for (name, angles) in balls {
            let Some(index) = link(name).filter(|&index| is_ball(body, index)) else { continue };
            let base = body.links()[index].parent;
            columns.push((
                names(angles, side),
                Source::Ball { link: index, base, signs: [1.0, sign, sign], kept: [true; 3] },
            ));
            own(index).for_each(|dof| used[dof] = true);
        }
        for (name, angle, sign) in
            [("shin", "knee_angle", -1.0), ("foot", "ankle_angle", 1.0), ("forearm", "elbow_flex", 1.0)]
        {
            let Some(index) = link(name).filter(|&index| body.links()[index].joints.first() == Some(&RIGHT_AXIS))
            else {
                continue;
            };
            columns.push((vec![format!("{angle}{side}")], Source::Angle { dof: body.first_dof(index), sign }));
            used[body.first_dof(index)] = true;
        }
    }
    for (dof, (name, (_, joint))) in body.dof_names().into_iter().zip(body.joints()).enumerate() {
        if !used[dof] {
            let source = match joint {
                Joint::Rotate(_) => Source::Angle { dof, sign: 1.0 },
                Joint::Translate(_) => Source::Length { dof },
            };
            columns.push((vec![name.replace('.', "_").split_whitespace().collect::<Vec<_>>().join("_")], source));
        }
    }
    columns
}

/// Poses in which it is looked at what joints change.
const TRIED: usize = 5;

/// Which of the angles of a link relative to another ever differ from 0.
fn movable(body: &KinematicTree, link: usize, base: usize) -> [bool; 3] {
    let mut kept = [false; 3];
    for tried in 1..=TRIED {
        let state: Vec<f64> =
            (0..body.dof()).map(|dof| 0.4 * ((1.3 * tried as f64) * (dof + 1) as f64).sin()).collect();
        let pose = pose(body, &state);
        let turn = product(&transpose(&pose.rotations[base]), &pose.rotations[link]);
        for (kept, angle) in kept.iter_mut().zip(flexion_adduction_rotation(&turn, None)) {
            *kept |= angle.abs() > 1e-9;
        }
    }
    kept
}

/// Whether keypoints show how the link of a column turns: one that lies on it beside its joint, or beyond it.
fn is_observed(body: &KinematicTree, keypoints: &[String], source: &Source) -> bool {
    let turned = match source {
        Source::Ball { link, .. } => *link,
        Source::Angle { dof, .. } => match (0..body.links().len()).rev().find(|&link| body.first_dof(link) <= *dof) {
            Some(link) => link,
            None => return true,
        },
        Source::Middle(_) | Source::Length { .. } => return true,
    };
    let is_beyond = |link: usize| {
        let above = std::iter::successors(body.links()[link].parent, |&parent| body.links()[parent].parent);
        above.into_iter().any(|parent| parent == turned)
    };
    let shows = |point: &sinew_body::Point| {
        let is_beside = point.link == turned && point.offset != [0.0; 3];
        (is_beside || is_beyond(point.link)) && keypoints.contains(&point.name)
    };
    keypoints.is_empty() || body.points().iter().any(shows)
}

const RIGHT_AXIS: Joint = Joint::Rotate(sinew_body::Axis::X);

fn is_ball(body: &KinematicTree, link: usize) -> bool {
    let joints = &body.links()[link].joints;
    joints.len() == 3 && joints.iter().all(|joint| matches!(joint, Joint::Rotate(_)))
}

/// Angles of `R_x(a) R_y(b) R_z(c)`, those nearest to the ones before.
fn flexion_adduction_rotation(m: &Matrix, before: Option<[f64; 3]>) -> [f64; 3] {
    let a = (-m[1][2]).atan2(m[2][2]);
    let b = m[0][2].atan2(m[0][0].hypot(m[0][1]));
    let c = (-m[0][1]).atan2(m[0][0]);
    let Some(before) = before else { return [a, b, c] };
    let near = |angles: [f64; 3]| [0, 1, 2].map(|k| angles[k] + TAU * ((before[k] - angles[k]) / TAU).round());
    let apart = |angles: &[f64; 3]| angles.iter().zip(before).map(|(x, y)| (x - y).abs()).sum::<f64>();
    let [one, other] = [near([a, b, c]), near([a + PI, PI - b, c + PI])];
    if apart(&other) < apart(&one) { other } else { one }
}

pub(crate) struct Coordinates {
    sources: Vec<Source>,
    names: Vec<String>,
    /// Angles of every ball in the frame before.
    pub(crate) before: Vec<Option<[f64; 3]>>,
    pub(crate) file: PartialFile,
}

const TITLE: &str = "Coordinates";

impl Coordinates {
    pub(crate) fn open(place: &Place<'_>, info: &RunInfo) -> Result<Self, Error> {
        let is_shown = |(_, source): &(_, Source)| info.has_masks || is_observed(&info.body, &info.keypoints, source);
        let (names, sources): (Vec<Vec<String>>, Vec<Source>) =
            columns(&info.body).into_iter().filter(is_shown).unzip();
        let names = names.concat();
        let file = place.file("angles.mot", |out| mot::write_header(out, TITLE, &names, 0))?;
        Ok(Self { before: vec![None; sources.len()], sources, names, file })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate, pose: &Pose) -> Result<(), Error> {
        let mut values = Vec::with_capacity(self.names.len());
        for (source, before) in self.sources.iter().zip(&mut self.before) {
            match source {
                Source::Middle([a, b]) => {
                    let middle = [0, 1, 2].map(|k| 0.5 * (pose.origins[*a][k] + pose.origins[*b][k]));
                    values.extend(trc::trc_from_world(middle));
                }
                Source::Ball { link, base, signs, kept } => {
                    let turn = match base {
                        Some(base) => product(&transpose(&pose.rotations[*base]), &pose.rotations[*link]),
                        None => pose.rotations[*link],
                    };
                    let angles = flexion_adduction_rotation(&turn, *before);
                    *before = Some(angles);
                    let kept = angles.iter().zip(signs).zip(kept).filter(|(_, kept)| **kept);
                    values.extend(kept.map(|((angle, sign), _)| sign * angle.to_degrees()));
                }
                Source::Angle { dof, sign } => values.push(sign * estimate.mean_state[*dof].to_degrees()),
                Source::Length { dof } => values.push(estimate.mean_state[*dof]),
            }
        }
        self.file.write(|out| mot::write_row(out, estimate.time_s, &values))
    }

    /// Takes up the angles of the frame before.
    pub(crate) fn remember(&mut self, before: &[Option<[f64; 3]>]) -> Result<(), Problem> {
        check_length(before.len(), self.before.len())?;
        self.before.copy_from_slice(before);
        Ok(())
    }

    pub(crate) fn finish(mut self, frames: u64) -> Result<PartialFile, Error> {
        let frames = u32::try_from(frames).unwrap_or(u32::MAX);
        self.file.rewrite_start(|out| mot::write_header(out, TITLE, &self.names, frames))?;
        Ok(self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Link, Proportions, standard};
    use sinew_formats::rotation::about_axis;

    fn names(body: &KinematicTree) -> Vec<String> {
        columns(body).into_iter().flat_map(|(names, _)| names).collect()
    }

    #[test]
    fn the_standard_body_has_the_names_of_opensim() {
        let names = names(&standard::h32(&Proportions::default()));
        for name in [
            "pelvis_tilt",
            "pelvis_ty",
            "hip_flexion_r",
            "knee_angle_l",
            "ankle_angle_r",
            "arm_add_l",
            "elbow_flex_r",
            "lumbar_bending",
            "head_rz",
            "l_foot_ry",
        ] {
            assert!(names.contains(&name.to_owned()), "{name} in {names:?}");
        }
        assert!(!names.iter().any(|name| name.starts_with("spine_") || name == "lumbar_extension"));
    }

    #[test]
    fn a_layout_without_feet_has_no_angles_of_ankles() {
        let body = standard::h32(&Proportions::default());
        let shown = |layout: &str| {
            let points = sinew_formats::layout::find(layout).unwrap().points;
            let keypoints: Vec<String> = points.into_iter().flatten().collect();
            let columns = columns(&body).into_iter().filter(|(_, source)| is_observed(&body, &keypoints, source));
            columns.flat_map(|(names, _)| names).collect::<Vec<String>>()
        };
        let [with, without] = ["BODY_25B", "COCO_17"].map(shown);
        let is_of_foot = |name: &&String| name.contains("ankle") || name.contains("foot");
        assert_eq!(with, names(&body));
        assert_eq!(with.iter().filter(is_of_foot).count(), 4);
        assert_eq!(without, with.iter().filter(|name| !is_of_foot(name)).cloned().collect::<Vec<_>>());
    }

    #[test]
    fn other_bodies_keep_their_names() {
        let link = Link {
            name: "arm".into(),
            parent: None,
            offset: [0.0; 3],
            joints: vec![RIGHT_AXIS, Joint::Translate(sinew_body::Axis::Z)],
        };
        assert_eq!(names(&KinematicTree::new(vec![link], vec![]).unwrap()), ["arm_rx", "arm_tz"]);
    }

    #[test]
    fn angles_of_a_ball_come_back_and_do_not_jump() {
        let mut before = None;
        for step in 0..400 {
            let t = f64::from(step) * 0.02;
            let angles = [0.8 * t, 0.9 * (1.3 * t).sin(), -0.7 * t];
            let turn =
                product(&product(&about_axis(0, angles[0]), &about_axis(1, angles[1])), &about_axis(2, angles[2]));
            let found = flexion_adduction_rotation(&turn, before);
            for (a, b) in found.iter().zip(angles) {
                assert!((a - b).abs() < 1e-9, "{found:?} {angles:?}");
            }
            before = Some(found);
        }
    }

    /// A thigh lifted forward is flexion on both sides; one lifted outward is negative adduction on both.
    #[test]
    fn both_sides_read_alike() {
        let body = standard::h32(&Proportions::default());
        for (axis, column) in [(0, "hip_flexion"), (1, "hip_adduction")] {
            for (link, side, sign) in [("r_thigh", "_r", 1.0), ("l_thigh", "_l", -1.0)] {
                let mut state = vec![0.0; body.dof()];
                let index = body.link_index(link).unwrap();
                // The links' own order is z, y, x.
                state[body.first_dof(index) + 2 - axis] = if axis == 0 { 0.4 } else { sign * 0.4 };
                let pose = pose(&body, &state);
                let (_, source) =
                    columns(&body).into_iter().find(|(names, _)| names.contains(&format!("{column}{side}"))).unwrap();
                let Source::Ball { link, base: Some(base), signs, .. } = source else { panic!("{source:?}") };
                let turn = product(&transpose(&pose.rotations[base]), &pose.rotations[link]);
                assert!((signs[axis] * flexion_adduction_rotation(&turn, None)[axis] - 0.4).abs() < 1e-12);
            }
        }
    }
}
