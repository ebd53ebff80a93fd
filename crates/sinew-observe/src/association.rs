//! Which detection in each view is the tracked person?
//!
//! **At the start**, and again once a person has been lost for some frames, by consistency over cameras ([`groups`]):
//!
//! 1. Seeds: each pair of people in two of the (at most [`Config::seed_cameras`]) cameras that see most keypoints is triangulated keypoint by keypoint.
//! 2. Where the pair agrees with its own pixels, every other camera contributes the person whose keypoints lie nearest to the projected points, if near enough.
//! 3. The group with most agreeing keypoints wins, its people are taken out, and the rest is searched again: groups come in the order of completeness.
//!
//! The cost is linear in the number of cameras, since only seeds are paired. Distances are medians over the shared keypoints, in units of the person's size in the
//! image, so that neither image size nor distance matters.
//!
//! **Afterwards** by nearness ([`nearest`]): in each camera the person nearest to where the keypoints were predicted, within a gate. Bystanders fall outside it.
//!
//! [`crate::association::following`] is the two together with the little memory that they need.

pub mod assignment;
pub mod following;
pub mod identities;
pub mod identities_joining;
pub mod view_partition;

use crate::cameras::camera::Camera;
use crate::cameras::triangulate::{Seen, linear};
use crate::keypoints::keypoint_model::Detection;
use sinew_core::estimators::median;

/// Keypoints of one person in one view, in the order of the layout; `None` is missing.
pub type Person = Vec<Option<Detection>>;

/// How people are distinguished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Median reprojection distance up to which views agree, in sizes of the person in the image.
    pub agreeing: f64,
    /// Median distance from the prediction up to which a person is taken for the predicted one, in sizes.
    pub near: f64,
    /// Keypoints of lower confidence do not count.
    pub least_confidence: f64,
    /// Fewest shared keypoints for a comparison.
    pub least_keypoints: usize,
    /// Cameras whose people are paired.
    pub seed_cameras: usize,
    /// Frames without the person after which the search starts again from all people.
    pub lost_frames: usize,
    /// Relative error of limb lengths up to which someone who is found again is the same person.
    pub length_error: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            agreeing: 0.06,
            near: 0.25,
            least_confidence: 0.2,
            least_keypoints: 4,
            seed_cameras: 4,
            lost_frames: 10,
            length_error: 0.2,
        }
    }
}

/// Detections that belong to one person.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonGroup {
    /// For each camera, the index of the person there.
    pub members: Vec<Option<usize>>,
    /// Detections that agree with the person's points in space.
    pub keypoints: usize,
    /// Mean over the members of the median reprojection distance, in sizes; 0 for a single view.
    pub error: f64,
    /// World positions of the keypoints, metres.
    pub points: Vec<Option<[f64; 3]>>,
}

pub(crate) fn usable(point: Option<Detection>, config: &Config) -> Option<Detection> {
    point.filter(|d| d.confidence >= config.least_confidence && d.pixel.iter().all(|x| x.is_finite()))
}

