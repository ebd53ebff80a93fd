//! What cameras show of one frame.

use sinew_observe::RgbImage;
use sinew_observe::association::Person;
use sinew_observe::silhouettes::bit_image::BitImage;

/// A frame as it is read: once, and whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// For each camera the people that it saw; where it is known who is who, the tracked one alone.
    pub people: Vec<Vec<Person>>,
    /// For each camera everybody who is known to be someone else; empty where nobody is known.
    pub others: Vec<Vec<Person>>,
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
