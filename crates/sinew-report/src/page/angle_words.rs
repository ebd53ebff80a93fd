//! Names of angles (`knee_angle_l`) in words of anatomy.

/// What an angle is called.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct AngleWords {
    /// Both sides of an angle have one group.
    pub(super) group: String,
    /// `left`, `right` or `middle`.
    pub(super) side: &'static str,
    /// The smaller, the earlier its group is shown.
    pub(super) rank: usize,
}

/// Angles without their side, in the order in which they are shown.
const WORDS: [(&str, &str); 33] = [
    ("knee_angle", "knee flexion"),
    ("hip_flexion", "hip flexion"),
    ("ankle_angle", "ankle dorsiflexion"),
    ("elbow_flex", "elbow flexion"),
    ("arm_flex", "shoulder flexion"),
    ("shoulder_elevation", "shoulder elevation"),
    ("shoulder_plane", "shoulder, plane of elevation"),
    ("lumbar_extension", "lumbar extension"),
    ("trunk_flexion", "trunk flexion"),
    ("head_rx", "head, forward and back"),
    ("neck_flexion", "neck flexion"),
    ("pelvis_tilt", "pelvis, tilt about the ground’s axis"),
    ("pelvic_tilt", "pelvic tilt"),
    ("hip_adduction", "hip adduction"),
    ("hip_rotation", "hip, internal rotation"),
    ("ankle_inversion", "ankle inversion"),
    ("foot_ry", "foot, sideways"),
    ("arm_add", "shoulder adduction"),
    ("arm_rot", "shoulder, internal rotation"),
    ("shoulder_rotation", "shoulder, axial rotation"),
    ("lumbar_bending", "lumbar bending"),
    ("lumbar_rotation", "lumbar rotation"),
    ("trunk_bending", "trunk bending"),
    ("trunk_rotation", "trunk rotation"),
    ("head_ry", "head, sideways"),
    ("head_rz", "head, twist"),
    ("neck_bending", "neck bending"),
    ("neck_rotation", "neck rotation"),
    ("girdle_rz", "shoulder girdle, twist"),
    ("pelvis_list", "pelvis, list about the ground’s axis"),
    ("pelvic_obliquity", "pelvic obliquity"),
    ("pelvis_rotation", "pelvis, rotation"),
    ("pelvic_rotation", "pelvic rotation"),
];

/// The words for an angle; others than of the standard bodies keep their names.
pub(super) fn angle_words(name: &str) -> AngleWords {
    let sides = [("_l", "l_", "left"), ("_r", "r_", "right")];
    let found = sides.into_iter().find_map(|(suffix, prefix, side)| {
        let bare = name.strip_suffix(suffix).or_else(|| name.strip_prefix(prefix))?;
        Some((bare, side))
    });
    let (bare, side) = found.unwrap_or((name, "middle"));
    match WORDS.iter().position(|(known, _)| *known == bare) {
        Some(rank) => AngleWords { group: WORDS[rank].1.to_owned(), side, rank },
        None => AngleWords { group: bare.to_owned(), side, rank: usize::from(u16::MAX) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::angles::{Convention, JointAngles};
    use sinew::body::{Proportions, standard};

    #[test]
    fn both_sides_share_a_group_and_knees_come_first() {
        let [left, right] = ["knee_angle_l", "knee_angle_r"].map(angle_words);
        assert_eq!((left.side, right.side), ("left", "right"));
        assert_eq!((&left.group, left.group == right.group, left.rank), (&"knee flexion".to_owned(), true, 0));
        assert_eq!(angle_words("l_foot_ry").group, angle_words("r_foot_ry").group);
        assert_eq!((angle_words("tail_rq").group.as_str(), angle_words("plain").side), ("tail_rq", "middle"));
    }

    #[test]
    fn every_angle_of_the_standard_body_has_words() {
        let body = standard::h32(&Proportions::default());
        for convention in [Convention::OpenSim, Convention::Isb] {
            for name in JointAngles::new(&body, &[], false, convention).names() {
                assert!(angle_words(name).rank < WORDS.len(), "{name}");
            }
        }
    }
}
