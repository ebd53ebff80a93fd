//! Keypoint layouts: which point of the body each index of a detector's list means.
//!
//! Points have the names of the marker files that movement science programs exchange: `Nose`, `LShoulder`, `RBigToe`, …
//! A point that has no counterpart among them (faces, fingers) has no name. Two necks are distinguished: `Neck` is the
//! upper neck (BODY_25B, HALPE_26), `MidShoulder` the middle of the shoulders (BODY_25).
//!
//! Sources: OpenPose (BODY_25, BODY_25B), AlphaPose (HALPE_26; HALPE_136 with face and hands), COCO (COCO_17),
//! COCO-WholeBody (COCO_133: body, feet, 68 face and 2 × 21 hand points) and MediaPipe Pose (MEDIAPIPE_33, whose foot index is
//! taken for the big toe).
//!
//! ```
//! use sinew_formats::layout;
//! let layout = layout::find("body-25b")?;
//! assert_eq!(layout.points[17].as_deref(), Some("Neck"));
//! assert_eq!(layout.index("RAnkle"), Some(16));
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::nearest::nearest;
use crate::toml_text::{Document, quoted};
use crate::{Error, Place};
use std::collections::BTreeSet;

/// Meaning of the indices of a keypoint list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Name.
    pub name: String,
    /// Name of the point at each index; `None` is a point that bodies do not have.
    pub points: Vec<Option<String>>,
}

impl Layout {
    /// Length of a flat list of x, y, confidence.
    #[must_use]
    pub fn numbers(&self) -> usize {
        3 * self.points.len()
    }

    /// Index of the point of that name.
    #[must_use]
    pub fn index(&self, point: &str) -> Option<usize> {
        self.points.iter().position(|name| name.as_deref() == Some(point))
    }

    /// Indices of points that are mirror images of each other, (left, right).
    #[must_use]
    pub fn left_right_pairs(&self) -> Vec<(usize, usize)> {
        let right_of = |left: &str| left.strip_prefix('L').and_then(|rest| self.index(&format!("R{rest}")));
        let named = self.points.iter().enumerate().filter_map(|(i, name)| Some((i, name.as_deref()?)));
        named.filter_map(|(i, name)| Some((i, right_of(name)?))).collect()
    }
}

const FACE: [&str; 5] = ["Nose", "LEye", "REye", "LEar", "REar"];

const LIMBS: [&str; 12] = [
    "LShoulder",
    "RShoulder",
    "LElbow",
    "RElbow",
    "LWrist",
    "RWrist",
    "LHip",
    "RHip",
    "LKnee",
    "RKnee",
    "LAnkle",
    "RAnkle",
];

const FEET: [&str; 6] = ["LBigToe", "LSmallToe", "LHeel", "RBigToe", "RSmallToe", "RHeel"];

const FEET_IN_PAIRS: [&str; 6] = ["LBigToe", "RBigToe", "LSmallToe", "RSmallToe", "LHeel", "RHeel"];

const BODY_25_TRUNK: [&str; 19] = [
    "Nose",
    "MidShoulder",
    "RShoulder",
    "RElbow",
    "RWrist",
    "LShoulder",
    "LElbow",
    "LWrist",
    "MidHip",
    "RHip",
    "RKnee",
    "RAnkle",
    "LHip",
    "LKnee",
    "LAnkle",
    "REye",
    "LEye",
    "REar",
    "LEar",
];

/// Empty names are corners of eyes and mouth, and fingers.
const MEDIAPIPE: [&str; 33] = [
    "Nose",
    "",
    "LEye",
    "",
    "",
    "REye",
    "",
    "LEar",
    "REar",
    "",
    "",
    "LShoulder",
    "RShoulder",
    "LElbow",
    "RElbow",
    "LWrist",
    "RWrist",
    "",
    "",
    "",
    "",
    "",
    "",
    "LHip",
    "RHip",
    "LKnee",
    "RKnee",
    "LAnkle",
    "RAnkle",
    "LHeel",
    "RHeel",
    "LBigToe",
    "RBigToe",
];

type Table = (&'static str, &'static [&'static [&'static str]], usize);

/// Name, points in order, empty where they have no name, and number of unnamed points after them.
const TABLES: [Table; 7] = [
    ("BODY_25B", &[&FACE, &LIMBS, &["Neck", "Head"], &FEET], 0),
    ("BODY_25", &[&BODY_25_TRUNK, &FEET], 0),
    ("HALPE_26", &[&FACE, &LIMBS, &["Head", "Neck", "MidHip"], &FEET_IN_PAIRS], 0),
    ("COCO_17", &[&FACE, &LIMBS], 0),
    ("COCO_133", &[&FACE, &LIMBS, &FEET], 68 + 2 * 21),
    ("HALPE_136", &[&FACE, &LIMBS, &["Head", "Neck", "MidHip"], &FEET_IN_PAIRS], 68 + 2 * 21),
    ("MEDIAPIPE_33", &[&MEDIAPIPE], 0),
];

/// Names of the known layouts.
#[must_use]
pub fn names() -> Vec<&'static str> {
    TABLES.iter().map(|(name, ..)| *name).collect()
}

