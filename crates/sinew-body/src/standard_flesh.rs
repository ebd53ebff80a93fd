//! The flesh of the standard bodies of real people, from the lengths of their segments.
//!
//! Hips, chest, head, arms to the fingers, legs and feet. Thicknesses are an adult's of 1.75 m, stretched with the subject's limbs; silhouettes of the subject refine them.

use crate::Error;
use crate::flesh::{DOWNWARDS, Flesh, Solid, UPWARDS};
use crate::frustum::Frustum;
use crate::standard::Proportions;
use crate::tree::KinematicTree;

/// Wrist to the tips of relaxed fingers, metres, in an adult of 1.75 m.
const HAND: f64 = 0.15;

/// The solids of a body with the links of H32 or CF28 (feet are left out where there are none), from its own lengths.
///
/// # Errors
/// [`Error::NoSolid`] where the tree has none of these links.
pub fn standard_flesh(tree: &KinematicTree) -> Result<Flesh, Error> {
    let nominal = Proportions::default();
    let reach = |link: &str| {
        let link = &tree.links()[tree.link_index(link)?];
        Some(link.offset.iter().map(|x| x * x).sum::<f64>().sqrt())
    };
    let end = |point: &str| {
        let point = &tree.points()[tree.point_index(point)?];
        Some(point.offset.iter().map(|x| x * x).sum::<f64>().sqrt())
    };
    let thigh = reach("r_shin").unwrap_or(nominal.thigh);
    let shin = end("RAnkle").unwrap_or(nominal.shin);
    let upper_arm = reach("r_forearm").unwrap_or(nominal.upper_arm);
    let forearm = end("RWrist").unwrap_or(nominal.forearm);
    let neck = reach("head").unwrap_or(nominal.spine);
    let shoulders = reach("girdle").unwrap_or(nominal.shoulder_height);
    let drop = tree.link_index("r_thigh").map_or(nominal.pelvis_drop, |link| -tree.links()[link].offset[2]);
    let scale =
        (thigh + shin + upper_arm + forearm) / (nominal.thigh + nominal.shin + nominal.upper_arm + nominal.forearm);
    let head = end("Head").unwrap_or(nominal.head_top[2]);
    let mut solids = Vec::new();
    let mut add = |name: &str, base: [f64; 3], axes, height: f64, radii: [f64; 2], ratio: f64| {
        let Some(link) = tree.link_index(name) else { return };
        let frustum = Frustum { height, radii: radii.map(|r| scale * r), ratio };
        solids.push(Solid { name: name.into(), link, base, axes, frustum });
    };
    // The lowest of the hips is the crotch; the chest ends at the base of the neck.
    let crotch = drop + 0.09 * scale;
    add("pelvis", [0.0, 0.0, -crotch], UPWARDS, crotch + 0.02 * scale, [0.165, 0.14], 0.70);
    add("spine", [0.0; 3], UPWARDS, 0.5 * (shoulders + neck), [0.14, 0.155], 0.72);
    add("head", [0.0; 3], UPWARDS, head, [0.065, 0.08], 1.15);
    for side in ["l", "r"] {
        add(&format!("{side}_upper_arm"), [0.0; 3], DOWNWARDS, upper_arm, [0.055, 0.042], 1.0);
        add(&format!("{side}_forearm"), [0.0; 3], DOWNWARDS, forearm + HAND * scale, [0.043, 0.028], 0.9);
    }
    for side in ["l", "r"] {
        add(&format!("{side}_thigh"), [0.0; 3], DOWNWARDS, thigh, [0.09, 0.06], 1.0);
        add(&format!("{side}_shin"), [0.0; 3], DOWNWARDS, shin, [0.06, 0.042], 1.0);
    }
    for (side, points) in [("l", ["LHeel", "LBigToe", "LSmallToe"]), ("r", ["RHeel", "RBigToe", "RSmallToe"])] {
        let place = |point: &str| tree.point_index(point).map(|k| tree.points()[k].offset);
        let [Some(heel), Some(big_toe), small_toe] = points.map(place) else { continue };
        let toes = small_toe.map_or(big_toe, |small_toe| [0, 1, 2].map(|k| 0.5 * (big_toe[k] + small_toe[k])));
        let Some((axes, length)) = foot_axes(heel, toes) else { continue };
        // Markers are on the sole and on the toes' joints; the foot is around them.
        let [_, down, forwards] = axes;
        let base = [0, 1, 2].map(|k| heel[k] - scale * (0.03 * forwards[k] + 0.03 * down[k]));
        add(&format!("{side}_foot"), base, axes, length + 0.07 * scale, [0.04, 0.045], 0.85);
    }
    solids.sort_by_key(|solid| solid.link);
    Flesh::new(tree, solids)
}

