//! Settings of OpenSim's inverse kinematics: a weight for each marker.

use super::scale_setup::SCALED;
use super::weights::MarkerWeights;
use std::fmt::Write as _;

/// The settings.
pub(super) fn to_xml(weights: &MarkerWeights, [from, to]: [f64; 2]) -> String {
    let mut tasks = String::new();
    for (name, weight) in weights.names.iter().zip(weights.constant()) {
        let _ = writeln!(
            tasks,
            "\t\t\t\t<IKMarkerTask name=\"{name}\"><apply>true</apply><weight>{weight}</weight></IKMarkerTask>"
        );
    }
    include_str!("ik.xml")
        .replace("{{scaled}}", SCALED)
        .replace("{{range}}", &format!("{from} {to}"))
        .replace("{{tasks}}\n", &tasks)
}
