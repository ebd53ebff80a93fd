//! Landmarks of MediaPipe Pose as JSON, one file a video.
//!
//! MediaPipe has no file format of its own; programs store what it returns. A file is a list of frames, or an object that
//! holds it under `frames`. A frame has its 33 landmarks under `pose_landmarks`, `poseLandmarks` or `landmarks`: a list of
//! `{"x", "y", "z", "visibility"}`, a list of such lists (people), or `{"landmark": […]}`. It may be the list of landmarks
//! itself, and may have its number under `frame`, `frame_id`, `frame_index` or `frame_number`; else frames count from 0.
//! Quirks that are ordinary input:
//!
//! - x and y are shares of the image's width and height. They are taken for pixels where most are above 2.
//! - Nobody: `null`, an empty list, or no landmarks.
//! - `visibility` is the confidence, 1 where there is none. All 33 points are always there; one outside the image is a
//!   guess of the model, not a sighting, and is missing.
//! - `z` and landmarks in the world (`pose_world_landmarks`) are ignored: their depth comes from one image.
//!
//! ```
//! use sinew_formats::mediapipe_json::read;
//! let landmark = r#"{"x": 0.25, "y": 0.5, "z": -0.1, "visibility": 0.9}"#;
//! let text = format!(r#"[{{"frame": 4, "pose_landmarks": [{}]}}]"#, [landmark; 33].join(","));
//! let table = read("cam01.json", &text, 1.0)?;
//! assert!(table.in_image_shares);
//! assert_eq!(table.cameras[0].frames[&4].people[0].keypoints[32].unwrap().x, 0.25);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::keypoint_table::{Frames, KeypointTable, TableCamera, add_person};
use crate::openpose::{OpenposeFrame, OpenposePerson, keypoint};
use crate::{Error, Place, json_text, layout};
use serde::Deserialize;

/// Landmarks of a person.
const POINTS: usize = 33;

/// Coordinates above this are pixels: shares reach it only far outside the image.
const PIXELS: f64 = 2.0;

