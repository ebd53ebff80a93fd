//! Keypoints of one camera at a time between two of its frames.
//!
//! With frames −1, 0, 1, 2 and the time w in (0, 1), a keypoint is the polynomial through it where it was found (Lagrange): cubic in four frames, quadratic in three, linear in two. It must have been found in frames 0 and 1.
//!
//! A polynomial errs by the first derivative that it leaves out. Of a swing `A sin(ω t)`, sampled every h, with φ = ωh and ℓ the linear interpolation:
//!
//! | polynomial | error | standard deviation that is stated, with φ = 0.8 |
//! |---|---|---|
//! | cubic | (1 + w)(2 − w) φ²/12 times what ℓ errs by | the same share of the distance from ℓ |
//! | quadratic | up to (1 + w) φ/3 times, or (2 − w) φ/3 | the same share of the distance from ℓ |
//! | linear | w(1 − w) φ/2 times the step from frame 0 to 1 | the same share of the step |
//!
//! φ = 0.8 is a limb that swings at 3.8 Hz before 30 frames a second. The polynomial's own noise is at most that of one frame where it is cubic or linear (weights' squares add to 0.64 and 0.5 in the middle), 1.2 of it where quadratic; that is not added.

use crate::association::assignment::least_cost;
use crate::association::{Config, Person, distance_px, person_size_px, usable};
use crate::keypoints::keypoint_model::Detection;

/// Angle by which the swiftest limb swings in a frame.
const PHASE: f64 = 0.8;

/// A keypoint from frames −1, 0, 1, 2 at the time `share` between frames 0 and 1.
#[must_use]
pub fn keypoint_between(near: [Option<Detection>; 4], share: f64) -> Option<Detection> {
    let [before, start, end, after] = near;
    let (start, end, w) = (start?, end?, share);
    let linear = [0, 1].map(|k| (1.0 - w) * start.pixel[k] + w * end.pixel[k]);
    let through = |weights: &[(f64, Detection)]| {
        [0, 1].map(|k: usize| weights.iter().map(|(weight, seen)| weight * seen.pixel[k]).sum::<f64>())
    };
    let rms = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) / 2.0_f64.sqrt();
    let (pixel, extra_px) = match (before, after) {
        (Some(before), Some(after)) => {
            let pixel = through(&[
                (-w * (1.0 - w) * (2.0 - w) / 6.0, before),
                ((1.0 + w) * (1.0 - w) * (2.0 - w) / 2.0, start),
                ((1.0 + w) * w * (2.0 - w) / 2.0, end),
                (-(1.0 + w) * w * (1.0 - w) / 6.0, after),
            ]);
            (pixel, (1.0 + w) * (2.0 - w) * PHASE * PHASE / 12.0 * rms(pixel, linear))
        }
        (Some(before), None) => {
            let pixel =
                through(&[(-w * (1.0 - w) / 2.0, before), ((1.0 + w) * (1.0 - w), start), ((1.0 + w) * w / 2.0, end)]);
            (pixel, (1.0 + w) * PHASE / 3.0 * rms(pixel, linear))
        }
        (None, Some(after)) => {
            let pixel =
                through(&[((1.0 - w) * (2.0 - w) / 2.0, start), (w * (2.0 - w), end), (-w * (1.0 - w) / 2.0, after)]);
            (pixel, (2.0 - w) * PHASE / 3.0 * rms(pixel, linear))
        }
        (None, None) => (linear, w * (1.0 - w) * PHASE / 2.0 * rms(start.pixel, end.pixel)),
    };
    Some(Detection { pixel, confidence: start.confidence.min(end.confidence), extra_px })
}

/// A person from frames −1, 0, 1, 2 at the time `share` between frames 0 and 1.
#[must_use]
pub fn person_between(near: [Option<&Person>; 4], share: f64) -> Person {
    let keypoints = near.iter().flatten().map(|person| person.len()).max().unwrap_or(0);
    let at = |k: usize| near.map(|person| person.and_then(|person| person.get(k).copied().flatten()));
    (0..keypoints).map(|k| keypoint_between(at(k), share)).collect()
}

/// Distance that a person moves between neighbouring frames at most, in sizes of the person in the image.
const FARTHEST: f64 = 0.5;

/// Everybody in a view at the time `share` between frames 0 and 1 of the four, who are in both of them.
///
/// People are followed from frame to frame by assignment of least total distance; they come in the order of frame 0.
#[must_use]
pub fn people_between(near: [&[Person]; 4], share: f64, config: &Config) -> Vec<Person> {
    let [before, start, end, after] = near;
    let next = followed(start, end, config);
    let (earlier, later) = (followed(start, before, config), followed(end, after, config));
    let person = |(index, next): (usize, Option<usize>)| {
        let next = next?;
        let outer = (earlier[index].map(|i| &before[i]), later[next].map(|i| &after[i]));
        Some(person_between([outer.0, Some(&start[index]), Some(&end[next]), outer.1], share))
    };
    next.into_iter().enumerate().filter_map(person).collect()
}

