//! Settings of OpenSim's inverse kinematics: a weight for each marker, and what markers do not show.
//!
//! Of the pelvis there are two points, the hips: they do not show how it is tilted, and the lumbar joint's flexion makes up for any tilt. Without a word of it the fit puts the trunk's lean somewhere between both, and hips turn with the pelvis, by 15° in the demo. As Pose2Sim's settings do, these hold that coordinate at its default with a small weight: the pelvis then goes with the trunk.

use super::scale_setup::SCALED;
use super::weights::MarkerWeights;
use std::fmt::Write as _;

/// Flexion of the lumbar joint: in Pose2Sim's models, in gait2392 and Rajagopal's.
const HELD: [&str; 2] = ["L5_S1_Flex_Ext", "lumbar_extension"];

/// That of Pose2Sim's settings: a radian counts as much as a marker that is 32 cm away.
const HELD_WEIGHT: f64 = 0.1;

/// The settings; `coordinates` are the model's, if they are known: OpenSim refuses to hold one that a model lacks.
pub(super) fn to_xml(weights: &MarkerWeights, coordinates: Option<&[String]>, [from, to]: [f64; 2]) -> String {
    let mut tasks = String::new();
    for (name, weight) in weights.names.iter().zip(weights.constant()) {
        let _ = writeln!(
            tasks,
            "\t\t\t\t<IKMarkerTask name=\"{name}\"><apply>true</apply><weight>{weight}</weight></IKMarkerTask>"
        );
    }
    let may_have = |name: &&str| coordinates.is_none_or(|own| own.iter().any(|own| own == name));
    for name in HELD.iter().filter(|name| may_have(name)) {
        let is_there = coordinates.is_some();
        let _ = writeln!(
            tasks,
            "\t\t\t\t<IKCoordinateTask name=\"{name}\"><apply>{is_there}</apply><weight>{HELD_WEIGHT}</weight>\
             <value_type>default_value</value_type></IKCoordinateTask>"
        );
    }
    include_str!("ik.xml")
        .replace("{{scaled}}", SCALED)
        .replace("{{range}}", &format!("{from} {to}"))
        .replace("{{tasks}}\n", &tasks)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tasks of coordinates for a model with these, or for one that is not known.
    fn held(coordinates: Option<&[&str]>) -> Vec<String> {
        let weights = MarkerWeights::of(&["RHip"], vec![vec![1e4]]);
        let own: Option<Vec<String>> = coordinates.map(|own| own.iter().map(|name| (*name).to_owned()).collect());
        let xml = to_xml(&weights, own.as_deref(), [0.0, 1.0]);
        assert!(xml.contains("<IKMarkerTask name=\"RHip\">") && !xml.contains("{{"), "{xml}");
        xml.lines().map(str::trim).filter(|line| line.starts_with("<IKCoordinateTask")).map(String::from).collect()
    }

    /// The coordinate of Pose2Sim's models with the weight of its own settings (`IK_Setup_Pose2Sim_Body25b.xml`, 0.10.49).
    #[test]
    fn flexion_of_the_lumbar_joint_is_held_where_a_model_has_it() {
        let task = |name: &str, apply: bool| {
            format!(
                "<IKCoordinateTask name=\"{name}\"><apply>{apply}</apply><weight>0.1</weight>\
                 <value_type>default_value</value_type></IKCoordinateTask>"
            )
        };
        let own = ["pelvis_tilt", "L5_S1_Flex_Ext", "L5_S1_Lat_Bending"];
        assert_eq!(held(Some(&own)), [task("L5_S1_Flex_Ext", true)]);
        assert_eq!(held(Some(&["lumbar_extension", "lumbar_bending"])), [task("lumbar_extension", true)]);
        // OpenSim fails on a task that applies to a coordinate that is not there.
        assert!(held(Some(&["pelvis_tilt"])).is_empty());
        assert_eq!(held(None), [task("L5_S1_Flex_Ext", false), task("lumbar_extension", false)]);
    }
}
