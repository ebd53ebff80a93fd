//! People of a crowd who come late, leave, and come back or not.
//!
//! Nobody is seen by any camera, and hides nobody, while they are away. Whoever comes back has gone somewhere in the meantime: they are anywhere within [`STROLL_M_S`] times the gap of where they left, in a direction of its own, and walks towards the middle from there. So nothing but who they are joins the two stays, and the way that lies between.

use crate::draws::uniforms;
use sinew_body::points::Trajectories;
use sinew_core::random::Stage;
use std::f64::consts::TAU;
use std::ops::Range;

/// How far somebody gets while they are away, metres a second.
pub const STROLL_M_S: f64 = 1.5;
/// How far beside the middle they walk afterwards, metres.
const BESIDE_M: f64 = 0.5;

/// Who is away when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absences {
    /// Probability that somebody comes late and stays; everybody else leaves once.
    pub late: f64,
    /// Probability that somebody who leaves does not come back.
    pub for_good: f64,
    /// Seconds between which somebody comes late.
    pub comes_s: [f64; 2],
    /// Seconds between which somebody leaves.
    pub leaves_s: [f64; 2],
    /// Seconds that they are away, from and to.
    pub gap_s: [f64; 2],
}

impl Absences {
    /// One in four comes late. Of the others one in four leaves for good, and the rest is away for half a second to three.
    pub const USUAL: Self =
        Self { late: 0.25, for_good: 0.25, comes_s: [1.0, 5.0], leaves_s: [1.5, 4.5], gap_s: [0.5, 3.0] };
}

/// Frames without somebody; where they come back, `motion` is changed from there on.
/// Whoever `turns` within a room is back where their way has led meanwhile.
pub(crate) fn away(
    absences: &Absences,
    rate_hz: f64,
    motion: &mut Trajectories,
    turns: bool,
    stage: &Stage,
) -> Range<usize> {
    let luck = uniforms(stage, 0, 8);
    let between = |[low, high]: [f64; 2], part: f64| low + part * (high - low);
    let frame = |seconds: f64| ((seconds * rate_hz).round() as usize).min(motion.frames.len());
    if luck[0] < absences.late {
        return 0..frame(between(absences.comes_s, luck[1]));
    }
    let (left_s, gap_s) = (between(absences.leaves_s, luck[1]), between(absences.gap_s, luck[2]));
    let (left, back) = (frame(left_s), frame(if luck[7] < absences.for_good { f64::INFINITY } else { left_s + gap_s }));
    if back < motion.frames.len() && !turns {
        let (sin, cos) = (TAU * luck[3]).sin_cos();
        let far = STROLL_M_S * gap_s * luck[4].sqrt();
        let [x, y] = place(&motion.frames[left]);
        let from = [x + far * cos, y + far * sin];
        let towards = [luck[5], luck[6]].map(|part| BESIDE_M * (2.0 * part - 1.0));
        walk_from(motion, back, from, towards);
    }
    left..back
}

/// Middle of the points, seen from above.
fn place(points: &[[f64; 3]]) -> [f64; 2] {
    [0, 1].map(|axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len().max(1) as f64)
}

/// Turns and moves a motion from a frame on, so that it starts at one place and heads for another.
fn walk_from(motion: &mut Trajectories, frame: usize, from: [f64; 2], towards: [f64; 2]) {
    let [first, now] = [&motion.frames[0], &motion.frames[frame]].map(|points| place(points));
    let heading = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]).atan2(b[0] - a[0]);
    let (sin, cos) = (heading(from, towards) - heading(first, now)).sin_cos();
    for point in motion.frames[frame..].iter_mut().flatten() {
        let [x, y] = [point[0] - now[0], point[1] - now[1]];
        (point[0], point[1]) = (from[0] + cos * x - sin * y, from[1] + sin * x + cos * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points that go along x at 1.2 m/s, at 10 frames a second, through the middle half way.
    fn motion() -> Trajectories {
        let at = |frame: usize| 0.12 * (frame as f64 - 40.0);
        let frames = (0..80).map(|f| vec![[at(f), -0.2, 0.0], [at(f), 0.2, 1.7]]).collect();
        Trajectories { names: vec!["A".into(), "B".into()], frames }
    }

    #[test]
    fn people_come_late_or_are_away_for_as_long_as_stated_and_come_back_where_they_can_have_gone() {
        let (mut late, mut gone, mut gaps) = (0, 0, vec![]);
        for seed in 0..400 {
            let mut changed = motion();
            let away = away(&Absences::USUAL, 10.0, &mut changed, false, &Stage::new(seed, "test"));
            if away.start == 0 {
                late += 1;
                assert!((10..=50).contains(&away.end), "{away:?}");
                assert_eq!(changed, motion());
                continue;
            }
            if away.end == 80 && away.start < 50 {
                gone += 1;
                continue;
            }
            assert!((15..=45).contains(&away.start) && (5..=30).contains(&away.len()), "{away:?}");
            gaps.push(away.len());
            let [left, back] = [away.start, away.end].map(|frame| place(&changed.frames[frame]));
            let far = (back[0] - left[0]).hypot(back[1] - left[1]);
            assert!(far <= STROLL_M_S * (0.1 * away.len() as f64 + 0.1), "{far} m in {away:?}");
            let next = place(&changed.frames[away.end + 1]);
            assert!(((next[0] - back[0]).hypot(next[1] - back[1]) - 0.12).abs() < 1e-9, "{next:?}");
            let tall = |points: &Vec<[f64; 3]>| (0..3).map(|k| (points[1][k] - points[0][k]).powi(2)).sum::<f64>();
            assert!((tall(&changed.frames[away.end]) - tall(&motion().frames[0])).abs() < 1e-12);
        }
        assert!((70..130).contains(&late) && (50..100).contains(&gone), "{late} of 400 late, {gone} gone");
        assert!(gaps.iter().min() < Some(&8) && gaps.iter().max() > Some(&27));
    }

    #[test]
    fn whoever_comes_back_heads_for_the_middle() {
        let mut changed = motion();
        walk_from(&mut changed, 30, [3.0, 4.0], [0.0, 0.0]);
        let [start, on] = [30, 50].map(|frame| place(&changed.frames[frame]));
        assert!((start[0] - 3.0).abs() < 1e-9 && (start[1] - 4.0).abs() < 1e-9);
        assert!((on[0] / on[1] - 0.75).abs() < 1e-9 && on[0] < 3.0, "{on:?}");
    }
}
