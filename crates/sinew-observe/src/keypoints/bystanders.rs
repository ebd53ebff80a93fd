//! Other people in a view, whose keypoints a detector may give to the tracked person.

use crate::association::following::Associated;
use crate::association::{Config, Person, distance_px, size_px, usable};
use crate::keypoints::keypoint_model::{Detection, KeypointModel};
use std::f64::consts::TAU;

/// Median distance of keypoints, in sizes of the person in the image, up to which another detection is the same person once more.
const SAME: f64 = 0.1;

/// For each view, for each point of the model, the density (1/px²) at its detection of the other people's keypoints of that name ([`crate::KeypointFrame::elsewhere`]); empty where there is nobody else. `people` are all people of each view, in any number of parts,
/// `found` is the tracked one among them, `keypoint` says for each point of the model which keypoint it is.
#[must_use]
pub fn elsewhere(
    model: &KeypointModel,
    people: [&[Vec<Person>]; 2],
    found: &Associated,
    keypoint: &[usize],
    config: &Config,
) -> Vec<Vec<f64>> {
    let in_view = |(view, own): (usize, &Person)| {
        let all = people.iter().filter_map(|part| part.get(view)).flatten();
        let others = others(all, own, config);
        if others.is_empty() {
            return vec![];
        }
        let density = |&k: &usize| {
            let Some(seen) = own.get(k).copied().flatten() else { return 0.0 };
            let theirs = others.iter().filter_map(|other| usable(other.get(k).copied().flatten(), config));
            theirs.map(|other| shared_density(model, view, seen, other)).sum::<f64>() / others.len() as f64
        };
        keypoint.iter().map(density).collect()
    };
    found.people.iter().enumerate().map(in_view).collect()
}

/// Everybody in a view but the one with these keypoints.
fn others<'a>(people: impl Iterator<Item = &'a Person>, own: &Person, config: &Config) -> Vec<&'a Person> {
    let places: Vec<Option<[f64; 2]>> = own.iter().map(|d| usable(*d, config).map(|d| d.pixel)).collect();
    let near = SAME * size_px(places.iter().flatten().copied());
    let is_other = |other: &&Person| distance_px(other, &places, config).is_some_and(|(distance, _)| distance > near);
    people.filter(is_other).collect()
}

/// Density of the distance of two detections of one keypoint.
fn shared_density(model: &KeypointModel, view: usize, one: Detection, other: Detection) -> f64 {
    let variance = model.noise_px2(view, &one) + model.noise_px2(view, &other);
    let square = (one.pixel[0] - other.pixel[0]).powi(2) + (one.pixel[1] - other.pixel[1]).powi(2);
    (-0.5 * square / variance).exp() / (TAU * variance)
}
