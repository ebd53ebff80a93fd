//! A source of frames that shows one of several people alone, where one was chosen.
//!
//! Its frames are then all from the first that shows this person to the last.

use super::frame::Frame;
use super::roll::Roll;
use super::source::{FrameSource, InputHashes};
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::association::Person;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, RgbImage};
use std::ops::Range;

/// A source of which one person is shown, or everybody.
pub struct OnePerson<'a, S> {
    /// Everybody.
    pub source: &'a mut S,
    /// Who is who, and which of the roll's people is shown; everybody if `None`.
    pub chosen: Option<(&'a Roll, usize)>,
}

impl<S: FrameSource> FrameSource for OnePerson<'_, S> {
    fn cameras(&self) -> &[Camera] {
        self.source.cameras()
    }

    fn layout(&self) -> &Layout {
        self.source.layout()
    }

    fn frames(&self) -> Range<u64> {
        self.chosen.map_or_else(|| self.source.frames(), |(roll, person)| roll.people[person].frames.clone())
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let people = self.source.people(number)?;
        let Some((roll, person)) = self.chosen else { return Ok(people) };
        let [own, _] = roll.parted(number, person, people);
        Ok(own)
    }

    fn others(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let Some((roll, person)) = self.chosen else { return self.source.others(number) };
        let [_, others] = roll.parted(number, person, self.source.people(number)?);
        Ok(others)
    }

    fn shows_one(&self) -> bool {
        self.chosen.is_some() || self.source.shows_one()
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
        let frame = self.source.frame(number)?;
        let Some((roll, person)) = self.chosen else { return Ok(frame) };
        let [people, others] = roll.parted(number, person, frame.people);
        Ok(Frame { people, others, ..frame })
    }
}
