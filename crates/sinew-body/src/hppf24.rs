//! The body of Husz, Wallace & Green (2007): 24 parameters and ten truncated elliptical cones. The coarse-to-fine tracker's has the same skeleton with cylinders.
//!
//! | index | what |
//! |---|---|
//! | 0–2 | centre of the pelvis |
//! | 3 | heading, about z |
//! | 4, 5 | lean of the torso, about x and y |
//! | 6, 7 | head, about x and y |
//! | 8, 9; 12, 13 | left, right upper arm: flexion about x, abduction about y |
//! | 10, 11; 14, 15 | left, right forearm: twist about z, hinge about x |
//! | 16–19; 20–23 | left, right leg alike |
//!
//! The paper names tilt and azimuth of the torso; here the lean is a turn about x followed by one about y, which has no pole where the body stands upright and is a chain of plain joints. Tilts up to 60° are reached in all directions.

use crate::Error;
use crate::flesh::Flesh;
use crate::standard::Proportions;
use crate::ten_cones::{Torso, ten_cones, ten_cones_on};
use crate::tree::{Axis, Joint, KinematicTree, Link, Point};
use core::f64::consts::PI;

const HIP: f64 = 0.09;
const SHOULDER: f64 = 0.18;
const TORSO: f64 = 0.52;
const NECK: f64 = 0.58;
const HEAD: f64 = 0.25;
const UPPER_ARM: f64 = 0.30;
const FOREARM: f64 = 0.26;
const THIGH: f64 = 0.43;
const SHIN: f64 = 0.42;

/// Height of the pelvis' centre above the ground where the body of an adult of 1.75 m stands upright, metres.
pub const STANDING_HEIGHT_M: f64 = 0.92;

/// Lengths of the skeleton, metres.
struct Lengths {
    hip: f64,
    shoulder: f64,
    torso: f64,
    neck: f64,
    head: f64,
    upper_arm: f64,
    forearm: f64,
    thigh: f64,
    shin: f64,
}

/// The tree with the fifteen joints of evaluation, sizes of an adult of 1.75 m times `scale`.
///
/// # Panics
/// If the scale is not finite.
#[must_use]
pub fn tree(scale: f64) -> KinematicTree {
    skeleton(&Lengths {
        hip: scale * HIP,
        shoulder: scale * SHOULDER,
        torso: scale * TORSO,
        neck: scale * NECK,
        head: scale * HEAD,
        upper_arm: scale * UPPER_ARM,
        forearm: scale * FOREARM,
        thigh: scale * THIGH,
        shin: scale * SHIN,
    })
}

/// The tree with the sizes of a subject.
///
/// # Panics
/// If a size is not finite.
#[must_use]
pub fn sized(p: &Proportions) -> KinematicTree {
    skeleton(&Lengths {
        hip: p.hip_half_width,
        shoulder: p.shoulder_half_width,
        torso: p.shoulder_height + p.pelvis_drop,
        neck: p.spine + p.pelvis_drop,
        head: p.head_top[2],
        upper_arm: p.upper_arm,
        forearm: p.forearm,
        thigh: p.thigh,
        shin: p.shin,
    })
}

fn skeleton(lengths: &Lengths) -> KinematicTree {
    use Axis::{X, Y, Z};
    let Lengths { hip, shoulder, torso, neck, head, upper_arm, forearm, thigh, shin } = *lengths;
    let link = |name: &str, parent: Option<usize>, offset: [f64; 3], axes: &[Axis]| {
        Link::new(name, parent, offset, axes.iter().map(|&axis| Joint::Rotate(axis)).collect())
    };
    let mut pelvis = link("pelvis", None, [0.0; 3], &[Z]);
    pelvis.joints.splice(0..0, [X, Y, Z].map(Joint::Translate));
    let mut links =
        vec![pelvis, link("torso", Some(0), [0.0; 3], &[X, Y]), link("head", Some(1), [0.0, 0.0, neck], &[X, Y])];
    for (side, sign) in [("l", -1.0), ("r", 1.0)] {
        links.push(link(&format!("{side}_upper_arm"), Some(1), [sign * shoulder, 0.0, torso], &[X, Y]));
        links.push(link(&format!("{side}_forearm"), Some(links.len() - 1), [0.0, 0.0, -upper_arm], &[Z, X]));
    }
    for (side, sign) in [("l", -1.0), ("r", 1.0)] {
        links.push(link(&format!("{side}_thigh"), Some(0), [sign * hip, 0.0, 0.0], &[X, Y]));
        links.push(link(&format!("{side}_shin"), Some(links.len() - 1), [0.0, 0.0, -thigh], &[Z, X]));
    }
    let point = |name: &str, link, offset: [f64; 3]| Point { name: name.into(), link, offset };
    let mut points = vec![point("MidHip", 0, [0.0; 3]), point("Neck", 2, [0.0; 3]), point("Head", 2, [0.0, 0.0, head])];
    for (side, arm, leg) in [("L", 3, 7), ("R", 5, 9)] {
        points.extend([
            point(&format!("{side}Shoulder"), arm, [0.0; 3]),
            point(&format!("{side}Elbow"), arm + 1, [0.0; 3]),
            point(&format!("{side}Wrist"), arm + 1, [0.0, 0.0, -forearm]),
            point(&format!("{side}Hip"), leg, [0.0; 3]),
            point(&format!("{side}Knee"), leg + 1, [0.0; 3]),
            point(&format!("{side}Ankle"), leg + 1, [0.0, 0.0, -shin]),
        ]);
    }
    KinematicTree::new(links, points).expect("the built-in bodies are valid for every finite size")
}

