//! COCO results: a JSON list with an entry for each person and image. AlphaPose writes the same with names of images.
//!
//! `[{"image_id": 12, "category_id": 1, "keypoints": [x, y, score, …], "score": 0.9}, …]`; x and y in pixels. One file holds one
//! camera. The frame is `image_id`, or of a name the last number in it: `"0012.jpg"`. Quirks that are ordinary input:
//!
//! - Scores are heights of the detector's maps: above 1, up to 2, counts as 1, and 0 or less as not found. Older
//!   versions of AlphaPose go up to 6: declare the scale.
//! - An image without people has no entry. A missing frame is one without people, and a file `[]` a camera that saw nobody.
//! - Entries with a `category_id` other than 1 are no people, those without `keypoints` say nothing: both are left out,
//!   counted in a warning. `box`, `bbox`, `idx` and others are ignored.
//!
//! ```
//! use sinew_formats::coco_results::read;
//! let text = r#"[{"image_id": "7.jpg", "category_id": 1, "keypoints": [10, 20.5, 1.2, 0, 0, 0], "score": 2.8},
//!     {"image_id": "7.jpg", "category_id": 18, "keypoints": [1, 1, 1]}]"#;
//! let table = read("alphapose-results.json", text, 1.0)?;
//! let person = &table.cameras[0].frames[&7].people[0];
//! assert_eq!((person.keypoints[0].unwrap().y, person.keypoints[0].unwrap().confidence), (20.5, 1.0));
//! assert!(person.keypoints[1].is_none() && table.leaves_out_nobody);
//! assert_eq!(table.warnings[0].to_string(), "alphapose-results.json: 1 entry is left out: `category_id` is not 1, a person's");
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::json_text::{self, frame_number_of};
use crate::keypoint_table::{Frames, KeypointTable, add_person, height_as_confidence};
use crate::openpose::{OpenposeFrame, OpenposePerson, keypoint};
use crate::source_text::shortened;
use crate::{Error, Place, Warning};
use serde::Deserialize;
use serde_json::Value;

/// Category of people in COCO.
const PERSON: f64 = 1.0;

#[derive(Deserialize)]
struct Entry {
    image_id: Option<Value>,
    category_id: Option<f64>,
    keypoints: Option<Vec<Option<f64>>>,
}

/// Whether a file begins with a list of such entries, or is an empty list.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let is_list = beginning.starts_with('[');
    (is_list && beginning.contains("\"image_id\"") && beginning.contains("\"keypoints\"")) || is_empty_list(beginning)
}

/// Whether a file holds an empty list: a camera that saw nobody.
#[must_use]
pub fn is_empty_list(text: &str) -> bool {
    let inside = text.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    inside.is_some_and(|inside| inside.trim().is_empty())
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, entries without an image, images without a number, keypoints that are no triples,
/// scores outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let entries: Vec<Entry> = json_text::parse(name, text)?;
    let mut frames = Frames::new();
    let (mut others, mut bare) = (0, 0);
    for (index, entry) in entries.into_iter().enumerate() {
        let place = Place::file(name).within(format!("entry {}", index + 1));
        let number = image_number(&place, entry.image_id)?;
        let frame = frames.entry(number).or_default();
        if entry.category_id.is_some_and(|category| category != PERSON) {
            others += 1;
            continue;
        }
        let Some(numbers) = entry.keypoints else {
            bare += 1;
            continue;
        };
        add_entry(&place.within(format!("frame {number}")), frame, &numbers, confidence_scale)?;
    }
    let reasons = [(others, "`category_id` is not 1, a person's"), (bare, "without `keypoints`")];
    let left_out = reasons.into_iter().filter(|(entries, _)| *entries > 0);
    let warning = |(entries, why)| Warning::EntriesLeftOut { place: Place::file(name), entries, why };
    Ok(KeypointTable {
        leaves_out_nobody: true,
        warnings: left_out.map(warning).collect(),
        ..KeypointTable::from_one_camera(frames)
    })
}

/// The frame of an image.
fn image_number(place: &Place, image: Option<Value>) -> Result<u64, Error> {
    let Some(image) = image else {
        return Err(place.clone().lacks("image_id"));
    };
    frame_number_of(&image).ok_or_else(|| {
        place.clone().bad_value(
            "image_id",
            shortened(&image.to_string()),
            "a whole number from 0, or a name with the frame, as \"0012.jpg\"",
        )
    })
}

fn add_entry(place: &Place, frame: &mut OpenposeFrame, numbers: &[Option<f64>], scale: f64) -> Result<(), Error> {
    if !numbers.len().is_multiple_of(3) {
        return Err(Error::NotTriples { place: place.clone(), found: numbers.len() });
    }
    let mut keypoints = Vec::with_capacity(numbers.len() / 3);
    for triple in numbers.chunks_exact(3) {
        if let &[x, y, score] = triple {
            let confidence = score.map(|score| height_as_confidence(score, scale));
            keypoints.push(keypoint(place, [x, y, confidence], scale, frame)?);
        }
    }
    add_person(frame, OpenposePerson { index: 0, keypoints });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(read("a.json", text, 1.0).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn people_of_an_image_keep_their_order() {
        let text = r#"[{"image_id":3,"category_id":1,"keypoints":[1,2,0.5]},{"image_id":1.0,"keypoints":[NaN,2,0.5,1,1,-0.1]},
            {"image_id":3,"category_id":18,"keypoints":[9,9,1]},{"image_id":3,"category_id":1,"keypoints":[3,4,1],"idx":[1.0]}]"#;
        let frames = read("a.json", text, 1.0).unwrap().cameras.remove(0).frames;
        let xs: Vec<_> = frames[&3].people.iter().map(|p| (p.index, p.keypoints[0].unwrap().x)).collect();
        assert_eq!(xs, [(0, 1.0), (1, 3.0)]);
        assert!(frames[&1].people.is_empty() && frames[&1].without_coordinates == 1);
    }

    #[test]
    fn entries_left_out_are_counted() {
        let text = r#"[{"image_id":3,"category_id":18,"keypoints":[9,9,1]},{"image_id":4,"keypoints":null},
            {"image_id":5,"bbox":[0,0,1,1]},{"image_id":5,"keypoints":[1,2,1]}]"#;
        let table = read("a.json", text, 1.0).unwrap();
        let warnings: Vec<String> = table.warnings.iter().map(ToString::to_string).collect();
        let wanted =
            ["1 entry is left out: `category_id` is not 1, a person's", "2 entries are left out: without `keypoints`"];
        assert_eq!(warnings, wanted.map(|text| format!("a.json: {text}")));
        assert_eq!(table.cameras[0].frames.keys().collect::<Vec<_>>(), [&3, &4, &5]);
    }

    #[test]
    fn an_empty_list_is_a_camera_that_saw_nobody() {
        for text in ["[]", " [ \n]\n"] {
            assert!(recognises(text.trim_start()));
            let table = read("a.json", text, 1.0).unwrap();
            assert!(table.leaves_out_nobody && table.cameras[0].frames.is_empty() && table.warnings.is_empty());
        }
        assert!(!is_empty_list("[1]") && !is_empty_list("{}") && !is_empty_list("["));
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
        for image in ["\"a.jpg\"", "-1", "3.5", "[3]", "1e300"] {
            let shown = if image == "1e300" { "1e+300" } else { image };
            check(
                &format!("[{{\"image_id\":{image},\"keypoints\":[1,2,3]}}]"),
                &format!(
                    "a.json (entry 1): image_id = {shown}; must be a whole number from 0, or a name with the frame, as \"0012.jpg\""
                ),
            );
        }
    }
}
