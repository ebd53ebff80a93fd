//! The sizes of a subject one by one, as numbers that can be estimated.

use crate::standard::Proportions;

/// A size: its name, whether it is a length (else a coordinate of an offset), and its place.
pub type Size = (&'static str, bool, fn(&mut Proportions) -> &mut f64);

/// Everything that [`crate::bundle::refine`] may change. Points in the plane of symmetry have no x.
pub const SIZES: [Size; 28] = [
    ("spine", true, |p| &mut p.spine),
    ("shoulder_height", true, |p| &mut p.shoulder_height),
    ("shoulder_half_width", true, |p| &mut p.shoulder_half_width),
    ("hip_half_width", true, |p| &mut p.hip_half_width),
    ("pelvis_drop", true, |p| &mut p.pelvis_drop),
    ("upper_arm", true, |p| &mut p.upper_arm),
    ("forearm", true, |p| &mut p.forearm),
    ("thigh", true, |p| &mut p.thigh),
    ("shin", true, |p| &mut p.shin),
    ("head_top.y", false, |p| &mut p.head_top[1]),
    ("head_top.z", false, |p| &mut p.head_top[2]),
    ("nose.y", false, |p| &mut p.nose[1]),
    ("nose.z", false, |p| &mut p.nose[2]),
    ("eye.x", false, |p| &mut p.eye[0]),
    ("eye.y", false, |p| &mut p.eye[1]),
    ("eye.z", false, |p| &mut p.eye[2]),
    ("ear.x", false, |p| &mut p.ear[0]),
    ("ear.y", false, |p| &mut p.ear[1]),
    ("ear.z", false, |p| &mut p.ear[2]),
    ("heel.x", false, |p| &mut p.heel[0]),
    ("heel.y", false, |p| &mut p.heel[1]),
    ("heel.z", false, |p| &mut p.heel[2]),
    ("big_toe.x", false, |p| &mut p.big_toe[0]),
    ("big_toe.y", false, |p| &mut p.big_toe[1]),
    ("big_toe.z", false, |p| &mut p.big_toe[2]),
    ("small_toe.x", false, |p| &mut p.small_toe[0]),
    ("small_toe.y", false, |p| &mut p.small_toe[1]),
    ("small_toe.z", false, |p| &mut p.small_toe[2]),
];

/// All sizes times a factor.
#[must_use]
pub fn scaled(proportions: &Proportions, factor: f64) -> Proportions {
    let mut p = *proportions;
    for (_, _, size) in SIZES {
        *size(&mut p) *= factor;
    }
    p
}
