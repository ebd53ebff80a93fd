//! Recordings of one person by the same cameras, shown one after the other.
//!
//! So what is constant over all of them is found at once. Between two recordings nobody is seen for a while, so that nothing is taken to move from the end of one to the beginning of the next.

use super::source::FrameSource;
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::association::Person;
use std::ops::Range;

/// Several sources as one, whose frames are counted from 0.
pub struct OneAfterAnother<S> {
    sources: Vec<S>,
    /// Where each begins.
    starts: Vec<u64>,
    end: u64,
}

impl<S: FrameSource> OneAfterAnother<S> {
    /// Shows sources one after the other with `gap` empty frames between them; `None` where there are none, or where their cameras or keypoints differ.
    #[must_use]
    pub fn new(sources: Vec<S>, gap: u64) -> Option<Self> {
        let first = sources.first()?;
        let is_alike = |source: &S| source.cameras() == first.cameras() && source.layout() == first.layout();
        if !sources.iter().all(is_alike) {
            return None;
        }
        let (mut starts, mut end) = (vec![], 0);
        for source in &sources {
            let frames = source.frames();
            starts.push(if starts.is_empty() { 0 } else { end + gap });
            end = starts.last().copied().unwrap_or(0) + (frames.end - frames.start);
        }
        Some(Self { sources, starts, end })
    }

    /// The source of a frame, and the frame's number there; `None` between two of them.
    fn place(&mut self, number: u64) -> Option<(&mut S, u64)> {
        let index = self.starts.partition_point(|start| *start <= number).checked_sub(1)?;
        let source = &mut self.sources[index];
        let frames = source.frames();
        let own = frames.start + (number - self.starts[index]);
        (own < frames.end).then_some((source, own))
    }
}

impl<S: FrameSource> FrameSource for OneAfterAnother<S> {
    fn cameras(&self) -> &[Camera] {
        self.sources[0].cameras()
    }

    fn layout(&self) -> &Layout {
        self.sources[0].layout()
    }

    fn frames(&self) -> Range<u64> {
        0..self.end
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let nobody = vec![vec![]; self.cameras().len()];
        self.place(number).map_or(Ok(nobody), |(source, own)| source.people(own))
    }
}

#[cfg(test)]
mod tests {
    use super::super::in_memory::InMemory;
    use super::*;
    use sinew_formats::openpose::Keypoint;

    fn shown(frames: &[u8]) -> InMemory {
        let camera = Camera::look_at("C1", [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let layout = Layout { name: "L".into(), points: vec![Some("Nose".into())] };
        let point = |frame: &u8| vec![Some(Keypoint { x: f64::from(*frame), y: 0.0, confidence: 1.0 })];
        InMemory { cameras: camera.into_iter().collect(), layout, keypoints: vec![frames.iter().map(point).collect()] }
    }

    #[test]
    fn frames_come_in_order_with_a_gap() {
        let mut both = OneAfterAnother::new(vec![shown(&[1, 2]), shown(&[3])], 2).unwrap();
        assert_eq!(both.frames(), 0..5);
        let seen: Vec<usize> = (0..5).map(|number| both.people(number).unwrap()[0].len()).collect();
        assert_eq!(seen, [1, 1, 0, 0, 1]);
    }

    #[test]
    fn other_cameras_are_refused() {
        let mut other = shown(&[1]);
        other.cameras[0].name = "C2".into();
        assert!(OneAfterAnother::new(vec![shown(&[1]), other], 2).is_none());
        assert!(OneAfterAnother::<InMemory>::new(vec![], 2).is_none());
    }
}
