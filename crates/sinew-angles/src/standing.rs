//! The zero of angles in the draws of a standing trial, and what speaks against the trial.
//!
//! Estimates of somebody who stands still move as keypoints err. With m_t and v_t the mean and the variance over draws of an angle less its zero in frame t, an angle moves by
//!
//! ```text
//! s² = Var_t(m_t) − mean_t(v_t)        span from 5 % to 95 % of a normal law: 3.29 s
//! ```
//!
//! which is 0 where what is known of each frame explains all of it.

use crate::circle::{self, TURN_RAD};
use crate::zero::{has_zero, mean_directions};
use crate::{AngleDraws, JointAngles};
use sinew_body::KinematicTree;

/// Movement of an angle over the trial above which nobody stands still.
pub const MOST_MOVED_DEG: f64 = 5.0;
/// Zero above which angles of one joint mix where it is subtracted.
pub const LARGEST_ZERO_DEG: f64 = 20.0;
/// Difference of the lengths of two bodies over their sum, above which they are hardly of one person.
const MOST_LONGER: f64 = 0.04;

/// Standard deviations between the 5 % and 95 % quantiles of a normal law.
const SPAN_SD: f64 = 3.29;

/// Mean and variance over draws of each angle less its zero in a frame.
struct FrameSpread(Vec<[f64; 2]>);

impl FrameSpread {
    /// From a row of angles for each draw, radians.
    fn new(draws: &[Vec<f64>]) -> Self {
        let of = |angle: usize| {
            let middle = direction(draws.iter().map(|row| row[angle]));
            let apart = draws.iter().map(|row| about(row[angle] - middle).powi(2)).sum::<f64>();
            [middle, apart / draws.len() as f64]
        };
        Self((0..draws.first().map_or(0, Vec::len)).map(of).collect())
    }
}

/// What a run says of itself.
#[derive(Clone, Copy, Debug)]
pub struct TrialRun<'a> {
    /// Whether its draws are trajectories.
    pub is_smoothed: bool,
    /// A diagnostic that failed, in words.
    pub failed: Option<&'a str>,
}

/// Angles of a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingAngles {
    /// Angles that have a zero.
    pub names: Vec<String>,
    /// Mean directions over the frames, radians: a row for each draw, a number for each name.
    pub drawn: Vec<f64>,
    /// What speaks against them.
    pub doubts: Vec<StandingDoubt>,
}

/// What speaks against a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub enum StandingDoubt {
    /// Its draws are no trajectories.
    Filtered,
    /// A diagnostic of it failed, in words.
    Failed(String),
    /// Angles that its keypoints do not show.
    Unseen(Vec<String>),
    /// Angles that move over it, the most in words.
    Moves(String),
    /// Zeros that are too large to be subtracted, the largest in words.
    LargeZeros(String),
    /// The sizes of its body differ from the run's by this share.
    OtherSizes(f64),
}

impl StandingAngles {
    /// From the draws of a run, in which keypoints do not show some of the angles.
    #[must_use]
    pub fn new(angles: &JointAngles, draws: &AngleDraws, run: &TrialRun<'_>, is_unseen: impl Fn(&str) -> bool) -> Self {
        let all = angles.names().iter().enumerate().filter(|(_, name)| has_zero(name));
        let (unseen, kept): (Vec<_>, Vec<_>) = all.partition(|(_, name)| is_unseen(name));
        let kept_only = |all: Vec<f64>| kept.iter().map(|(k, _)| all[*k]).collect::<Vec<f64>>();
        let in_draw = |draw| {
            let states: Vec<Vec<f64>> = (0..draws.frames()).map(|frame| draws.state(draw, frame)).collect();
            kept_only(mean_directions(angles, states.iter().map(Vec::as_slice)))
        };
        let drawn: Vec<Vec<f64>> = (0..draws.draws()).map(in_draw).collect();
        let in_frame = |frame| {
            let less_zero = |(draw, zero): (usize, &Vec<f64>)| {
                let state = draws.state(draw, frame);
                let here = kept_only(mean_directions(angles, std::iter::once(&state[..])));
                here.iter().zip(zero).map(|(angle, zero)| angle - zero).collect()
            };
            FrameSpread::new(&drawn.iter().enumerate().map(less_zero).collect::<Vec<Vec<f64>>>())
        };
        let frames: Vec<FrameSpread> = (0..draws.frames()).map(in_frame).collect();
        let named = |all: &[(usize, &String)]| all.iter().map(|(_, name)| (*name).clone()).collect::<Vec<String>>();
        let (names, unseen) = (named(&kept), named(&unseen));
        let doubts = doubts(run, &names, &drawn, &frames, &unseen);
        Self { names, drawn: drawn.concat(), doubts }
    }
}

/// Doubts about a trial: the zeros of angles with these names in each draw, and their spread in each frame, radians.
fn doubts(
    run: &TrialRun<'_>,
    names: &[String],
    drawn: &[Vec<f64>],
    frames: &[FrameSpread],
    unseen: &[String],
) -> Vec<StandingDoubt> {
    let mut found = vec![];
    if !run.is_smoothed {
        found.push(StandingDoubt::Filtered);
    }
    if let Some(failed) = run.failed {
        found.push(StandingDoubt::Failed(failed.to_owned()));
    }
    if !unseen.is_empty() {
        found.push(StandingDoubt::Unseen(unseen.to_vec()));
    }
    let moved = (0..names.len()).map(|angle| moved(frames, angle).to_degrees());
    let zeros = (0..names.len()).map(|angle| direction(drawn.iter().map(|row| row[angle])).abs().to_degrees());
    if let Some(words) = above(names, moved, MOST_MOVED_DEG) {
        found.push(StandingDoubt::Moves(words));
    }
    if let Some(words) = above(names, zeros, LARGEST_ZERO_DEG) {
        found.push(StandingDoubt::LargeZeros(words));
    }
    found
}

