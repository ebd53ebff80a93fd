//! What the set-up found odd.

use sinew_input::flag::{flag, flag_with};
use sinew_input::lag::ClockLag;
use sinew_input::up_axis::Z_UP;
use sinew_observe::clocks::lag_estimate::CameraLag;
use std::fmt;

/// An oddity of a recording or its calibration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetupWarning {
    /// One camera only.
    OneCamera,
    /// Sizes that nothing measured.
    Unmeasured {
        /// Their names.
        sizes: Vec<&'static str>,
    },
    /// Layout points that the body lacks.
    PointsWithoutPlace {
        /// Their names.
        points: Vec<String>,
    },
    /// The cameras are far away for a body of this size.
    Millimetres {
        /// Largest distance of a camera from the origin.
        distance: f64,
        /// Size of the skeleton, in the same unit.
        height: f64,
    },
    /// The person moves faster than people do.
    Fast {
        /// Part of the body.
        part: &'static str,
        /// Its speed, metres a second.
        m_per_s: f64,
        /// Speed of the fastest people.
        fastest_m_per_s: f64,
        /// Frames per second taken.
        fps: f64,
    },
    /// The subject lies behind some cameras.
    Behind {
        /// Cameras that the subject is behind.
        cameras: usize,
        /// Of all these.
        of: usize,
        /// Which, where the other cameras found the subject.
        names: Vec<String>,
    },
    /// The world's z axis points down the body.
    FeetAboveHead {
        /// Frames looked at.
        frames: usize,
        /// The axis that points up the body.
        up_axis: &'static str,
    },
    /// The world's z axis is nearest to up, and does not point there.
    Unlevel {
        /// Angle between z and up, degrees.
        tilt_deg: f64,
        /// Standard deviation of what points up, degrees.
        sd_deg: f64,
    },
    /// A camera's keypoints scatter more than a calibrated camera's.
    Scatter {
        /// Camera.
        camera: String,
        /// Scatter per axis, pixels.
        px: f64,
    },
    /// A camera shows people, and hardly ever the one that the others see.
    Unmatched {
        /// Camera.
        camera: String,
        /// Frames in which it shows people.
        shown: u64,
        /// Frames in which the tracked person is among them.
        matched: u64,
    },
    /// Clocks of cameras are off.
    Unsynchronised {
        /// Cameras, each with the frames that it is late.
        cameras: Vec<(String, CameraLag)>,
        /// The setting `lag` that mends it.
        mended: Vec<(String, ClockLag)>,
    },
    /// One camera suddenly shows someone elsewhere.
    Jump {
        /// Camera.
        camera: String,
        /// Frame.
        frame: u64,
        /// Median distance of the keypoints from where they are expected, pixels.
        px: f64,
    },
    /// Left and right are swapped in one camera for a span.
    Swapped {
        /// Camera.
        camera: String,
        /// First frame.
        first: u64,
        /// Last frame.
        last: u64,
        /// Residual as labelled, pixels.
        residual_px: f64,
        /// Residual with the labels swapped, pixels.
        swapped_px: f64,
    },
}

impl fmt::Display for SetupWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneCamera => write!(f, "one camera: depth comes from the prior only"),
            Self::Unmeasured { sizes } => {
                write!(f, "not measured, scaled with the other sizes: {}", sizes.join(", "))
            }
            Self::PointsWithoutPlace { points } => {
                write!(f, "points of the layout that the body lacks, ignored: {}", points.join(", "))
            }
            Self::Millimetres { distance, height } => write!(
                f,
                "cameras stand {distance:.0} units from the origin but the skeleton is {height:.1} tall; are translations in millimetres?"
            ),
            Self::Fast { part, m_per_s, fastest_m_per_s, fps } => write!(
                f,
                "at {fps} frames per second the person's {part} would move at {m_per_s:.0} m/s, where the fastest people reach {fastest_m_per_s} m/s; is {} right?",
                flag("fps")
            ),
            Self::Behind { cameras, of, names } => {
                write!(f, "in {cameras} of {of} cameras the subject lies behind the lens; is the pose inverted?")?;
                if names.is_empty() { Ok(()) } else { write!(f, " ({})", names.join(", ")) }
            }
            Self::FeetAboveHead { frames, up_axis } => {
                let what = if *up_axis == "-z" { "feet are above the head" } else { "the body does not stand along z" };
                write!(f, "{what} in the first {frames} frames; ")?;
                match *up_axis {
                    // Another axis or direction was declared.
                    Z_UP => write!(f, "leave `up_axis` and `up` out (found: {up_axis}, the default)")?,
                    _ => write!(f, "set `up_axis` (found: {up_axis})")?,
                }
                write!(f, ", or let the person say where up is: {}", flag_with("up", "auto"))
            }
            Self::Unlevel { tilt_deg, sd_deg } => write!(
                f,
                "the world is not level: the person stands {tilt_deg:.0} ± {sd_deg:.0}° away from its z axis; {} levels it by the person, {} by a direction",
                flag_with("up", "auto"),
                flag_with("up", "X,Y,Z")
            ),
            Self::Scatter { camera, px } => {
                write!(f, "{camera}: keypoints scatter by {px:.0} px; is this the calibration of this camera?")
            }
            Self::Unmatched { camera, shown, matched } => write!(
                f,
                "{camera} shows people in {shown} frames, and in {matched} of them the person whom the other cameras see; is this the calibration of this camera?"
            ),
            Self::Unsynchronised { cameras, mended } => {
                let late = cameras.iter().map(|(camera, lag)| {
                    let side = if lag.frames > 0.0 { "late" } else { "early" };
                    format!("{camera} is {:.1} ± {:.1} frames {side}", lag.frames.abs(), lag.sd)
                });
                let lags = mended.iter().map(|(camera, lag)| format!("{camera}={lag}")).collect::<Vec<_>>().join(",");
                let late = late.collect::<Vec<_>>().join(", ");
                write!(f, "{late} against the other cameras; ")?;
                match mended.is_empty() {
                    true => write!(f, "leave {} out, which reads frames that do not belong together", flag("lag")),
                    false => write!(f, "{} reads the frames that belong together", flag_with("lag", lags)),
                }
            }
            Self::Jump { camera, frame, px } => write!(f, "{camera} frame {frame}: jump of {px:.0} px in all joints"),
            Self::Swapped { camera, first, last, residual_px, swapped_px } => write!(
                f,
                "{camera} frames {first}-{last}: swapping left and right lowers the residual from {residual_px:.0} to {swapped_px:.0} px"
            ),
        }
    }
}
