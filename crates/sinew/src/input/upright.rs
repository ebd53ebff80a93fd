//! A source of frames in a world that is turned so that z points up.

use super::frame::FrameImages;
use super::source::FrameSource;
use super::up_axis::upright;
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::association::Person;
use std::collections::BTreeSet;
use std::ops::Range;

/// A source whose world is turned so that z points up.
pub struct Upright<'a, S> {
    source: &'a mut S,
    cameras: Vec<Camera>,
    up: String,
    read: Vec<Range<u64>>,
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