/// How far an angle moves over the trial, radians.
fn moved(frames: &[FrameSpread], angle: usize) -> f64 {
    let count = frames.len() as f64;
    let means = || frames.iter().map(|frame| frame.0[angle][0]);
    let middle = direction(means());
    let between = means().map(|mean| about(mean - middle).powi(2)).sum::<f64>() / count;
    let within = frames.iter().map(|frame| frame.0[angle][1]).sum::<f64>() / count;
    SPAN_SD * (between - within).max(0.0).sqrt()
}

/// Mean direction of angles.
fn direction(angles: impl Iterator<Item = f64>) -> f64 {
    circle::direction(angles, TURN_RAD)
}

/// An angle within half a turn of 0.
fn about(angle: f64) -> f64 {
    circle::near(angle, 0.0, TURN_RAD)
}

/// The largest of the values above a limit with its name, and how many others there are.
fn above(names: &[String], values: impl Iterator<Item = f64>, limit: f64) -> Option<String> {
    let all: Vec<(&String, f64)> = names.iter().zip(values).filter(|(_, value)| *value > limit).collect();
    let (name, value) = all.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = match all.len() - 1 {
        0 => String::new(),
        1 => ", and one other".into(),
        others => format!(", and {others} others"),
    };
    Some(format!("`{name}` {value:.0}°{others}"))
}

/// A doubt where the lengths of two bodies with the same links differ.
#[must_use]
pub fn other_sizes(trial: &KinematicTree, run: &KinematicTree) -> Option<StandingDoubt> {
    let length = |offset: &[f64; 3]| offset.iter().map(|x| x * x).sum::<f64>().sqrt();
    let pairs: Vec<[f64; 2]> =
        trial.links().iter().zip(run.links()).map(|(a, b)| [&a.offset, &b.offset].map(length)).collect();
    let apart: f64 = pairs.iter().map(|[a, b]| (a - b).abs()).sum();
    let share = apart / pairs.iter().map(|[_, b]| b).sum::<f64>().max(f64::MIN_POSITIVE);
    (share > MOST_LONGER).then_some(StandingDoubt::OtherSizes(share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Proportions, standard};

    fn names() -> Vec<String> {
        ["knee_angle_r", "ankle_angle_r"].map(str::to_owned).into()
    }

    /// Frames in which angles are where `at` says, their draws apart by `apart` to both sides.
    fn frames(at: impl Fn(usize) -> [f64; 2], apart: f64) -> Vec<FrameSpread> {
        let row = |frame: usize, sign: f64| at(frame).map(|x| x + sign * apart).to_vec();
        (0..41).map(|frame| FrameSpread::new(&[row(frame, -1.0), row(frame, 1.0)])).collect()
    }

    /// Estimates of a knee that wander by 2.6° about half a turn, within what draws say of each frame.
    #[test]
    fn a_still_smoothed_trial_with_small_zeros_has_no_doubts() {
        let run = TrialRun { is_smoothed: true, failed: None };
        let wanders = |frame: usize| [3.1 + 0.045 * (1.3 * frame as f64).sin(), 0.0];
        let drawn = vec![vec![0.1, -0.1]; 20];
        assert!(doubts(&run, &names(), &drawn, &frames(wanders, 0.045), &[]).is_empty());
        assert_eq!(doubts(&run, &names(), &drawn, &frames(wanders, 0.002), &[]).len(), 1);
    }

    #[test]
    fn all_that_is_wrong_with_a_trial_is_said() {
        let run = TrialRun { is_smoothed: false, failed: Some("R-hat") };
        let drawn = vec![vec![3.1, 0.0], vec![-3.1, 0.0]];
        let moving = frames(|frame| [0.1 * (frame as f64).sin(), 0.0], 0.01);
        let found = doubts(&run, &names(), &drawn, &moving, &["head_rz".to_owned()]);
        let wanted = [
            StandingDoubt::Filtered,
            StandingDoubt::Failed("R-hat".into()),
            StandingDoubt::Unseen(vec!["head_rz".into()]),
            StandingDoubt::Moves("`knee_angle_r` 13°".into()),
            StandingDoubt::LargeZeros("`knee_angle_r` 180°".into()),
        ];
        assert_eq!(found, wanted);
    }

    #[test]
    fn sizes_of_another_person_are_said() {
        let body = |factor: f64| {
            let usual = Proportions::default();
            standard::h32(&Proportions { thigh: factor * usual.thigh, shin: factor * usual.shin, ..usual })
        };
        assert_eq!(other_sizes(&body(1.0), &body(1.03)), None);
        let found = other_sizes(&body(1.2), &body(1.0)).unwrap();
        assert!(matches!(found, StandingDoubt::OtherSizes(share) if share > MOST_LONGER), "{found:?}");
    }
}
