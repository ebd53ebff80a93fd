//! Where frames come from.

use super::FrameImages;
use crate::Error;
use crate::setup::checks::z_up_from;
use crate::synthetic::recording::Recording as Synthetic;
use crate::{recording, setup};
use sinew_formats::Layout;
use sinew_observe::association::Person;
use sinew_observe::{Camera, Detection};
use std::collections::BTreeSet;
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

/// A source whose world is turned so that z points up.
pub struct Upright<'a, S> {
    source: &'a mut S,
    cameras: Vec<Camera>,
    up: String,
    read: Vec<Range<u64>>,
}

/// Cameras in a world turned to z up. Nothing is computed for the usual world, so that its numbers stay as they are.
pub(crate) fn upright(cameras: Vec<Camera>, up: &str) -> Vec<Camera> {
    match z_up_from(up) {
        Some(turn) if up != "+z" => cameras.iter().map(|camera| camera.turned(turn)).collect(),
        _ => cameras,
    }
}

impl<'a, S: FrameSource> Upright<'a, S> {
    /// Turns the world of a source whose axis `up` (`+x` to `-z`) points up. Unknown names turn nothing.
    pub fn new(source: &'a mut S, up: &str) -> Self {
        let cameras = upright(source.cameras().to_vec(), up);
        Self { source, cameras, up: up.into(), read: vec![] }
    }

    /// Runs of frames that were read, in their order: who reads them again in this order knows of the source what is known now.
    #[must_use]
    pub fn read(&self) -> &[Range<u64>] {
        &self.read
    }

    /// Reads such runs again, each frame that counts once; `each` is told how many they are with the one at hand, and in all, and may refuse to go on.
    ///
    /// # Errors
    /// Those of the source and of `each`.
    pub fn read_again(
        &mut self,
        read: &[Range<u64>],
        mut each: impl FnMut(u64, u64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let frames = self.source.frames();
        let numbers = || read.iter().flat_map(|run| run.start.max(frames.start)..run.end.min(frames.end));
        let total = numbers().collect::<BTreeSet<u64>>().len() as u64;
        let mut seen = BTreeSet::new();
        for number in numbers() {
            if seen.insert(number) {
                each(seen.len() as u64, total)?;
                self.source.people(number)?;
            }
        }
        self.read = read.to_vec();
        Ok(())
    }

    /// The source itself.
    #[must_use]
    pub fn source(&self) -> &S {
        self.source
    }
}

impl<S: FrameSource> FrameSource for Upright<'_, S> {
    fn cameras(&self) -> &[Camera] {
        &self.cameras
    }
    fn layout(&self) -> &Layout {
        self.source.layout()
    }
    fn frames(&self) -> Range<u64> {
        self.source.frames()
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let people = self.source.people(number)?;
        match self.read.last_mut() {
            _ if !self.source.reads_people() => {}
            Some(run) if run.end == number => run.end += 1,
            _ => self.read.push(number..number + 1),
        }
        Ok(people)
    }
    fn image_cameras(&self) -> Option<Vec<Camera>> {
        self.source.image_cameras().map(|cameras| upright(cameras, &self.up))
    }
    fn images(&mut self, number: u64) -> Result<FrameImages, Error> {
        self.source.images(number)
    }
    fn begin_tracking(&mut self) {
        self.source.begin_tracking();
    }
    fn reads_people(&self) -> bool {
        self.source.reads_people()
    }
}

impl FrameSource for recording::Recording {
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
        Ok(setup::detections(&self.frame(number)?))
    }
}

impl FrameSource for Synthetic {
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
        let person = |camera: &Vec<Vec<Option<sinew_formats::openpose::Keypoint>>>| {
            camera.get(number as usize).map_or_else(Vec::new, |points| {
                let detection =
                    |k: sinew_formats::openpose::Keypoint| Detection { pixel: [k.x, k.y], confidence: k.confidence };
                vec![points.iter().map(|k| k.map(detection)).collect()]
            })
        };
        Ok(self.keypoints.iter().map(person).collect())
    }
}
