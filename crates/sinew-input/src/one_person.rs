//! A source of frames that shows one of several people alone.
//!
//! Its frames are all from the first that shows this person to the last.

use super::frame::Frame;
use super::roll::Roll;
use super::source::{FrameSource, InputHashes};
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::association::Person;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, RgbImage};
use std::ops::Range;

/// A source of which one person is shown.
pub struct OnePerson<'a, S> {
    /// Everybody.
    pub source: &'a mut S,
    /// Who is who.
    pub roll: &'a Roll,
    /// Which of the roll's people.
    pub person: usize,
}

impl<S: FrameSource> FrameSource for OnePerson<'_, S> {
    fn cameras(&self) -> &[Camera] {
        self.source.cameras()
    }

    fn layout(&self) -> &Layout {
        self.source.layout()
    }

    fn frames(&self) -> Range<u64> {
        self.roll.people[self.person].frames.clone()
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let [own, _] = self.roll.parted(number, self.person, self.source.people(number)?);
        Ok(own)
    }

    fn others(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let [_, others] = self.roll.parted(number, self.person, self.source.people(number)?);
        Ok(others)
    }

    fn shows_one(&self) -> bool {
        true
    }

    fn image_cameras(&self) -> Option<Vec<Camera>> {
        self.source.image_cameras()
    }

    fn masks(&mut self, number: u64) -> Result<Vec<Option<BitImage>>, Error> {
        self.source.masks(number)
    }

    fn pictured(&self, numbers: &Range<u64>) -> Vec<u64> {
        self.source.pictured(numbers)
    }

    fn pictures(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        self.source.pictures(number)
    }

    fn warnings(&self) -> Vec<String> {
        self.source.warnings()
    }

    fn input_hashes(&self) -> InputHashes {
        self.source.input_hashes()
    }

    fn frame(&mut self, number: u64) -> Result<Frame, Error> {
        let Frame { people, others: _, images } = self.source.frame(number)?;
        let [people, others] = self.roll.parted(number, self.person, people);
        Ok(Frame { people, others, images })
    }
}