/// Diagonal of the box around a set of pixels.
pub(crate) fn size_px(pixels: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in pixels {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    (high[0] - low[0]).hypot(high[1] - low[1])
}

pub(crate) fn person_size_px(person: &Person, config: &Config) -> f64 {
    size_px(person.iter().filter_map(|d| usable(*d, config)).map(|d| d.pixel)).max(1.0)
}

/// Median distance of a person's keypoints from expected pixels (in pixels) and the number of shared ones; `None` where too few are shared.
pub(crate) fn distance_px(person: &Person, expected: &[Option<[f64; 2]>], config: &Config) -> Option<(f64, usize)> {
    let mut distances: Vec<f64> = person
        .iter()
        .zip(expected)
        .filter_map(|(d, e)| {
            let (d, [u, v]) = (usable(*d, config)?, (*e)?);
            Some((d.pixel[0] - u).hypot(d.pixel[1] - v))
        })
        .collect();
    let shared = distances.len();
    (shared >= config.least_keypoints).then(|| (median(&mut distances), shared))
}

pub(crate) fn projected(camera: &Camera, points: &[Option<[f64; 3]>]) -> Vec<Option<[f64; 2]>> {
    points.iter().map(|p| camera.project((*p)?).pixel()).collect()
}

/// Keypoints in space from the chosen people.
#[must_use]
pub fn triangulated(
    cameras: &[Camera],
    people: &[Vec<Person>],
    members: &[Option<usize>],
    config: &Config,
) -> Vec<Option<[f64; 3]>> {
    let chosen: Vec<(&Camera, &Person)> = cameras
        .iter()
        .zip(people)
        .zip(members)
        .filter_map(|((camera, people), member)| Some((camera, people.get((*member)?)?)))
        .collect();
    let keypoints = chosen.iter().map(|(_, person)| person.len()).max().unwrap_or(0);
    (0..keypoints)
        .map(|k| {
            let seen: Vec<Seen<'_>> = chosen
                .iter()
                .filter_map(|(camera, person)| {
                    let d = usable(person.get(k).copied().flatten(), config)?;
                    let pixel = camera.undistort(d.pixel).ok()?;
                    Some(Seen { camera, pixel, confidence: d.confidence })
                })
                .collect();
            linear(&seen, true).filter(|p| seen.iter().all(|s| s.camera.project_ideal(*p).is_some()))
        })
        .collect()
}

/// The people whom several cameras agree on, most complete first, at most `count`. With a single camera: its people by the number of keypoints.
#[must_use]
pub fn groups(cameras: &[Camera], people: &[Vec<Person>], count: usize, config: &Config) -> Vec<PersonGroup> {
    let seen = |person: &Person| person.iter().filter(|d| usable(**d, config).is_some()).count();
    let mut free: Vec<Vec<bool>> =
        people.iter().map(|p| p.iter().map(|person| seen(person) >= config.least_keypoints).collect()).collect();
    if cameras.len() == 1 {
        let mut order: Vec<usize> = (0..people.first().map_or(0, Vec::len)).filter(|&i| free[0][i]).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(seen(&people[0][i])));
        let alone = |i: usize| {
            let points = vec![None; people[0][i].len()];
            PersonGroup { members: vec![Some(i)], keypoints: seen(&people[0][i]), error: 0.0, points }
        };
        return order.into_iter().take(count).map(alone).collect();
    }
    let mut found: Vec<PersonGroup> = vec![];
    while found.len() < count {
        let mut seeds: Vec<(usize, usize)> = (0..cameras.len().min(people.len()))
            .map(|c| (c, (0..people[c].len()).filter(|&i| free[c][i]).map(|i| seen(&people[c][i])).max().unwrap_or(0)))
            .filter(|(_, most)| *most > 0)
            .collect();
        seeds.sort_by_key(|&(c, most)| (std::cmp::Reverse(most), c));
        seeds.truncate(config.seed_cameras.max(2));
        let mut best: Option<PersonGroup> = None;
        for (a, &(first, _)) in seeds.iter().enumerate() {
            for &(second, _) in &seeds[a + 1..] {
                for i in (0..people[first].len()).filter(|&i| free[first][i]) {
                    for j in (0..people[second].len()).filter(|&j| free[second][j]) {
                        let grown = grow(cameras, people, &free, [(first, i), (second, j)], config);
                        if let Some(group) = grown
                            && best.as_ref().is_none_or(|b| {
                                group.keypoints > b.keypoints || group.keypoints == b.keypoints && group.error < b.error
                            })
                        {
                            best = Some(group);
                        }
                    }
                }
            }
        }
        let Some(group) = best else { break };
        for (c, member) in group.members.iter().enumerate() {
            if let Some(i) = member {
                free[c][*i] = false;
            }
        }
        found.push(group);
    }
    found
}

