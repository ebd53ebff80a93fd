//! COCO results: a JSON list with an entry for each person and image. AlphaPose writes the same with names of images.
//!
//! `[{"image_id": 12, "category_id": 1, "keypoints": [x, y, score, …], "score": 0.9}, …]`; x and y in pixels. One file holds one
//! camera. The frame is `image_id`, or of a name the last number in it: `"0012.jpg"`. Quirks that are ordinary input:
//!
//! - Scores are heights of the detector's maps: above 1, up to 2, counts as 1, and 0 or less as not found. Older
//!   versions of AlphaPose go up to 6: declare the scale.
//! - An image without people has no entry: its frame is missing.
//! - `category_id` other than 1 is no person and left out. `box`, `bbox`, `idx` and others are ignored.
//!
//! ```
//! use sinew_formats::coco_results::read;
//! let text = r#"[{"image_id": "7.jpg", "category_id": 1, "keypoints": [10, 20.5, 1.2, 0, 0, 0], "score": 2.8}]"#;
//! let table = read("alphapose-results.json", text, 1.0)?;
//! let person = &table.cameras[0].frames[&7].people[0];
//! assert_eq!((person.keypoints[0].unwrap().y, person.keypoints[0].unwrap().confidence), (20.5, 1.0));
//! assert!(person.keypoints[1].is_none());
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::keypoint_table::{Frames, KeypointTable, add_person, height_as_confidence};
use crate::openpose::{OpenposePerson, keypoint};
use crate::source_text::shortened;
use crate::{Error, Place, frame_number, json_text};
use serde::Deserialize;

/// Category of people in COCO.
const PERSON: i64 = 1;

#[derive(Deserialize)]
struct Entry {
    image_id: Option<ImageId>,
    category_id: Option<i64>,
    keypoints: Option<Vec<Option<f64>>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum ImageId {
    Number(u64),
    Name(String),
}

/// Whether a file begins with a list of such entries.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    beginning.starts_with('[') && beginning.contains("\"image_id\"") && beginning.contains("\"keypoints\"")
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, entries without an image, images without a number, keypoints that are no triples,
/// scores outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let entries: Vec<Entry> = json_text::parse(name, text)?;
    let mut frames = Frames::new();
    for (index, entry) in entries.into_iter().enumerate() {
        let mut place = Place::file(name).within(format!("entry {}", index + 1));
        if entry.category_id.is_some_and(|category| category != PERSON) {
            continue;
        }
        let number = match entry.image_id {
            Some(ImageId::Number(number)) => number,
            Some(ImageId::Name(image)) => frame_number::parse(&image).ok_or_else(|| {
                let (found, expected) =
                    (format!("image `{}`", shortened(&image)), "a name with the frame, as `0012.jpg`");
                Error::Syntax { place: place.clone(), found, expected: expected.into() }
            })?,
            None => return Err(Error::MissingField { place, field: "image_id".into() }),
        };
        place = place.within(format!("frame {number}"));
        let numbers = entry.keypoints.unwrap_or_default();
        if !numbers.len().is_multiple_of(3) {
            return Err(Error::NotTriples { place, found: numbers.len() });
        }
        let frame = frames.entry(number).or_default();
        let mut keypoints = Vec::with_capacity(numbers.len() / 3);
        for triple in numbers.chunks_exact(3) {
            if let &[x, y, score] = triple {
                let confidence = score.map(|score| height_as_confidence(score, confidence_scale));
                keypoints.push(keypoint(&place, [x, y, confidence], confidence_scale, frame)?);
            }
        }
        add_person(frame, OpenposePerson { index: 0, keypoints });
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
    fn people_of_an_image_keep_their_order() {
        let text = r#"[{"image_id":3,"category_id":1,"keypoints":[1,2,0.5]},{"image_id":1,"keypoints":[NaN,2,0.5,1,1,-0.1]},
            {"image_id":3,"category_id":18,"keypoints":[9,9,1]},{"image_id":3,"category_id":1,"keypoints":[3,4,1],"idx":[1.0]}]"#;
        let frames = read("a.json", text, 1.0).unwrap().cameras.remove(0).frames;
        let xs: Vec<_> = frames[&3].people.iter().map(|p| (p.index, p.keypoints[0].unwrap().x)).collect();
        assert_eq!(xs, [(0, 1.0), (1, 3.0)]);
        assert!(frames[&1].people.is_empty() && frames[&1].without_coordinates == 1);
    }

    #[test]
    fn faults_are_named() {
        check("[{\"keypoints\":[1,2,3]}]", "a.json (entry 1): `image_id` is missing");
        check(
            "[{\"image_id\":4,\"keypoints\":[1,2]}]",
            "a.json (frame 4): 2 numbers; keypoints are triples x, y, confidence",
        );
        check(
            "[{\"image_id\":4,\"keypoints\":[1,2,5.5]}]",
            "a.json (frame 4): confidence 5.5 found; expected 0 to 1; set `confidence_scale = 100`",
        );
        check(
            "[{\"image_id\":\"a.jpg\",\"keypoints\":[1,2,3]}]",
            "a.json (entry 1): image `a.jpg`; expected a name with the frame, as `0012.jpg`",
        );
    }
}