fn layout((name, named, unnamed): &Table) -> Layout {
    let name_or_none = |point: &&str| (!point.is_empty()).then(|| (*point).to_owned());
    let named = named.iter().flat_map(|part| part.iter()).map(name_or_none);
    Layout { name: (*name).to_owned(), points: named.chain((0..*unnamed).map(|_| None)).collect() }
}

/// The layout of that name; letter case, `_` and `-` do not matter.
///
/// # Errors
/// [`Error::UnknownLayout`] lists the known ones.
pub fn find(name: &str) -> Result<Layout, Error> {
    let folded = |name: &str| name.replace(['_', '-', ' '], "").to_lowercase();
    let wanted = folded(name);
    TABLES.iter().find(|(known, ..)| folded(known) == wanted).map(layout).ok_or_else(|| Error::UnknownLayout {
        name: name.into(),
        known: names().into_iter().map(Into::into).collect(),
        nearest: nearest(name, names()).map(Into::into),
    })
}

/// The layouts whose lists have that many numbers: 75 fits two, other lengths one or none.
#[must_use]
pub fn with_numbers(numbers: usize) -> Vec<Layout> {
    TABLES.iter().map(layout).filter(|layout| layout.numbers() == numbers).collect()
}

/// Reads a mapping file: TOML with `points = ["Nose", "LEye", …]`, one name per keypoint and `""` for one without, and
/// an optional `name`.
///
/// # Errors
/// TOML that is malformed, keys other than these, names that are used twice.
pub fn read(name: &str, text: &str) -> Result<Layout, Error> {
    let document = Document::parse(name, text)?;
    let root = document.root();
    root.allow(&["name", "points"])?;
    let points: Vec<String> = root.strings("points")?;
    let mut seen = BTreeSet::new();
    if let Some(twice) = points.iter().find(|point| !point.is_empty() && !seen.insert(point.as_str())) {
        return Err(Place::file(name).twice("point", twice.clone()));
    }
    let title = root.optional_string("name")?.unwrap_or_else(|| name.to_owned());
    Ok(Layout { name: title, points: points.into_iter().map(|point| (!point.is_empty()).then_some(point)).collect() })
}

/// Writes a mapping file that [`read`] reads.
#[must_use]
pub fn write(layout: &Layout) -> String {
    let points: Vec<String> = layout.points.iter().map(|point| quoted(point.as_deref().unwrap_or_default())).collect();
    format!("name = {}\npoints = [{}]\n", quoted(&layout.name), points.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(name: &str, length: usize, expected: &[(usize, &str)]) {
        let layout = find(name).unwrap();
        assert_eq!(layout.points.len(), length, "{name}");
        for &(index, point) in expected {
            assert_eq!(layout.index(point), Some(index), "{name} {point}");
        }
    }

    #[test]
    fn tables_say_what_their_sources_say() {
        check(
            "BODY_25B",
            25,
            &[(0, "Nose"), (6, "RShoulder"), (16, "RAnkle"), (17, "Neck"), (18, "Head"), (24, "RHeel")],
        );
        check("BODY_25", 25, &[(1, "MidShoulder"), (4, "RWrist"), (8, "MidHip"), (18, "LEar"), (19, "LBigToe")]);
        check("HALPE_26", 26, &[(17, "Head"), (18, "Neck"), (19, "MidHip"), (21, "RBigToe"), (25, "RHeel")]);
        check("COCO_17", 17, &[(5, "LShoulder"), (16, "RAnkle")]);
        check("COCO_133", 133, &[(17, "LBigToe"), (22, "RHeel")]);
        assert!(find("COCO_133").unwrap().points[23..].iter().all(Option::is_none));
        check("HALPE_136", 136, &[(17, "Head"), (25, "RHeel")]);
        check("MEDIAPIPE_33", 33, &[(5, "REye"), (12, "RShoulder"), (23, "LHip"), (29, "LHeel"), (32, "RBigToe")]);
        assert!(find("MEDIAPIPE_33").unwrap().points[17..23].iter().all(Option::is_none));
    }

    #[test]
    fn every_left_point_has_its_right_one() {
        for name in names() {
            let pairs = [("COCO_17", 8), ("MEDIAPIPE_33", 10)].into_iter().find(|(own, _)| *own == name);
            assert_eq!(find(name).unwrap().left_right_pairs().len(), pairs.map_or(11, |(_, pairs)| pairs), "{name}");
        }
    }

    #[test]
    fn lengths_are_distinguished_where_they_can_be() {
        let fitting = |numbers| with_numbers(numbers).into_iter().map(|layout| layout.name).collect::<Vec<_>>();
        assert_eq!(fitting(75), ["BODY_25B", "BODY_25"]);
        assert_eq!(fitting(78), ["HALPE_26"]);
        assert_eq!(fitting(51), ["COCO_17"]);
        assert_eq!(fitting(399), ["COCO_133"]);
        assert!(fitting(52).is_empty());
    }

    #[test]
    fn a_mapping_file_reads_back() {
        let layout = Layout { name: "mine".into(), points: vec![Some("Nose".into()), None, Some("LHip".into())] };
        assert_eq!(read("mine.toml", &write(&layout)).unwrap(), layout);
        assert!(read("mine.toml", "points = [\"Nose\", \"Nose\"]").is_err());
    }
}
