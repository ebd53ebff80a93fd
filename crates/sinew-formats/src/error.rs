//! What can be wrong with a file.
//!
//! One variant per violated condition, with the values found. The text of a variant says where, what was found and what
//! was expected.

use crate::Place;
use crate::nearest::suggestion;
use crate::numbers::{Bytes, Count, Rough};

/// Everything that this crate refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A byte that no UTF-8 text contains at this place.
    #[error("{}: byte 0x{byte:02X} at line {line} is not UTF-8; save as UTF-8", place)]
    NotUtf8 {
        /// File at fault.
        place: Place,
        /// First offending byte.
        byte: u8,
        /// Its line, counted from 1.
        line: usize,
        /// Its offset from the start of the file.
        offset: usize,
    },
    /// The file is larger than any of its kind should be.
    #[error("{place}: the file has {}; at most {} are read", Bytes(*bytes), Bytes(*limit))]
    TooLarge {
        /// File at fault.
        place: Place,
        /// Its size.
        bytes: u64,
        /// Size up to which it would have been read.
        limit: u64,
    },
    /// The text stops before it is complete.
    #[error("{place}: ends inside {inside} at byte {}{}", Count(*offset as u64), line.map(|line| format!(" (line {line})")).unwrap_or_default())]
    Truncated {
        /// File at fault.
        place: Place,
        /// What was open at the end, with its article.
        inside: &'static str,
        /// Length of the text, bytes.
        offset: usize,
        /// Last line, counted from 1; none where the file is no text.
        line: Option<usize>,
    },
    /// Brackets nested deeper than any real file nests them.
    #[error("{place}: nested more than {limit} deep")]
    TooDeep {
        /// Line where the limit is passed.
        place: Place,
        /// Allowed depth.
        limit: usize,
    },
    /// More of something than any real file has.
    #[error("{place}: more than {} {what}, the most that are read", Count(*limit as u64))]
    TooMany {
        /// Where the limit is passed.
        place: Place,
        /// What is counted, plural.
        what: &'static str,
        /// The most that are read.
        limit: usize,
    },
    /// A count in a header that the file cannot hold.
    #[error("{place}: file claims {} {unit}, holds {}", Count(*claimed), Bytes(*bytes))]
    ImpossibleCount {
        /// File at fault.
        place: Place,
        /// Count claimed.
        claimed: u64,
        /// What is counted, plural.
        unit: &'static str,
        /// Size of the file.
        bytes: u64,
    },
    /// The text breaks the grammar of its format.
    #[error("{place}: {found}; expected {expected}")]
    Syntax {
        /// Where.
        place: Place,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// NaN, an infinity or a number too large for an `f64`.
    #[error("{}: value out of range at line {line}", place)]
    OutOfRange {
        /// File at fault.
        place: Place,
        /// Line, counted from 1.
        line: usize,
    },
    /// A comma where a decimal point belongs.
    #[error("{place}: `{found}` has a decimal comma; expected a decimal point")]
    DecimalComma {
        /// Where.
        place: Place,
        /// The number as it stands there.
        found: String,
    },
    /// A value outside what its field allows.
    #[error("{place}: {field} = {found}; must be {expected}")]
    BadValue {
        /// Where.
        place: Place,
        /// Name of the field.
        field: String,
        /// Value found.
        found: String,
        /// Values allowed.
        expected: String,
    },
    /// A field that the format demands is not there.
    #[error("{place}: `{field}` is missing")]
    MissingField {
        /// Where.
        place: Place,
        /// Name of the field.
        field: String,
    },
    /// A key of our own files that does not exist.
    #[error("{place}: unknown key `{key}`{}", suggestion(nearest))]
    UnknownKey {
        /// Where.
        place: Place,
        /// Key found.
        key: String,
        /// Known key nearest to it.
        nearest: Option<String>,
    },
    /// A reference to something that was never defined.
    #[error("{place}: unknown {what} `{name}`{}", suggestion(nearest))]
    UnknownName {
        /// Where.
        place: Place,
        /// Kind of thing, singular.
        what: &'static str,
        /// Name found.
        name: String,
        /// Known name nearest to it.
        nearest: Option<String>,
    },
    /// One name for two things.
    #[error("{place}: the {what} `{name}` is there twice")]
    DuplicateName {
        /// Where the second one stands.
        place: Place,
        /// Kind of thing, singular.
        what: &'static str,
        /// The shared name.
        name: String,
    },
    /// A valid file that asks for something this crate does not do.
    #[error("{place}: {what} is not supported")]
    Unsupported {
        /// Where.
        place: Place,
        /// What is required.
        what: String,
    },
    /// A row with more or fewer values than the header announces.
    #[error("{place}: {found} values; expected {expected}")]
    RowLength {
        /// Where.
        place: Place,
        /// Values found.
        found: usize,
        /// Values announced.
        expected: usize,
    },
    /// A time stamp before that of the row above.
    #[error("{place}: time goes back at row {row}: {after} after {before} s")]
    TimeBackwards {
        /// Where.
        place: Place,
        /// Row of data, counted from 1.
        row: usize,
        /// Time of the row above, seconds.
        before: f64,
        /// Time found, seconds.
        after: f64,
    },
    /// Keypoints of another layout than the requested one.
    #[error("{place}: {found} numbers, layout `{layout}` needs {expected}")]
    KeypointCount {
        /// Where.
        place: Place,
        /// Numbers found.
        found: usize,
        /// Name of the layout.
        layout: String,
        /// Three times its number of keypoints.
        expected: usize,
    },
    /// Keypoints that are no triples.
    #[error("{place}: {found} numbers; keypoints are triples x, y, confidence")]
    NotTriples {
        /// Where.
        place: Place,
        /// Numbers found.
        found: usize,
    },
    /// A confidence outside \[0, 1\] after division by the declared scale.
    #[error("{place}: confidence {found:?} found; expected 0 to {scale}{}", scale_advice(*found, *scale))]
    Confidence {
        /// Where.
        place: Place,
        /// Confidence found.
        found: f64,
        /// Scale in force.
        scale: f64,
    },
    /// A keypoint layout that is not known.
    #[error("unknown layout `{name}`; known: {}; or give a mapping file{}", known.join(", "), suggestion(nearest))]
    UnknownLayout {
        /// Requested name.
        name: String,
        /// Known names.
        known: Vec<String>,
        /// Known name nearest to it.
        nearest: Option<String>,
    },
    /// Two keypoint files for one frame.
    #[error("two files claim frame {frame}: {first}, {second}")]
    DuplicateFrame {
        /// Frame number.
        frame: u64,
        /// First file.
        first: String,
        /// Second file.
        second: String,
    },
    /// A file name without a frame number.
    #[error("{name}: no frame number in the file name; expected a name like `cam01.0034.{}`", extension(name))]
    NoFrameNumber {
        /// File name.
        name: String,
    },
    /// Recordings of two cameras that do not begin or end together.
    #[error("{camera} has {frames} frames, {other} has {other_frames}; difference {}", difference(*frames, *other_frames, *ends))]
    FrameRanges {
        /// A camera.
        camera: String,
        /// Its number of frames, holes included.
        frames: u64,
        /// Camera that differs from it.
        other: String,
        /// Its number of frames, holes included.
        other_frames: u64,
        /// Difference of the first and of the last frame numbers (other minus camera).
        ends: (i64, i64),
    },
    /// Two cameras that cannot be distinguished by name.
    #[error("cameras `{first}` and `{second}` have the same name but for punctuation, case and leading zeros")]
    CameraCollision {
        /// First name.
        first: String,
        /// Second name.
        second: String,
    },
    /// Keypoints of a camera that the calibration lacks.
    #[error("no calibration for `{name}`; calibrated: {}", calibrated.join(", "))]
    NoCalibration {
        /// Name of the keypoint folder.
        name: String,
        /// Names in the calibration.
        calibrated: Vec<String>,
    },
    /// A file of calibrated cameras in no known format.
    #[error("{place}: {found}; expected a calibration of Pose2Sim, Caliscope, Anipose, FreeMoCap, Qualisys or OpenCV")]
    UnknownCalibration {
        /// File at fault.
        place: Place,
        /// What stands there.
        found: String,
    },
    /// A camera that a format of calibrations cannot hold.
    #[error("camera `{camera}` cannot be written for {program}: {reason}")]
    CameraUnwritable {
        /// Its name.
        camera: String,
        /// Program that reads the format.
        program: &'static str,
        /// What the format lacks.
        reason: &'static str,
    },
    /// A rotation matrix too far from orthonormal to be repaired.
    #[error("{place}: R'R differs from identity by {}", Rough(*deviation))]
    NotOrthonormal {
        /// Camera at fault.
        place: Place,
        /// Largest entry of R'R − 1.
        deviation: f64,
    },
    /// A rotation matrix with determinant −1.
    #[error("{place}: R is a mirror image (determinant -1); axes are left-handed")]
    MirrorRotation {
        /// Camera at fault.
        place: Place,
    },
    /// An image larger than any camera's.
    #[error("{place}: the image has {width} x {height} pixels; at most {} are read", Count(*limit))]
    TooManyPixels {
        /// File at fault.
        place: Place,
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Number of pixels up to which it would have been read.
        limit: u64,
    },
    /// A mask in colour or with transparent pixels.
    #[error("{place}: {found}; a mask has one channel")]
    MaskChannels {
        /// File at fault.
        place: Place,
        /// What was found, with the first pixel of it.
        found: String,
    },
    /// A mask with several dark values: labels of several things.
    #[error("{place}: values {}; a mask has two, 0 and 255", listed_levels(levels))]
    MaskLevels {
        /// File at fault.
        place: Place,
        /// Values found, rising.
        levels: Vec<u8>,
    },
    /// Links and points that are no kinematic tree.
    #[error("{place}: not a valid body")]
    Body {
        /// File at fault.
        place: Place,
        /// What the body crate says.
        #[source]
        reason: sinew_body::Error,
    },
}

