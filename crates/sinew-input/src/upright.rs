//! A source of frames in a world that is turned so that z points up.

use super::frame::Frame;
use super::source::{FrameSource, InputHashes};
use super::up_axis::upright;
use crate::Error;
use serde::{Deserialize, Serialize};
use sinew_formats::Layout;
use sinew_observe::association::Person;
use sinew_observe::clocks::lag_estimate::CameraLag;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, RgbImage};
use std::collections::BTreeSet;
use std::ops::Range;

/// A source whose world is turned so that z points up.
pub struct Upright<'a, S> {
    source: &'a mut S,
    cameras: Vec<Camera>,
    up: String,
    read: FramesRead,
}

/// Runs of frames that were read for a set-up, in their order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FramesRead {
    /// Frames of which people were read.
    pub people: Vec<Range<u64>>,
    /// Frames of which masks were read.
    pub masks: Vec<Range<u64>>,
    /// Frames of which pictures were read.
    pub pictures: Vec<Range<u64>>,
}

/// The frames of a run that are there.
fn within(run: &Range<u64>, frames: &Range<u64>) -> Range<u64> {
    run.start.max(frames.start)..run.end.min(frames.end)
}

/// Adds a frame to runs of frames.
fn note(runs: &mut Vec<Range<u64>>, number: u64) {
    match runs.last_mut() {
        Some(run) if run.end == number => run.end += 1,
        _ => runs.push(number..number + 1),
    }
}

impl<'a, S: FrameSource> Upright<'a, S> {
    /// Turns the world of a source whose axis or direction `up` points up ([`z_up_from`](super::up_axis::z_up_from)). Unknown names turn nothing.
    pub fn new(source: &'a mut S, up: &str) -> Self {
        let cameras = upright(source.cameras().to_vec(), up);
        Self { source, cameras, up: up.into(), read: FramesRead::default() }
    }

    /// The same source in a world that is turned by another axis, as [`Upright::new`] does; what was read is kept.
    #[must_use]
    pub fn turned(self, up: &str) -> Self {
        let cameras = upright(self.source.cameras().to_vec(), up);
        Self { cameras, up: up.into(), ..self }
    }

    /// The axis or direction that points up in the world of the source.
    #[must_use]
    pub fn up(&self) -> &str {
        &self.up
    }

    /// What was read for the set-up.
    #[must_use]
    pub const fn read(&self) -> &FramesRead {
        &self.read
    }

    /// Reads again what a run had read: the runs of frames of its set-up, each frame once, and the frames that it tracked. `each` takes how many they are with the one at hand, and in all,
    /// and may end it.
    ///
    /// # Errors
    /// Errors of the source and of `each`.
    pub fn read_again<E: From<Error>>(
        &mut self,
        set_up: &FramesRead,
        tracked: Range<u64>,
        mut each: impl FnMut(u64, u64) -> Result<(), E>,
    ) -> Result<(), E> {
        let frames = self.source.frames();
        let people = &set_up.people;
        let mut left: BTreeSet<u64> = people.iter().flat_map(|run| within(run, &frames)).collect();
        let total = left.iter().copied().chain(within(&tracked, &frames)).collect::<BTreeSet<u64>>().len() as u64;
        let mut done = 0;
        for number in people.iter().flat_map(|run| within(run, &frames)).filter(|number| left.remove(number)) {
            done += 1;
            each(done, total)?;
            self.source.people(number)?;
        }
        for number in set_up.masks.iter().flat_map(|run| within(run, &frames)) {
            self.source.masks(number)?;
        }
        for number in set_up.pictures.iter().flat_map(|run| within(run, &frames)) {
            self.source.pictures(number)?;
        }
        for number in within(&tracked, &frames) {
            if !people.iter().any(|run| run.contains(&number)) {
                done += 1;
                each(done, total)?;
            }
            self.source.frame(number)?;
        }
        self.read = set_up.clone();
        Ok(())
    }

    /// The source itself, to be tracked or moved on.
    pub fn source_mut(&mut self) -> &mut S {
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
        note(&mut self.read.people, number);
        Ok(people)
    }
    fn others(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        self.source.others(number)
    }
    fn masks(&mut self, number: u64) -> Result<Vec<Option<BitImage>>, Error> {
        let masks = self.source.masks(number)?;
        note(&mut self.read.masks, number);
        Ok(masks)
    }
    fn pictured(&self, numbers: &Range<u64>) -> Vec<u64> {
        self.source.pictured(numbers)
    }
    fn pictures(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        let pictures = self.source.pictures(number)?;
        note(&mut self.read.pictures, number);
        Ok(pictures)
    }
    fn shows_one(&self) -> bool {
        self.source.shows_one()
    }
    fn lags_of_all(&self) -> Option<&[CameraLag]> {
        self.source.lags_of_all()
    }
    fn image_cameras(&self) -> Option<Vec<Camera>> {
        self.source.image_cameras().map(|cameras| upright(cameras, &self.up))
    }
    fn warnings(&self) -> Vec<String> {
        self.source.warnings()
    }
    fn input_hashes(&self) -> InputHashes {
        self.source.input_hashes()
    }
    fn frame(&mut self, number: u64) -> Result<Frame, Error> {
        self.source.frame(number)
    }
}