fn flesh_of(scale: f64, round: bool) -> Flesh {
    let torso = Torso { link: "torso", drop: 0.0, height: scale * TORSO };
    let heights = [HEAD, UPPER_ARM, FOREARM, THIGH, SHIN].map(|height| scale * height);
    ten_cones(&tree(scale), torso, heights, scale, round)
        .expect("the built-in bodies are valid for every positive size")
}

/// The ten truncated cones of a tree that [`sized`] made: as long as its segments, and as thick as an adult of 1.75 m stretched with the limbs.
///
/// # Errors
/// [`Error::NoSolid`] for the tree of another body.
pub fn flesh_on(tree: &KinematicTree) -> Result<Flesh, Error> {
    let shoulder = tree.link_index("l_upper_arm").ok_or(Error::NoSolid)?;
    if tree.links().len() != 11 {
        return Err(Error::NoSolid);
    }
    ten_cones_on(tree, Torso { link: "torso", drop: 0.0, height: tree.links()[shoulder].offset[2].abs() })
}

/// The ten truncated cones: torso, head, then upper and lower limb of left arm, right arm, left leg, right leg.
///
/// # Panics
/// If the scale is not finite and positive.
#[must_use]
pub fn flesh(scale: f64) -> Flesh {
    flesh_of(scale, false)
}

/// The ten cylinders of the coarse-to-fine tracker, each with the mean of the four semi-axes of its cone as radius.
///
/// # Panics
/// If the scale is not finite and positive.
#[must_use]
pub fn cylinders(scale: f64) -> Flesh {
    flesh_of(scale, true)
}

