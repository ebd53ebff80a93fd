//! Keypoints of one person that are in memory already, as a source of frames.

use super::source::FrameSource;
use crate::Error;
use sinew_formats::Layout;
use sinew_formats::openpose::Keypoint;
use sinew_observe::association::Person;
use sinew_observe::{Camera, Detection};
use std::ops::Range;

/// Keypoints by camera, frame and point of the layout.
#[derive(Clone, Debug)]
pub struct InMemory {
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// Names of the keypoints.
    pub layout: Layout,
    /// By camera, frame and point.
    pub keypoints: Vec<Vec<Vec<Option<Keypoint>>>>,
}

impl FrameSource for InMemory {
    fn cameras(&self) -> &[Camera] {
        &self.cameras
    }
    fn layout(&self) -> &Layout {
        &self.layout
    }
    fn frames(&self) -> Range<u64> {
        0..self.keypoints.first().map_or(0, Vec::len) as u64
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let detection = |k: Keypoint| Detection::new([k.x, k.y], k.confidence);
        let person = |camera: &Vec<Vec<Option<Keypoint>>>| {
            let points = camera.get(number as usize)?;
            Some(points.iter().map(|k| k.map(detection)).collect())
        };
        Ok(self.keypoints.iter().map(|camera| person(camera).into_iter().collect()).collect())
    }
}
