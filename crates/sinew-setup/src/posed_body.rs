//! Frames of all links and points of a body in one state, and its T-pose.
//!
//! Once per written frame; whatever runs per particle uses [`sinew_body::Plan`].

use sinew_body::{KinematicTree, Point};
use sinew_formats::rotation::{IDENTITY, Matrix, about_axis, apply, product};
use std::f64::consts::FRAC_PI_2;

/// World rotation and origin of every link, and position of every point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Rotation, world from link.
    pub rotations: Vec<Matrix>,
    /// Origin of each link after its joints, metres.
    pub origins: Vec<[f64; 3]>,
    /// Position of each point, metres.
    pub points: Vec<[f64; 3]>,
}

/// Pose of a body in a state.
///
/// # Panics
/// If the state is shorter than the body's number of degrees of freedom.
#[must_use]
pub fn pose(body: &KinematicTree, state: &[f64]) -> Pose {
    let (rotations, origins): (Vec<Matrix>, Vec<[f64; 3]>) = body.link_frames(state).into_iter().unzip();
    let moved = |p: &Point| {
        let step = apply(&rotations[p.link], p.offset);
        [0, 1, 2].map(|k| origins[p.link][k] + step[k])
    };
    let points = body.points().iter().map(moved).collect();
    Pose { rotations, origins, points }
}

/// World rotation of every link in the T-pose.
#[must_use]
pub fn t_pose(body: &KinematicTree) -> Vec<Matrix> {
    let mut rest: Vec<Matrix> = Vec::with_capacity(body.links().len());
    for link in body.links() {
        let own = if link.name.ends_with("upper_arm") {
            about_axis(1, FRAC_PI_2.copysign(-link.offset[0]))
        } else {
            link.rest.unwrap_or(IDENTITY)
        };
        let parent = link.parent.map_or(IDENTITY, |parent| rest[parent]);
        rest.push(product(&parent, &own));
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Plan, Proportions, point_positions, standard};
    use sinew_core::lanes::Isa;

    #[test]
    fn agrees_with_the_lane_plan() {
        let body = standard::h32(&Proportions::default());
        let state: Vec<f64> = (0..body.dof()).map(|i| (i as f64 * 1.7).sin()).collect();
        let plan = Plan::with_all_points(&body);
        let mut points = vec![0.0; 3 * plan.points()];
        point_positions(&plan, Isa::best(), &state, &mut points);
        for (a, b) in pose(&body, &state).points.iter().flatten().zip(&points) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