/// Nominal range of each angle, radians, by coordinate; the position and the heading have none.
#[must_use]
pub fn ranges() -> [Option<[f64; 2]>; 24] {
    let degrees = |low: f64, high: f64| Some([low, high].map(|x| x * PI / 180.0));
    let mirrored = |range: Option<[f64; 2]>| range.map(|[low, high]| [-high, -low]);
    let mut ranges = [None; 24];
    ranges[4..8].copy_from_slice(&[
        degrees(-60.0, 60.0),
        degrees(-60.0, 60.0),
        degrees(-50.0, 50.0),
        degrees(-40.0, 40.0),
    ]);
    let arm = [degrees(-60.0, 170.0), degrees(-20.0, 150.0), degrees(-90.0, 90.0), degrees(0.0, 150.0)];
    let leg = [degrees(-40.0, 120.0), degrees(-20.0, 45.0), degrees(-45.0, 45.0), degrees(-150.0, 0.0)];
    for (first, limb) in [(8, arm), (16, leg)] {
        ranges[first..first + 4].copy_from_slice(&limb);
        ranges[first + 4..first + 8].copy_from_slice(&limb);
        // Turning about +y moves a hanging limb to the left; the right one goes outwards the other way.
        ranges[first + 5] = mirrored(limb[1]);
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placed::{self, near};

    fn points(q: &[f64; 24]) -> impl Fn(&str) -> [f64; 3] + use<> {
        placed::points(tree(1.0), q)
    }

    #[test]
    fn it_stands_upright_at_zero() {
        let at = points(&[0.0; 24]);
        assert!(near(at("RAnkle"), [HIP, 0.0, -THIGH - SHIN]) && near(at("LWrist"), [-SHOULDER, 0.0, TORSO - 0.56]));
        assert!(near(at("Head"), [0.0, 0.0, NECK + HEAD]));
        assert!((STANDING_HEIGHT_M - THIGH - SHIN - 0.07).abs() < 1e-12, "ankles are at 0.07 m");
    }

    #[test]
    fn coordinates_turn_what_they_are_named_for() {
        let turned = |j: usize| {
            let mut q = [0.0; 24];
            q[j] = 0.5 * PI;
            points(&q)
        };
        assert!(near(turned(8)("LElbow"), [-SHOULDER, UPPER_ARM, TORSO]), "flexion goes forward");
        assert!(near(turned(9)("LElbow"), [-SHOULDER - UPPER_ARM, 0.0, TORSO]), "abduction of the left goes left");
        assert!(near(turned(11)("LWrist"), [-SHOULDER, FOREARM, TORSO - UPPER_ARM]), "elbows bend forward");
        assert!(near(turned(10)("LWrist"), points(&[0.0; 24])("LWrist")), "a twist leaves a straight arm where it is");
        let mut bent = [0.0; 24];
        (bent[23], bent[22]) = (-0.5 * PI, 0.5 * PI);
        assert!(near(points(&bent)("RAnkle"), [HIP + SHIN, 0.0, -THIGH]), "the twist turns the hinge");
        assert!(
            near(turned(5)("Neck"), [NECK, 0.0, 0.0]) && near(turned(5)("LHip"), [-HIP, 0.0, 0.0]),
            "hips do not lean"
        );
    }

    #[test]
    fn solids_reach_from_joint_to_joint() {
        let (tree, flesh) = (tree(1.1), flesh(1.1));
        assert_eq!(flesh.solids().len(), 10);
        let names: Vec<&str> = flesh.solids().iter().map(|solid| solid.name.as_str()).collect();
        assert_eq!(names[..4], ["torso", "head", "l_upper_arm", "l_forearm"]);
        let heights: Vec<f64> = flesh.solids().iter().map(|solid| solid.frustum.height / 1.1).collect();
        let expected = [TORSO, HEAD, UPPER_ARM, FOREARM, UPPER_ARM, FOREARM, THIGH, SHIN, THIGH, SHIN];
        assert!(heights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{heights:?}");
        assert_eq!(
            flesh.coordinates(&tree),
            [
                (0..6).collect(),
                vec![6, 7],
                vec![8, 9],
                vec![10, 11],
                vec![12, 13],
                vec![14, 15],
                vec![16, 17],
                vec![18, 19],
                vec![20, 21],
                vec![22, 23]
            ]
        );
        assert_eq!(flesh.parents()[..4], [None, Some(0), Some(0), Some(2)]);
        assert_eq!(flesh.parents()[6..], [Some(0), Some(6), Some(0), Some(8)]);
        let torso = cylinders(1.0).solids()[0].frustum;
        assert!((torso.radii[0] - 0.25 * (0.15 + 0.10 + 0.17 + 0.17 / 1.5)).abs() < 1e-12 && torso.ratio == 1.0);
    }

    #[test]
    fn a_subject_of_standard_size_has_the_standard_body() {
        let (sized, standard) = (sized(&Proportions::default()), tree(1.0));
        let offsets = |tree: &KinematicTree| -> Vec<[f64; 3]> {
            let links = tree.links().iter().map(|link| link.offset);
            links.chain(tree.points().iter().map(|point| point.offset)).collect()
        };
        assert!(offsets(&sized).into_iter().zip(offsets(&standard)).all(|(a, b)| near(a, b)));
        let (found, expected) = (flesh_on(&sized).expect("its own tree"), flesh(1.0));
        for (a, b) in found.solids().iter().zip(expected.solids()) {
            let [a, b] = [a, b].map(|s| [s.frustum.height, s.frustum.radii[0], s.frustum.radii[1]]);
            assert!(near(a, b), "{a:?} for {b:?}");
        }
        assert!(flesh_on(&crate::standard::h32(&Proportions::default())).is_err());
    }

    #[test]
    fn ranges_are_mirrored() {
        let ranges = ranges();
        assert_eq!(ranges[..4], [None; 4]);
        assert_eq!(ranges.iter().flatten().count(), 20);
        assert_eq!(ranges[9].map(|r| r.map(|x| (x * 180.0 / PI).round())), Some([-20.0, 150.0]));
        assert_eq!(ranges[13].map(|r| r.map(|x| (x * 180.0 / PI).round())), Some([-150.0, 20.0]));
    }
}
