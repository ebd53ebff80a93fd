//! Following one person through a recording: association of frames with the memory that it needs.

use crate::association::{
    Config, Person, PersonGroup, distance_px, groups, nearest, projected, size_px, triangulated, usable,
};
use crate::cameras::camera::Camera;
use sinew_core::estimators::median;

/// What following one person needs to remember.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Following {
    /// Which of the people at the start: 0 is the most complete one.
    pub person: usize,
    /// Distances between pairs of keypoints by which they are known again, metres.
    pub lengths: Vec<(usize, usize, f64)>,
    /// Where their keypoints were last seen or, where they were not, projected to, camera by camera.
    pub last_px: Vec<Vec<Option<[f64; 2]>>>,
    /// Frames since they were last seen.
    pub lost: usize,
    /// Whether they were ever seen.
    pub started: bool,
}

/// The followed person in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Associated {
    /// For each camera, the index of the person there.
    pub members: Vec<Option<usize>>,
    /// For each camera, their keypoints; empty where they were not found. Detectors sometimes break a person in two: fragments are put together.
    pub people: Vec<Person>,
}

impl Associated {
    /// Whether any camera found them.
    #[must_use]
    pub fn is_present(&self) -> bool {
        self.members.iter().any(Option::is_some)
    }
}

/// Finds the followed person in a frame (people of each camera) and remembers where they are. `predicted` are the expected pixels, offsets included, where a motion
/// model gives them; without it they are expected where they were.
pub fn follow(
    following: &mut Following,
    cameras: &[Camera],
    people: &[Vec<Person>],
    predicted: Option<&[Vec<Option<[f64; 2]>>]>,
    config: &Config,
) -> Associated {
    let mut members = vec![None; cameras.len()];
    if following.started && following.lost < config.lost_frames {
        let expected = predicted.unwrap_or(&following.last_px);
        members = nearest(people, expected, config);
        if cameras.len() > 1 && members.iter().flatten().count() == 1 {
            // One view alone may show someone else who stands in the same direction.
            members = nearest(people, expected, &Config { near: config.agreeing, ..*config });
        }
    } else if !following.started {
        let count = following.person + 1;
        if let Some(group) = groups(cameras, people, count, config).into_iter().nth(following.person) {
            members = group.members;
        }
    } else {
        let known = |group: &PersonGroup| length_error(&group.points, &following.lengths) <= config.length_error;
        if let Some(group) = groups(cameras, people, usize::MAX, config).into_iter().find(known) {
            members = group.members;
        }
    }
    if members.iter().all(Option::is_none) {
        following.lost = following.lost.saturating_add(1);
        return Associated { people: vec![vec![]; members.len()], members };
    }
    let expected: Vec<Vec<Option<[f64; 2]>>> = if following.lost == 0 && following.started {
        predicted.unwrap_or(&following.last_px).to_vec()
    } else {
        vec![vec![]; cameras.len()]
    };
    let assembled: Vec<Person> =
        (0..members.len()).map(|c| with_fragments(&people[c], members[c], &expected[c], config)).collect();
    following.lost = 0;
    following.started = true;
    let whole: Vec<Vec<Person>> = assembled.iter().map(|p| vec![p.clone()]).collect();
    let first: Vec<Option<usize>> = members.iter().map(|m| m.map(|_| 0)).collect();
    let points = triangulated(cameras, &whole, &first, config);
    following.last_px.resize(cameras.len(), vec![]);
    for (c, last) in following.last_px.iter_mut().enumerate() {
        if members[c].is_some() {
            last.resize(assembled[c].len(), None);
            for (last, d) in last.iter_mut().zip(&assembled[c]) {
                *last = usable(*d, config).map(|d| d.pixel).or(*last);
            }
        } else if points.iter().flatten().count() >= config.least_keypoints {
            *last = projected(&cameras[c], &points);
        }
    }
    Associated { members, people: assembled }
}

/// The chosen person with the keypoints of others who stand where they are expected and have hardly a keypoint in common with them.
fn with_fragments(people: &[Person], member: Option<usize>, expected: &[Option<[f64; 2]>], config: &Config) -> Person {
    let Some(mut whole) = member.and_then(|i| people.get(i).cloned()) else { return vec![] };
    let gate = 0.5 * config.near * size_px(expected.iter().flatten().copied());
    for (j, other) in people.iter().enumerate() {
        let fits = distance_px(other, expected, config).is_some_and(|(distance, _)| distance <= gate);
        if Some(j) == member || !fits {
            continue;
        }
        let usable_in = |person: &Person, k: usize| usable(person.get(k).copied().flatten(), config).is_some();
        let own = (0..other.len()).filter(|&k| usable_in(other, k)).count();
        let shared = (0..other.len()).filter(|&k| usable_in(other, k) && usable_in(&whole, k)).count();
        if 4 * shared <= own {
            for (mine, theirs) in whole.iter_mut().zip(other) {
                *mine = usable(*mine, config).or(*theirs);
            }
        }
    }
    whole
}

/// Median relative error of the distances that can be compared; 0 without any.
fn length_error(points: &[Option<[f64; 3]>], lengths: &[(usize, usize, f64)]) -> f64 {
    let at = |k: usize| points.get(k).copied().flatten();
    let mut errors: Vec<f64> = lengths
        .iter()
        .filter_map(|&(i, j, length)| {
            let (a, b) = (at(i)?, at(j)?);
            let found = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
            Some((found / length - 1.0).abs())
        })
        .collect();
    if errors.is_empty() { 0.0 } else { median(&mut errors) }
}
