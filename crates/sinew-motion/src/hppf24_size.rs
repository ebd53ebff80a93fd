//! HPPF24 with the lengths of a recorded person's segments, each the median over all frames.
//!
//! Left and right have their mean. The trunk reaches from the middle of the hips to the middle of the shoulders and to the base of the neck. Thicknesses are none of this.

use crate::Error;
use crate::points::{Trajectories, between, distance};
use sinew_body::{KinematicTree, hppf24};

/// A place on the person: a point, or the middle of two.
type Place = [&'static str; 2];

const HIPS: Place = ["LHip", "RHip"];
const SHOULDERS: Place = ["LShoulder", "RShoulder"];

const fn point(name: &'static str) -> Place {
    [name, name]
}

/// The body; motion has all joints of evaluation.
///
/// # Errors
/// [`Error::NoPoint`], [`Error::NoFrames`], and [`Error::NoPose`] for positions that are no numbers.
pub fn sized(motion: &Trajectories) -> Result<KinematicTree, Error> {
    let length = |from: Place, to: Place| median_distance(motion, from, to);
    let both = |from: &str, to: &str| -> Result<f64, Error> {
        let side = |side: &str| {
            let [from, to] = [from, to].map(|name| format!("{side}{name}"));
            median_distance(motion, [&from, &from], [&to, &to])
        };
        Ok(0.5 * (side("L")? + side("R")?))
    };
    let hip = 0.5 * length(point(HIPS[0]), point(HIPS[1]))?;
    let shoulder = 0.5 * length(point(SHOULDERS[0]), point(SHOULDERS[1]))?;
    let (trunk, neck) = (length(HIPS, SHOULDERS)?, length(HIPS, point("Neck"))?);
    let head = length(point("Neck"), point("Head"))?;
    let (upper_arm, forearm) = (both("Shoulder", "Elbow")?, both("Elbow", "Wrist")?);
    let (thigh, shin) = (both("Hip", "Knee")?, both("Knee", "Ankle")?);

    let usual = hppf24::tree(1.0);
    let mut links = usual.links().to_vec();
    for link in &mut links {
        let side = link.offset[0].signum();
        link.offset = match link.name.trim_start_matches("l_").trim_start_matches("r_") {
            "head" => [0.0, 0.0, neck],
            "upper_arm" => [side * shoulder, 0.0, trunk],
            "forearm" => [0.0, 0.0, -upper_arm],
            "thigh" => [side * hip, 0.0, 0.0],
            "shin" => [0.0, 0.0, -thigh],
            _ => link.offset,
        };
    }
    let mut points = usual.points().to_vec();
    for point in &mut points {
        point.offset = match point.name.trim_start_matches(['L', 'R']) {
            "Head" => [0.0, 0.0, head],
            "Wrist" => [0.0, 0.0, -forearm],
            "Ankle" => [0.0, 0.0, -shin],
            _ => point.offset,
        };
    }
    KinematicTree::new(links, points).map_err(|_| Error::NoPose)
}

fn median_distance(motion: &Trajectories, from: [&str; 2], to: [&str; 2]) -> Result<f64, Error> {
    let column = |name: &str| motion.index(name).ok_or_else(|| Error::NoPoint(name.to_owned()));
    let columns = |place: [&str; 2]| Ok([column(place[0])?, column(place[1])?]);
    let (from, to) = (columns(from)?, columns(to)?);
    let place = |frame: &[[f64; 3]], [a, b]: [usize; 2]| between(frame[a], frame[b], 0.5);
    let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(place(frame, from), place(frame, to))).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().ok_or(Error::NoFrames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::points_of_states;

    #[test]
    fn lengths_of_a_body_that_moves_are_found() {
        let body = hppf24::tree(1.1);
        let state = |frame: u32| (0..24).map(|j| 0.1 * f64::from(frame) * f64::from(j % 5)).collect::<Vec<f64>>();
        let states: Vec<Vec<f64>> = (0..5).map(state).collect();
        let found = sized(&points_of_states(&body, &states)).unwrap();
        for (a, b) in found.links().iter().zip(body.links()) {
            assert!(distance(a.offset, b.offset) < 1e-9, "{}: {:?} for {:?}", a.name, a.offset, b.offset);
        }
        for (a, b) in found.points().iter().zip(body.points()) {
            assert!(distance(a.offset, b.offset) < 1e-9, "{}: {:?} for {:?}", a.name, a.offset, b.offset);
        }
        assert_eq!(sized(&Trajectories::default()), Err(Error::NoPoint("LHip".into())));
    }
}
