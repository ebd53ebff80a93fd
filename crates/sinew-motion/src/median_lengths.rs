//! The lengths of a recorded person's segments, each the median over all frames, for the bodies of silhouettes.
//!
//! Left and right have their mean. The trunk reaches from the middle of the hips to the middle of the shoulders and to the base of the neck. Thicknesses, feet and faces are none of this.

use crate::FollowError;
use sinew_body::Proportions;
use sinew_body::points::{Trajectories, between, distance};
use sinew_core::estimators::median;

/// A place on the person: a point, or the middle of two.
type Place = [&'static str; 2];

const HIPS: Place = ["LHip", "RHip"];
const SHOULDERS: Place = ["LShoulder", "RShoulder"];

const fn point(name: &'static str) -> Place {
    [name, name]
}

/// The sizes of a body whose root lies above the middle of the hips by this share of the trunk; the motion has all joints of evaluation.
///
/// # Errors
/// [`FollowError::Body`], [`FollowError::NoFrames`], and [`FollowError::NoPose`] for positions that are no numbers.
pub fn median_lengths(motion: &Trajectories, root: f64) -> Result<Proportions, FollowError> {
    let length = |from: Place, to: Place| median_distance(motion, from, to);
    let both = |from: &str, to: &str| -> Result<f64, FollowError> {
        let side = |side: &str| {
            let [from, to] = [from, to].map(|name| format!("{side}{name}"));
            median_distance(motion, [&from, &from], [&to, &to])
        };
        Ok(0.5 * (side("L")? + side("R")?))
    };
    let (hips, shoulders) =
        (length(point(HIPS[0]), point(HIPS[1]))?, length(point(SHOULDERS[0]), point(SHOULDERS[1]))?);
    let (trunk, neck) = (length(HIPS, SHOULDERS)?, length(HIPS, point("Neck"))?);
    let drop = root * trunk;
    let found = Proportions {
        hip_half_width: 0.5 * hips,
        shoulder_half_width: 0.5 * shoulders,
        pelvis_drop: drop,
        shoulder_height: trunk - drop,
        spine: neck - drop,
        head_top: [0.0, 0.0, length(point("Neck"), point("Head"))?],
        upper_arm: both("Shoulder", "Elbow")?,
        forearm: both("Elbow", "Wrist")?,
        thigh: both("Hip", "Knee")?,
        shin: both("Knee", "Ankle")?,
        ..Proportions::default()
    };
    if found.are_within(Proportions::LONGEST_M) { Ok(found) } else { Err(FollowError::NoPose) }
}

fn median_distance(motion: &Trajectories, from: [&str; 2], to: [&str; 2]) -> Result<f64, FollowError> {
    let columns = |place: [&str; 2]| Ok::<_, sinew_body::Error>([motion.column(place[0])?, motion.column(place[1])?]);
    let (from, to) = (columns(from)?, columns(to)?);
    let place = |frame: &[[f64; 3]], [a, b]: [usize; 2]| between(frame[a], frame[b], 0.5);
    let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(place(frame, from), place(frame, to))).collect();
    if all.is_empty() { Err(FollowError::NoFrames) } else { Ok(median(&mut all)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::points::points_of_states;
    use sinew_body::{KinematicTree, hapf31, hppf24};

    #[test]
    fn lengths_of_a_body_that_moves_are_found() {
        let usual = Proportions::default();
        let tall =
            Proportions { thigh: 0.5, forearm: 0.3, spine: 0.5, shoulder_height: 0.44, pelvis_drop: 0.11, ..usual };
        type Build = fn(&Proportions) -> KinematicTree;
        // The trunk of HAPF31 bends between hips and shoulders: thorax and clavicles are kept still.
        let bodies: [(Build, f64, &[usize]); 2] =
            [(hppf24::sized, 0.0, &[]), (hapf31::sized, 0.2, &[6, 7, 16, 17, 22, 23])];
        for (build, root, still) in bodies {
            let body = build(&tall);
            let state = |frame: usize| -> Vec<f64> {
                let angle = |j: usize| if still.contains(&j) { 0.0 } else { 0.1 * frame as f64 * (j % 5) as f64 };
                (0..body.dof()).map(angle).collect()
            };
            let states: Vec<Vec<f64>> = (0..5).map(state).collect();
            let found = build(&median_lengths(&points_of_states(&body, &states), root).unwrap());
            for (a, b) in found.links().iter().zip(body.links()) {
                assert!(distance(a.offset, b.offset) < 1e-9, "{}: {:?} for {:?}", a.name, a.offset, b.offset);
            }
            for (a, b) in found.points().iter().zip(body.points()) {
                assert!(distance(a.offset, b.offset) < 1e-9, "{}: {:?} for {:?}", a.name, a.offset, b.offset);
            }
        }
        assert_eq!(
            median_lengths(&Trajectories::default(), 0.0),
            Err(FollowError::Body(sinew_body::Error::NoPoint("LHip".into())))
        );
    }
}
