//! Predictions of MMPose, one file a video or one an image.
//!
//! `{"meta_info": …, "instance_info": [{"frame_id": 1, "instances": [{"keypoints": [[x, y], …], "keypoint_scores": […]}]}]}`
//! is what the demos write; the inferencer writes the inner list alone. x and y are pixels. One file holds one camera. Of a
//! folder of images the inferencer writes a file for each, the list of instances, called after the image: [`read_image`].
//! Quirks that are ordinary input:
//!
//! - `frame_id` is the frame; without it the place in the list, from 0.
//! - Scores are heights of the detector's maps: above 1, up to 2, counts as 1, and 0 or less as not found.
//! - A frame without instances is one without people.
//! - Points with three coordinates (predictions in space) are refused.
//!
//! ```
//! use sinew_formats::mmpose_json::read;
//! let text = r#"{"meta_info": {}, "instance_info": [
//!     {"frame_id": 5, "instances": [{"keypoints": [[10, 20.5], [1, 2]], "keypoint_scores": [1.1, 0.0], "bbox": [[0, 0, 9, 9]]}]}]}"#;
//! let table = read("results_cam01.json", text, 1.0)?;
//! let person = &table.cameras[0].frames[&5].people[0];
//! assert_eq!((person.keypoints[0].unwrap().y, person.keypoints[0].unwrap().confidence), (20.5, 1.0));
//! assert!(person.keypoints[1].is_none());
//!
//! use sinew_formats::{mmpose_json::read_image, openpose::OpenposeOptions};
//! let text = r#"[{"keypoints": [[10, 20.5]], "keypoint_scores": [0.5], "bbox": [[0, 0, 9, 9]], "bbox_score": 0.9}]"#;
//! let frame = read_image("cam01/000005.json", text, &OpenposeOptions::default())?;
//! assert_eq!(frame.people[0].keypoints[0].unwrap().confidence, 0.5);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::keypoint_table::{Frames, KeypointTable, add_scored_person};
use crate::openpose::{OpenposeFrame, OpenposeOptions, check_people};
use crate::{Error, Place, json_text};
use serde::Deserialize;

#[derive(Deserialize)]
struct Predictions {
    instance_info: Vec<Entry>,
}

/// A frame with its instances or, of a single image, an instance.
#[derive(Deserialize)]
struct Entry {
    frame_id: Option<u64>,
    instances: Option<Vec<Instance>>,
    #[serde(flatten)]
    own: Instance,
}

#[derive(Default, Deserialize)]
struct Instance {
    keypoints: Option<Vec<Vec<Option<f64>>>>,
    keypoint_scores: Option<Vec<Option<f64>>>,
}

/// Whether a file begins with predictions of this form.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let has = |key: &str| beginning.contains(key);
    has("\"instance_info\"") || has("\"keypoint_scores\"") || (has("\"frame_id\"") && has("\"instances\""))
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// JSON that is truncated or malformed, a frame that is there twice, points without two coordinates, scores that are not
/// as many as the points or outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let is_list = crate::source_text::without_mark(text).trim_start().starts_with('[');
    let entries: Vec<Entry> = if is_list {
        json_text::parse(name, text)?
    } else {
        json_text::parse::<Predictions>(name, text)?.instance_info
    };
    let is_image = entries.iter().any(|entry| entry.instances.is_none() && entry.own.keypoints.is_some());
    let mut frames = Frames::new();
    for (index, entry) in entries.into_iter().enumerate() {
        let number = if is_image { 0 } else { entry.frame_id.unwrap_or(index as u64) };
        let place = Place::file(name).within(format!("frame {number}"));
        if !is_image && frames.contains_key(&number) {
            return Err(place.twice("frame", number.to_string()));
        }
        let frame = frames.entry(number).or_default();
        for instance in entry.instances.unwrap_or_else(|| vec![entry.own]) {
            add_instance(&place, frame, instance, confidence_scale)?;
        }
    }
    Ok(KeypointTable::from_one_camera(frames))
}

/// Whether a file begins with the instances of one image.
#[must_use]
pub fn is_image(beginning: &str) -> bool {
    let has = |key: &str| beginning.contains(key);
    let is_video = ["\"instance_info\"", "\"instances\"", "\"frame_id\""].into_iter().any(has);
    beginning.starts_with('[') && has("\"keypoint_scores\"") && !is_video
}

