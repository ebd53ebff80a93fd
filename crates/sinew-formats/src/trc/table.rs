//! What a TRC file holds.

use crate::Warning;

/// Unit of length of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Metres.
    #[default]
    Metres,
    /// Centimetres.
    Centimetres,
    /// Millimetres.
    Millimetres,
}

impl Units {
    /// The unit that a text names; case does not count.
    #[must_use]
    pub fn named(text: &str) -> Option<Self> {
        match text.to_lowercase().as_str() {
            "m" | "meters" | "metres" | "meter" | "metre" => Some(Self::Metres),
            "cm" => Some(Self::Centimetres),
            "mm" | "millimeters" | "millimetres" => Some(Self::Millimetres),
            _ => None,
        }
    }

    /// Metres per unit.
    #[must_use]
    pub const fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Centimetres => 1e-2,
            Self::Millimetres => 1e-3,
        }
    }

    /// Symbol in the header.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Centimetres => "cm",
            Self::Millimetres => "mm",
        }
    }
}

/// What the five lines of the header say, but for the number of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Name of the file that line 1 repeats.
    pub file_name: String,
    /// Frames per second.
    pub rate_hz: f64,
    /// Unit of length.
    pub units: Units,
    /// First frame of the original recording.
    pub start_frame: i64,
    /// Names of the points.
    pub markers: Vec<String>,
}

impl Header {
    /// A header in metres that starts at frame 1.
    #[must_use]
    pub fn new(file_name: &str, rate_hz: f64, markers: Vec<String>) -> Self {
        Self { file_name: file_name.into(), rate_hz, units: Units::Metres, start_frame: 1, markers }
    }
}

/// A row of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TrcFrame {
    /// Number in the first column, counted from 1.
    pub number: i64,
    /// Time, seconds.
    pub time_s: f64,
    /// Points in the order of the header, in units and axes of the file; `None` is missing.
    pub points: Vec<Option<[f64; 3]>>,
}

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Trc {
    /// Header.
    pub header: Header,
    /// Rows.
    pub frames: Vec<TrcFrame>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

impl Trc {
    /// Position of a point in the world (Z up, metres), if the frame has it.
    #[must_use]
    pub fn point_in_world(&self, frame: usize, marker: usize) -> Option<[f64; 3]> {
        let point = (*self.frames.get(frame)?.points.get(marker)?)?;
        Some(world_from_trc(point).map(|v| v * self.header.units.metres()))
    }

    /// Index of the point of that name.
    #[must_use]
    pub fn marker_index(&self, name: &str) -> Option<usize> {
        self.header.markers.iter().position(|marker| marker == name)
    }
}

/// From the world (Z up) to the axes of the file (Y up).
#[must_use]
pub const fn trc_from_world([x, y, z]: [f64; 3]) -> [f64; 3] {
    [y, z, x]
}

/// From the axes of the file (Y up) to the world (Z up).
#[must_use]
pub const fn world_from_trc([x, y, z]: [f64; 3]) -> [f64; 3] {
    [z, x, y]
}
