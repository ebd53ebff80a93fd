//! Ranges of motion of adults, by coordinate of a body.
//!
//! Degrees from the zero pose of the [standard bodies](crate::standard), for joints whose coordinates are anatomical angles:
//!
//! | coordinate | range | source |
//! |---|---|---|
//! | knee: flexion, extension | 141.9, 1.6 | S |
//! | elbow: flexion, extension | 150.0, 4.7 | S |
//! | thigh: turn | 90 to each side | twice the 45 of A: the coordinate is the rotation of the hip only where the thigh hangs |
//! | ankle: plantarflexion, dorsiflexion | 62.1, 20 | S, A (S has 13.8 without weight on the foot) |
//! | foot: inversion, eversion | 35, 15 | A |
//! | head: turn, bend to the side | 60, 45 to each side | A |
//! | trunk: turn, bend to the side | 45, 35 to each side | A |
//! | girdle: turn | 45 to each side | as the trunk, whose turn is measured at the shoulders |
//!
//! S: Soucie, Wang, Forsyth, Funk, Denny, Roach & Boone (2011), Range of motion measurements: reference values and a database for comparison studies, Haemophilia 17, 500–507; means of women of 20 to 44
//! years, who move farther than men. A: American Academy of Orthopaedic Surgeons (1965), Joint Motion: Method of Measuring and Recording.
//!
//! Other coordinates of hips, and shoulders, have none: they turn in another order than the angles that were measured, and each range depends on the other two. Nor has the nod of the head, for which a face has no zero.

use crate::tree::KinematicTree;

/// Link and axis of a coordinate on the right or in the middle, and its range, degrees.
const RANGES: [(&str, [f64; 2]); 11] = [
    ("r_thigh.rz", [-90.0, 90.0]),
    ("r_shin.rx", [-141.9, 1.6]),
    ("r_forearm.rx", [-4.7, 150.0]),
    ("r_foot.rx", [-62.1, 20.0]),
    ("r_foot.ry", [-15.0, 35.0]),
    ("head.rz", [-60.0, 60.0]),
    ("head.ry", [-45.0, 45.0]),
    ("spine.rz", [-45.0, 45.0]),
    ("spine.ry", [-35.0, 35.0]),
    ("girdle.rz", [-45.0, 45.0]),
    ("pelvis.rz", [-45.0, 45.0]),
];

/// Bends of limbs, which turn round where they are straight, and turns about the common axis of trunk and head, of which only sums are seen.
const UNDECIDED: [&str; 5] = ["shin.rx", "forearm.rx", "spine.rz", "girdle.rz", "head.rz"];

/// The ranges of what keypoints may leave undecided: bends of knees and elbows, and turns of trunk, girdle and head about their common axis.
#[must_use]
pub fn undecided_ranges(body: &KinematicTree) -> Vec<Option<[f64; 2]>> {
    let is_undecided = |name: &String| UNDECIDED.iter().any(|end| name.ends_with(end));
    motion_ranges(body)
        .into_iter()
        .zip(body.dof_names())
        .map(|(range, name)| range.filter(|_| is_undecided(&name)))
        .collect()
}

/// Ranges of the coordinates of a body, radians; `None` for those without, and for all of the root.
#[must_use]
pub fn motion_ranges(body: &KinematicTree) -> Vec<Option<[f64; 2]>> {
    let roots = body.links().iter().take_while(|link| link.parent.is_none()).map(|link| link.joints.len()).sum();
    let range = |(dof, name): (usize, String)| {
        let is_left = name.starts_with("l_");
        let right = if is_left { format!("r{}", &name[1..]) } else { name };
        let (_, range) = RANGES.iter().find(|(known, _)| dof >= roots && *known == right)?;
        let [low, high] = range.map(f64::to_radians);
        // Turns about the forward and the up axis are mirrored.
        let is_mirrored = is_left && !right.ends_with('x');
        Some(if is_mirrored { [-high, -low] } else { [low, high] })
    };
    body.dof_names().into_iter().enumerate().map(range).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{cf28, h32};
    use crate::{Plan, Proportions, point_positions};
    use sinew_core::lanes::Isa;

    fn degrees(body: &KinematicTree, name: &str) -> Option<[f64; 2]> {
        let place = body.dof_names().iter().position(|known| known == name).unwrap();
        motion_ranges(body)[place].map(|range| range.map(|x| (x.to_degrees() * 10.0).round() / 10.0))
    }

    #[test]
    fn ranges_belong_to_coordinates_and_are_mirrored() {
        let body = h32(&Proportions::default());
        assert_eq!(degrees(&body, "l_shin.rx"), Some([-141.9, 1.6]));
        assert_eq!(degrees(&body, "r_foot.ry"), Some([-15.0, 35.0]));
        assert_eq!(degrees(&body, "l_foot.ry"), Some([-35.0, 15.0]));
        for free in ["pelvis.rz", "pelvis.tx", "l_thigh.rx", "r_upper_arm.rz", "head.rx"] {
            assert_eq!(degrees(&body, free), None, "{free}");
        }
        assert_eq!(degrees(&cf28(&Proportions::default()), "pelvis.rz"), Some([-45.0, 45.0]));
    }

    #[test]
    fn bends_of_limbs_and_turns_of_the_trunk_may_be_undecided() {
        let body = h32(&Proportions::default());
        let all = body.dof_names().into_iter().zip(undecided_ranges(&body));
        let mut names: Vec<String> = all.filter_map(|(name, range)| range.map(|_| name)).collect();
        names.sort_unstable();
        let expected = ["girdle.rz", "head.rz", "l_forearm.rx", "l_shin.rx", "r_forearm.rx", "r_shin.rx", "spine.rz"];
        assert_eq!(names, expected);
    }

    /// The larger end of each range is where the joint goes: heels to the buttocks, hands to the shoulders, toes down, soles inwards.
    #[test]
    fn joints_bend_the_way_that_the_ranges_say() {
        let sizes = Proportions::default();
        let body = h32(&sizes);
        let place = |name: &str, coordinate: &str, degrees: f64| {
            let mut q = vec![0.0; body.dof()];
            let dof = body.dof_names().iter().position(|known| known == coordinate).unwrap();
            q[dof] = degrees.to_radians();
            let plan = Plan::with_all_points(&body);
            let mut points = vec![0.0; 3 * plan.points()];
            point_positions(&plan, Isa::baseline(), &q, &mut points);
            let k = body.point_index(name).unwrap();
            [points[3 * k], points[3 * k + 1], points[3 * k + 2]]
        };
        let moved = |name: &str, coordinate: &str, degrees: f64, axis: usize| {
            place(name, coordinate, degrees)[axis] - place(name, coordinate, 0.0)[axis]
        };
        assert!(moved("RAnkle", "r_shin.rx", -90.0, 1) < -0.3);
        assert!(moved("RWrist", "r_forearm.rx", 90.0, 1) > 0.2);
        assert!(moved("RBigToe", "r_foot.rx", -40.0, 2) < -0.05);
        // Inversion lifts the inner edge of the foot, on which the big toe is.
        let lifted = |side: &str, degrees: f64| {
            let coordinate = format!("{}_foot.ry", side.to_lowercase());
            moved(&format!("{side}BigToe"), &coordinate, degrees, 2)
                - moved(&format!("{side}SmallToe"), &coordinate, degrees, 2)
        };
        assert!(lifted("R", 30.0) > 0.0 && lifted("L", -30.0) > 0.0);
    }
}
