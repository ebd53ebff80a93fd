//! What RTMLib returns of each frame, stored as JSON, one file a video.
//!
//! RTMLib has no file format of its own. It returns two arrays a frame, `keypoints` (people × points × 2, pixels) and `scores`
//! (people × points). A file is a list of frames with these two, or an object that holds the list under `frames`:
//!
//! ```python
//! model, video, frames = rtmlib.BodyWithFeet(), cv2.VideoCapture("cam01.mp4"), []
//! while (image := video.read()[1]) is not None:
//!     keypoints, scores = model(image)
//!     frames.append({"keypoints": keypoints.tolist(), "scores": scores.tolist()})
//! json.dump(frames, open("keypoints/cam01.json", "w"))
//! ```
//!
//! Quirks that are ordinary input:
//!
//! - A frame may have its number under `frame`, `frame_id`, `frame_index` or `frame_idx`; else frames count from 0.
//! - Scores are heights of the detector's maps: above 1, up to 2, counts as 1, and 0 or less as not found.
//! - A frame with empty lists is one without people.
//!
//! ```
//! use sinew_formats::rtmlib_json::read;
//! let text = r#"[{"keypoints": [[[10, 20.5], [1, 2]]], "scores": [[1.1, 0.0]]}, {"keypoints": [], "scores": []}]"#;
//! let table = read("cam01.json", text, 1.0)?;
//! let frames = &table.cameras[0].frames;
//! let person = &frames[&0].people[0];
//! assert_eq!((person.keypoints[0].unwrap().y, person.keypoints[0].unwrap().confidence), (20.5, 1.0));
//! assert!(person.keypoints[1].is_none() && frames[&1].people.is_empty());
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::keypoint_table::{Frames, KeypointTable, add_scored_person};
use crate::{Error, Place, json_text, source_text};
use serde::Deserialize;

#[derive(Deserialize)]
struct File {
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    #[serde(alias = "frame_id", alias = "frame_index", alias = "frame_idx")]
    frame: Option<u64>,
    keypoints: Option<Vec<Vec<Vec<Option<f64>>>>>,
    scores: Option<Vec<Vec<Option<f64>>>>,
}

/// Whether a file begins with frames of this form.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let has = |key: &str| beginning.contains(key);
    let is_other = ["\"keypoint_scores\"", "\"instances\"", "\"image_id\""].into_iter().any(has);
    has("\"keypoints\"") && has("\"scores\"") && !is_other
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, a frame that is there twice, points without two coordinates, scores that are not as
/// many as the people and their points or outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let is_list = source_text::without_mark(text).trim_start().starts_with('[');
    let raw: Vec<Frame> =
        if is_list { json_text::parse(name, text)? } else { json_text::parse::<File>(name, text)?.frames };
    let mut frames = Frames::new();
    for (index, Frame { frame, keypoints, scores }) in raw.into_iter().enumerate() {
        let number = frame.unwrap_or(index as u64);
        let place = Place::file(name).within(format!("frame {number}"));
        if frames.contains_key(&number) {
            return Err(place.twice("frame", number.to_string()));
        }
        let frame = frames.entry(number).or_default();
        let people = keypoints.unwrap_or_default();
        let missing = || place.clone().lacks("scores");
        let scores = if people.is_empty() { vec![] } else { scores.ok_or_else(missing)? };
        if scores.len() != people.len() {
            return Err(Error::RowLength { place, found: scores.len(), expected: people.len() });
        }
        for (points, scores) in people.iter().zip(&scores) {
            add_scored_person(&place, frame, points, scores, confidence_scale)?;
        }
    }
    Ok(KeypointTable::from_one_camera(frames))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(read("a.json", text, 1.0).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn frames_have_people_by_their_arrays() {
        let two = r#"{"keypoints":[[[1,2],[3,4]],[[5,6],[7,8]]],"scores":[[0.5,-0.1],[NaN,0.25]]}"#;
        for text in [
            format!("[{two},{{\"frame_idx\":9,\"keypoints\":null}}]"),
            format!("{{\"frames\":[{two},{{\"frame\":9}}]}}"),
        ] {
            let frames = read("a.json", &text, 1.0).unwrap().cameras.remove(0).frames;
            let first = &frames[&0].people;
            assert_eq!((first[0].keypoints[0].unwrap().x, first[0].keypoints[1]), (1.0, None));
            assert_eq!((first[1].keypoints[0], first[1].keypoints[1].unwrap().confidence), (None, 0.25));
            assert!(frames[&9].people.is_empty() && frames.len() == 2);
        }
    }

    #[test]
    fn faults_are_named() {
        check("[{\"keypoints\":[[[1,2]]]}]", "a.json (frame 0): `scores` is missing");
        check("[{\"keypoints\":[[[1,2]]],\"scores\":[]}]", "a.json (frame 0): 0 values; expected 1");
        check("[{\"keypoints\":[[[1,2]]],\"scores\":[[1,1]]}]", "a.json (frame 0): 2 values; expected 1");
        check(
            "[{\"keypoints\":[[[1,2,3]]],\"scores\":[[1]]}]",
            "a.json (frame 0): a point with 3 coordinates; expected x and y",
        );
        check("[{\"frame\":3},{\"frame_id\":3}]", "a.json (frame 3): the frame `3` is there twice");
    }
}
