//! Landmarks of MediaPipe Pose as JSON, one file a video.
//!
//! MediaPipe has no file format of its own; programs store what it returns. A file is a list of frames, or an object that
//! holds the list under `frames`, `landmarks`, `pose_landmarks`, `poses`, `data` or `results`, or that has a frame under each
//! number.
//!
//! A frame has its 33 landmarks under one of [`KEYS`]. They are a list of landmarks, a list of such lists (people), or what
//! `MessageToDict` makes of `pose_landmarks`, `{"landmark": […]}`; a frame may be each of these itself. A landmark is
//! `{"x", "y", "z", "visibility"}` or a list of these numbers. The frame's number stands under one of [`NUMBERS`]; else
//! frames count from 0. Quirks that are ordinary input:
//!
//! - x and y are shares of the image's width and height. They are taken for pixels where most are above 2.
//! - Nobody: `null`, an empty list, or no landmarks. Where frames have numbers, a missing one is one without people.
//! - `visibility` is the confidence, 1 where there is none. All 33 points are always there; one outside the image is a
//!   guess of the model, not a sighting, and is missing.
//! - `z`, hands and face are ignored. Landmarks in the world (`pose_world_landmarks`) are no replacement for those in the
//!   image: a frame with nothing else is refused.
//!
//! ```
//! use sinew_formats::mediapipe_json::read;
//! let landmark = r#"{"x": 0.25, "y": 0.5, "z": -0.1, "visibility": 0.9}"#;
//! let landmarks = [landmark; 33].join(",");
//! let text = format!(r#"[{{"frame": 4, "pose_landmarks": [{landmarks}]}}, {{"frame": 5, "landmark": [{landmarks}]}}]"#);
//! let table = read("cam01.json", &text, 1.0)?;
//! assert!(table.in_image_shares);
//! assert_eq!(table.cameras[0].frames[&4].people[0].keypoints[32].unwrap().x, 0.25);
//! assert_eq!(table.cameras[0].frames[&5].people, table.cameras[0].frames[&4].people);
//! let unknown = read("cam01.json", r#"[{"joints": [{"x": 0.25, "y": 0.5}]}]"#, 1.0).unwrap_err();
//! assert!(unknown.to_string().starts_with("cam01.json (frame 0): the keys `joints`; expected landmarks under `pose_landmarks`,"));
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::json_text::{self, frame_number_of};
use crate::keypoint_table::{Frames, KeypointTable, TableCamera, add_person};
use crate::openpose::{OpenposeFrame, OpenposePerson, keypoint};
use crate::source_text::shortened;
use crate::{Error, Place, layout};
use serde_json::{Map, Value};

/// Keys under which a frame or a person may have landmarks.
pub const KEYS: [&str; 8] =
    ["pose_landmarks", "poseLandmarks", "landmarks", "landmark", "pose", "poses", "people", "keypoints"];

/// Keys under which a frame may have its number.
pub const NUMBERS: [&str; 11] = [
    "frame",
    "frame_id",
    "frame_index",
    "frame_idx",
    "frame_number",
    "frame_num",
    "frame_nr",
    "frame_no",
    "frameId",
    "frameIndex",
    "frameNumber",
];

/// Keys under which a file may have its frames.
const LISTS: [&str; 7] = ["frames", "landmarks", "pose_landmarks", "poseLandmarks", "poses", "data", "results"];

/// What else a frame may hold beside the landmarks of a pose.
const BESIDE: [&str; 2] = ["hand", "face"];

/// Landmarks of a person.
const POINTS: usize = 33;

/// Coordinates above this are pixels: shares reach it only far outside the image.
const PIXELS: f64 = 2.0;

#[derive(Clone, Copy)]
struct Landmark {
    x: Option<f64>,
    y: Option<f64>,
    visibility: Option<f64>,
}

/// A frame before it is known whether coordinates are shares or pixels.
struct RawFrame {
    number: u64,
    people: Vec<Vec<Landmark>>,
}

/// Whether a file begins with landmarks.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let has = |key: &str| beginning.contains(key);
    let is_named = ["\"pose_landmarks\"", "\"poseLandmarks\"", "\"landmarks\"", "\"landmark\""].into_iter().any(has);
    is_named || (has("\"visibility\"") && has("\"x\"") && has("\"y\""))
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, frames whose keys are unknown, other than 33 landmarks, a frame that is there twice,
/// visibilities outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let file: Value = json_text::parse(name, text)?;
    let mut found: Vec<RawFrame> = vec![];
    let mut has_numbers = false;
    for (index, (number, frame)) in listed(&file).into_iter().enumerate() {
        let place = |number: u64| Place::file(name).within(format!("frame {number}"));
        let own = match number {
            Some(number) => Some(number),
            None => own_number(&place(index as u64), frame)?,
        };
        has_numbers |= own.is_some();
        let number = own.unwrap_or(index as u64);
        found.push(RawFrame { number, people: people(&place(number), frame)? });
    }
    let coordinates =
        || found.iter().flat_map(|frame| frame.people.iter().flatten()).flat_map(|l| [l.x, l.y]).flatten();
    let above = coordinates().filter(|x| *x > PIXELS).count();
    let in_image_shares = 2 * above <= coordinates().count();
    let mut frames = Frames::new();
    for RawFrame { number, people } in found {
        let place = Place::file(name).within(format!("frame {number}"));
        if frames.contains_key(&number) {
            return Err(place.twice("frame", number.to_string()));
        }
        let frame = frames.entry(number).or_default();
        for landmarks in people {
            add(&place, frame, &landmarks, in_image_shares, confidence_scale)?;
        }
    }
    Ok(KeypointTable {
        layout: Some(layout::find("MEDIAPIPE_33")?),
        in_image_shares,
        leaves_out_nobody: has_numbers,
        ..KeypointTable::from_cameras(vec![TableCamera { name: None, frames }])
    })
}

