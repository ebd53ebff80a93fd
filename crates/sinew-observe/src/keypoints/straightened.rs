//! Keypoints with exchanged sides of limbs put right, before any pose is known.
//!
//! In each camera a pair of limbs is as named or exchanged, frame by frame. The likeliest sequence (Viterbi) pays for every exchanged frame its odds (e⁴ to one against it), and for every keypoint that moves by d pixels from a frame to
//! the next `min(½ d²/m², 8)`, with m the median of all moves in that camera. Limbs that cross in the image can be followed either way; the odds bring them back to their names.

use crate::cameras::offsets::Sighted;
use sinew_core::estimators::median;

/// Log odds against exchanged sides in a frame.
const ODDS: f64 = 4.0;
/// Most that a move costs.
const MOST: f64 = 8.0;
/// Least usual move, pixels.
const LEAST_PX: f64 = 2.0;

/// Some frames that follow each other, with sides put right; `limbs` are pairs of limbs, each the pairs (left, right) of their keypoints.
#[must_use]
pub fn straightened(frames: &[Sighted], limbs: &[Vec<(usize, usize)>]) -> Vec<Sighted> {
    let mut straight = frames.to_vec();
    let cameras = frames.first().map_or(0, Vec::len);
    for camera in 0..cameras {
        for limb in limbs {
            let usual = usual_move(frames, camera, limb);
            for (frame, exchanged) in straight.iter_mut().zip(exchanged(frames, camera, limb, usual)) {
                let seen = &mut frame[camera];
                let count = seen.len();
                for &(left, right) in limb.iter().filter(|(l, r)| exchanged && *l.max(r) < count) {
                    seen.swap(left, right);
                }
            }
        }
    }
    straight
}

/// A keypoint's place in a frame, under its name or its partner's.
fn place(frame: &Sighted, camera: usize, keypoint: usize) -> Option<[f64; 2]> {
    frame.get(camera)?.get(keypoint).copied().flatten().map(|d| d.pixel)
}

/// Distance of a keypoint from another of the next frame, pixels.
fn distance(from: &Sighted, to: &Sighted, camera: usize, [before, after]: [usize; 2]) -> Option<f64> {
    let ([a, b], [x, y]) = (place(from, camera, before)?, place(to, camera, after)?);
    Some((x - a).hypot(y - b))
}

/// Median of the moves of a limb's keypoints, pixels.
fn usual_move(frames: &[Sighted], camera: usize, limb: &[(usize, usize)]) -> f64 {
    let keypoints = || limb.iter().flat_map(|&(l, r)| [l, r]);
    let in_step = |step: &[Sighted]| -> Vec<f64> {
        keypoints().filter_map(|k| distance(&step[0], &step[1], camera, [k, k])).collect()
    };
    let mut moves: Vec<f64> = frames.windows(2).flat_map(in_step).collect();
    if moves.is_empty() { LEAST_PX } else { median(&mut moves).max(LEAST_PX) }
}

/// For each frame whether a pair of limbs is exchanged in a camera.
fn exchanged(frames: &[Sighted], camera: usize, limb: &[(usize, usize)], usual_px: f64) -> Vec<bool> {
    // Cost of the best sequence that ends as named, or exchanged; and where it came from.
    let mut cost = [0.0, ODDS];
    let mut from: Vec<[usize; 2]> = vec![];
    for pair in frames.windows(2) {
        let moves = |is_turned: bool| -> f64 {
            let one = |[before, after]: [usize; 2]| {
                let px = distance(&pair[0], &pair[1], camera, [before, after]).unwrap_or(0.0);
                (0.5 * (px / usual_px).powi(2)).min(MOST)
            };
            let both = |&(l, r): &(usize, usize)| {
                if is_turned { one([l, r]) + one([r, l]) } else { one([l, l]) + one([r, r]) }
            };
            limb.iter().map(both).sum()
        };
        let [kept, turned] = [moves(false), moves(true)];
        let step = |to: usize| {
            let ways = [cost[to] + kept, cost[1 - to] + turned];
            if ways[0] <= ways[1] { (ways[0], to) } else { (ways[1], 1 - to) }
        };
        let [straight, crossed] = [step(0), step(1)];
        from.push([straight.1, crossed.1]);
        cost = [straight.0, crossed.0 + ODDS];
    }
    let mut state = usize::from(cost[1] < cost[0]);
    let mut found = vec![state == 1; frames.len().min(1)];
    for from in from.iter().rev() {
        state = from[state];
        found.push(state == 1);
    }
    found.reverse();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Detection;

    /// Left and right ankles, knees and toes that pass each other in the image, 200 frames.
    fn walk() -> Vec<Sighted> {
        let at = |u: f64, v: f64| Some(Detection::new([u, v], 0.8));
        (0..200)
            .map(|t| {
                let phase = 0.15 * f64::from(t);
                let jitter = 2.0 * f64::from(t * 7 % 5) / 5.0;
                let pair = |reach: f64, v: f64| {
                    [at(300.0 + reach * phase.sin() + jitter, v), at(300.0 - reach * phase.sin(), v + 3.0)]
                };
                vec![[pair(80.0, 500.0), pair(45.0, 400.0), pair(85.0, 520.0)].concat()]
            })
            .collect()
    }

    /// Single frames and spans come back; what was right stays so, also where the ankles pass each other.
    #[test]
    fn exchanged_frames_are_put_right() {
        let truth = walk();
        let limbs = vec![vec![(0, 1), (2, 3), (4, 5)]];
        assert_eq!(straightened(&truth, &limbs), truth);
        let mut seen = truth.clone();
        let wrong: Vec<usize> = (0..200).filter(|t| t % 17 == 9 || (120..126).contains(t)).collect();
        wrong.iter().for_each(|&t| limbs[0].iter().for_each(|&(l, r)| seen[t][0].swap(l, r)));
        let found = straightened(&seen, &limbs);
        let far = |t: &usize| (0.15 * *t as f64).sin().abs() > 0.3;
        let bad: Vec<usize> = (0..200).filter(far).filter(|&t| found[t] != truth[t]).collect();
        assert!(bad.is_empty(), "{bad:?} of {wrong:?}");
    }

    /// Missing keypoints, missing people and no frames at all are as they were.
    #[test]
    fn missing_keypoints_stay_missing() {
        let limbs = vec![vec![(0, 1), (7, 8)]];
        let mut frames = walk();
        frames[3][0][1] = None;
        frames[5][0].clear();
        let found = straightened(&frames, &limbs);
        assert!(found[3][0][1].is_none() && found[5][0].is_empty());
        assert!(straightened(&[], &limbs).is_empty());
    }
}
