//! The feature vectors of a body: which coordinates move together.
//!
//! HPPF24 has the 14 of Husz, Wallace & Green (2007): all joint angles, head, arms and legs, and each part of a limb, by the names of the body's links. The others have one, since their
//! model is used as the prior of the whole body: all coordinates except root and feet ([`pose_coordinates`]), as latent models have them. Recordings show one point of a foot, which does not say how it rolls, so that the same step has other angles in each; the feet walk at
//! random.

use crate::follow::NamedBody;
use sinew_body::KinematicTree;
use sinew_dynamics::primitives::model::FeatureVector;

/// Coordinates of the root: position and orientation. HPPF24 has a heading and the lean of its torso.
const ROOT: usize = 6;

/// Links of the feet.
const FEET: [&str; 2] = ["l_foot", "r_foot"];

/// Limbs of HPPF24, with their links.
const LIMBS: [(&str, [&str; 2]); 4] = [
    ("l_arm", ["l_upper_arm", "l_forearm"]),
    ("r_arm", ["r_upper_arm", "r_forearm"]),
    ("l_leg", ["l_thigh", "l_shin"]),
    ("r_leg", ["r_thigh", "r_shin"]),
];

/// The feature vectors of a body, the whole body's first.
#[must_use]
pub fn feature_vectors(body: NamedBody) -> Vec<FeatureVector> {
    let tree = body.tree();
    let vector = |name: &str, coordinates| FeatureVector { name: name.into(), coordinates };
    let mut found = vec![vector("body", pose_coordinates(body).collect())];
    if body == NamedBody::Hppf24 {
        let links = |names: &[&str]| names.iter().flat_map(|name| coordinates_of(&tree, name)).collect();
        found.push(vector("head", links(&["head"])));
        found.extend(LIMBS.iter().map(|(limb, parts)| vector(limb, links(parts))));
        found.extend(LIMBS.iter().flat_map(|(_, parts)| parts.map(|part| vector(part, links(&[part])))));
    }
    found
}

/// The coordinates that recordings of other people know: all between the root and the feet, which come last.
#[must_use]
pub fn pose_coordinates(body: NamedBody) -> std::ops::Range<usize> {
    let tree = body.tree();
    let feet = FEET.iter().map(|foot| coordinates_of(&tree, foot)).filter(|foot| !foot.is_empty());
    ROOT..feet.map(|foot| foot.start).min().unwrap_or(tree.dof())
}

fn coordinates_of(tree: &KinematicTree, name: &str) -> std::ops::Range<usize> {
    let Some(link) = tree.link_index(name) else { return 0..0 };
    let first = tree.first_dof(link);
    first..first + tree.links()[link].joints.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hppf24_has_the_fourteen_of_the_paper() {
        let found = feature_vectors(NamedBody::Hppf24);
        let shown: Vec<String> =
            found.iter().map(|feature| format!("{} {:?}", feature.name, feature.coordinates)).collect();
        assert_eq!(shown[0], format!("body {:?}", (6..24).collect::<Vec<_>>()));
        assert_eq!(
            shown[1..],
            [
                "head [6, 7]",
                "l_arm [8, 9, 10, 11]",
                "r_arm [12, 13, 14, 15]",
                "l_leg [16, 17, 18, 19]",
                "r_leg [20, 21, 22, 23]",
                "l_upper_arm [8, 9]",
                "l_forearm [10, 11]",
                "r_upper_arm [12, 13]",
                "r_forearm [14, 15]",
                "l_thigh [16, 17]",
                "l_shin [18, 19]",
                "r_thigh [20, 21]",
                "r_shin [22, 23]",
            ]
        );
    }

    #[test]
    fn the_standard_bodies_have_all_but_root_and_feet() {
        for body in [NamedBody::H32, NamedBody::Cf28] {
            let found = feature_vectors(body);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].coordinates, (6..28).collect::<Vec<_>>());
        }
    }
}
