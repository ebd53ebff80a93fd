//! OpenPose-style keypoint files: JSON, one file per camera and frame.
//!
//! `people[i].pose_keypoints_2d` is a flat list of x, y (pixels) and confidence for each keypoint of the layout. Other
//! fields are ignored. Quirks that are ordinary input:
//!
//! - `people` is empty: nobody was found. An entry `{}` or one with an empty list: this person is absent, the others
//!   keep their index (association tools put the tracked person at index 0).
//! - `0 0 0`: not detected. Any keypoint with confidence 0, and one with a `null` or `NaN` coordinate, is missing.
//! - (0, 0) with confidence above 0 is kept and counted: some trackers mean "not found" by it.
//!
//! Confidences must lie in \[0, 1\] once divided by [`OpenposeOptions::confidence_scale`]. Warnings are per recording, not per
//! frame: add every frame to a [`Tally`].
//!
//! ```
//! use sinew_formats::openpose::{OpenposeOptions, read, write};
//! let text = r#"{"people": [{"pose_keypoints_2d": [10.5, 20.0, 0.9, 0, 0, 0]}]}"#;
//! let frame = read("cam01.0034.json", text, &OpenposeOptions::default())?;
//! assert_eq!(frame.people[0].keypoints[0].unwrap().x, 10.5);
//! assert!(frame.people[0].keypoints[1].is_none());
//! assert_eq!(read("again.json", &write(&frame.people), &OpenposeOptions::default())?, frame);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::{Error, Layout, Place, Warning, json_text, limits};
use serde::Deserialize;
use sinew_observe::Detection;
use sinew_observe::association::Person;

/// Absent people that are written before one who is there.
const MAX_ABSENT: usize = 1000;

/// How to read keypoint files.
#[derive(Clone, Copy, Debug)]
pub struct OpenposeOptions<'a> {
    /// Frame number, for messages.
    pub frame: Option<u64>,
    /// Layout that every person must fit; without one any number of triples is taken.
    pub layout: Option<&'a Layout>,
    /// Confidence that means certainty.
    pub confidence_scale: f64,
}

impl Default for OpenposeOptions<'_> {
    fn default() -> Self {
        Self { frame: None, layout: None, confidence_scale: 1.0 }
    }
}

/// A detected keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// Column, pixels.
    pub x: f64,
    /// Row, pixels.
    pub y: f64,
    /// Confidence of the detector, above 0 and at most 1.
    pub confidence: f64,
}

/// A person in one view.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenposePerson {
    /// Index in the file's list, which also counts absent people.
    pub index: usize,
    /// Keypoints in the order of the layout; `None` is missing.
    pub keypoints: Vec<Option<Keypoint>>,
}

impl OpenposePerson {
    /// The keypoints in the form that association and likelihoods take.
    #[must_use]
    pub fn detections(&self) -> Person {
        let detection = |k: Keypoint| Detection::new([k.x, k.y], k.confidence);
        self.keypoints.iter().map(|k| k.map(detection)).collect()
    }
}

/// The people of a frame, camera by camera, in that form.
#[must_use]
pub fn detections(people: &[Vec<OpenposePerson>]) -> Vec<Vec<Person>> {
    people.iter().map(|people| people.iter().map(OpenposePerson::detections).collect()).collect()
}

/// Everyone seen by one camera in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpenposeFrame {
    /// People who are present, by rising index.
    pub people: Vec<OpenposePerson>,
    /// Keypoints with confidence above 0 but without coordinates; they are missing.
    pub without_coordinates: u64,
    /// Confidence of the first keypoint at exactly (0, 0) with confidence above 0, if there is one.
    pub at_origin: Option<f64>,
}

/// Counts over the frames of a camera, from which its warnings are made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    frames: u64,
    empty: u64,
    first_empty: Option<u64>,
    without_coordinates: u64,
    at_origin: u64,
    first_at_origin: Option<f64>,
}

impl Tally {
    /// Counts a frame; `None` is one without a file.
    pub fn add(&mut self, number: u64, frame: Option<&OpenposeFrame>) {
        self.frames += 1;
        if frame.is_none_or(|frame| frame.people.is_empty()) {
            self.empty += 1;
            self.first_empty.get_or_insert(number);
        }
        if let Some(frame) = frame {
            self.without_coordinates += frame.without_coordinates;
            if let Some(confidence) = frame.at_origin {
                self.at_origin += 1;
                self.first_at_origin.get_or_insert(confidence);
            }
        }
    }

