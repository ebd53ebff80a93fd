//! Keypoints of a whole recording, or of one of its cameras, as files of [many formats](crate::keypoint_formats) hold them.
//!
//! Cameras have names where the file names them, frames have the numbers of the file, people the order of the file.

use crate::openpose::{OpenposeFrame, OpenposePerson, keypoint};
use crate::{Error, Layout, Place, Warning};
use std::collections::BTreeMap;

/// Frames of a camera by number.
pub type Frames = BTreeMap<u64, OpenposeFrame>;

/// Keypoints of a recording, or of one of its cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct KeypointTable {
    /// Meaning of the keypoint indices, where the format says it.
    pub layout: Option<Layout>,
    /// Whether x and y are shares of the image's width and height instead of pixels.
    pub in_image_shares: bool,
    /// Whether a frame in which a camera sees nobody has no entry.
    pub leaves_out_nobody: bool,
    /// Frames per second, where the file has times.
    pub rate_hz: Option<f64>,
    /// What is odd about the file.
    pub warnings: Vec<Warning>,
    /// Cameras in the order of the file.
    pub cameras: Vec<TableCamera>,
}

/// What a camera saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableCamera {
    /// Name or number in the file; none where the file holds one camera and does not name it.
    pub name: Option<String>,
    /// Its frames.
    pub frames: Frames,
}

impl KeypointTable {
    /// Frames of some cameras, in pixels, whose layout is to be seen from the number of keypoints; every frame has an entry.
    pub(crate) fn from_cameras(cameras: Vec<TableCamera>) -> Self {
        Self {
            layout: None,
            in_image_shares: false,
            leaves_out_nobody: false,
            rate_hz: None,
            warnings: vec![],
            cameras,
        }
    }

    /// As [`KeypointTable::from_cameras`] for one camera without a name.
    pub(crate) fn from_one_camera(frames: Frames) -> Self {
        Self::from_cameras(vec![TableCamera { name: None, frames }])
    }
}

/// Adds a person to a frame, after those who are there.
pub(crate) fn add_person(frame: &mut OpenposeFrame, mut person: OpenposePerson) {
    if person.keypoints.iter().any(Option::is_some) {
        person.index = frame.people.last().map_or(0, |last| last.index + 1).max(person.index);
        frame.people.push(person);
    }
}

/// Adds a person whose points and scores are lists of their own, pixels and heights of the detector's maps.
///
/// # Errors
/// Points without two coordinates, scores that are not as many as the points or outside the scale.
pub(crate) fn add_scored_person(
    place: &Place,
    frame: &mut OpenposeFrame,
    points: &[Vec<Option<f64>>],
    scores: &[Option<f64>],
    scale: f64,
) -> Result<(), Error> {
    if scores.len() != points.len() {
        return Err(Error::RowLength { place: place.clone(), found: scores.len(), expected: points.len() });
    }
    let mut keypoints = Vec::with_capacity(points.len());
    for (point, score) in points.iter().zip(scores) {
        let &[x, y] = point.as_slice() else {
            return Err(place.clone().syntax(format!("a point with {} coordinates", point.len()), "x and y"));
        };
        let confidence = score.map(|score| height_as_confidence(score, scale));
        keypoints.push(keypoint(place, [x, y, confidence], scale, frame)?);
    }
    add_person(frame, OpenposePerson { index: 0, keypoints });
    Ok(())
}

/// What a score counts of a detector whose scores are heights of its maps and no probabilities.
///
/// They may lie somewhat above the scale, or below 0 where nothing was found. Up to twice the scale counts as certain, 0
/// and less as not found; more is left as it is, for [`Error::Confidence`].
pub(crate) fn height_as_confidence(score: f64, scale: f64) -> f64 {
    const HIGHEST: f64 = 2.0;
    if score <= 0.0 {
        0.0
    } else if score > scale && score <= HIGHEST * scale {
        scale
    } else {
        score
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_of_maps_become_confidences() {
        for (score, confidence) in [(-1.0, 0.0), (0.0, 0.0), (0.5, 0.5), (1.3, 1.0), (2.0, 1.0), (87.0, 87.0)] {
            assert_eq!(height_as_confidence(score, 1.0), confidence, "{score}");
        }
        assert!(height_as_confidence(f64::NAN, 1.0).is_nan());
    }

    #[test]
    fn people_without_keypoints_are_absent() {
        let mut frame = OpenposeFrame::default();
        add_person(&mut frame, OpenposePerson { index: 0, keypoints: vec![None, None] });
        assert!(frame.people.is_empty());
    }
}
