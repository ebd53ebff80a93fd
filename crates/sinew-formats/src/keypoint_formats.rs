//! Files that hold the keypoints of a whole recording: of one camera, or of all.
//!
//! Each format is a module with `recognises` and `read`; [`FORMATS`] lists them, so that a new one is a file and a line
//! here. A file is recognised by its beginning, whatever it is called. Camera and frame have the names and numbers of the
//! file; a format without cameras leaves the name to the name of the file.
//!
//! | module | whose | confidence |
//! |---|---|---|
//! | [`caliscope_xy`] | Caliscope, `xy_*.csv` | none: 1 |
//! | [`deeplabcut_csv`] | DeepLabCut, one and several animals | `likelihood` |
//! | [`mmpose_json`] | MMPose | `keypoint_scores` |
//! | [`rtmlib_json`] | what RTMLib returns | `scores` |
//! | [`coco_results`] | COCO results, AlphaPose | third number of a keypoint |
//! | [`mediapipe_json`] | MediaPipe Pose | `visibility` |
//!
//! ```
//! use sinew_formats::keypoint_formats::{read, recognised};
//! let text = "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y\n7,0,7,0.2,11,520,193\n";
//! assert_eq!(recognised(text).unwrap().name, "Caliscope");
//! let table = read("xy_POSE.csv", text, 1.0)?;
//! assert_eq!(table.cameras[0].name.as_deref(), Some("0"));
//! assert_eq!(table.cameras[0].frames[&7].people[0].keypoints[11].unwrap().x, 520.0);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::keypoint_table::KeypointTable;
use crate::openpose::{self, OpenposeFrame, OpenposeOptions};
use crate::source_text::without_mark;
use crate::{Error, Place};
use crate::{caliscope_xy, coco_results, deeplabcut_csv, mediapipe_json, mmpose_json, rtmlib_json};

/// A format of such files.
#[derive(Clone, Copy, Debug)]
pub struct KeypointFormat {
    /// Name for messages.
    pub name: &'static str,
    /// Whether a file that begins so is of this format.
    pub recognises: fn(&str) -> bool,
    /// Reads a file: its name, its text and the confidence that means certainty.
    pub read: fn(&str, &str, f64) -> Result<KeypointTable, Error>,
}

/// The formats, in the order in which they are tried.
pub const FORMATS: [KeypointFormat; 6] = [
    KeypointFormat { name: "Caliscope", recognises: caliscope_xy::recognises, read: caliscope_xy::read },
    KeypointFormat { name: "DeepLabCut", recognises: deeplabcut_csv::recognises, read: deeplabcut_csv::read },
    KeypointFormat { name: "MMPose", recognises: mmpose_json::recognises, read: mmpose_json::read },
    KeypointFormat { name: "RTMLib", recognises: rtmlib_json::recognises, read: rtmlib_json::read },
    KeypointFormat { name: "AlphaPose, COCO results", recognises: coco_results::recognises, read: coco_results::read },
    KeypointFormat { name: "MediaPipe", recognises: mediapipe_json::recognises, read: mediapipe_json::read },
];

/// The formats in words, with the formats that have a file a frame.
#[must_use]
pub fn known() -> String {
    let names = FORMATS.map(|format| format.name);
    format!("{}; OpenPose and MMPose with a file a frame, in a folder a camera", names.join(", "))
}

/// Bytes at the beginning of a file by which it is recognised.
const BEGINNING: usize = 1 << 16;

/// The format of a text, by its beginning.
#[must_use]
pub fn recognised(text: &str) -> Option<&'static KeypointFormat> {
    let text = without_mark(text).trim_start();
    let end = (0..=BEGINNING.min(text.len())).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
    let beginning = text.get(..end).unwrap_or_default();
    FORMATS.iter().find(|format| (format.recognises)(beginning))
}

/// Reads a file of one frame: OpenPose's, or MMPose's list of instances.
///
/// # Errors
/// What [`openpose::read`] and [`mmpose_json::read_image`] refuse.
pub fn read_frame(name: &str, text: &str, options: &OpenposeOptions<'_>) -> Result<OpenposeFrame, Error> {
    let is_list = without_mark(text).trim_start().starts_with('[');
    if is_list { mmpose_json::read_image(name, text, options) } else { openpose::read(name, text, options) }
}

/// Whether a file begins as one of [`read_frame`] that shows somebody, or is OpenPose's of nobody.
#[must_use]
pub fn is_frame(beginning: &str) -> bool {
    let beginning = without_mark(beginning).trim_start();
    (beginning.starts_with('{') && beginning.contains("\"people\"")) || mmpose_json::is_image(beginning)
}

/// Reads a file of any of the formats; `confidence_scale` is the confidence that means certainty.
///
/// # Errors
/// A text of another kind, a scale that is not positive, and what the reader of its format refuses.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let place = Place::file(name);
    if !(confidence_scale > 0.0 && confidence_scale.is_finite()) {
        return Err(place.bad_value("confidence_scale", format!("{confidence_scale}"), "positive"));
    }
    match recognised(text) {
        Some(format) => (format.read)(name, text, confidence_scale),
        None => Err(place.syntax("the beginning is that of no known keypoint file", format!("a file of {}", known()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_one_frame_is_of_openpose_or_mmpose() {
        let people = |text: &str| read_frame("a.json", text, &OpenposeOptions::default()).unwrap().people.len();
        let (openpose, mmpose) =
            ("{\"people\":[{\"pose_keypoints_2d\":[1,2,0.5]}]}", "[{\"keypoints\":[[1,2]],\"keypoint_scores\":[0.5]}]");
        for text in [openpose, mmpose, "\u{feff} [{\"keypoints\":[[1,2]],\"keypoint_scores\":[0.5]}]"] {
            assert!(is_frame(text) && people(text) == 1, "{text}");
        }
        assert_eq!((people("[]"), is_frame("[]"), is_frame("[1]")), (0, false, false));
    }

    #[test]
    fn other_texts_are_refused_with_a_list() {
        for text in ["", "{\"people\": []}", "a,b\n1,2\n", "[1]"] {
            let error = read("a.json", text, 1.0).unwrap_err().to_string();
            assert!(
                error.contains("a file of Caliscope, DeepLabCut, MMPose, RTMLib, AlphaPose, COCO results, MediaPipe;"),
                "{error}"
            );
        }
        assert!(read("a.json", "", 0.0).unwrap_err().to_string().contains("confidence_scale = 0; must be positive"));
    }
}