    /// What is odd about the frames so far.
    #[must_use]
    pub fn warnings(&self, camera: &str) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if let Some(first) = self.first_empty {
            warnings.push(Warning::NoPerson { camera: camera.into(), empty: self.empty, frames: self.frames, first });
        }
        if self.without_coordinates > 0 {
            warnings.push(Warning::NoCoordinates { points: self.without_coordinates });
        }
        if let Some(confidence) = self.first_at_origin {
            warnings.push(Warning::AtOrigin { confidence, frames: self.at_origin });
        }
        warnings
    }
}

/// A file as it stands.
#[derive(Deserialize)]
#[serde(expecting = "an object with `people`")]
pub(crate) struct RawFile {
    people: Option<Vec<RawPerson>>,
}

#[derive(Deserialize)]
struct RawPerson {
    pose_keypoints_2d: Option<Vec<Option<f64>>>,
}

/// Reads the keypoints of one camera and frame.
///
/// # Errors
/// JSON that is truncated or malformed, numbers out of range, keypoints that are no triples or do not fit the layout,
/// confidences outside the declared scale, and more people than [`limits::MAX_PEOPLE`].
pub fn read(name: &str, text: &str, options: &OpenposeOptions<'_>) -> Result<OpenposeFrame, Error> {
    let mut place = Place::file(name);
    if let Some(frame) = options.frame {
        place = place.within(format!("frame {frame}"));
    }
    people_of(&place, json_text::parse(name, text)?, options)
}

/// The people in a file.
pub(crate) fn people_of(place: &Place, raw: RawFile, options: &OpenposeOptions<'_>) -> Result<OpenposeFrame, Error> {
    let scale = options.confidence_scale;
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(place.clone().bad_value("confidence_scale", format!("{scale}"), "positive"));
    }
    let people = raw.people.ok_or_else(|| place.clone().lacks("people"))?;
    let is_there = |person: &&RawPerson| person.pose_keypoints_2d.as_ref().is_some_and(|numbers| !numbers.is_empty());
    check_count_of_people(place, people.iter().filter(is_there).count())?;
    let mut out = OpenposeFrame::default();
    for (index, person) in people.into_iter().enumerate() {
        let numbers = person.pose_keypoints_2d.unwrap_or_default();
        if numbers.is_empty() {
            continue;
        }
        check_count(place, numbers.len(), options.layout)?;
        let mut keypoints = Vec::with_capacity(numbers.len() / 3);
        for triple in numbers.chunks_exact(3) {
            if let &[x, y, confidence] = triple {
                keypoints.push(keypoint(place, [x, y, confidence], scale, &mut out)?);
            }
        }
        out.people.push(OpenposePerson { index, keypoints });
    }
    Ok(out)
}

fn check_count_of_people(place: &Place, found: usize) -> Result<(), Error> {
    limits::check_count(|| place.clone(), found, "people", limits::MAX_PEOPLE)
}

fn check_count(place: &Place, found: usize, layout: Option<&Layout>) -> Result<(), Error> {
    match layout {
        Some(layout) if found != layout.numbers() => Err(Error::KeypointCount {
            place: place.clone(),
            found,
            layout: layout.name.clone(),
            expected: layout.numbers(),
        }),
        None if !found.is_multiple_of(3) => Err(Error::NotTriples { place: place.clone(), found }),
        _ => Ok(()),
    }
}

/// Refuses people who do not fit the layout, and more of them than [`limits::MAX_PEOPLE`].
///
/// # Errors
/// [`Error::KeypointCount`] for the first of them, [`Error::TooMany`].
pub fn check_people(place: &Place, frame: &OpenposeFrame, layout: Option<&Layout>) -> Result<(), Error> {
    check_count_of_people(place, frame.people.len())?;
    frame.people.iter().try_for_each(|person| check_count(place, 3 * person.keypoints.len(), layout))
}

/// A keypoint of three numbers x, y, confidence, and what is odd about it; `None` is missing.
pub(crate) fn keypoint(
    place: &Place,
    [x, y, confidence]: [Option<f64>; 3],
    scale: f64,
    frame: &mut OpenposeFrame,
) -> Result<Option<Keypoint>, Error> {
    let Some(found) = confidence else { return Ok(None) };
    let confidence = found / scale;
    if !(0.0..=1.0).contains(&confidence) {
        return Err(Error::Confidence { place: place.clone(), found, scale });
    }
    if confidence == 0.0 {
        return Ok(None);
    }
    let (Some(x), Some(y)) = (x, y) else {
        frame.without_coordinates += 1;
        return Ok(None);
    };
    if x == 0.0 && y == 0.0 {
        frame.at_origin.get_or_insert(confidence);
    }
    Ok(Some(Keypoint { x, y, confidence }))
}

