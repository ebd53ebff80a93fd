//! Lines between points of a body, by their names.

use crate::inspect::stick_figure::BONES;

/// Feet and face, which a small figure does without.
const FINE: [(&str, &str); 12] = [
    ("LAnkle", "LHeel"),
    ("LHeel", "LBigToe"),
    ("LAnkle", "LBigToe"),
    ("LBigToe", "LSmallToe"),
    ("RAnkle", "RHeel"),
    ("RHeel", "RBigToe"),
    ("RAnkle", "RBigToe"),
    ("RBigToe", "RSmallToe"),
    ("Nose", "LEye"),
    ("LEye", "LEar"),
    ("Nose", "REye"),
    ("REye", "REar"),
];

/// Pairs of points that a line joins; a body with other names has none.
pub(super) fn bones(points: &[String]) -> Vec<[usize; 2]> {
    let find = |name: &str| points.iter().position(|point| point == name);
    let all = BONES.iter().map(|(from, to, _)| (*from, *to)).chain(FINE);
    all.filter_map(|(from, to)| Some([find(from)?, find(to)?])).collect()
}
