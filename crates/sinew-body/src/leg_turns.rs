//! Turns of legs about themselves, which only feet show while legs are straight.
//!
//! Without feet nothing shows then which way a knee bends, either.

use crate::tree::KinematicTree;

/// Links that turn with feet.
const FEET: [&str; 2] = ["r_foot", "l_foot"];
/// Links whose first coordinate turns a leg about itself.
const THIGHS: [&str; 2] = ["r_thigh", "l_thigh"];

/// Whether a point beyond an ankle is among those shown, by name.
#[must_use]
pub fn shows_feet(tree: &KinematicTree, is_shown: impl Fn(&str) -> bool) -> bool {
    let is_beyond = |link: usize, offset: [f64; 3]| {
        offset != [0.0; 3] && tree.links().get(link).is_some_and(|link| FEET.contains(&link.name.as_str()))
    };
    tree.points().iter().any(|point| is_beyond(point.link, point.offset) && is_shown(&point.name))
}

/// Coordinates that turn legs about themselves, each with the two other coordinates of its thigh.
#[must_use]
pub fn leg_turns(tree: &KinematicTree) -> Vec<[usize; 3]> {
    let thighs = THIGHS.iter().filter_map(|name| tree.link_index(name));
    thighs
        .filter(|link| tree.links()[*link].joints.len() == 3)
        .map(|link| [0, 1, 2].map(|k| tree.first_dof(link) + k))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Proportions;
    use crate::standard::{cf28, h32};

    #[test]
    fn toes_and_heels_show_feet_and_ankles_do_not() {
        for tree in [h32(&Proportions::default()), cf28(&Proportions::default())] {
            assert!(!shows_feet(&tree, |name| ["LAnkle", "RAnkle", "LKnee"].contains(&name)));
            assert_eq!(shows_feet(&tree, |name| name == "LHeel"), tree.point_index("LHeel").is_some());
        }
    }

    #[test]
    fn legs_turn_about_themselves_by_the_first_coordinate_of_the_thigh() {
        let tree = h32(&Proportions::default());
        let names = tree.dof_names();
        let turns: Vec<[&str; 3]> = leg_turns(&tree).iter().map(|turn| turn.map(|dof| names[dof].as_str())).collect();
        assert_eq!(turns, [["r_thigh.rz", "r_thigh.ry", "r_thigh.rx"], ["l_thigh.rz", "l_thigh.ry", "l_thigh.rx"]]);
    }
}
