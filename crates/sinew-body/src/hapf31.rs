//! The body of Raskin, Rudzsky & Rivlin (2011), after Balan, Sigal & Black (2005).
//!
//! Place and orientation λ, 25 angles ω, ten truncated cones, and the tree of its latent spaces.
//!
//! | index | ω | what |
//! |---|---|---|
//! | 0–2 | | waist |
//! | 3–5 | | orientation, about z, y, x |
//! | 6, 7 | 0, 1 | thorax, about y and x |
//! | 8–10, 11; 12–14, 15 | 2–5; 6–9 | left, right hip about z, y, x, knee |
//! | 16, 17; 22, 23 | 10, 11; 16, 17 | left, right clavicle, about z and y |
//! | 18–20, 21; 24–26, 27 | 12–15; 18–21 | left, right shoulder about z, y, x, elbow |
//! | 28–30 | 22–24 | head, about z, y, x |
//!
//! The paper gives counts only; axes and the grouping are ours. The body it cites has the thorax' angles after the arms; here, as everywhere, a link's angles come after its parent's.

use crate::Error;
use crate::flesh::Flesh;
use crate::standard::Proportions;
use crate::ten_cones::{Torso, ten_cones_on};
use crate::tree::{Axis, Joint, KinematicTree, Link, Point};
use core::ops::Range;

/// Number of coordinates of λ, which come first.
pub const FREE: usize = 6;

/// Number of angles ω.
pub const ANGLES: usize = 25;

/// Part of half the distance of the shoulders that lies before the clavicle.
const CLAVICLE: f64 = 1.0 / 6.0;

const LINKS: usize = 13;

/// One of the body's latent spaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatentSpace {
    /// Its name.
    pub name: &'static str,
    /// Place of the space above it in [`HIERARCHY`].
    pub parent: Option<usize>,
    /// Its layer, from 1.
    pub layer: usize,
    /// Stretches of ω that it covers.
    pub stretches: [[usize; 2]; 2],
    /// Dimension of the latent.
    pub latent_dim: usize,
}

impl LatentSpace {
    const fn new(
        name: &'static str,
        parent: Option<usize>,
        layer: usize,
        stretch: Range<usize>,
        latent_dim: usize,
    ) -> Self {
        Self { name, parent, layer, stretches: [[stretch.start, stretch.end], [0, 0]], latent_dim }
    }

    /// The coordinates of ω that it covers, ascending.
    #[must_use]
    pub fn coordinates(&self) -> Vec<usize> {
        self.stretches.iter().flat_map(|&[first, end]| first..end).collect()
    }
}

/// The latent spaces: the whole; legs, arms and upper body; limbs, thorax and head.
pub const HIERARCHY: [LatentSpace; 10] = [
    LatentSpace::new("body", None, 1, 0..25, 3),
    LatentSpace::new("legs", Some(0), 2, 2..10, 2),
    LatentSpace::new("arms", Some(0), 2, 10..22, 2),
    LatentSpace { stretches: [[0, 2], [22, 25]], ..LatentSpace::new("upper_body", Some(0), 2, 0..2, 2) },
    LatentSpace::new("l_leg", Some(1), 3, 2..6, 2),
    LatentSpace::new("r_leg", Some(1), 3, 6..10, 2),
    LatentSpace::new("l_arm", Some(2), 3, 10..16, 2),
    LatentSpace::new("r_arm", Some(2), 3, 16..22, 2),
    LatentSpace::new("thorax", Some(3), 3, 0..2, 1),
    LatentSpace::new("head", Some(3), 3, 22..25, 2),
];

