//! Ten truncated elliptical cones, the flesh of bodies that are tracked on silhouettes.
//!
//! Torso, head, and upper and lower limbs, on links of these names.

use crate::Error;
use crate::flesh::{DOWNWARDS, Flesh, Solid, UPWARDS};
use crate::frustum::Frustum;
use crate::standard::Proportions;
use crate::tree::KinematicTree;

/// Radii at base and top of an adult of 1.75 m, metres, and the ratio of the axes: torso, head, upper arm, forearm, thigh, shin.
const SECTIONS: [([f64; 2], f64); 6] = [
    ([0.15, 0.17], 0.10 / 0.15),
    ([0.06, 0.075], 1.25),
    ([0.05, 0.04], 1.0),
    ([0.04, 0.028], 0.9),
    ([0.085, 0.06], 1.0),
    ([0.058, 0.038], 1.0),
];

/// Where the torso's cone stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torso {
    /// Name of its link.
    pub link: &'static str,
    /// From the link's origin down to its base, metres.
    pub drop: f64,
    /// Its height, metres.
    pub height: f64,
}

/// The cones with heights of head, upper arm, forearm, thigh and shin, radii times `scale`; `round` makes them cylinders with the mean of the four semi-axes.
pub(crate) fn ten_cones(
    tree: &KinematicTree,
    torso: Torso,
    heights: [f64; 5],
    scale: f64,
    round: bool,
) -> Result<Flesh, Error> {
    let solid = |(link, name): (usize, &str)| {
        let part = match name.trim_start_matches("l_").trim_start_matches("r_") {
            name if name == torso.link => 0,
            "head" => 1,
            "upper_arm" => 2,
            "forearm" => 3,
            "thigh" => 4,
            "shin" => 5,
            _ => return None,
        };
        let (radii, ratio) = SECTIONS[part];
        let mean = 0.5 * (radii[0] + radii[1]) * 0.5 * (1.0 + ratio);
        let (radii, ratio) = if round { ([mean; 2], 1.0) } else { (radii, ratio) };
        let (height, base) = match part {
            0 => (torso.height, [0.0, 0.0, -torso.drop]),
            _ => (heights[part - 1], [0.0; 3]),
        };
        let frustum = Frustum { height, radii: radii.map(|r| scale * r), ratio };
        let axes = if part < 2 { UPWARDS } else { DOWNWARDS };
        Some(Solid { name: name.into(), link, base, axes, frustum })
    };
    let links = tree.links().iter().enumerate().map(|(index, link)| (index, &*link.name));
    Flesh::new(tree, links.filter_map(solid).collect())
}

/// The cones of a tree as long as its segments, and as thick as an adult of 1.75 m stretched with the limbs.
///
/// # Errors
/// [`Error::NoSolid`] for a tree without these segments.
pub(crate) fn ten_cones_on(tree: &KinematicTree, torso: Torso) -> Result<Flesh, Error> {
    let reach = |link: &str| Some(tree.links()[tree.link_index(link)?].offset[2].abs());
    let end = |point: &str| Some(tree.points()[tree.point_index(point)?].offset[2].abs());
    let heights = [end("Head"), reach("l_forearm"), end("LWrist"), reach("l_shin"), end("LAnkle")];
    let [Some(head), Some(upper_arm), Some(forearm), Some(thigh), Some(shin)] = heights else {
        return Err(Error::NoSolid);
    };
    let usual = Proportions::default();
    let scale = (upper_arm + forearm + thigh + shin) / (usual.upper_arm + usual.forearm + usual.thigh + usual.shin);
    ten_cones(tree, torso, [head, upper_arm, forearm, thigh, shin], scale, false)
}
