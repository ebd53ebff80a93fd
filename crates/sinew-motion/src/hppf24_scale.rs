//! HPPF24 in a person's size by one scale for the whole body, from the lengths of some segments.

use crate::follow_error::FollowError;
use sinew_body::hppf24;
use sinew_body::points::{Trajectories, distance, points_of_states};
use sinew_core::estimators::median;

/// How lengths of segments become a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Sum of the medians over all frames over the sum of the body's.
    Medians,
    /// Least squares of the lengths in the first frame.
    LeastSquares,
}

/// The scale of HPPF24, 1 for an adult of 1.75 m, by which its segments are as long as a motion's. A segment is a pair of names of points.
///
/// # Errors
/// [`FollowError::Body`] for a point that the motion lacks, [`FollowError::NoFrames`].
pub fn scale(motion: &Trajectories, segments: &[(&str, &str)], how: Scale) -> Result<f64, FollowError> {
    let unit = hppf24::tree(1.0);
    let body = points_of_states(&unit, &[vec![0.0; unit.dof()]]);
    Ok(match how {
        Scale::Medians => sum_of_medians(motion, segments)? / sum_of_medians(&body, segments)?,
        Scale::LeastSquares => {
            let (own, theirs) = (first_lengths(&body, segments)?, first_lengths(motion, segments)?);
            let product: f64 = own.iter().zip(&theirs).map(|(a, b)| a * b).sum();
            product / own.iter().map(|a| a * a).sum::<f64>()
        }
    })
}

fn sum_of_medians(motion: &Trajectories, segments: &[(&str, &str)]) -> Result<f64, FollowError> {
    let median_length = |(from, to): &(&str, &str)| {
        let (a, b) = (motion.column(from)?, motion.column(to)?);
        let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(frame[a], frame[b])).collect();
        if all.is_empty() { Err(FollowError::NoFrames) } else { Ok(median(&mut all)) }
    };
    segments.iter().map(median_length).sum()
}

fn first_lengths(motion: &Trajectories, segments: &[(&str, &str)]) -> Result<Vec<f64>, FollowError> {
    let frame = motion.frames.first().ok_or(FollowError::NoFrames)?;
    let length = |(from, to): &(&str, &str)| Ok(distance(frame[motion.column(from)?], frame[motion.column(to)?]));
    segments.iter().map(length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEGMENTS: [(&str, &str); 3] = [("LShoulder", "LElbow"), ("RHip", "RKnee"), ("RKnee", "RAnkle")];

    #[test]
    fn both_scales_match_the_body_that_moved() {
        let body = hppf24::tree(1.1);
        let state = |frame: u32| (0..24).map(|j| 0.1 * f64::from(frame) * f64::from(j % 5)).collect::<Vec<f64>>();
        let motion = points_of_states(&body, &(0..8).map(state).collect::<Vec<_>>());
        for how in [Scale::Medians, Scale::LeastSquares] {
            let found = scale(&motion, &SEGMENTS, how).unwrap();
            assert!((found - 1.1).abs() < 1e-9, "{how:?} {found}");
        }
    }

    #[test]
    fn a_motion_without_points_or_frames_is_refused() {
        assert_eq!(
            scale(&Trajectories::default(), &SEGMENTS, Scale::Medians),
            Err(FollowError::Body(sinew_body::Error::NoPoint("LShoulder".into())))
        );
        let named = Trajectories { names: vec!["LShoulder".into(), "LElbow".into()], frames: vec![] };
        assert_eq!(scale(&named, &SEGMENTS[..1], Scale::Medians), Err(FollowError::NoFrames));
        assert_eq!(scale(&named, &SEGMENTS[..1], Scale::LeastSquares), Err(FollowError::NoFrames));
    }
}