/// The tree with the fifteen joints of evaluation and the sizes of a subject.
///
/// # Panics
/// If a size is not finite.
#[must_use]
pub fn sized(p: &Proportions) -> KinematicTree {
    use Axis::{X, Y, Z};
    let link = |name: &str, parent: Option<usize>, offset: [f64; 3], axes: &[Axis]| {
        Link::new(name, parent, offset, axes.iter().map(|&axis| Joint::Rotate(axis)).collect())
    };
    let mut torso = link("torso", None, [0.0; 3], &[Z, Y, X]);
    torso.joints.splice(0..0, [X, Y, Z].map(Joint::Translate));
    let mut links = vec![torso, link("thorax", Some(0), [0.0; 3], &[Y, X])];
    for (side, sign) in [("l", -1.0), ("r", 1.0)] {
        let hip = [sign * p.hip_half_width, 0.0, -p.pelvis_drop];
        links.push(link(&format!("{side}_thigh"), Some(0), hip, &[Z, Y, X]));
        links.push(link(&format!("{side}_shin"), Some(links.len() - 1), [0.0, 0.0, -p.thigh], &[X]));
    }
    for (side, sign) in [("l", -1.0), ("r", 1.0)] {
        let clavicle = [sign * CLAVICLE * p.shoulder_half_width, 0.0, p.shoulder_height];
        let shoulder = [sign * (1.0 - CLAVICLE) * p.shoulder_half_width, 0.0, 0.0];
        links.push(link(&format!("{side}_clavicle"), Some(1), clavicle, &[Z, Y]));
        links.push(link(&format!("{side}_upper_arm"), Some(links.len() - 1), shoulder, &[Z, Y, X]));
        links.push(link(&format!("{side}_forearm"), Some(links.len() - 1), [0.0, 0.0, -p.upper_arm], &[X]));
    }
    links.push(link("head", Some(1), [0.0, 0.0, p.spine], &[Z, Y, X]));
    let point = |name: &str, link, offset: [f64; 3]| Point { name: name.into(), link, offset };
    let mut points = vec![
        point("MidHip", 0, [0.0, 0.0, -p.pelvis_drop]),
        point("Neck", 12, [0.0; 3]),
        point("Head", 12, [0.0, 0.0, p.head_top[2]]),
    ];
    for (side, leg, arm) in [("L", 2, 7), ("R", 4, 10)] {
        points.extend([
            point(&format!("{side}Shoulder"), arm, [0.0; 3]),
            point(&format!("{side}Elbow"), arm + 1, [0.0; 3]),
            point(&format!("{side}Wrist"), arm + 1, [0.0, 0.0, -p.forearm]),
            point(&format!("{side}Hip"), leg, [0.0; 3]),
            point(&format!("{side}Knee"), leg + 1, [0.0; 3]),
            point(&format!("{side}Ankle"), leg + 1, [0.0, 0.0, -p.shin]),
        ]);
    }
    KinematicTree::new(links, points).expect("the built-in bodies are valid for every finite size")
}

