//! Which links the keypoints of a layout show at all.

use crate::link_angles::CoordinateSource;
use sinew_body::KinematicTree;

/// Whether keypoints show how the link of a column turns: one that lies on it beside its joint, or beyond it.
pub(crate) fn is_shown(body: &KinematicTree, keypoints: &[String], source: &CoordinateSource) -> bool {
    let CoordinateSource::Angles(angles) = source else { return true };
    let is_beyond = |link: usize| {
        let above = std::iter::successors(body.links()[link].parent, |&parent| body.links()[parent].parent);
        above.into_iter().any(|parent| parent == angles.link)
    };
    let shows = |point: &sinew_body::Point| {
        let is_beside = point.link == angles.link && point.offset != [0.0; 3];
        (is_beside || is_beyond(point.link)) && keypoints.contains(&point.name)
    };
    body.points().iter().any(shows)
}
