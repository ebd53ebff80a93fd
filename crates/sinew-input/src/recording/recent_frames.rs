//! The last frames that were read of a camera, which make frames in between ([`sinew_observe::clocks::between_frames`]).

use crate::Error;
use sinew_observe::association::{Config, Person};
use sinew_observe::clocks::between_frames::people_between;
use std::collections::VecDeque;

/// Frames before, at, and after a time that make what lies between.
const NEAR: usize = 4;

/// Frames by the camera's own numbers, last read last.
#[derive(Debug, Default)]
pub(super) struct RecentFrames {
    read: VecDeque<(u64, Vec<Person>)>,
}

impl RecentFrames {
    /// The people at a time, counted in the camera's own frames and interpolated between the four around it; `read` reads the people of one frame.
    pub(super) fn people_at(
        &mut self,
        time: f64,
        read: impl Fn(u64) -> Result<Vec<Person>, Error>,
    ) -> Result<Vec<Person>, Error> {
        let start = time.floor();
        for step in [-1.0, 0.0, 1.0, 2.0] {
            let number = start + step;
            if number >= 0.0 && !self.read.iter().any(|(known, _)| *known == number as u64) {
                self.read.push_back((number as u64, read(number as u64)?));
            }
        }
        let near = [-1.0, 0.0, 1.0, 2.0].map(|step| {
            let is_it = |(number, _): &&(u64, Vec<Person>)| *number as f64 == start + step;
            self.read.iter().find(is_it).map_or(&[][..], |(_, people)| people)
        });
        let people = people_between(near, time - start, &Config::default());
        self.read.drain(..self.read.len().saturating_sub(NEAR));
        Ok(people)
    }
}
