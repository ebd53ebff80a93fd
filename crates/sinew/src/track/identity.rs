//! What is tracked, as a number: random streams are those of the seed and of this.
//!
//! Trials, and people of one, that drew the same random numbers would err alike: the mean of two would be stated too wide, and their difference far too narrow.
//! So streams are derived from the seed and from what the first frame that shows the person shows of them. That is the same whatever else is tracked, in whichever order, from files, arrays or a live stream, which knows nothing else
//! before it has to answer; a copy of a trial, which shares all errors, has the same. Frames before that one have the streams of the set-up.

use crate::files::{FNV_START, fnv};
use crate::input::frame::Frame;
use crate::setup::Setup;

/// A hash of what a frame shows of whom is tracked: keypoints, with their confidences, and masks, camera by camera. None where it shows nobody.
pub(super) fn shown(frame: &Frame) -> Option<u64> {
    let (mut hash, mut is_empty) = (FNV_START, true);
    let mut add = |place: usize, numbers: &[f64]| {
        hash = fnv(hash, &(place as u64).to_le_bytes());
        hash = numbers.iter().fold(hash, |hash, number| fnv(hash, &number.to_bits().to_le_bytes()));
        is_empty = false;
    };
    for (camera, people) in frame.people.iter().enumerate() {
        for (place, point) in people.iter().flatten().enumerate() {
            if let Some(point) = point {
                add(camera, &[place as f64, point.pixel[0], point.pixel[1], point.confidence]);
            }
        }
    }
    for (camera, mask) in frame.images.silhouettes.iter().enumerate() {
        let Some(mask) = mask.as_ref().filter(|mask| mask.bounds().is_some()) else { continue };
        let columns = (0..mask.width()).map(|x| mask.count_inside(x..x + 1, 0..mask.height()) as f64);
        add(camera, &columns.collect::<Vec<_>>());
    }
    (!is_empty).then_some(hash)
}

/// A hash of what a set-up found first, which tells it from others.
pub(super) fn setup_hash(setup: &Setup) -> u64 {
    let numbers = setup.start_pose.iter().fold(FNV_START, |hash, x| fnv(hash, &x.to_bits().to_le_bytes()));
    fnv(numbers, &(setup.person as u64).to_le_bytes())
}

/// The seed of the streams of what is tracked, in a run with a seed.
pub(super) fn seed_of(seed: u64, identity: u64) -> u64 {
    fnv(fnv(FNV_START, &seed.to_le_bytes()), &identity.to_le_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_observe::Detection;

    fn frame(x: f64) -> Frame {
        let point = Detection { pixel: [x, 2.0], confidence: 0.5, extra_px: 0.0 };
        Frame { people: vec![vec![], vec![vec![None, Some(point)]]], ..Frame::default() }
    }

    #[test]
    fn only_a_frame_that_shows_somebody_says_who() {
        assert_eq!(shown(&Frame::default()), None);
        assert_eq!(shown(&Frame { people: vec![vec![vec![None; 3]]; 2], ..Frame::default() }), None);
        assert_eq!(shown(&frame(1.0)), shown(&frame(1.0)));
        assert_ne!(shown(&frame(1.0)), shown(&frame(1.5)));
        let others = Frame { others: frame(7.0).people, ..frame(1.0) };
        assert_eq!(shown(&others), shown(&frame(1.0)), "what others do is no part of it");
    }

    #[test]
    fn seeds_and_identities_are_told_apart() {
        let seeds: std::collections::BTreeSet<u64> =
            (0..30).flat_map(|seed| (0..30).map(move |identity| seed_of(seed, identity))).collect();
        assert_eq!(seeds.len(), 900);
    }
}
