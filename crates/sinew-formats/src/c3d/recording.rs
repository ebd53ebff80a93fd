//! What a C3D file holds.

use super::events::C3dEvent;
use super::parameters::C3dGroup;
use super::processor::Processor;
use super::quantities;
use super::screen_axes::ScreenAxis;
use crate::Warning;
use crate::trc::Units;
use std::io;

/// What is said about the points, but for the number of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct C3dHeader {
    /// Frames per second.
    pub rate_hz: f64,
    /// Unit of length.
    pub units: Units,
    /// Number of the first frame; frame 1 has time 0.
    pub first_frame: u32,
    /// Axis of the file that points right on a screen, POINT:X_SCREEN.
    pub right: Option<ScreenAxis>,
    /// Axis of the file that points up on a screen, POINT:Y_SCREEN.
    pub up: Option<ScreenAxis>,
    /// Names of the points.
    pub markers: Vec<String>,
}

impl C3dHeader {
    /// A header in metres, Y up, that starts at frame 1.
    #[must_use]
    pub const fn new(rate_hz: f64, markers: Vec<String>) -> Self {
        let (right, up) = (Some(ScreenAxis::X), Some(ScreenAxis::Y));
        Self { rate_hz, units: Units::Metres, first_frame: 1, right, up, markers }
    }

    /// Number of the last of that number of frames.
    pub(super) fn last_frame(&self, frames: u32) -> io::Result<u32> {
        let end = self.first_frame.checked_add(frames).filter(|_| self.first_frame > 0);
        let refusal = || io::Error::new(io::ErrorKind::InvalidInput, "frames are numbered from 1 to below 2^32");
        end.map(|end| end - 1).ok_or_else(refusal)
    }
}

/// A point of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct C3dPoint {
    /// Position in units and axes of the file.
    pub position: [f64; 3],
    /// Average distance of the cameras' rays from the point, in the unit of the file; 0 where it was not measured.
    pub residual: f32,
    /// Cameras that saw the point, a bit each, the first in the lowest of seven.
    pub cameras: u8,
}

/// An analog channel.
#[derive(Clone, Debug, PartialEq)]
pub struct AnalogChannel {
    /// Name.
    pub name: String,
    /// Unit of the samples, as the file states it.
    pub units: String,
    /// Factor of this channel.
    pub scale: f64,
    /// What is taken off a stored sample before it is scaled.
    pub offset: f64,
    /// Samples in the channel's unit: (stored − offset) × scale × general scale.
    pub samples: Vec<f64>,
}

/// Analog channels, all sampled at the same times.
#[derive(Clone, Debug, PartialEq)]
pub struct Analog {
    /// Samples of a channel in each frame.
    pub samples_per_frame: usize,
    /// Factor of all channels, ANALOG:GEN_SCALE.
    pub general_scale: f64,
    /// Whether stored samples and offsets are words without sign, ANALOG:FORMAT.
    pub is_unsigned: bool,
    /// The channels.
    pub channels: Vec<AnalogChannel>,
}

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct C3d {
    /// Processor for which the file was written.
    pub processor: Processor,
    /// What is said about the points.
    pub header: C3dHeader,
    /// Factor of words and of residuals, in the unit of the file: |POINT:SCALE|.
    pub scale: f64,
    /// Points of each frame in the order of the header; `None` is missing.
    pub frames: Vec<Vec<Option<C3dPoint>>>,
    /// Analog channels.
    pub analog: Analog,
    /// Events of the header, then of the group EVENT.
    pub events: Vec<C3dEvent>,
    /// All parameters.
    pub groups: Vec<C3dGroup>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

impl C3d {
    /// Time of a frame, counted from 0 in the file, in seconds: on the clock of the events.
    #[must_use]
    pub fn time_s(&self, frame: usize) -> f64 {
        (f64::from(self.header.first_frame) - 1.0 + frame as f64) / self.header.rate_hz
    }

    /// Samples of an analog channel per second.
    #[must_use]
    pub fn analog_rate_hz(&self) -> f64 {
        self.header.rate_hz * self.analog.samples_per_frame as f64
    }

    /// Position of a point in the world (Z up, metres), if the frame has it; where the file does not say which axis points up, Z does.
    #[must_use]
    pub fn point_in_world(&self, frame: usize, marker: usize) -> Option<[f64; 3]> {
        let point = (*self.frames.get(frame)?.get(marker)?)?;
        let up = self.header.up.unwrap_or(ScreenAxis::Z);
        Some(up.world_from_file(point.position).map(|v| v * self.header.units.metres()))
    }

    /// Whether each of the points is a position, and no angle, force or other result of a model.
    #[must_use]
    pub fn are_positions(&self) -> Vec<bool> {
        quantities::are_positions(&self.groups, &self.header.markers)
    }

    /// Index of the point of that name.
    #[must_use]
    pub fn marker_index(&self, name: &str) -> Option<usize> {
        self.header.markers.iter().position(|marker| marker == name)
    }
}