/// Axes of a foot whose origin is the ankle: across, down and from heel to toes; and that distance, metres. `None` where heel and toes coincide, or are in line with the ankle.
fn foot_axes(heel: [f64; 3], toes: [f64; 3]) -> Option<([[f64; 3]; 3], f64)> {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let unit = |a: [f64; 3]| {
        let length = dot(a, a).sqrt();
        (length > LEAST_M).then(|| (a.map(|x| x / length), length))
    };
    let (forwards, length) = unit([0, 1, 2].map(|k| toes[k] - heel[k]))?;
    let along = dot(heel, forwards);
    let (down, _) = unit([0, 1, 2].map(|k| heel[k] - along * forwards[k]))?;
    let across = [0, 1, 2].map(|k| {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        down[a] * forwards[b] - down[b] * forwards[a]
    });
    Some(([across, down, forwards], length))
}

/// Least extent that has a direction, metres.
const LEAST_M: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{cf28, h32};

    #[test]
    fn every_link_that_has_flesh_has_it_once() {
        let p = Proportions::default();
        for (tree, count) in [(h32(&p), 13), (cf28(&p), 11)] {
            let flesh = standard_flesh(&tree).expect("links of people");
            assert_eq!(flesh.solids().len(), count);
            let mut all: Vec<usize> = flesh.coordinates(&tree).concat();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..tree.dof()));
            assert!(flesh.coordinates(&tree).iter().all(|part| !part.is_empty()));
        }
    }

    /// Whatever way a measured foot's frame is turned, its solid lies along the sole.
    #[test]
    fn feet_lie_along_heel_and_toes() {
        let p = Proportions { heel: [0.0, -0.06, -0.01], big_toe: [0.0, 0.09, -0.14], ..Proportions::default() };
        let p = Proportions { small_toe: [0.04, 0.06, -0.12], ..p };
        let flesh = standard_flesh(&h32(&p)).expect("links of people");
        let foot = flesh.solids().iter().find(|solid| solid.name == "r_foot").expect("a foot");
        for (marker, beyond) in [(p.heel, 0.03), ([0.02, 0.075, -0.13], 0.04)] {
            let [along, down] = [2, 1]
                .map(|axis: usize| -> f64 { (0..3).map(|k| (marker[k] - foot.base[k]) * foot.axes[axis][k]).sum() });
            let end = along.min(foot.frustum.height - along);
            assert!((end - beyond).abs() < 2e-3 && (down - 0.03).abs() < 2e-3, "{marker:?}: {end} {down}");
        }
    }

    #[test]
    fn larger_people_are_thicker() {
        let of = |factor: f64| {
            let p = Proportions::default();
            let p = Proportions {
                thigh: factor * p.thigh,
                shin: factor * p.shin,
                upper_arm: factor * p.upper_arm,
                forearm: factor * p.forearm,
                ..p
            };
            let flesh = standard_flesh(&h32(&p)).expect("links of people");
            flesh.solids().iter().find(|solid| solid.name == "l_thigh").map(|solid| solid.frustum).expect("a thigh")
        };
        let (usual, large) = (of(1.0), of(1.2));
        assert!((large.height - 1.2 * usual.height).abs() < 1e-12);
        assert!((large.radii[0] - 1.2 * usual.radii[0]).abs() < 1e-12 && (usual.radii[0] - 0.09).abs() < 1e-12);
    }
}