/// Reads the keypoints of one camera and image.
///
/// # Errors
/// As [`read`], and people who do not fit the layout.
pub fn read_image(name: &str, text: &str, options: &OpenposeOptions<'_>) -> Result<OpenposeFrame, Error> {
    let instances: Vec<Instance> = json_text::parse(name, text)?;
    let mut place = Place::file(name);
    if let Some(frame) = options.frame {
        place = place.within(format!("frame {frame}"));
    }
    let mut frame = OpenposeFrame::default();
    for instance in instances {
        add_instance(&place, &mut frame, instance, options.confidence_scale)?;
    }
    check_people(&place, &frame, options.layout)?;
    Ok(frame)
}

fn add_instance(place: &Place, frame: &mut OpenposeFrame, instance: Instance, scale: f64) -> Result<(), Error> {
    let points = instance.keypoints.unwrap_or_default();
    let missing = || place.clone().lacks("keypoint_scores");
    let scores = if points.is_empty() { vec![] } else { instance.keypoint_scores.ok_or_else(missing)? };
    add_scored_person(place, frame, &points, &scores, scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(read("a.json", text, 1.0).unwrap_err().to_string(), message, "{text}");
    }

    fn numbers(text: &str) -> Vec<(u64, usize)> {
        let frames = read("a.json", text, 1.0).unwrap().cameras.remove(0).frames;
        frames.iter().map(|(number, frame)| (*number, frame.people.len())).collect()
    }

    #[test]
    fn every_form_is_read() {
        let person = "{\"keypoints\":[[1,2]],\"keypoint_scores\":[0.5]}";
        assert_eq!(numbers(&format!("[{{\"frame_id\":3,\"instances\":[{person},{person}]}}]")), [(3, 2)]);
        assert_eq!(numbers(&format!("[{{\"instances\":[]}},{{\"instances\":[{person}]}}]")), [(0, 0), (1, 1)]);
        assert_eq!(numbers(&format!("[{person},{person}]")), [(0, 2)]);
        assert_eq!(numbers(&format!("{{\"instance_info\":[{{\"frame_id\":9,\"instances\":[{person}]}}]}}")), [(9, 1)]);
    }

    #[test]
    fn the_instances_of_an_image_are_people() {
        let person = "{\"keypoints\":[[1,2]],\"keypoint_scores\":[0.5]}";
        let text = format!("[{person},{person}]");
        assert!(is_image(&text) && !is_image(&format!("[{{\"frame_id\":3,\"instances\":[{person}]}}]")));
        let read = |text: &str, layout: Option<&crate::Layout>| {
            let options = OpenposeOptions { frame: Some(4), layout, ..OpenposeOptions::default() };
            read_image("a.json", text, &options).map(|frame| frame.people.len()).map_err(|error| error.to_string())
        };
        assert_eq!((read(&text, None), read("[]", None)), (Ok(2), Ok(0)));
        let layout = crate::layout::find("COCO_17").unwrap();
        assert_eq!(read(&text, Some(&layout)), Err("a.json (frame 4): 3 numbers, layout `COCO_17` needs 51".into()));
        assert_eq!(
            read("[{\"keypoints\":[[1,2]]}]", None),
            Err("a.json (frame 4): `keypoint_scores` is missing".into())
        );
    }

    #[test]
    fn faults_are_named() {
        let frame = |instance: &str| format!("[{{\"frame_id\":3,\"instances\":[{instance}]}}]");
        check(&frame("{\"keypoints\":[[1,2]]}"), "a.json (frame 3): `keypoint_scores` is missing");
        check(&frame("{\"keypoints\":[[1,2]],\"keypoint_scores\":[]}"), "a.json (frame 3): 0 values; expected 1");
        check(
            &frame("{\"keypoints\":[[1,2,3]],\"keypoint_scores\":[1]}"),
            "a.json (frame 3): a point with 3 coordinates; expected x and y",
        );
        check(
            "[{\"frame_id\":3,\"instances\":[]},{\"frame_id\":3,\"instances\":[]}]",
            "a.json (frame 3): the frame `3` is there twice",
        );
    }
}
