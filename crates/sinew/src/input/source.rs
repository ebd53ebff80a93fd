//! Where frames come from.

use super::frame::{FrameImages, detections};
use super::recording::Recording;
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::association::Person;
use std::ops::Range;

/// Keypoints of all people in all views, one frame at a time.
pub trait FrameSource {
    /// The cameras.
    fn cameras(&self) -> &[Camera];
    /// Names of the keypoints.
    fn layout(&self) -> &Layout;
    /// Numbers of the frames.
    fn frames(&self) -> Range<u64>;
    /// For each camera the people that it saw in a frame.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error>;

    /// The cameras sized like the masks, if there are masks.
    fn image_cameras(&self) -> Option<Vec<Camera>> {
        None
    }

    /// Masks and pictures of a frame, in the order of the cameras.
    ///
    /// # Errors
    /// A frame that cannot be read.
    fn images(&mut self, number: u64) -> Result<FrameImages, Error> {
        let _ = number;
        Ok(FrameImages::default())
    }

    /// Told when the set-up is done and frames are tracked from now on.
    fn begin_tracking(&mut self) {}

    /// Whether keypoints are read for a frame; not where they served for the set-up only.
    fn reads_people(&self) -> bool {
        true
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
        Ok(detections(&self.frame(number)?))
    }
}