fn scale_advice(found: f64, scale: f64) -> String {
    if found < 0.0 || found.is_nan() {
        return "; negative confidences have no meaning".into();
    }
    let suited = [100.0, 255.0, 1000.0].into_iter().find(|&candidate| candidate > scale && found <= candidate);
    suited.map(|suited| format!("; set `confidence_scale = {suited}`")).unwrap_or_default()
}

fn extension(name: &str) -> &str {
    name.rsplit_once('.').map_or("json", |(_, extension)| extension)
}

fn listed_levels(levels: &[u8]) -> String {
    const SHOWN: usize = 5;
    let shown: Vec<String> = levels.iter().take(SHOWN).map(u8::to_string).collect();
    let more = if levels.len() > SHOWN { format!(" and {} more", levels.len() - SHOWN) } else { String::new() };
    format!("{}{more}", shown.join(", "))
}

fn difference(frames: u64, other_frames: u64, ends: (i64, i64)) -> String {
    match frames.abs_diff(other_frames) {
        0 => format!("0, but the first frames differ by {:+} and the last by {:+}", ends.0, ends.1),
        n => n.to_string(),
    }
}

/// The errors of a place.
impl Place {
    /// The error that something else stands here.
    pub(crate) fn syntax(self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::Syntax { place: self, found: found.into(), expected: expected.into() }
    }

    /// The error that a field has a value that it must not have.
    pub(crate) fn bad_value(
        self,
        field: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::BadValue { place: self, field: field.into(), found: found.into(), expected: expected.into() }
    }

    /// The error that a field is missing.
    pub(crate) fn lacks(self, field: impl Into<String>) -> Error {
        Error::MissingField { place: self, field: field.into() }
    }

    /// The error that a name is there twice.
    pub(crate) fn twice(self, what: &'static str, name: impl Into<String>) -> Error {
        Error::DuplicateName { place: self, what, name: name.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_is_advised_only_where_one_fits() {
        let text = |found, scale| Error::Confidence { place: Place::file("a.json"), found, scale }.to_string();
        assert_eq!(text(87.0, 1.0), "a.json: confidence 87.0 found; expected 0 to 1; set `confidence_scale = 100`");
        assert_eq!(
            text(-0.5, 1.0),
            "a.json: confidence -0.5 found; expected 0 to 1; negative confidences have no meaning"
        );
        assert_eq!(text(1e9, 1.0), "a.json: confidence 1000000000.0 found; expected 0 to 1");
    }

    #[test]
    fn errors_stay_small() {
        assert!(size_of::<Error>() <= 128);
    }
}
