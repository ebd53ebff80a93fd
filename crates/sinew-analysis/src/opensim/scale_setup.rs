//! Settings of OpenSim's scale tool: sizes of the model's bodies from distances between points.
//!
//! The tracked body keeps its lengths, so all frames say the same. The trunk has a height, from hips to shoulders, and widths at both. Hips do not say how high a pelvis is: were it scaled by them in all directions, somebody with wide hips would get a trunk that is too long, which can only be fitted bent. Markers are not moved afterwards: centres of joints stay at the joints.

use super::marker_set::ModelMarker;
use sinew_formats::xml_text::escaped;
use std::fmt::Write as _;

/// Scaled model that the scale tool writes and inverse kinematics reads.
pub(super) const SCALED: &str = "scaled.osim";

/// A measurement: its name, pairs of points that are averaged, and bodies that it scales along axes.
struct Measurement {
    name: &'static str,
    pairs: &'static [[&'static str; 2]],
    bodies: &'static [&'static str],
    axes: &'static str,
}

const ALL: &str = " X Y Z";

const MEASUREMENTS: [Measurement; 9] = [
    Measurement { name: "pelvis", pairs: &[["RHip", "LHip"]], bodies: &["pelvis", "sacrum"], axes: " Z" },
    Measurement {
        name: "thigh",
        pairs: &[["RHip", "RKnee"], ["LHip", "LKnee"]],
        bodies: &["femur_r", "femur_l", "patella_r", "patella_l"],
        axes: ALL,
    },
    Measurement {
        name: "shank",
        pairs: &[["RKnee", "RAnkle"], ["LKnee", "LAnkle"]],
        bodies: &["tibia_r", "tibia_l"],
        axes: ALL,
    },
    Measurement {
        name: "foot",
        pairs: &[["RHeel", "RBigToe"], ["LHeel", "LBigToe"]],
        bodies: &["talus_r", "calcn_r", "toes_r", "talus_l", "calcn_l", "toes_l"],
        axes: ALL,
    },
    Measurement {
        name: "torso",
        pairs: &[["RShoulder", "RHip"], ["LShoulder", "LHip"]],
        bodies: &["pelvis", "sacrum", "lumbar5", "lumbar4", "lumbar3", "lumbar2", "lumbar1", "torso"],
        axes: " X Y",
    },
    Measurement {
        name: "shoulders",
        pairs: &[["RShoulder", "LShoulder"]],
        bodies: &["lumbar5", "lumbar4", "lumbar3", "lumbar2", "lumbar1", "torso"],
        axes: " Z",
    },
    Measurement { name: "head", pairs: &[["Head", "Nose"]], bodies: &["head"], axes: ALL },
    Measurement {
        name: "arm",
        pairs: &[["RShoulder", "RElbow"], ["LShoulder", "LElbow"]],
        bodies: &["humerus_r", "humerus_l"],
        axes: ALL,
    },
    Measurement {
        name: "forearm",
        pairs: &[["RElbow", "RWrist"], ["LElbow", "LWrist"]],
        bodies: &["ulna_r", "radius_r", "hand_r", "ulna_l", "radius_l", "hand_l"],
        axes: ALL,
    },
];