/// The frames of a file, with their numbers where they are keys.
fn listed(file: &Value) -> Vec<(Option<u64>, &Value)> {
    let is_one = |items: &[Value]| items.first().is_some_and(is_landmark);
    match file {
        Value::Array(items) if !is_one(items) => items.iter().map(|frame| (None, frame)).collect(),
        Value::Object(map) => {
            let lists = LISTS.iter().filter_map(|key| map.get(*key));
            let mut lists = lists.filter(|list| match list {
                Value::Array(items) => !is_one(items),
                Value::Object(map) => is_numbered(map),
                _ => false,
            });
            match lists.next() {
                Some(list) => listed(list),
                None if is_numbered(map) => map.iter().map(|(key, frame)| (key.parse().ok(), frame)).collect(),
                None => vec![(None, file)],
            }
        }
        _ => vec![(None, file)],
    }
}

/// Whether an object has frames under their numbers.
fn is_numbered(map: &Map<String, Value>) -> bool {
    !map.is_empty() && map.keys().all(|key| key.parse::<u64>().is_ok())
}

/// The number that a frame states.
fn own_number(place: &Place, frame: &Value) -> Result<Option<u64>, Error> {
    let stated = NUMBERS.iter().find_map(|key| Some((*key, frame.get(*key).filter(|number| !number.is_null())?)));
    let Some((key, number)) = stated else { return Ok(None) };
    frame_number_of(number)
        .map(Some)
        .ok_or_else(|| place.clone().bad_value(key, shortened(&number.to_string()), "a whole number from 0"))
}

fn is_landmark(value: &Value) -> bool {
    match value {
        Value::Object(map) => map.contains_key("x") && map.contains_key("y"),
        Value::Array(numbers) => {
            numbers.len() >= 2 && numbers.iter().all(|number| number.is_number() || number.is_null())
        }
        _ => false,
    }
}

/// The people in a frame, or in what stands under one of its keys.
fn people(place: &Place, value: &Value) -> Result<Vec<Vec<Landmark>>, Error> {
    let expected = || format!("landmarks under `{}`", KEYS.join("`, `"));
    match value {
        Value::Null => Ok(vec![]),
        Value::Array(items) if items.first().is_some_and(is_landmark) => {
            Ok(vec![items.iter().map(|item| landmark(place, item)).collect::<Result<_, _>>()?])
        }
        Value::Array(items) => {
            let mut found = vec![];
            for item in items {
                found.extend(people(place, item)?);
            }
            Ok(found)
        }
        Value::Object(map) => match KEYS.iter().find_map(|key| map.get(*key)) {
            Some(landmarks) => people(place, landmarks),
            None => {
                let unknown: Vec<String> =
                    map.iter().filter(|(key, value)| is_content(key, value)).map(|(key, _)| shortened(key)).collect();
                if unknown.is_empty() {
                    return Ok(vec![]);
                }
                Err(place.clone().syntax(
                    format!("the keys `{}`", unknown.into_iter().take(LISTED).collect::<Vec<_>>().join("`, `")),
                    expected(),
                ))
            }
        },
        other => Err(place.clone().syntax(shortened(&other.to_string()), expected())),
    }
}

/// Unknown keys that are named.
const LISTED: usize = 5;

/// Whether a value is more than a number or a word about the frame, and not of hands or face.
fn is_content(key: &str, value: &Value) -> bool {
    let is_beside = BESIDE.iter().any(|part| key.to_lowercase().contains(part));
    let is_full = match value {
        Value::Array(items) => !items.is_empty(),
        Value::Object(map) => !map.is_empty(),
        _ => false,
    };
    is_full && !is_beside
}

fn landmark(place: &Place, value: &Value) -> Result<Landmark, Error> {
    if !is_landmark(value) {
        return Err(place.clone().syntax(shortened(&value.to_string()), "a landmark with x and y"));
    }
    let number = |key: &str, index: usize| value.get(key).or_else(|| value.get(index)).and_then(Value::as_f64);
    Ok(Landmark { x: number("x", 0), y: number("y", 1), visibility: number("visibility", 3) })
}