/// For each person the same one in a neighbouring frame.
fn followed(people: &[Person], neighbours: &[Person], config: &Config) -> Vec<Option<usize>> {
    let cost = |person: &Person, other: &Person| {
        let expected: Vec<Option<[f64; 2]>> = person.iter().map(|d| usable(*d, config).map(|d| d.pixel)).collect();
        let size = person_size_px(person, config);
        distance_px(other, &expected, config)
            .map(|(distance, _)| distance / size)
            .filter(|moved| *moved < FARTHEST)
            .unwrap_or(f64::INFINITY)
    };
    let costs: Vec<Vec<f64>> =
        people.iter().map(|person| neighbours.iter().map(|other| cost(person, other)).collect()).collect();
    least_cost(&costs, FARTHEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f64) -> Option<Detection> {
        Some(Detection::new([x, -2.0 * x], 0.8))
    }

    #[test]
    fn polynomials_of_their_degree_come_back() {
        let cubic = |t: f64| 3.0 - 2.0 * t + 0.7 * t * t - 0.4 * t * t * t;
        let quadratic = |t: f64| 3.0 - 2.0 * t + 0.7 * t * t;
        let linear = |t: f64| 3.0 - 2.0 * t;
        let found = |near: [Option<Detection>; 4], w: f64| keypoint_between(near, w).unwrap();
        for w in [0.1, 0.37, 0.5, 0.9] {
            let all = [-1.0, 0.0, 1.0, 2.0].map(|t| seen(cubic(t)));
            assert!((found(all, w).pixel[0] - cubic(w)).abs() < 1e-12);
            let [a, b, c, d] = [-1.0, 0.0, 1.0, 2.0].map(|t| seen(quadratic(t)));
            assert!((found([a, b, c, None], w).pixel[1] + 2.0 * quadratic(w)).abs() < 1e-12);
            assert!((found([None, b, c, d], w).pixel[0] - quadratic(w)).abs() < 1e-12);
            let two = found([None, seen(linear(0.0)), seen(linear(1.0)), None], w);
            assert!((two.pixel[0] - linear(w)).abs() < 1e-12 && two.extra_px > 0.0);
            let straight = found([-1.0, 0.0, 1.0, 2.0].map(|t| seen(linear(t))), w);
            assert!(straight.extra_px < 1e-12, "{straight:?}");
        }
        assert_eq!(keypoint_between([seen(0.0), None, seen(1.0), seen(2.0)], 0.5), None);
    }

    /// A swing at the phase that is assumed, at all times: the stated standard deviation is no smaller than the error, root mean square.
    #[test]
    fn the_stated_error_is_that_of_the_swiftest_swing() {
        for missing in [vec![], vec![0], vec![3], vec![0, 3]] {
            let (mut error, mut stated) = (0.0, 0.0);
            for step in 0..200 {
                let (w, turn) = (f64::from(step % 9 + 1) / 10.0, f64::from(step) * 0.71);
                let at = |t: f64| 100.0 * (PHASE * t + turn).sin();
                let mut near = [-1.0, 0.0, 1.0, 2.0].map(|t| Some(Detection::new([at(t), 0.0], 0.8)));
                missing.iter().for_each(|&k: &usize| near[k] = None);
                let found = keypoint_between(near, w).unwrap();
                error += (found.pixel[0] - at(w)).powi(2);
                stated += 2.0 * found.extra_px.powi(2);
            }
            assert!(stated > 0.6 * error && stated < 4.0 * error, "{missing:?}: {} {}", stated.sqrt(), error.sqrt());
        }
    }

    #[test]
    fn people_whose_order_changes_are_followed() {
        let person = |x: f64| -> Person {
            (0..8).map(|k| Some(Detection::new([x + 10.0 * f64::from(k % 3), 20.0 * f64::from(k)], 0.9))).collect()
        };
        let frames = [
            vec![person(0.0), person(300.0)],
            vec![person(302.0), person(2.0)],
            vec![person(4.0), person(304.0)],
            vec![person(6.0)],
        ];
        let near = [&frames[0][..], &frames[1], &frames[2], &frames[3]];
        let found = people_between(near, 0.25, &Config::default());
        assert_eq!(found.len(), 2);
        assert!(
            (found[0][0].unwrap().pixel[0] - 302.5).abs() < 1e-9 && (found[1][0].unwrap().pixel[0] - 2.5).abs() < 1e-9
        );
        let alone = [&[][..], &frames[1], &frames[3], &[]];
        assert_eq!(people_between(alone, 0.25, &Config::default()).len(), 1);
    }
}