/// The settings; `bodies` are the model's, if they are known.
pub(super) fn to_xml(
    model_file: &str,
    markers: &[ModelMarker],
    bodies: Option<&[String]>,
    [from, to]: [f64; 2],
) -> String {
    let mut measured = String::new();
    let has_marker = |name: &str| markers.iter().any(|marker| marker.name == name);
    let has_body = |name: &&&str| bodies.is_none_or(|bodies| bodies.iter().any(|body| body == **name));
    for Measurement { name, pairs, bodies, axes } in MEASUREMENTS {
        let pairs: Vec<_> = pairs.iter().filter(|pair| pair.iter().all(|name| has_marker(name))).collect();
        if pairs.is_empty() {
            continue;
        }
        let _ = writeln!(measured, "\t\t\t\t\t<Measurement name=\"{name}\">\n\t\t\t\t\t\t<apply>true</apply>");
        measured += "\t\t\t\t\t\t<MarkerPairSet><objects>\n";
        for [one, other] in pairs {
            let _ = writeln!(measured, "\t\t\t\t\t\t\t<MarkerPair><markers> {one} {other}</markers></MarkerPair>");
        }
        measured += "\t\t\t\t\t\t</objects></MarkerPairSet>\n\t\t\t\t\t\t<BodyScaleSet><objects>\n";
        for body in bodies.iter().filter(has_body) {
            let _ = writeln!(measured, "\t\t\t\t\t\t\t<BodyScale name=\"{body}\"><axes>{axes}</axes></BodyScale>");
        }
        measured += "\t\t\t\t\t\t</objects></BodyScaleSet>\n\t\t\t\t\t</Measurement>\n";
    }
    include_str!("scale.xml")
        .replace("{{model}}", &escaped(model_file))
        .replace("{{scaled}}", SCALED)
        .replace("{{range}}", &format!("{from} {to}"))
        .replace("{{measurements}}\n", &measured)
}

#[cfg(test)]
mod tests {
    use super::super::marker_set::{HIP, SHOULDER, TRUNK};
    use super::*;
    use sinew_body::points::points_of_states;
    use sinew_body::{Proportions, standard};

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn bodies_that_the_model_lacks_are_not_scaled() {
        let marker = |name: &str| ModelMarker { name: name.into(), body: "hand_r".into(), place: [0.0; 3] };
        let markers = ["RElbow", "RWrist"].map(marker);
        let scaled = |bodies: Option<&[String]>| {
            let text = to_xml("model.osim", &markers, bodies, [0.5, 2.0]);
            let names = text.split("<BodyScale name=\"").skip(1).filter_map(|own| own.split_once('"'));
            (names.map(|(name, _)| name.to_owned()).collect::<Vec<_>>(), text.matches("<Measurement name=").count())
        };
        let all = ["ulna_r", "radius_r", "hand_r", "ulna_l", "radius_l", "hand_l"].map(str::to_owned);
        assert_eq!(scaled(None), (all.to_vec(), 1));
        let of_model = ["pelvis", "radius_r", "hand_l"].map(str::to_owned);
        assert_eq!(scaled(Some(&of_model)), (of_model[1..].to_vec(), 1));
    }

    /// The scaled model's shoulders are as high above its hips as the person's, however wide their hips are: with a trunk that is too long or too short, flexion of the lumbar joint would make up for it.
    #[test]
    fn the_trunk_is_as_high_as_the_persons_with_narrow_and_wide_hips() {
        for hip_half_width in [0.07, 0.1, 0.13] {
            let sizes = Proportions { hip_half_width, ..Proportions::default() };
            let tree = standard::h32(&sizes);
            let zero = points_of_states(&tree, &[vec![0.0; tree.dof()]]);
            let ours = |name: &str| zero.frames[0][zero.index(name).unwrap()];
            let model = |name: &str| {
                let [x, y, z] =
                    if name.ends_with("Hip") { HIP } else { [0, 1, 2].map(|k: usize| TRUNK[k] + SHOULDER[k]) };
                [x, y, if name.starts_with('L') { -z } else { z }]
            };
            // The scale tool: means of ratios of distances.
            let height_factor = |body: &str| {
                let is_its = |m: &&Measurement| m.bodies.contains(&body) && m.axes.contains('Y');
                let Measurement { pairs, .. } = MEASUREMENTS.iter().find(is_its).unwrap();
                let ratio = |[a, b]: &[&str; 2]| apart(ours(a), ours(b)) / apart(model(a), model(b));
                pairs.iter().map(ratio).sum::<f64>() / pairs.len() as f64
            };
            let found = height_factor("pelvis") * (TRUNK[1] - HIP[1]) + height_factor("torso") * SHOULDER[1];
            let expected = ours("RShoulder")[2] - ours("RHip")[2];
            assert!((found - expected).abs() < 0.01, "{found:.3} m for {expected:.3} m");
        }
    }
}
