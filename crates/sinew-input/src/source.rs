//! Where frames come from.

use super::frame::Frame;
use super::recording::Recording;
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::association::Person;
use sinew_observe::clocks::lag_estimate::CameraLag;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, RgbImage};
use std::collections::BTreeMap;
use std::ops::Range;

/// Hashes by the name of the input.
pub type InputHashes = BTreeMap<String, String>;

/// Keypoints of all people in all views, one frame at a time.
pub trait FrameSource {
    /// The cameras.
    fn cameras(&self) -> &[Camera];
    /// Names of the keypoints.
    fn layout(&self) -> &Layout;
    /// Numbers of the frames.
    fn frames(&self) -> Range<u64>;
    /// For each camera the people that it saw in a frame, for the set-up.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error>;

    /// For each camera everybody in a frame who is known to be someone else, for the set-up; empty where nobody is known.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn others(&mut self, _number: u64) -> Result<Vec<Vec<Person>>, Error> {
        Ok(vec![])
    }

    /// Whether the person to be tracked is the only one whom [`FrameSource::people`] shows.
    fn shows_one(&self) -> bool {
        false
    }

    /// How late each camera is, as everybody in view shows; `None` where only [`FrameSource::people`] can tell.
    fn lags_of_all(&self) -> Option<&[CameraLag]> {
        None
    }

    /// The cameras sized like the masks, if there are masks.
    fn image_cameras(&self) -> Option<Vec<Camera>> {
        None
    }

    /// For each camera its mask in a frame, for the set-up; none without masks.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn masks(&mut self, number: u64) -> Result<Vec<Option<BitImage>>, Error> {
        Ok(self.frame(number)?.images.silhouettes)
    }

    /// Numbers of those frames of which there are pictures, rising, for the set-up; none without masks.
    fn pictured(&self, _numbers: &Range<u64>) -> Vec<u64> {
        vec![]
    }

    /// For each camera its picture in a frame, for the set-up; none without pictures.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn pictures(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        Ok(self.frame(number)?.images.pictures)
    }

    /// What is odd about the frames as far as they were read.
    fn warnings(&self) -> Vec<String> {
        vec![]
    }

    /// Hashes of what was read so far, by the name of the input.
    fn input_hashes(&self) -> InputHashes {
        InputHashes::new()
    }

    /// A frame to be tracked: people and, where there are masks, images.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn frame(&mut self, number: u64) -> Result<Frame, Error> {
        Ok(Frame { people: self.people(number)?, ..Frame::default() })
    }
}

impl FrameSource for Recording {
    fn cameras(&self) -> &[Camera] {
        self.cameras()
    }
    fn layout(&self) -> &Layout {
        self.layout()
    }
    fn frames(&self) -> Range<u64> {
        self.frames()
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        self.people(number)
    }
    fn warnings(&self) -> Vec<String> {
        self.warnings()
    }
    fn input_hashes(&self) -> InputHashes {
        self.input_hashes()
    }
}
