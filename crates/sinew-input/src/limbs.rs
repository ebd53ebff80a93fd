//! Segments by whose lengths a person is known again.

use sinew_formats::Layout;

/// Ends of the segments, left and right in turn.
pub const LIMBS: [[&str; 2]; 10] = [
    ["LHip", "LKnee"],
    ["RHip", "RKnee"],
    ["LKnee", "LAnkle"],
    ["RKnee", "RAnkle"],
    ["LShoulder", "LElbow"],
    ["RShoulder", "RElbow"],
    ["LElbow", "LWrist"],
    ["RElbow", "RWrist"],
    ["LShoulder", "LHip"],
    ["RShoulder", "RHip"],
];

/// The same by length: left and right, which are alike, together.
#[must_use]
pub fn paired_limbs(layout: &Layout) -> Vec<Vec<(usize, usize)>> {
    let ends = |[a, b]: &[&str; 2]| Some((layout.index(a)?, layout.index(b)?));
    LIMBS.chunks(2).map(|sides| sides.iter().filter_map(ends).collect()).collect()
}

/// Keypoints at the ends of the segments that a layout has both ends of.
#[must_use]
pub fn limbs(layout: &Layout) -> Vec<(usize, usize)> {
    LIMBS.iter().filter_map(|[a, b]| Some((layout.index(a)?, layout.index(b)?))).collect()
}
