//! Frames as they come: one line of JSON a frame, with what all cameras saw.
//!
//! ```text
//! {"frame": 12, "cameras": {"C1": {"people": [{"pose_keypoints_2d": [x, y, confidence, …]}]}, "C2": null}}
//! ```
//!
//! What stands for a camera is what a file of [`openpose`](crate::openpose) holds, and is read by the same rules. A camera that is `null` or left out
//! sent nothing in that frame. Other fields are ignored.
//!
//! ```
//! use sinew_formats::live_frame::read;
//! use sinew_formats::openpose::OpenposeOptions;
//! let line = r#"{"frame": 12, "cameras": {"C1": {"people": [{"pose_keypoints_2d": [10.5, 20.0, 0.9]}]}, "C2": null}}"#;
//! let frame = read("line 1", line, &OpenposeOptions::default())?;
//! assert_eq!((frame.number, frame.cameras.len()), (12, 2));
//! assert_eq!(frame.cameras[0].1.as_ref().map(|seen| seen.people.len()), Some(1));
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::limits::MAX_LIVE_CAMERAS;
use crate::openpose::{OpenposeFrame, OpenposeOptions, RawFile, people_of};
use crate::{Error, Place, json_text};
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, Visitor};
use std::fmt;

/// A frame of all cameras.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveFrame {
    /// Its number.
    pub number: u64,
    /// Cameras by name, in the order of the line; none in place of what a camera did not send.
    pub cameras: Vec<(String, Option<OpenposeFrame>)>,
}

#[derive(serde::Deserialize)]
#[serde(expecting = "a frame")]
struct RawLine {
    frame: Option<u64>,
    cameras: Option<Entries>,
}

/// The members of an object in their order, repeated ones included.
struct Entries(Vec<(String, Option<RawFile>)>);

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Entries;
            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("an object with cameras by name")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    if entries.len() == MAX_LIVE_CAMERAS {
                        return Err(A::Error::custom(format_args!("more than {MAX_LIVE_CAMERAS} cameras")));
                    }
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// Reads a line; `name` is its place for messages.
///
/// # Errors
/// JSON that is truncated or malformed, a line without number or cameras, more than [`MAX_LIVE_CAMERAS`] cameras, one that
/// is there twice, and what [`read`](crate::openpose::read) refuses of a camera.
pub fn read(name: &str, line: &str, options: &OpenposeOptions<'_>) -> Result<LiveFrame, Error> {
    let raw: RawLine = json_text::parse(name, line)?;
    let missing = |field: &str| Place::file(name).lacks(field);
    let number = raw.frame.ok_or_else(|| missing("frame"))?;
    let Entries(entries) = raw.cameras.ok_or_else(|| missing("cameras"))?;
    let mut cameras: Vec<(String, Option<OpenposeFrame>)> = Vec::with_capacity(entries.len());
    for (camera, seen) in entries {
        if cameras.iter().any(|(name, _)| *name == camera) {
            return Err(Place::file(name).twice("camera", camera));
        }
        let place = || Place::file(name).within(format!("frame {number}, {camera}"));
        let seen = seen.map(|raw| people_of(&place(), raw, options)).transpose()?;
        cameras.push((camera, seen));
    }
    Ok(LiveFrame { number, cameras })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(line: &str) -> String {
        read("line 7", line, &OpenposeOptions::default()).unwrap_err().to_string()
    }

    #[test]
    fn a_wrong_line_is_refused_in_words() {
        let cases = [
            (r#"{"frame": 1, "cameras": {"C1": "#, "line 7: ends inside an object at byte 31 (line 1)"),
            (r#"{"cameras": {}}"#, "line 7: `frame` is missing"),
            (r#"{"frame": 4}"#, "line 7: `cameras` is missing"),
            (r#"{"frame": 4, "cameras": {"C1": {}}}"#, "line 7 (frame 4, C1): `people` is missing"),
            (r#"{"frame": 4, "cameras": {"C1": null, "C1": null}}"#, "line 7: the camera `C1` is there twice"),
        ];
        for (line, expected) in cases {
            assert_eq!(refused(line), expected);
        }
        assert!(refused(r#"{"frame": -4, "cameras": {}}"#).contains("-4"));
        assert!(refused(r#"{"frame": 4, "cameras": [1]}"#).contains("expected"));
        let two = r#"{"frame": 4, "cameras": {"C1": {"people": [{"pose_keypoints_2d": [1, 2]}]}}}"#;
        assert!(refused(two).starts_with("line 7 (frame 4, C1): 2 numbers"));
    }

    #[test]
    fn cameras_and_people_in_a_line_have_bounds() {
        let line = |cameras: usize| {
            let cameras: Vec<String> = (0..cameras).map(|k| format!("\"C{k}\":null")).collect();
            format!("{{\"frame\": 4, \"cameras\": {{{}}}}}", cameras.join(","))
        };
        assert_eq!(read("line 7", &line(1000), &OpenposeOptions::default()).unwrap().cameras.len(), 1000);
        assert_eq!(refused(&line(1001)), "line 7:1: more than 1000 cameras; expected JSON of this kind");
        let people = vec!["{\"pose_keypoints_2d\":[1,2,0.5]}"; 60_000].join(",");
        let crowd = format!("{{\"frame\": 4, \"cameras\": {{\"C1\":{{\"people\":[{people}]}}}}}}");
        assert_eq!(refused(&crowd), "line 7 (frame 4, C1): more than 100 people, the most that are read");
    }

    #[test]
    fn a_camera_that_sent_nothing_is_no_camera_that_saw_nobody() {
        let line = r#"{"frame": 0, "cameras": {"C1": null, "C2": {"people": []}}, "sent": 3}"#;
        let frame = read("line 1", line, &OpenposeOptions::default()).unwrap();
        assert_eq!(frame.cameras, [("C1".into(), None), ("C2".into(), Some(OpenposeFrame::default()))]);
    }
}
