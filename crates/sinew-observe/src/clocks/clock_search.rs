//! Whole frames by which cameras are late, however many, from where rays pass each other.
//!
//! Rays to the same keypoint meet where two cameras show the same moment. For each pair of cameras and each lag between them, the cost is the mean distance of the rays of all keypoints, cut off at `FARTHEST_M`, of everybody in a frame to whom fits best in the other view.
//! The lags of all cameras together have the least sum of the pairs' costs, found camera by camera from each camera as the one that is right; between lags that cost the same, the smaller one is taken, and none at all where lags do not lower the sum of costs to `WORTH` of it: cameras that are not quite where their calibration says have costs of their own.
//! It is a search: [`crate::clocks::lag_estimate`] says what fractions of a frame are left, and how sure that is.

use crate::association::{Config, Person, usable};
use crate::cameras::camera::Camera;
use nalgebra::{Matrix3, Vector3};
use sinew_core::estimators::mean;

/// Distance of rays that says no more than that they do not meet, metres.
const FARTHEST_M: f64 = 0.2;
/// Cost of a frame of lag, metres: it decides where nothing else does.
const FRAME_M: f64 = 1e-5;
/// Share of the cost of no lags that lags must come down to.
const WORTH: f64 = 0.7;
/// Frames of the first camera of a pair that are looked at, at most.
const LOOKED_AT: usize = 300;
/// Frames and keypoints in which two people must be seen together.
const LEAST_FRAMES: usize = 20;
const LEAST_KEYPOINTS: usize = 5;
/// Sine of the angle between rays that say where they meet.
const LEAST_SINE: f64 = 0.05;
/// Rounds over all cameras.
const ROUNDS: usize = 20;

/// Directions to the keypoints of a person, in the world.
type Rays = Vec<Option<Vector3<f64>>>;

/// Whole frames that each camera is late against the first, at most `most`, from what all cameras show frame by frame; all 0 with fewer than two cameras.
///
/// Frames lie one after the other, each with the people of every camera; those that a camera missed are empty.
#[must_use]
pub fn whole_lags(cameras: &[Camera], frames: &[Vec<Vec<Person>>], most: usize, config: &Config) -> Vec<i64> {
    let count = cameras.len();
    let rays: Vec<Vec<Vec<Rays>>> =
        (0..count).map(|c| frames.iter().map(|views| rays(&cameras[c], views.get(c), config)).collect()).collect();
    let centres: Vec<Vector3<f64>> = cameras.iter().map(|camera| camera.centre().into()).collect();
    let mut costs = vec![vec![vec![]; count]; count];
    for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
        costs[a][b] = pair_costs(centres[b] - centres[a], &rays[a], &rays[b], most as i64);
    }
    let cost = |a: usize, b: usize, lag: i64| {
        let (a, b, lag) = if a < b { (a, b, lag) } else { (b, a, -lag) };
        let place = usize::try_from(lag + most as i64).ok();
        place.and_then(|place| costs[a][b].get(place)).copied().unwrap_or(FARTHEST_M)
    };
    let total = |lags: &[i64]| {
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        pairs.map(|(a, b)| cost(a, b, lags[b] - lags[a])).sum::<f64>()
    };
    let reach = || (0..=most as i64).flat_map(|lag| if lag == 0 { vec![0] } else { vec![lag, -lag] });
    let best = |of: &dyn Fn(i64) -> f64| reach().min_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(0);
    let from = |first: usize| {
        let mut lags: Vec<i64> =
            (0..count).map(|c| if c == first { 0 } else { best(&|lag| cost(first, c, lag)) }).collect();
        for _ in 0..ROUNDS {
            let before = lags.clone();
            for c in (0..count).filter(|c| *c != first) {
                let others = |lag: i64| (0..count).filter(|d| *d != c).map(|d| cost(d, c, lag - lags[d])).sum::<f64>();
                lags[c] = best(&others);
            }
            if lags == before {
                break;
            }
        }
        lags
    };
    let found = (0..count).map(from).min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or_default();
    let none = vec![0; count];
    if total(&found) > WORTH * total(&none) {
        return none;
    }
    found.iter().map(|lag| lag - found[0]).collect()
}

fn rays(camera: &Camera, people: Option<&Vec<Person>>, config: &Config) -> Vec<Rays> {
    let turn = Matrix3::from_fn(|i, j| camera.rotation[j][i]);
    let ray = |detection| {
        let [x, y] = camera.normalised_from_pixel(camera.undistort(usable(detection, config)?.pixel).ok()?);
        Some((turn * Vector3::new(x, y, 1.0)).normalize())
    };
    people.into_iter().flatten().map(|person| person.iter().map(|d| ray(*d)).collect()).collect()
}

