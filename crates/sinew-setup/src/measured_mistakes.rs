//! How often each camera's detector takes something for something else ([`Mistakes`]).
//!
//! Both probabilities have Beta priors; a round of the set-up replaces them by their means given how probable each mistake is at the poses of that round (expectation–maximisation).

use super::mistake_prior::{ELSEWHERE, EXCHANGED};
use super::stored::{CameraSetup, Setup};
use sinew_body::KinematicTree;
use sinew_observe::keypoints::mistakes::paired_limbs;
use sinew_observe::{KeypointFrame, KeypointModel, Mistakes};

/// The pairs of limbs of a body, by the places of their points among `points`.
#[must_use]
pub fn limb_pairs(tree: &KinematicTree, points: &[usize]) -> Vec<Vec<(usize, usize)>> {
    let place = |name: &str| points.iter().position(|&p| tree.points()[p].name == name);
    let pair = |(k, &p): (usize, &usize)| {
        let right = tree.points()[p].name.strip_prefix('L').map(|rest| format!("R{rest}"))?;
        Some((k, place(&right)?))
    };
    let pairs: Vec<(usize, usize)> = points.iter().enumerate().filter_map(pair).collect();
    paired_limbs(tree, points, &pairs)
}

/// The mistakes of cameras, for a model of these points of a body.
#[must_use]
pub fn mistakes<'a>(
    tree: &KinematicTree,
    points: &[usize],
    cameras: impl Iterator<Item = &'a CameraSetup> + Clone,
) -> Mistakes {
    Mistakes {
        limbs: limb_pairs(tree, points),
        exchanged: cameras.clone().map(|camera| camera.exchanged).collect(),
        elsewhere: cameras.map(|camera| camera.elsewhere).collect(),
    }
}

/// Probabilities of mistakes given some frames, whose points are where the frames predict them.
pub(super) fn measured<'a>(model: &KeypointModel, frames: impl Iterator<Item = KeypointFrame<'a>>) -> Mistakes {
    let mut exchanged: Vec<Vec<f64>> = vec![vec![]; model.views.len()];
    let mut elsewhere = exchanged.clone();
    for frame in frames {
        for (all, found) in exchanged.iter_mut().zip(model.exchanged(&frame)) {
            all.extend(found.into_iter().flatten());
        }
        for (all, found) in elsewhere.iter_mut().zip(model.elsewhere(&frame)) {
            all.extend(found);
        }
    }
    Mistakes {
        exchanged: exchanged.iter().map(|found| EXCHANGED.given(found)).collect(),
        elsewhere: elsewhere.iter().map(|found| ELSEWHERE.given(found)).collect(),
        ..model.mistakes.clone()
    }
}

/// A probability with few digits, as it is stored.
fn rounded(probability: f64) -> f64 {
    (1e5 * probability).round() / 1e5
}

impl Setup {
    /// Takes up what was measured.
    pub(super) fn store_mistakes(&mut self, mistakes: &Mistakes) {
        for (view, camera) in self.camera.iter_mut().enumerate() {
            camera.exchanged = rounded(mistakes.exchanged(view));
            camera.elsewhere = rounded(mistakes.elsewhere(view));
        }
    }
}
