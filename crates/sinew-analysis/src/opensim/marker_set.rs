//! Where our points are on a model of OpenSim.
//!
//! Points of joints are centres of joints, and the bodies of the models in use (gait2392, Rajagopal's, Pose2Sim's) have their origins there: hips are at the origin of the femur, knees of the tibia, ankles of the talus, shoulders of the humerus, elbows of the ulna, wrists of the hand. Sets of markers for the skin put them beside the joints, which turns angles by up to 16° (docs/evidence/opensim.md).
//!
//! Toes, heels, neck, head and nose are no joints. They lie on the model as they lie on the tracked body at its zero pose, in which soles are level and the trunk is upright: from the ankle, from the middle of the shoulders, from the neck. The scale tool multiplies places with the body's size, so they are divided by the factor that it will find: of the foot from heel to big toe, of the trunk from shoulder to hip, of the head from its top to the nose.

use sinew_body::KinematicTree;
use sinew_body::points::points_of_states;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A marker on a body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelMarker {
    pub(super) name: String,
    pub(super) body: String,
    /// In the body, metres.
    pub(super) place: [f64; 3],
}

/// Joints at origins of bodies, of either side.
const JOINTS: [(&str, &str); 6] = [
    ("Hip", "femur"),
    ("Knee", "tibia"),
    ("Ankle", "talus"),
    ("Shoulder", "humerus"),
    ("Elbow", "ulna"),
    ("Wrist", "hand"),
];

/// Points of the feet, of either side, and their bodies.
const FEET: [(&str, &str); 3] = [("Heel", "calcn"), ("BigToe", "toes"), ("SmallToe", "toes")];

/// Places in the models before they are scaled, metres, x forward, y up, z to the right: heel bone and toes from the talus of the right foot, shoulder in the trunk, trunk and right hip in the pelvis, head in the trunk at rest.
const CALCANEUS: [f64; 3] = [-0.048_77, -0.041_95, 0.007_92];
const TOES: [f64; 3] = [0.130_03, -0.043_95, 0.009];
pub(super) const SHOULDER: [f64; 3] = [0.003_155, 0.3715, 0.17];
pub(super) const TRUNK: [f64; 3] = [-0.1007, 0.0815, 0.0];
pub(super) const HIP: [f64; 3] = [-0.0707, -0.0661, 0.0835];
const NECK_JOINT: [f64; 3] = [0.0, 0.541_458, 0.0];
const HEAD_BELOW_JOINT: [f64; 3] = [0.0, -0.03, 0.0];

/// Feet (heel to big toe) and heads (top to nose) of an adult of the model's size, metres.
const FOOT_M: f64 = 0.221;
const HEAD_M: f64 = 0.164;

/// Without these no model can be scaled.
pub(super) const NEEDED: [&str; 8] = ["RHip", "LHip", "RKnee", "LKnee", "RAnkle", "LAnkle", "RShoulder", "LShoulder"];

/// Places of the points of a body at its zero pose, in the axes of models.
struct AtZero(BTreeMap<String, [f64; 3]>);

fn combined(a: [f64; 3], factor: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + factor * b[axis])
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

impl AtZero {
    fn new(tree: &KinematicTree) -> Self {
        let zero = points_of_states(tree, &[vec![0.0; tree.dof()]]);
        let places = zero.frames.first().into_iter().flatten();
        Self(zero.names.iter().cloned().zip(places.map(|[x, y, z]| [*y, *z, *x])).collect())
    }

    /// From one point to another, if both are there.
    fn between(&self, from: &str, to: &str) -> Option<[f64; 3]> {
        Some(combined(*self.0.get(to)?, -1.0, *self.0.get(from)?))
    }

    /// From the middle of the shoulders to a point.
    fn beyond_shoulders(&self, to: &str) -> Option<[f64; 3]> {
        Some(combined(self.between("RShoulder", to)?, -0.5, self.between("RShoulder", "LShoulder")?))
    }
}

/// All points of a body that have a place on a model.
pub(super) fn markers(tree: &KinematicTree) -> Vec<ModelMarker> {
    let zero = AtZero::new(tree);
    let mut found = vec![];
    for (side, suffix, mirror) in [("R", "_r", 1.0), ("L", "_l", -1.0)] {
        for (joint, body) in JOINTS {
            found.push(ModelMarker {
                name: format!("{side}{joint}"),
                body: format!("{body}{suffix}"),
                place: [0.0; 3],
            });
        }
        for (point, body) in FEET {
            let name = format!("{side}{point}");
            if let Some(place) = on_foot(&zero, side, point, body, mirror) {
                found.push(ModelMarker { name, body: format!("{body}{suffix}"), place });
            }
        }
    }
    found.extend(trunk_and_head(&zero));
    found.retain(|marker| zero.0.contains_key(&marker.name));
    found
}