#[derive(Deserialize)]
#[serde(untagged)]
enum File {
    Frames(Vec<RawFrame>),
    Named {
        #[serde(alias = "poses")]
        frames: Vec<RawFrame>,
    },
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawFrame {
    Bare(Vec<Landmark>),
    Named {
        #[serde(alias = "frame_id", alias = "frame_index", alias = "frame_number", alias = "frame_idx")]
        frame: Option<u64>,
        #[serde(alias = "poseLandmarks", alias = "landmarks")]
        pose_landmarks: Option<Landmarks>,
    },
    Nobody(()),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Landmarks {
    Person(Vec<Landmark>),
    People(Vec<Vec<Landmark>>),
    Wrapped { landmark: Vec<Landmark> },
}

#[derive(Clone, Copy, Deserialize)]
struct Landmark {
    x: Option<f64>,
    y: Option<f64>,
    visibility: Option<f64>,
}

/// Whether a file begins with landmarks.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let has = |key: &str| beginning.contains(key);
    let is_named = ["\"pose_landmarks\"", "\"poseLandmarks\"", "\"landmarks\""].into_iter().any(has);
    (is_named || has("\"visibility\"")) && has("\"x\"") && has("\"y\"")
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, other than 33 landmarks, a frame that is there twice, visibilities outside the
/// declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let (File::Frames(raw) | File::Named { frames: raw }) = json_text::parse(name, text)?;
    let mut found: Vec<(u64, Vec<Vec<Landmark>>)> = Vec::with_capacity(raw.len());
    for (index, frame) in raw.into_iter().enumerate() {
        let (number, people) = people(index as u64, frame);
        found.push((number, people));
    }
    let coordinates =
        || found.iter().flat_map(|(_, people)| people.iter().flatten()).flat_map(|l| [l.x, l.y]).flatten();
    let above = coordinates().filter(|x| *x > PIXELS).count();
    let in_image_shares = 2 * above <= coordinates().count();
    let mut frames = Frames::new();
    for (number, people) in found {
        let place = Place::file(name).within(format!("frame {number}"));
        if frames.contains_key(&number) {
            return Err(Error::DuplicateName { place, what: "frame", name: number.to_string() });
        }
        let frame = frames.entry(number).or_default();
        for landmarks in people {
            add(&place, frame, &landmarks, in_image_shares, confidence_scale)?;
        }
    }
    let cameras = vec![TableCamera { name: None, frames }];
    Ok(KeypointTable { layout: Some(layout::find("MEDIAPIPE_33")?), in_image_shares, cameras })
}

/// Number and people of a frame.
fn people(index: u64, frame: RawFrame) -> (u64, Vec<Vec<Landmark>>) {
    match frame {
        RawFrame::Nobody(()) => (index, vec![]),
        RawFrame::Bare(landmarks) => (index, vec![landmarks]),
        RawFrame::Named { frame, pose_landmarks } => {
            let people = match pose_landmarks {
                None => vec![],
                Some(Landmarks::Person(landmarks) | Landmarks::Wrapped { landmark: landmarks }) => vec![landmarks],
                Some(Landmarks::People(people)) => people,
            };
            (frame.unwrap_or(index), people)
        }
    }
}

fn add(
    place: &Place,
    frame: &mut OpenposeFrame,
    landmarks: &[Landmark],
    in_image_shares: bool,
    scale: f64,
) -> Result<(), Error> {
    if landmarks.is_empty() {
        return Ok(());
    }
    if landmarks.len() != POINTS {
        let (found, expected) = (format!("{} landmarks", landmarks.len()), format!("{POINTS}"));
        return Err(Error::Syntax { place: place.clone(), found, expected });
    }
    let mut keypoints = Vec::with_capacity(POINTS);
    for &Landmark { x, y, visibility } in landmarks {
        let is_outside = in_image_shares && [x, y].into_iter().flatten().any(|share| !(0.0..=1.0).contains(&share));
        let confidence = if is_outside { Some(0.0) } else { Some(visibility.unwrap_or(scale)) };
        keypoints.push(keypoint(place, [x, y, confidence], scale, frame)?);
    }
    add_person(frame, OpenposePerson { index: 0, keypoints });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landmarks(x: f64, y: f64) -> String {
        format!("[{}]", vec![format!("{{\"x\":{x},\"y\":{y},\"visibility\":0.5}}"); POINTS].join(","))
    }

    fn numbers(text: &str) -> Vec<(u64, usize)> {
        let frames = read("a.json", text, 1.0).unwrap().cameras.remove(0).frames;
        frames.iter().map(|(number, frame)| (*number, frame.people.len())).collect()
    }

    #[test]
    fn every_form_is_read() {
        let one = landmarks(0.5, 0.25);
        assert_eq!(numbers(&format!("[{one},null,[],{one}]")), [(0, 1), (1, 0), (2, 0), (3, 1)]);
        assert_eq!(
            numbers(&format!("{{\"fps\":30,\"frames\":[{{\"frame_index\":7,\"landmarks\":{one}}}]}}")),
            [(7, 1)]
        );
        assert_eq!(
            numbers(&format!("[{{\"poseLandmarks\":[{one},{one}]}},{{\"poseLandmarks\":null}}]")),
            [(0, 2), (1, 0)]
        );
        assert_eq!(numbers(&format!("[{{\"pose_landmarks\":{{\"landmark\":{one}}}}}]")), [(0, 1)]);
    }

    #[test]
    fn pixels_and_shares_are_distinguished() {
        let pixels = read("a.json", &format!("[{}]", landmarks(640.0, 360.0)), 1.0).unwrap();
        assert!(!pixels.in_image_shares);
        let outside = format!("[{},{}]", landmarks(0.5, 1.2), landmarks(0.5, 0.2));
        assert_eq!(numbers(&outside), [(0, 0), (1, 1)]);
    }

    #[test]
    fn faults_are_named() {
        let message = |text: &str| read("a.json", text, 1.0).unwrap_err().to_string();
        assert_eq!(message("[[{\"x\":0.1,\"y\":0.2}]]"), "a.json (frame 0): 1 landmarks; expected 33");
        let twice =
            format!("[{{\"frame\":2,\"landmarks\":{0}}},{{\"frame\":2,\"landmarks\":{0}}}]", landmarks(0.1, 0.1));
        assert_eq!(message(&twice), "a.json (frame 2): the frame `2` is there twice");
    }
}