fn grow(
    cameras: &[Camera],
    people: &[Vec<Person>],
    free: &[Vec<bool>],
    seed: [(usize, usize); 2],
    config: &Config,
) -> Option<PersonGroup> {
    let mut members = vec![None; cameras.len()];
    for (c, i) in seed {
        members[c] = Some(i);
    }
    let from_seed = triangulated(cameras, people, &members, config);
    for (c, i) in seed {
        let person = &people[c][i];
        let (distance, _) = distance_px(person, &projected(&cameras[c], &from_seed), config)?;
        if distance > config.agreeing * person_size_px(person, config) {
            return None;
        }
    }
    for c in (0..people.len()).filter(|c| seed.iter().all(|s| s.0 != *c)) {
        let expected = projected(&cameras[c], &from_seed);
        members[c] = (0..people[c].len())
            .filter(|&i| free[c][i])
            .filter_map(|i| {
                let (distance, _) = distance_px(&people[c][i], &expected, config)?;
                let relative = distance / person_size_px(&people[c][i], config);
                (relative <= 2.0 * config.agreeing).then_some((relative, i))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, i)| i);
    }
    judged(cameras, people, members, config)
}

/// The group of these people: where their keypoints are, and how many agree; `None` where fewer than two views compare.
pub(crate) fn judged(
    cameras: &[Camera],
    people: &[Vec<Person>],
    members: Vec<Option<usize>>,
    config: &Config,
) -> Option<PersonGroup> {
    let points = triangulated(cameras, people, &members, config);
    let (mut keypoints, mut error, mut views) = (0, 0.0, 0);
    for (c, member) in members.iter().enumerate() {
        let Some(person) = member.and_then(|i| people[c].get(i)) else { continue };
        let expected = projected(&cameras[c], &points);
        let size = person_size_px(person, config);
        let Some((distance, _)) = distance_px(person, &expected, config) else { continue };
        keypoints += person
            .iter()
            .zip(&expected)
            .filter(|(d, e)| match (usable(**d, config), e) {
                (Some(d), Some([u, v])) => (d.pixel[0] - u).hypot(d.pixel[1] - v) <= 2.0 * config.agreeing * size,
                _ => false,
            })
            .count();
        error += distance / size;
        views += 1;
    }
    (views >= 2).then(|| PersonGroup { members, keypoints, error: error / f64::from(views), points })
}

/// In each camera, the person nearest to the predicted pixels (camera by camera, keypoint by keypoint), within the gate.
#[must_use]
pub fn nearest(people: &[Vec<Person>], predicted: &[Vec<Option<[f64; 2]>>], config: &Config) -> Vec<Option<usize>> {
    people
        .iter()
        .zip(predicted)
        .map(|(people, predicted)| {
            let expected = size_px(predicted.iter().flatten().copied());
            let distances = people.iter().enumerate().filter_map(|(i, person)| {
                let (distance, _) = distance_px(person, predicted, config)?;
                // Who is expected close to the lens, or beyond the image, has no size to measure by.
                let size = expected.min(2.0 * person_size_px(person, config));
                (distance <= config.near * size).then_some((distance, i))
            });
            distances.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_expected_beyond_all_bounds_is_not_taken_for_someone_far_away() {
        let person = |x: f64, size: f64| -> Person {
            let at = |k: usize| [x + size * (k % 3) as f64 / 2.0, 100.0 + size * (k / 3) as f64 / 2.0];
            (0..9).map(|k| Some(Detection::new(at(k), 0.9))).collect()
        };
        let expected = |x, size| person(x, size).into_iter().map(|d| d.map(|d| d.pixel)).collect::<Vec<_>>();
        let people = [vec![person(0.0, 200.0)]];
        let found = |x, size| nearest(&people, &[expected(x, size)], &Config::default())[0];
        assert_eq!(found(20.0, 200.0), Some(0));
        assert_eq!(found(4000.0, 200.0), None);
        assert_eq!(found(4000.0, 20_000.0), None);
    }
}
