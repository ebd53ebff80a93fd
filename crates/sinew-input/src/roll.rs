//! Who was seen where, when, and for how long: everybody of a recording, before anybody is tracked.
//!
//! People count who are seen by at least two cameras for a quarter of a second in all ([`LEAST_S`]); they are numbered in the order of coming. [`sinew_observe::association::identities`] names them.

use super::limbs::paired_limbs;
use super::source::FrameSource;
use crate::Error;
use sinew_observe::Camera;
use sinew_observe::association::identities::Identities;
use sinew_observe::association::{Config, Person};
use sinew_observe::clocks::lag_estimate::CameraLag;
use std::ops::Range;

/// Seconds for which two cameras must see somebody.
pub const LEAST_S: f64 = 0.25;

/// Somebody who was seen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PersonSeen {
    /// From the first frame in which a camera saw them to the one after the last.
    pub frames: Range<u64>,
    /// Frames in which at least two cameras saw them.
    pub seen: u64,
    /// Frames in which each camera saw them.
    pub by_camera: Vec<u64>,
}

/// Everybody, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roll {
    /// The first frame.
    pub start: u64,
    /// For each frame, for each camera, for each person there, which of `people`.
    named: Vec<Vec<Vec<Option<usize>>>>,
    /// Everybody who counts, in the order of coming.
    pub people: Vec<PersonSeen>,
    /// How late each camera is, as everybody shows; empty where that is unknown.
    pub lags: Vec<CameraLag>,
}

impl Roll {
    /// Names everybody in some frames of a source; `watch` is called before each frame with its place and may stop.
    ///
    /// # Errors
    /// Errors of the source and of `watch`.
    pub fn call<S: FrameSource, E: From<Error>>(
        source: &mut S,
        frames: Range<u64>,
        fps: f64,
        config: &Config,
        mut watch: impl FnMut(u64) -> Result<(), E>,
    ) -> Result<Self, E> {
        let cameras = source.cameras().to_vec();
        let mut identities = Identities::new(&cameras, paired_limbs(source.layout()), fps, *config);
        let mut named = vec![];
        for number in frames.clone() {
            watch(number - frames.start)?;
            named.push(identities.name(&source.people(number)?));
        }
        let people = identities.people();
        for name in named.iter_mut().flatten().flatten() {
            *name = name.map(|stay: usize| people[stay].person);
        }
        Ok(Self::counted(frames.start, named, cameras.len(), fps))
    }

    /// Counts who was seen, and leaves out whoever was hardly seen.
    fn counted(start: u64, mut named: Vec<Vec<Vec<Option<usize>>>>, cameras: usize, fps: f64) -> Self {
        let mut all: Vec<PersonSeen> = vec![];
        for (number, frame) in (start..).zip(&named) {
            let mut views: Vec<u64> = vec![0; all.len()];
            for (camera, k) in
                frame.iter().enumerate().flat_map(|(c, view)| view.iter().flatten().map(move |k| (c, *k)))
            {
                if k >= all.len() {
                    let new = PersonSeen { frames: number..number, seen: 0, by_camera: vec![0; cameras] };
                    all.resize(k + 1, new);
                    views.resize(k + 1, 0);
                }
                all[k].frames.end = number + 1;
                all[k].by_camera[camera] += 1;
                views[k] += 1;
            }
            all.iter_mut().zip(views).for_each(|(person, views)| person.seen += u64::from(views > 1));
        }
        let least = (LEAST_S * fps).ceil() as u64;
        let mut people = vec![];
        let kept: Vec<Option<usize>> = all
            .into_iter()
            .map(|person| {
                (person.seen >= least.max(1)).then(|| {
                    people.push(person);
                    people.len() - 1
                })
            })
            .collect();
        for name in named.iter_mut().flatten().flatten() {
            *name = name.and_then(|k| kept[k]);
        }
        Self { start, named, people, lags: vec![] }
    }

    /// The same people without one of the cameras, by its place.
    #[must_use]
    pub fn without_view(&self, left_out: usize) -> Self {
        let mut others = self.clone();
        for frame in others.named.iter_mut().filter(|frame| left_out < frame.len()) {
            frame.remove(left_out);
        }
        for person in others.people.iter_mut().filter(|person| left_out < person.by_camera.len()) {
            person.by_camera.remove(left_out);
        }
        if left_out < others.lags.len() {
            others.lags.remove(left_out);
        }
        others
    }

    /// Where a person was seen, in words.
    #[must_use]
    pub fn words(&self, person: usize, cameras: &[Camera]) -> String {
        let PersonSeen { frames, seen, by_camera } = &self.people[person];
        let by_camera: Vec<String> =
            cameras.iter().zip(by_camera).map(|(camera, frames)| format!("{} {frames}", camera.name)).collect();
        format!("frames {}..{}, by two cameras in {seen}; {}", frames.start, frames.end, by_camera.join(", "))
    }

    /// What each camera shows of a person in a frame, and of everybody else.
    #[must_use]
    pub fn parted(&self, number: u64, person: usize, people: Vec<Vec<Person>>) -> [Vec<Vec<Person>>; 2] {
        let frame = number.checked_sub(self.start).and_then(|k| self.named.get(usize::try_from(k).ok()?));
        let is_he =
            |view: usize, i: usize| frame.and_then(|frame| frame.get(view)?.get(i).copied().flatten()) == Some(person);
        let mut parted = [vec![], vec![]];
        for (view, people) in people.into_iter().enumerate() {
            let (own, others): (Vec<_>, Vec<_>) = people.into_iter().enumerate().partition(|(i, _)| is_he(view, *i));
            for (all, own) in parted.iter_mut().zip([own, others]) {
                all.push(own.into_iter().map(|(_, person)| person).collect());
            }
        }
        parted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Somebody in two views for three frames, then in one; a ghost for one frame.
    fn roll(fps: f64) -> Roll {
        let named = vec![
            vec![vec![Some(0)], vec![Some(1), Some(0)]],
            vec![vec![Some(0), Some(1)], vec![Some(0)]],
            vec![vec![Some(0)], vec![Some(0), None]],
            vec![vec![], vec![Some(0)]],
        ];
        Roll::counted(10, named, 2, fps)
    }

    #[test]
    fn people_count_whom_two_cameras_see_for_a_quarter_of_a_second() {
        let somebody = PersonSeen { frames: 10..14, seen: 3, by_camera: vec![3, 4] };
        assert_eq!(roll(12.0).people, [somebody]);
        assert_eq!(roll(12.1).people, []);
    }

    #[test]
    fn a_view_that_is_left_out_shifts_no_other() {
        let people = |x: f64| vec![None, Some(sinew_observe::Detection::new([x, 0.0], 1.0))];
        let [own, others] = roll(12.0).without_view(0).parted(10, 0, vec![vec![people(2.0), people(3.0)]]);
        assert_eq!((own, others), (vec![vec![people(3.0)]], vec![vec![people(2.0)]]));
    }

    #[test]
    fn a_frame_is_parted_into_a_person_and_the_others() {
        let people = |x: f64| vec![None, Some(sinew_observe::Detection::new([x, 0.0], 1.0))];
        let frame = vec![vec![people(1.0)], vec![people(2.0), people(3.0)]];
        let [own, others] = roll(12.0).parted(10, 0, frame.clone());
        assert_eq!(own, [vec![people(1.0)], vec![people(3.0)]]);
        assert_eq!(others, [vec![], vec![people(2.0)]]);
        let [own, others] = roll(12.0).parted(99, 0, frame.clone());
        assert_eq!((own, others), (vec![vec![], vec![]], frame));
    }
}
