//! Data section of a C3D file: points and analog samples, frame by frame.
//!
//! A frame has four numbers a point, then the samples of all channels at the first of its times, at the second, and so on.
//! Numbers are reals where the scale is negative, else words, of which three times scale is the position. The fourth
//! number is a word with sign in either case: the high byte has the cameras, the low byte is the residual / |scale|
//! (Technical User Guide, “Notes for programmers” of both kinds of 3D data). Negative it marks a point that is missing;
//! some programs write the real 65 535 for the word −1. A coordinate that is no finite number marks one as well.

use super::header::Header;
use super::recording::{AnalogChannel, C3dPoint};
use super::source::Source;
use crate::Error;

/// How a frame is laid out.
#[derive(Clone, Copy)]
pub(super) struct FrameLayout {
    pub(super) points: usize,
    pub(super) channels: usize,
    pub(super) samples_per_frame: usize,
    /// Negative for reals.
    pub(super) scale: f64,
    /// Whether samples that are words have no sign.
    pub(super) is_unsigned: bool,
}

impl FrameLayout {
    /// The layout that the header describes.
    pub(super) fn new(source: &Source<'_>, header: &Header, is_unsigned: bool) -> Result<Self, Error> {
        let (words, samples) = (usize::from(header.analog_words), usize::from(header.samples_per_frame));
        let channels = match words.checked_rem(samples) {
            _ if words == 0 => 0,
            Some(0) => words / samples,
            _ => {
                let found = format!("{words} in a frame, {samples} of a channel");
                return Err(source.bad("the number of analog samples", found, "a multiple"));
            }
        };
        if !(header.scale.is_finite() && header.scale != 0.0) {
            return Err(source.bad("the scale of the points", header.scale, "a number other than 0"));
        }
        let points = usize::from(header.points);
        Ok(Self { points, channels, samples_per_frame: samples, scale: header.scale, is_unsigned })
    }

    fn is_real(&self) -> bool {
        self.scale < 0.0
    }

    fn width(&self) -> usize {
        if self.is_real() { 4 } else { 2 }
    }

    fn samples(&self) -> usize {
        self.channels * self.samples_per_frame
    }

    /// Bytes of a frame.
    pub(super) fn bytes(&self) -> usize {
        (4 * self.points + self.samples()) * self.width()
    }
}

/// Points and samples of the whole file. `channels` come with scale and offset and get their samples, all of which are
/// multiplied by `general_scale`.
pub(super) fn read(
    source: &Source<'_>,
    data_at: usize,
    layout: FrameLayout,
    frames: usize,
    channels: &mut [AnalogChannel],
    general_scale: f64,
) -> Result<Vec<Vec<Option<C3dPoint>>>, Error> {
    let size = layout.bytes();
    let data = source.slice(data_at, size.saturating_mul(frames), "the frames")?;
    for channel in &mut *channels {
        channel.samples.reserve_exact(frames * layout.samples_per_frame);
    }
    let mut points = Vec::with_capacity(frames);
    for frame in 0..frames {
        let (positions, samples) = data[frame * size..(frame + 1) * size].split_at(4 * layout.points * layout.width());
        let point = |bytes: &[u8]| point(source, layout, bytes);
        points.push(positions.chunks_exact(4 * layout.width()).map(point).collect());
        for (sample, bytes) in samples.chunks_exact(layout.width()).enumerate() {
            let channel = &mut channels[sample % layout.channels];
            let stored = stored(source, bytes, layout.is_unsigned);
            channel.samples.push((stored - channel.offset) * channel.scale * general_scale);
        }
    }
    Ok(points)
}

/// A number of four or two bytes.
fn stored(source: &Source<'_>, bytes: &[u8], is_unsigned: bool) -> f64 {
    match *bytes {
        [a, b, c, d] => source.processor.real([a, b, c, d]),
        [a, b] if is_unsigned => source.processor.word([a, b]).into(),
        [a, b] => f64::from(source.processor.word([a, b]) as i16),
        _ => f64::NAN,
    }
}

fn point(source: &Source<'_>, layout: FrameLayout, bytes: &[u8]) -> Option<C3dPoint> {
    let number = |index: usize| stored(source, &bytes[index * layout.width()..][..layout.width()], false);
    let factor = if layout.is_real() { 1.0 } else { layout.scale };
    let position = [0, 1, 2].map(|axis| number(axis) * factor);
    let fourth = number(3) as i32 as i16;
    if fourth < 0 || !position.iter().all(|x| x.is_finite()) {
        return None;
    }
    let residual = (f64::from(fourth & 0xff) * layout.scale.abs()) as f32;
    Some(C3dPoint { position, residual, cameras: (fourth >> 8) as u8 })
}
