//! Departures of a recording from the model, in words.
//!
//! Which camera or limb, what was found, what is expected, what it means for the intervals, what to do.

use std::fmt;

/// A doubt about the assumed noise, calibration or sizes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// A camera's keypoints lie aside for good.
    Offset {
        /// Camera.
        camera: String,
        /// Mean residual, pixels.
        offset_px: [f64; 2],
        /// Frames.
        frames: u64,
        /// Standard error of the mean, pixels.
        usual_px: f64,
    },
    /// A camera's keypoints scatter more than assumed.
    Scatter {
        /// Camera.
        camera: String,
        /// Found over assumed.
        ratio: f64,
    },
    /// A camera has more gross errors than assumed.
    Outliers {
        /// Camera.
        camera: String,
        /// Share found, 0 to 1.
        share: f64,
        /// Share assumed.
        expected: f64,
    },
    /// Errors are not independent from frame to frame.
    Persistent {
        /// Cameras and their correlations.
        cameras: Vec<(String, f64)>,
    },
    /// The set-up found the cameras calibrated aside of each other.
    Calibration {
        /// Cameras and their offsets, pixels.
        cameras: Vec<(String, [f64; 2])>,
        /// Standard deviation per axis of the shift of the world that such offsets hide, metres.
        shift_m: f64,
    },
    /// A limb is of another length than the body's.
    Limb {
        /// Which.
        name: &'static str,
        /// Length between the keypoints over that of the body.
        ratio: f64,
        /// Length in the body, metres.
        body_m: f64,
    },
}

impl Doubt {
    /// The kind in a word.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Offset { .. } => "offset",
            Self::Scatter { .. } => "scatter",
            Self::Outliers { .. } => "outliers",
            Self::Persistent { .. } => "persistence",
            Self::Calibration { .. } => "calibration",
            Self::Limb { .. } => "limbs",
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Offset { camera, offset_px: [u, v], frames, usual_px } => write!(
                f,
                "{camera}: keypoints lie {u:+.1} {v:+.1} px from where the tracked body projects, on average over {frames} frames; chance explains {usual_px:.1} px. The intervals do not know of it and hold the truth less often than they promise: set up anew on this recording, or check this camera's calibration"
            ),
            Self::Scatter { camera, ratio } => write!(
                f,
                "{camera}: keypoints scatter {ratio:.1} times as much as the assumed noise. The intervals are too narrow, by up to that factor: set up anew on this recording, or raise `sigma_px` of the camera in setup.toml"
            ),
            Self::Outliers { camera, share, expected } => write!(
                f,
                "{camera}: {:.1} % of the keypoints are gross errors, {:.1} % are assumed. The intervals of the frames that have them may be wrong: raise `outlier` to about {:.2}, or leave the camera out",
                100.0 * share,
                100.0 * expected,
                share
            ),
            Self::Persistent { cameras } => {
                let listed: Vec<String> = cameras.iter().map(|(name, r)| format!("{name} {r:.2}")).collect();
                write!(
                    f,
                    "errors of the keypoints persist from frame to frame (correlation {}; independent ones are assumed). The intervals are too narrow: frames repeat what others said, or the body does not fit the person",
                    listed.join(", ")
                )
            }
            Self::Calibration { cameras, shift_m } => {
                let listed: Vec<String> =
                    cameras.iter().map(|(name, [u, v])| format!("{name} {u:+.1} {v:+.1} px")).collect();
                write!(
                    f,
                    "the set-up found cameras that see everything aside of the others ({}). This is taken away, but for the shift of the whole world that it hides: everything may lie some {:.0} mm aside along each axis, all the time, and no interval knows of it. Lengths and angles are right; where places matter, calibrate these cameras anew",
                    listed.join(", "),
                    1e3 * shift_m
                )
            }
            Self::Limb { name, ratio, body_m } => write!(
                f,
                "{name}: {:.1} % {} between the keypoints than in the body ({:.0} mm, left and right together). The intervals do not know of it and hold the truth less often than they promise: leave the set-up or the body file out, so that sizes are measured anew",
                100.0 * (ratio - 1.0).abs(),
                if *ratio > 1.0 { "longer" } else { "shorter" },
                1e3 * body_m
            ),
        }
    }
}
