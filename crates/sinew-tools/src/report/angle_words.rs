//! Names of rotations (`l_shin.rx`) in words of anatomy.

/// What a rotation is called.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct AngleWords {
    /// Both sides of a joint about one axis have one group.
    pub(super) group: String,
    /// `left`, `right` or `middle`.
    pub(super) side: &'static str,
    /// The smaller, the earlier its group is shown.
    pub(super) rank: usize,
}

/// Links of the standard bodies by the joint that turns them, in the order in which they are shown.
const JOINTS: [(&str, &str); 10] = [
    ("shin", "knee"),
    ("thigh", "hip"),
    ("foot", "ankle"),
    ("forearm", "elbow"),
    ("upper_arm", "shoulder"),
    ("spine", "trunk"),
    ("torso", "trunk"),
    ("head", "neck"),
    ("girdle", "shoulder girdle"),
    ("pelvis", "pelvis"),
];

/// Axes in the order in which they are shown.
const AXES: [(&str, &str); 3] = [("rx", "forward and back"), ("ry", "sideways"), ("rz", "twist")];

/// The words for a rotation; others than of the standard bodies keep their names.
pub(super) fn angle_words(name: &str) -> AngleWords {
    let (link, axis) = name.split_once('.').unwrap_or((name, ""));
    let (side, bare) = match link.split_once('_') {
        Some(("l" | "left", bare)) => ("left", bare),
        Some(("r" | "right", bare)) => ("right", bare),
        _ => ("middle", link),
    };
    let place = |list: &[(&str, &str)], wanted: &str| list.iter().position(|(known, _)| *known == wanted);
    match (place(&JOINTS, bare), place(&AXES, axis)) {
        (Some(joint), Some(axis)) => AngleWords {
            group: format!("{}, {}", JOINTS[joint].1, AXES[axis].1),
            side,
            rank: axis.min(1) * JOINTS.len() * AXES.len() + joint * AXES.len() + axis,
        },
        _ => AngleWords { group: format!("{bare}.{axis}"), side, rank: usize::from(u16::MAX) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_share_a_group_and_knees_come_first() {
        let [left, right] = ["l_shin.rx", "r_shin.rx"].map(angle_words);
        assert_eq!((left.side, right.side), ("left", "right"));
        assert_eq!(
            (&left.group, left.group == right.group, left.rank),
            (&"knee, forward and back".to_owned(), true, 0)
        );
        assert!(angle_words("l_thigh.rx").rank < angle_words("l_thigh.ry").rank);
        assert_eq!(angle_words("tail.rq").group, "tail.rq");
        assert_eq!(angle_words("plain").side, "middle");
    }
}
