//! How late a camera is: a lag in frames, and a drift of its clock.
//!
//! What the recording shows in frame f, such a camera shows at `f + frames + ppm·10⁻⁶ f` of its own frames. Written `2`, `-0.4`, `1.25+80ppm`.

use std::fmt;
use std::str::FromStr;

/// Largest lag, frames.
pub const MOST_FRAMES: f64 = 100_000.0;
/// Largest drift, parts in a million: beyond, cameras have different frame rates.
pub const MOST_PPM: f64 = 5000.0;

/// How late a camera is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockLag {
    /// Frames that it is late in frame 0.
    pub frames: f64,
    /// Frames that it falls behind in a million frames.
    pub ppm: f64,
}

impl ClockLag {
    /// A camera that is late by whole frames.
    #[must_use]
    pub const fn whole(frames: i64) -> Self {
        Self { frames: frames as f64, ppm: 0.0 }
    }

    /// Whether no frame lies between two of the camera's.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.ppm == 0.0 && self.frames.fract() == 0.0
    }

    /// The camera's own time of a frame, in its frames.
    #[must_use]
    pub fn own_time(&self, number: u64) -> f64 {
        let number = number as f64;
        number + self.frames + 1e-6 * self.ppm * number
    }

    /// The camera's own frame that is nearest to a frame in time; `None` before its first.
    #[must_use]
    pub fn nearest(&self, number: u64) -> Option<u64> {
        let own = self.own_time(number).round();
        (own >= 0.0).then_some(own as u64)
    }

    /// The time, in frames of the recording, of one of the camera's own frames.
    #[must_use]
    pub fn time_of(&self, own: u64) -> f64 {
        (own as f64 - self.frames) / (1.0 + 1e-6 * self.ppm)
    }
}

impl fmt::Display for ClockLag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.frames)?;
        if self.ppm == 0.0 { Ok(()) } else { write!(f, "{:+}ppm", self.ppm) }
    }
}

/// Why a text is no lag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LagTextError {
    /// It is not frames, or frames and a drift.
    Form,
    /// It is more than [`MOST_FRAMES`] or [`MOST_PPM`].
    Size,
}

impl FromStr for ClockLag {
    type Err = LagTextError;

    fn from_str(text: &str) -> Result<Self, LagTextError> {
        let (frames, ppm) = match text.trim().strip_suffix("ppm") {
            None => (text.trim(), "0"),
            Some(both) => {
                let sign = both.rfind(['+', '-']).filter(|place| *place > 0).ok_or(LagTextError::Form)?;
                both.split_at(sign)
            }
        };
        let number = |text: &str| {
            let number: Option<f64> = text.parse().ok();
            number.filter(|number| !number.is_nan()).ok_or(LagTextError::Form)
        };
        let lag = Self { frames: number(frames)?, ppm: number(ppm.trim())? };
        let is_possible = lag.frames.abs() <= MOST_FRAMES && lag.ppm.abs() <= MOST_PPM;
        if is_possible { Ok(lag) } else { Err(LagTextError::Size) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lags_are_read_as_they_are_written() {
        for (text, frames, ppm) in
            [("2", 2.0, 0.0), ("-0.4", -0.4, 0.0), ("1.25+80ppm", 1.25, 80.0), ("-3-7.5ppm", -3.0, -7.5)]
        {
            let lag: ClockLag = text.parse().unwrap();
            assert_eq!((lag, lag.to_string().as_str()), (ClockLag { frames, ppm }, text));
        }
        for wrong in ["", "half", "80ppm", "1+ppm", "nan", "1+2+3ppm"] {
            assert_eq!(wrong.parse::<ClockLag>(), Err(LagTextError::Form), "{wrong}");
        }
        for wrong in ["inf", "1e9", "1+9999ppm", "1+900000ppm"] {
            assert_eq!(wrong.parse::<ClockLag>(), Err(LagTextError::Size), "{wrong}");
        }
    }

    #[test]
    fn times_of_own_frames_are_inverse_to_own_times() {
        let lag = ClockLag { frames: -2.25, ppm: 120.0 };
        for number in [0, 3, 77_777] {
            assert!((lag.own_time(number) - (number as f64 * 1.000_12 - 2.25)).abs() < 1e-9);
        }
        assert!((lag.own_time(1000) - 997.87).abs() < 1e-9 && (lag.time_of(998) - 1000.13).abs() < 2e-4);
        assert_eq!((lag.nearest(0), lag.nearest(3)), (None, Some(1)));
        assert!(ClockLag::whole(4).is_whole() && !lag.is_whole());
    }
}
