//! What the set-up pass refuses of a recording and its calibration.

use super::warning::SetupWarning;

/// A recording that cannot be set up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// No keypoint is sure enough.
    #[error("the surest keypoint has confidence {surest:.3}; {least} is needed to set up")]
    Unsure {
        /// Largest confidence.
        surest: f64,
        /// Confidence that counts.
        least: f64,
    },
    /// The person is behind most cameras.
    #[error("{0}")]
    Behind(SetupWarning),
    /// Nobody at all.
    #[error("no person in any view of {frames} frames")]
    Nobody {
        /// Frames read.
        frames: u64,
    },
    /// Fewer people than the requested number.
    #[error("no person number {} that the cameras agree on in {frames} frames", person + 1)]
    NoSuchPerson {
        /// Requested place: 0 is the most complete one.
        person: usize,
        /// Frames read.
        frames: u64,
    },
    /// Nobody whom two cameras see at one place.
    #[error("no person whom two of {cameras} cameras agree on in {frames} frames")]
    NoAgreement {
        /// Cameras.
        cameras: usize,
        /// Frames read.
        frames: u64,
    },
    /// One camera shows too little of a person.
    #[error("too few keypoints of layout `{layout}` in {frames} frames")]
    TooFewKeypoints {
        /// Layout.
        layout: String,
        /// Frames read.
        frames: u64,
    },
    /// A camera that sees someone else than the others.
    #[error(
        "`{camera}` shows somebody else: the keypoints lie {distance_px:.0} px from where the other cameras see the person"
    )]
    SomebodyElse {
        /// Camera.
        camera: String,
        /// Length of its offset, pixels.
        distance_px: f64,
    },
    /// A camera of another frame rate.
    #[error(
        "{camera} records {rate:.4} frames for each frame of the other cameras: from frame {from} to {to} its lag changes by {change:+} frames"
    )]
    OtherRate {
        /// Camera.
        camera: String,
        /// Its rate over that of the others.
        rate: f64,
        /// Frame at which its lag was seen first.
        from: u64,
        /// Frame at which it was seen later.
        to: u64,
        /// Change of the lag, frames.
        change: i64,
    },
    /// Poses of cameras that fit when they are inverted.
    #[error(
        "the poses of the cameras fit when they are inverted (residual {inverted_px:.0} px instead of {now_px:.0} px)"
    )]
    InvertedPoses {
        /// Residual of the inverted poses, pixels.
        inverted_px: f64,
        /// Residual as they are, pixels.
        now_px: f64,
    },
    /// Keypoints of images of another size than the calibrated ones.
    #[error("{camera} is calibrated at {:.0}x{:.0}, the keypoints fit images of {:.0}x{:.0} (residual {fitting_px:.0} px instead of {now_px:.0} px); set `image_scale`", size_px[0], size_px[1], scale * size_px[0], scale * size_px[1])]
    ResizedImages {
        /// First camera.
        camera: String,
        /// Its calibrated size, pixels.
        size_px: [f64; 2],
        /// Scale that fits.
        scale: f64,
        /// Residual at that scale, pixels.
        fitting_px: f64,
        /// Residual as declared, pixels.
        now_px: f64,
    },
    /// Cameras that stand too far away for metres.
    #[error("{0}")]
    Millimetres(SetupWarning),
    /// A person of a size that nobody has.
    #[error(
        "the person would be {height_m:.3} m tall; are translations in metres, and do the cameras' poses belong to these images?"
    )]
    ImpossibleHeight {
        /// Height, metres.
        height_m: f64,
    },
    /// Segments that nobody has.
    #[error(
        "the person would have {}; is `{layout}` the layout of the detector, and are translations in metres?",
        listed(segments)
    )]
    SegmentLengths {
        /// The segments.
        segments: Vec<SegmentLength>,
        /// Layout in use.
        layout: String,
    },
    /// A person who moves as nobody can.
    #[error("{0}")]
    Fast(SetupWarning),
    /// Two cameras with each other's calibration.
    #[error("the keypoints of all cameras fit when the calibrations of {} and {} are exchanged (residual {residual_px:.0} px)", cameras[0], cameras[1])]
    ExchangedCameras {
        /// The two.
        cameras: [String; 2],
        /// Residual once they are exchanged, pixels.
        residual_px: f64,
    },
    /// Nobody who stands or walks shows where up is.
    #[error("nobody stands or walks in the {frames} frames looked at: where up is cannot be found")]
    NobodyUpright {
        /// Frames looked at.
        frames: usize,
    },
    /// No frame shows enough.
    #[error("no frame shows enough of the person for a pose")]
    NoPose,
    /// The body of a file has too few points of the layout.
    #[error("no frame shows a pose of the body of the file; of layout `{layout}` it has {} points: {}", shared.len(), shared.join(", "))]
    NoPoseOfFile {
        /// Layout.
        layout: String,
        /// Points that body and layout share.
        shared: Vec<String>,
    },
    /// A body without solids.
    #[error("the body cannot be compared with silhouettes: {0}")]
    NoFlesh(sinew_body::Error),
    /// What is constant has no posterior.
    #[error("what is constant over the recording cannot be measured: {0}")]
    Lasting(#[from] sinew_dynamics::Error),
    /// A set-up that has no text.
    #[error("the set-up cannot be written: {0}")]
    Unwritable(toml::ser::Error),
}

/// A segment whose length is nobody's.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentLength {
    /// Name, plural.
    pub name: &'static str,
    /// Length found, metres.
    pub found_m: f64,
    /// Least and greatest length among people, metres.
    pub people_m: [f64; 2],
}

fn listed(segments: &[SegmentLength]) -> String {
    let one = |segment: &SegmentLength| {
        let SegmentLength { name, found_m, people_m: [least, most] } = segment;
        format!("{name} of {found_m:.2} m (people: {least:.2} to {most:.2} m)")
    };
    segments.iter().map(one).collect::<Vec<_>>().join(", ")
}