fn add(
    place: &Place,
    frame: &mut OpenposeFrame,
    landmarks: &[Landmark],
    in_image_shares: bool,
    scale: f64,
) -> Result<(), Error> {
    if landmarks.len() != POINTS {
        return Err(place.clone().syntax(format!("{} landmarks", landmarks.len()), format!("{POINTS}")));
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

    fn check(text: &str, expected: &[(u64, usize)]) {
        assert!(recognises(text), "{text}");
        assert_eq!(numbers(text), expected, "{text}");
    }

    #[test]
    fn every_form_is_read() {
        let one = landmarks(0.5, 0.25);
        check(&format!("[{one},null,[],{one}]"), &[(0, 1), (1, 0), (2, 0), (3, 1)]);
        check(&format!("{{\"fps\":30,\"frames\":[{{\"frame_index\":7,\"landmarks\":{one}}}]}}"), &[(7, 1)]);
        check(&format!("[{{\"poseLandmarks\":[{one},{one}]}},{{\"poseLandmarks\":null}}]"), &[(0, 2), (1, 0)]);
        check(&format!("[{{\"pose_landmarks\":{{\"landmark\":{one}}}}}]"), &[(0, 1)]);
    }

    #[test]
    fn messages_as_protobuf_turns_them_into_objects_are_frames() {
        let one = landmarks(0.5, 0.25);
        check(&format!("[{{\"landmark\":{one}}},{{}},{{\"landmark\":{one}}}]"), &[(0, 1), (1, 0), (2, 1)]);
        check(
            &format!("{{\"pose_landmarks\":{{\"landmark\":{one}}},\"face_landmarks\":{{\"landmark\":[1]}}}}"),
            &[(0, 1)],
        );
        check(
            &format!("[{{\"pose\":{one},\"left_hand\":[{{\"x\":1,\"y\":1}}]}},{{\"right_hand\":[1]}}]"),
            &[(0, 1), (1, 0)],
        );
    }

    #[test]
    fn files_of_other_programs_are_read() {
        let one = landmarks(0.5, 0.25);
        check(&format!("{{\"fps\":30,\"landmarks\":[{{\"frame\":2,\"pose_landmarks\":{one}}}]}}"), &[(2, 1)]);
        check(&format!("{{\"frames\":[{{\"ts_ms\":0,\"poses\":[{one},{one}]}},{{\"poses\":[]}}]}}"), &[(0, 2), (1, 0)]);
        check(
            &format!("[{{\"frame_num\":3,\"landmarks\":{one}}},{{\"frame_nr\":5.0,\"landmarks\":{one}}}]"),
            &[(3, 1), (5, 1)],
        );
        check(&format!("{{\"0\":{{\"landmarks\":{one}}},\"2\":null}}"), &[(0, 1), (2, 0)]);
        check(&one, &[(0, 1)]);
        let lists = vec!["[0.5,0.25,-0.1,0.9]"; POINTS].join(",");
        check(
            &format!("{{\"metadata\":{{\"fps\":30}},\"frames\":[{{\"timestamp\":0,\"pose_landmarks\":[{lists}]}}]}}"),
            &[(0, 1)],
        );
        let table = read("a.json", &format!("[{{\"pose_landmarks\":[{lists}]}}]"), 1.0).unwrap();
        let point = table.cameras[0].frames[&0].people[0].keypoints[7].unwrap();
        assert_eq!((point.x, point.y, point.confidence), (0.5, 0.25, 0.9));
    }

    #[test]
    fn missing_numbers_are_frames_without_people() {
        let one = landmarks(0.5, 0.25);
        let leaves_out = |text: String| read("a.json", &text, 1.0).unwrap().leaves_out_nobody;
        assert!(leaves_out(format!("[{{\"frame\":2,\"landmarks\":{one}}}]")));
        assert!(!leaves_out(format!("[{{\"landmarks\":{one}}}]")));
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
        let keys = "`pose_landmarks`, `poseLandmarks`, `landmarks`, `landmark`, `pose`, `poses`, `people`, `keypoints`";
        assert_eq!(message("[[{\"x\":0.1,\"y\":0.2}]]"), "a.json (frame 0): 1 landmarks; expected 33");
        let twice =
            format!("[{{\"frame\":2,\"landmarks\":{0}}},{{\"frame\":2,\"landmarks\":{0}}}]", landmarks(0.1, 0.1));
        assert_eq!(message(&twice), "a.json (frame 2): the frame `2` is there twice");
        assert_eq!(
            message("[{\"frame\":1},{\"frame\":2,\"joints\":[[1,2]],\"pose_world_landmarks\":[[1,2,3]]}]"),
            format!("a.json (frame 2): the keys `joints`, `pose_world_landmarks`; expected landmarks under {keys}")
        );
        assert_eq!(message("[7]"), format!("a.json (frame 0): 7; expected landmarks under {keys}"));
        assert_eq!(
            message("[[{\"x\":0.1,\"y\":0.2},{\"x\":0.1}]]"),
            "a.json (frame 0): {\"x\":0.1}; expected a landmark with x and y"
        );
        assert_eq!(
            message("[{\"frame\":-1,\"landmarks\":[]}]"),
            "a.json (frame 0): frame = -1; must be a whole number from 0"
        );
    }
}
