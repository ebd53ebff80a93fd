//! Stick figures: lines between the joints of a pose, left in blue, right in red.

use sinew_body::points::Trajectories;
use sinew_formats::svg::Svg;

pub(super) const LEFT: &str = "#0b6e99";
pub(super) const RIGHT: &str = "#c2410c";
pub(super) const MIDDLE: &str = "#334155";

/// Lines of a figure.
pub(crate) const BONES: [(&str, &str, &str); 14] = [
    ("MidHip", "Neck", MIDDLE),
    ("Neck", "Head", MIDDLE),
    ("Neck", "LShoulder", LEFT),
    ("LShoulder", "LElbow", LEFT),
    ("LElbow", "LWrist", LEFT),
    ("Neck", "RShoulder", RIGHT),
    ("RShoulder", "RElbow", RIGHT),
    ("RElbow", "RWrist", RIGHT),
    ("MidHip", "LHip", LEFT),
    ("LHip", "LKnee", LEFT),
    ("LKnee", "LAnkle", LEFT),
    ("MidHip", "RHip", RIGHT),
    ("RHip", "RKnee", RIGHT),
    ("RKnee", "RAnkle", RIGHT),
];

/// An axis of the world and the sign with which it runs to the right of the picture.
pub(super) type View = (usize, f64);

/// The person faces the reader.
pub(super) const FROM_THE_FRONT: View = (0, -1.0);
/// The person faces to the right.
pub(super) const FROM_THE_RIGHT: View = (1, 1.0);

/// Pixels a metre from which on lines have their full thickness.
const FULL_SCALE: f64 = 40.0;

/// Draws a figure with the middle of its hips at a place, at `scale` pixels a metre.
pub(super) fn figure(
    svg: &mut Svg,
    motion: &Trajectories,
    frame: &[[f64; 3]],
    (axis, sign): View,
    scale: f64,
    centre: [f64; 2],
) {
    let Some(hip) = motion.index("MidHip") else { return };
    let thickness = (scale / FULL_SCALE).min(1.0);
    let place = |point: usize| {
        let from_hip = |k: usize| frame[point][k] - frame[hip][k];
        [centre[0] + scale * sign * from_hip(axis), centre[1] - scale * from_hip(2)]
    };
    for (from, to, color) in BONES {
        if let (Some(from), Some(to)) = (motion.index(from), motion.index(to)) {
            svg.line(place(from), place(to), 2.0 * thickness, color);
        }
    }
    if let Some(head) = motion.index("Head") {
        svg.circle(place(head), 3.0 * thickness, MIDDLE);
    }
}
