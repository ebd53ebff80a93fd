//! What cameras show of one frame.

use sinew_formats::openpose::{Keypoint, OpenposePerson};
use sinew_observe::association::Person as Pixels;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Detection, RgbImage};

/// A frame as it is read: once, and whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// For each camera the people that it saw; where it is known who is who, the tracked one alone.
    pub people: Vec<Vec<Pixels>>,
    /// For each camera everybody who is known to be someone else; empty where nobody is known.
    pub others: Vec<Vec<Pixels>>,
    /// Masks and pictures.
    pub images: FrameImages,
}

/// What cameras show of one frame besides keypoints, in the order of the cameras.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameImages {
    /// Masks of the person.
    pub silhouettes: Vec<Option<BitImage>>,
    /// Pictures.
    pub pictures: Vec<Option<RgbImage>>,
}

/// A frame's people, camera by camera, as the keypoint reader gives them, in the form that association takes.
#[must_use]
pub fn detections(people: &[Vec<OpenposePerson>]) -> Vec<Vec<Pixels>> {
    people.iter().map(|people| people.iter().map(detected).collect()).collect()
}

/// A person as the keypoint reader gives them, in the form that association takes.
#[must_use]
pub fn detected(person: &OpenposePerson) -> Pixels {
    let detection = |k: Keypoint| Detection::new([k.x, k.y], k.confidence);
    person.keypoints.iter().map(|k| k.map(detection)).collect()
}
