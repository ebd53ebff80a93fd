//! Points of a C3D file that are no positions: angles, forces and other results of models.
//!
//! Programs that compute joint angles store them as points and list their names in the parameters ANGLES, FORCES,
//! MOMENTS, POWERS and SCALARS of the group POINT, with units of their own.

use super::parameters::{C3dGroup, texts};
use std::collections::BTreeSet;

const LISTS: [&str; 5] = ["ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"];

/// Whether each of the points is a position.
pub(super) fn are_positions(groups: &[C3dGroup], markers: &[String]) -> Vec<bool> {
    let others: BTreeSet<&str> = LISTS.iter().flat_map(|list| texts(groups, "POINT", list)).collect();
    markers.iter().map(|marker| !others.contains(marker.as_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::super::parameters::{C3dParameter, C3dValues};
    use super::*;

    #[test]
    fn listed_angles_and_forces_are_no_positions() {
        let list = |name: &str, names: &[&str]| C3dParameter {
            name: name.into(),
            description: String::new(),
            dimensions: vec![],
            values: C3dValues::Texts(names.iter().map(|&name| name.into()).collect()),
        };
        let parameters = vec![list("ANGLES", &["LKneeAngles", ""]), list("FORCES2", &["b"]), list("FORCES", &["a"])];
        let groups = [C3dGroup { name: "POINT".into(), parameters, ..C3dGroup::default() }];
        let markers = ["LKNE", "LKneeAngles", "a", "b"].map(String::from);
        assert_eq!(are_positions(&groups, &markers), [true, false, false, false]);
    }
}