/// Costs of the lags −most, …, most of the second camera against the first, which is `apart` from it.
fn pair_costs(apart: Vector3<f64>, first: &[Vec<Rays>], second: &[Vec<Rays>], most: i64) -> Vec<f64> {
    let shown: Vec<usize> = (0..first.len()).filter(|frame| !first[*frame].is_empty()).collect();
    let looked: Vec<usize> = shown.iter().copied().step_by(shown.len().div_ceil(LOOKED_AT).max(1)).collect();
    let cost = |lag: i64| {
        let nearest = |frame: &usize| {
            let other = second.get(frame.checked_add_signed(lag as isize)?)?;
            let nearest = |a: &Rays| other.iter().filter_map(|b| distance(apart, a, b)).min_by(f64::total_cmp);
            let distances: Vec<f64> = first[*frame].iter().filter_map(nearest).collect();
            (!distances.is_empty()).then(|| mean(&distances))
        };
        let distances: Vec<f64> = looked.iter().filter_map(nearest).collect();
        let mean = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
        if distances.len() < LEAST_FRAMES { FARTHEST_M } else { mean + FRAME_M * lag.abs() as f64 }
    };
    (-most..=most).map(cost).collect()
}

/// Mean distance of the rays of two people, metres, each cut off.
fn distance(apart: Vector3<f64>, a: &Rays, b: &Rays) -> Option<f64> {
    let (mut sum, mut seen) = (0.0, 0);
    for (a, b) in a.iter().zip(b).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))) {
        let normal = a.cross(b);
        let sine = normal.norm();
        if sine > LEAST_SINE {
            sum += (apart.dot(&normal) / sine).abs().min(FARTHEST_M);
            seen += 1;
        }
    }
    (seen >= LEAST_KEYPOINTS).then(|| sum / seen as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keypoints::keypoint_model::Detection;

    /// Twelve points that swing and wander; nobody is there in some frames.
    fn at(point: usize, time: f64) -> [f64; 3] {
        let k = point as f64;
        let phase = 0.1 * time + k;
        [0.3 * k.sin() + 0.2 * phase.sin() + 0.006 * time, 0.3 * k.cos() + 0.15 * (0.7 * phase).cos(), 0.15 * k]
    }

    fn cameras(count: usize) -> Vec<Camera> {
        let camera = |i: usize| {
            let angle = 0.3 + std::f64::consts::TAU * i as f64 / (count as f64 + 0.5);
            let centre = [5.0 * angle.cos(), 5.0 * angle.sin(), 1.8];
            Camera::look_at(&format!("C{i}"), [1000.0, 1000.0], 700.0, centre, [0.0, 0.0, 1.0]).unwrap()
        };
        (0..count).map(camera).collect()
    }

    fn found(lags: &[i64], speed: f64, most: usize) -> Vec<i64> {
        let cameras = cameras(lags.len());
        let view = |camera: &Camera, time: f64, shift: f64| -> Person {
            let seen = |point| {
                let [x, y, z] = at(point, speed * time);
                Some(Detection::new(camera.project([x + shift, y, z]).pixel()?, 0.9))
            };
            (0..12).map(seen).collect()
        };
        let frame = |number: i64| -> Vec<Vec<Person>> {
            let people = |(camera, lag): (&Camera, &i64)| {
                let time = (number - lag) as f64;
                // A bystander stands still beside, first in every second frame.
                let mut people = vec![view(camera, time, 0.0), view(camera, 0.0, 1.5)];
                if number % 2 == 0 {
                    people.swap(0, 1);
                }
                if number % 17 == 0 { vec![] } else { people }
            };
            cameras.iter().zip(lags).map(people).collect()
        };
        let frames: Vec<Vec<Vec<Person>>> = (0..240).map(frame).collect();
        whole_lags(&cameras, &frames, most, &Config::default())
    }

    #[test]
    fn lags_of_many_frames_are_found() {
        for lags in [vec![0, 23, -41, 7], vec![0, 60], vec![0, 0, 0, 0, -1], vec![0, -9, 30]] {
            assert_eq!(found(&lags, 1.0, 120), lags);
        }
    }

    #[test]
    fn people_who_stand_still_have_no_lag() {
        assert_eq!(found(&[0, 23, -41, 7], 0.0, 120), [0; 4]);
        assert!(whole_lags(&[], &[], 10, &Config::default()).is_empty());
    }
}
