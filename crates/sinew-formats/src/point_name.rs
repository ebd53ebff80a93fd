//! Names that people give to points of the body, in the names of our [layouts](crate::layout).
//! Also what files of points demand of names.
//!
//! Letter case and separators do not count; the side stands before or after the part: `left_shoulder`, `LShoulder`,
//! `Shoulder.L`, `shoulder left`. A name that means no point of a layout has none.

/// Parts that come in pairs: what people call them, and our name.
const PAIRED: [(&str, &str); 18] = [
    ("shoulder", "Shoulder"),
    ("elbow", "Elbow"),
    ("wrist", "Wrist"),
    ("hip", "Hip"),
    ("knee", "Knee"),
    ("ankle", "Ankle"),
    ("eye", "Eye"),
    ("ear", "Ear"),
    ("heel", "Heel"),
    ("bigtoe", "BigToe"),
    ("toe", "BigToe"),
    ("toes", "BigToe"),
    ("footindex", "BigToe"),
    ("foottip", "BigToe"),
    ("hallux", "BigToe"),
    ("smalltoe", "SmallToe"),
    ("littletoe", "SmallToe"),
    ("pinkytoe", "SmallToe"),
];

/// Parts in the middle.
const SINGLE: [(&str, &str); 13] = [
    ("nose", "Nose"),
    ("neck", "Neck"),
    ("head", "Head"),
    ("headtop", "Head"),
    ("tophead", "Head"),
    ("topofhead", "Head"),
    ("midhip", "MidHip"),
    ("pelvis", "MidHip"),
    ("hipcenter", "MidHip"),
    ("hipcentre", "MidHip"),
    ("root", "MidHip"),
    ("midshoulder", "MidShoulder"),
    ("thorax", "MidShoulder"),
];

/// Sides as they are written, the longer first.
const SIDES: [(&str, &str); 4] = [("left", "L"), ("right", "R"), ("l", "L"), ("r", "R")];

/// The name in our layouts; `None` for a name that means no point of them.
#[must_use]
pub fn known_point(name: &str) -> Option<String> {
    let folded: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    if let Some((_, point)) = SINGLE.iter().find(|(own, _)| *own == folded) {
        return Some((*point).to_owned());
    }
    SIDES.iter().find_map(|(written, side)| {
        let sides = [folded.strip_prefix(written), folded.strip_suffix(written)];
        let part = |rest: &str| PAIRED.iter().find(|(own, _)| *own == rest).map(|(_, point)| format!("{side}{point}"));
        sides.into_iter().flatten().find_map(part)
    })
}

/// Whether a name comes back from a file of points as it was: not empty, no blanks at its ends, no control characters.
pub(crate) fn is_writable(name: &str) -> bool {
    !name.is_empty() && name.trim() == name && !name.chars().any(char::is_control)
}

/// Names that are there again, each as often as it is.
pub(crate) fn repeated(names: &[String]) -> impl Iterator<Item = String> {
    let mut sorted = names.to_vec();
    sorted.sort_unstable();
    let repeated: Vec<String> =
        sorted.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0].clone()).collect();
    repeated.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_parts_are_found_however_they_are_written() {
        for (name, point) in [
            ("left_shoulder", Some("LShoulder")),
            ("RShoulder", Some("RShoulder")),
            ("Knee.L", Some("LKnee")),
            ("right foot index", Some("RBigToe")),
            ("nose", Some("Nose")),
            ("Top of Head", Some("Head")),
            ("l_ear", Some("LEar")),
            ("ear_r", Some("REar")),
            ("heel", None),
            ("tailbase", None),
            ("shoulder1", None),
            ("", None),
        ] {
            assert_eq!(known_point(name).as_deref(), point, "{name}");
        }
    }
}