/// Writes a file that [`read`] and other programs read: `{}` for people that are absent, `0, 0, 0` for keypoints that are
/// missing or not finite. People must come by rising index, as they are read.
#[must_use]
pub fn write(people: &[OpenposePerson]) -> String {
    let mut entries: Vec<String> = Vec::new();
    for person in people {
        entries.resize(entries.len().max(person.index.min(MAX_ABSENT)), "{}".into());
        let finite = |point: &Keypoint| point.x.is_finite() && point.y.is_finite() && point.confidence.is_finite();
        let numbers = person.keypoints.iter().map(|point| match point.filter(finite) {
            Some(Keypoint { x, y, confidence }) => format!("{x:?},{y:?},{confidence:?}"),
            None => "0,0,0".into(),
        });
        let numbers: Vec<String> = numbers.collect();
        entries.push(format!("{{\"person_id\":[-1],\"pose_keypoints_2d\":[{}]}}", numbers.join(",")));
    }
    format!("{{\"version\":1.3,\"people\":[{}]}}\n", entries.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout;

    #[test]
    fn people_in_a_frame_have_a_bound() {
        let crowd = |there: usize, absent: usize| {
            let people = [vec!["{\"pose_keypoints_2d\":[1,2,0.5]}"; there], vec!["{}"; absent]].concat();
            read("a.json", &format!("{{\"people\":[{}]}}", people.join(",")), &OpenposeOptions::default())
        };
        assert_eq!(crowd(100, 200).unwrap().people.len(), 100);
        let refused = crowd(101, 0).unwrap_err().to_string();
        assert_eq!(refused, "a.json: more than 100 people, the most that are read");
    }

    fn one_person(numbers: &str) -> String {
        format!("{{\"version\":1.3,\"people\":[{{\"person_id\":[-1],\"pose_keypoints_2d\":[{numbers}]}}]}}")
    }

    fn check(numbers: &str, expected: &[Option<(f64, f64, f64)>]) -> OpenposeFrame {
        let frame = read("a.json", &one_person(numbers), &OpenposeOptions::default()).unwrap();
        let found: Vec<_> = frame.people[0].keypoints.iter().map(|k| k.map(|k| (k.x, k.y, k.confidence))).collect();
        assert_eq!(found, expected, "{numbers}");
        frame
    }

    #[test]
    fn every_way_to_be_missing() {
        check("0,0,0, 5,6,0, null,6,null", &[None, None, None]);
        let frame = check("null,6,0.5, 5,NaN,0.5, 5,6,NaN", &[None, None, None]);
        assert_eq!(frame.without_coordinates, 2);
        let frame = check("0,0,0.8, 0,1,0.2", &[Some((0.0, 0.0, 0.8)), Some((0.0, 1.0, 0.2))]);
        assert_eq!(frame.at_origin, Some(0.8));
    }

    #[test]
    fn absent_people_keep_their_place() {
        let text = "{\"people\":[{},{\"pose_keypoints_2d\":[]},{\"pose_keypoints_2d\":[1,2,1]}], \"other\": [[{}]]}";
        let frame = read("a.json", text, &OpenposeOptions::default()).unwrap();
        assert_eq!(frame.people.len(), 1);
        assert_eq!(frame.people[0].index, 2);
        assert!(read("a.json", "{\"people\":[]}", &OpenposeOptions::default()).unwrap().people.is_empty());
    }

    #[test]
    fn a_declared_scale_divides() {
        let options = OpenposeOptions { confidence_scale: 100.0, ..OpenposeOptions::default() };
        let frame = read("a.json", &one_person("1,2,87"), &options).unwrap();
        assert_eq!(frame.people[0].keypoints[0].unwrap().confidence, 0.87);
    }

    #[test]
    fn a_layout_fixes_the_count() {
        let layout = layout::find("BODY_25").unwrap();
        let options = OpenposeOptions { frame: Some(12), layout: Some(&layout), ..OpenposeOptions::default() };
        let error = read("cam01.0012.json", &one_person(&["1"; 51].join(",")), &options).unwrap_err();
        assert_eq!(error.to_string(), "cam01.0012.json (frame 12): 51 numbers, layout `BODY_25` needs 75");
    }

    #[test]
    fn a_tally_counts_and_names_the_first() {
        let mut tally = Tally::default();
        let odd = OpenposeFrame {
            without_coordinates: 3,
            at_origin: Some(0.5),
            people: vec![OpenposePerson { index: 0, keypoints: vec![] }],
        };
        tally.add(117, Some(&odd));
        tally.add(118, None);
        tally.add(119, Some(&OpenposeFrame::default()));
        let text: Vec<String> = tally.warnings("cam2").iter().map(ToString::to_string).collect();
        assert_eq!(text[0], "camera cam2: 2 of 3 frames have no person (first: 118)");
        assert_eq!(text[1], "3 points have no coordinates but confidence > 0; treated as missing");
        assert!(text[2].starts_with("point at exactly (0,0) with confidence 0.5 in 1 frames;"));
    }
}