fn on_foot(zero: &AtZero, side: &str, point: &str, body: &str, mirror: f64) -> Option<[f64; 3]> {
    let named = |point: &str| format!("{side}{point}");
    let size = zero.between(&named("Heel"), &named("BigToe")).map_or(1.0, |foot| length(foot) / FOOT_M);
    let from_ankle = zero.between(&named("Ankle"), &named(point))?;
    let [x, y, z] = if body == "toes" { TOES } else { CALCANEUS };
    Some(combined(from_ankle.map(|along| along / size), -1.0, [x, y, mirror * z]))
}

/// Neck, head and nose.
fn trunk_and_head(zero: &AtZero) -> Vec<ModelMarker> {
    let middle = [SHOULDER[0], SHOULDER[1], 0.0];
    let model_m = length(combined(combined(TRUNK, 1.0, SHOULDER), -1.0, HIP));
    let Some(trunk) = zero.between("RHip", "RShoulder").map(|trunk| length(trunk) / model_m) else { return vec![] };
    let Some(neck) = zero.beyond_shoulders("Neck") else { return vec![] };
    let neck = combined(middle, trunk.recip(), neck);
    let mut found = vec![ModelMarker { name: "Neck".into(), body: "torso".into(), place: neck }];
    let Some(size) = zero.between("Head", "Nose").map(|head| length(head) / HEAD_M) else { return found };
    // Where the head's origin comes to in the scaled trunk, from where the neck comes to.
    let origin = combined(combined([0.0; 3], trunk, combined(NECK_JOINT, -1.0, neck)), size, HEAD_BELOW_JOINT);
    for name in ["Head", "Nose"] {
        if let Some(from_neck) = zero.between("Neck", name) {
            let place = combined(from_neck, -1.0, origin).map(|along| along / size);
            found.push(ModelMarker { name: name.into(), body: "head".into(), place });
        }
    }
    found
}

/// The set as a file of OpenSim.
pub(super) fn to_xml(markers: &[ModelMarker]) -> String {
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\" ?>\n<OpenSimDocument Version=\"40000\">\n\
        \t<!-- Centres of joints at the origins of bodies; toes, heels, neck, head and nose as on the tracked body. -->\n\
        \t<MarkerSet name=\"sinew\">\n\t\t<objects>\n"
        .to_owned();
    for ModelMarker { name, body, place } in markers {
        let [x, y, z] = place.map(|along| (along * 1e6).round() / 1e6 + 0.0);
        let _ = writeln!(
            text,
            "\t\t\t<Marker name=\"{name}\">\n\t\t\t\t<socket_parent_frame>/bodyset/{body}</socket_parent_frame>\n\
             \t\t\t\t<location>{x} {y} {z}</location>\n\t\t\t\t<fixed>true</fixed>\n\t\t\t</Marker>"
        );
    }
    text + "\t\t</objects>\n\t</MarkerSet>\n</OpenSimDocument>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Proportions, standard};

    /// What the scale tool makes of a place: times the ratio of our distance to that on the model.
    #[test]
    fn scaled_feet_and_heads_are_the_tracked_ones() {
        let sizes = Proportions {
            heel: [0.0, -0.06, -0.07],
            big_toe: [-0.01, 0.2, -0.07],
            nose: [0.0, 0.12, 0.1],
            ..Proportions::default()
        };
        let body = standard::h32(&sizes);
        let found = markers(&body);
        let place = |name: &str| found.iter().find(|marker| marker.name == name).unwrap().place;
        for (side, mirror) in [("R", 1.0), ("L", -1.0)] {
            let at =
                |name: &str, [x, y, z]: [f64; 3]| combined(place(&format!("{side}{name}")), 1.0, [x, y, mirror * z]);
            let (heel, toe) = (at("Heel", CALCANEUS), at("BigToe", TOES));
            let ours = combined([sizes.big_toe[1], sizes.big_toe[2], 0.0], -1.0, [sizes.heel[1], sizes.heel[2], 0.0]);
            let factor = length([ours[0], ours[1], -0.01]) / length(combined(toe, -1.0, heel));
            assert!((factor * heel[0] + 0.06).abs() < 1e-9 && (factor * heel[1] + 0.07).abs() < 1e-9, "{heel:?}");
            assert!((factor * toe[2] + mirror * 0.01).abs() < 1e-9, "{toe:?}");
        }
        let (head, nose) = (place("Head"), place("Nose"));
        let factor = length([0.12, 0.1 - 0.25, 0.0]) / length(combined(nose, -1.0, head));
        assert!((factor * (nose[0] - head[0]) - 0.12).abs() < 1e-9, "{head:?} {nose:?}");
    }

    #[test]
    fn joints_are_at_origins_and_bodies_without_feet_have_none() {
        let found = markers(&standard::cf28(&Proportions::default()));
        assert!(found.iter().all(|marker| !marker.name.contains("Toe")));
        assert!(NEEDED.iter().all(|name| found.iter().any(|marker| marker.name == *name && marker.place == [0.0; 3])));
        assert!(found.iter().any(|marker| marker.name == "Head"));
    }
}