/// The ten truncated cones of a tree that [`sized`] made: torso, legs, arms and head, as long as its segments, and as thick as an adult of 1.75 m stretched with the limbs.
///
/// # Errors
/// [`Error::NoSolid`] for the tree of another body.
pub fn flesh_on(tree: &KinematicTree) -> Result<Flesh, Error> {
    let offset = |link: &str| Some(tree.links()[tree.link_index(link)?].offset[2]);
    let (Some(shoulders), Some(hips)) = (offset("l_clavicle"), offset("l_thigh")) else {
        return Err(Error::NoSolid);
    };
    if tree.links().len() != LINKS {
        return Err(Error::NoSolid);
    }
    ten_cones_on(tree, Torso { link: "thorax", drop: -hips, height: shoulders - hips })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Plan, point_positions};
    use crate::placed::{self, near};
    use core::f64::consts::PI;
    use sinew_core::lanes::Isa;

    fn points(q: &[f64]) -> impl Fn(&str) -> [f64; 3] + use<> {
        placed::points(sized(&Proportions::default()), q)
    }

    #[test]
    fn it_stands_as_the_standard_body_does() {
        let p = Proportions::default();
        let (own, standard) = (sized(&p), crate::standard::h32(&p));
        assert_eq!((own.dof(), own.points().len()), (FREE + ANGLES, 15));
        let at = |tree: &KinematicTree| {
            let plan = Plan::with_all_points(tree);
            let mut at = vec![0.0; 3 * plan.points()];
            point_positions(&plan, Isa::baseline(), &vec![0.0; tree.dof()], &mut at);
            at.as_chunks::<3>().0.to_vec()
        };
        let (own_at, standard_at) = (at(&own), at(&standard));
        for (point, place) in own.points().iter().zip(own_at) {
            let other = standard_at[standard.point_index(&point.name).expect("a joint of evaluation")];
            assert!(near(place, other), "{}: {place:?} for {other:?}", point.name);
        }
    }

    #[test]
    fn coordinates_turn_what_they_are_named_for() {
        let turned = |j: usize| {
            let mut q = [0.0; FREE + ANGLES];
            q[j] = 0.5 * PI;
            points(&q)
        };
        assert!(near(turned(7)("Neck"), [0.0, -0.48, 0.0]), "the thorax leans back about x");
        assert!(near(turned(7)("LHip"), [-0.09, 0.0, -0.1]), "hips do not lean");
        assert!(near(turned(10)("LKnee"), [-0.09, 0.43, -0.1]), "hips flex forward about x");
        assert!(near(turned(16)("LShoulder"), [-0.03, -0.15, 0.42]), "clavicles turn about z");
        assert!(near(turned(21)("LWrist"), [-0.18, 0.26, 0.12]), "elbows bend forward about x");
        assert!(near(turned(30)("Head"), [0.0, -0.25, 0.48]), "the head leans back about x");
    }

    #[test]
    fn ten_cones_reach_from_joint_to_joint() {
        let p = Proportions::default();
        let tree = sized(&p);
        let flesh = flesh_on(&tree).expect("its own tree");
        let heights: Vec<f64> = flesh.solids().iter().map(|solid| solid.frustum.height).collect();
        let expected = [0.52, p.thigh, p.shin, p.thigh, p.shin, 0.30, 0.26, 0.30, 0.26, 0.25];
        assert!(heights.len() == 10 && heights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{heights:?}");
        assert_eq!(flesh.solids()[0].base, [0.0, 0.0, -p.pelvis_drop]);
        let torso = Some(0);
        assert_eq!(flesh.parents(), [None, torso, Some(1), torso, Some(3), torso, Some(5), torso, Some(7), torso]);
        let mut all = flesh.coordinates(&tree).concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..FREE + ANGLES));
        assert!(flesh_on(&crate::standard::h32(&p)).is_err() && flesh_on(&crate::hppf24::sized(&p)).is_err());
        assert!(crate::hppf24::flesh_on(&tree).is_err());
    }

    /// Leaves of the hierarchy (A14): the spaces of the last layer hold every angle once, and each space what those below it hold; they are the links that they are named for.
    #[test]
    fn leaves_cover_every_coordinate_once() {
        let sorted = |mut coordinates: Vec<usize>| {
            coordinates.sort_unstable();
            coordinates
        };
        let leaves = HIERARCHY.iter().filter(|space| space.layer == 3).flat_map(LatentSpace::coordinates);
        assert_eq!(sorted(leaves.collect()), (0..ANGLES).collect::<Vec<_>>());
        for (k, space) in HIERARCHY.iter().enumerate() {
            assert_eq!(space.layer, space.parent.map_or(1, |parent| HIERARCHY[parent].layer + 1));
            assert!(space.parent.is_none_or(|parent| parent < k) && space.latent_dim < space.coordinates().len());
            let below: Vec<usize> =
                HIERARCHY.iter().filter(|other| other.parent == Some(k)).flat_map(LatentSpace::coordinates).collect();
            assert!(
                below.is_empty() == (space.layer == 3) && (below.is_empty() || sorted(below) == space.coordinates())
            );
        }
        let tree = sized(&Proportions::default());
        let links_angles = |names: &[&str]| -> Vec<usize> {
            let coordinates = |name: &&str| {
                let link = tree.link_index(name).expect("a link");
                let first = tree.first_dof(link) - FREE;
                first..first + tree.links()[link].joints.len()
            };
            names.iter().flat_map(coordinates).collect()
        };
        let named = |name: &str| HIERARCHY.iter().find(|space| space.name == name).expect("a space").coordinates();
        assert_eq!(named("l_leg"), links_angles(&["l_thigh", "l_shin"]));
        assert_eq!(named("r_arm"), links_angles(&["r_clavicle", "r_upper_arm", "r_forearm"]));
        assert_eq!(named("upper_body"), links_angles(&["thorax", "head"]));
    }
}
