//! What is odd about a file that is read all the same.
//!
//! Libraries do not print: a reader returns its warnings as values, and the caller counts and shows them.

use crate::Place;
use crate::numbers::Rough;
use std::fmt;

/// Something odd that was read all the same.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Frames whose file names nobody, or that have no file.
    NoPerson {
        /// Camera.
        camera: String,
        /// How many.
        empty: u64,
        /// Of how many.
        frames: u64,
        /// First of them.
        first: u64,
    },
    /// Holes in the numbering of a camera's files.
    LacksFrames {
        /// Camera.
        camera: String,
        /// Numbers that are missing.
        frames: Vec<u64>,
    },
    /// Confident keypoints without coordinates.
    NoCoordinates {
        /// How many.
        points: u64,
    },
    /// Confident keypoints at exactly (0, 0).
    AtOrigin {
        /// Confidence of the first of them.
        confidence: f64,
        /// In how many frames.
        frames: u64,
    },
    /// A rotation matrix that was made orthonormal.
    RotationRepaired {
        /// Camera.
        place: Place,
        /// Largest entry of R'R − 1 before the repair.
        deviation: f64,
    },
    /// A skew in the camera matrix, which the camera model lacks.
    SkewIgnored {
        /// Camera.
        place: Place,
        /// Skew, pixels.
        skew: f64,
    },
    /// A camera of a calibration that is not used.
    CameraLeftOut {
        /// Where it stands in the file.
        place: Place,
        /// Its name.
        camera: String,
        /// Why it is left out.
        why: &'static str,
    },
    /// A calibration that states no unit, with cameras too far away for metres.
    MillimetresAssumed {
        /// File.
        place: Place,
        /// Distance of the farthest camera from the origin, in the unit of the file.
        distance: f64,
    },
    /// A camera that was calibrated on its side or upside down.
    TurnedView {
        /// Camera.
        place: Place,
        /// By how much its program turns the picture.
        degrees: f64,
    },
    /// Cameras much farther away than a person is tall.
    FarCameras {
        /// Median distance from the origin, in the units of the file.
        distance: f64,
        /// Height of the body, metres.
        height: f64,
    },
    /// A count in a header that the file does not keep.
    CountDisagrees {
        /// File.
        place: Place,
        /// Name of the field.
        field: &'static str,
        /// Count stated.
        stated: u64,
        /// Count found.
        found: u64,
    },
    /// More frames in a file than it says that it has.
    UnreadFrames {
        /// File.
        place: Place,
        /// Frames that are read.
        read: u64,
        /// Frames for which the file has bytes.
        room: u64,
    },
    /// Coordinate labels that are not X1 Y1 Z1 X2 …
    OddLabels {
        /// File.
        place: Place,
        /// First label found.
        first: String,
    },
    /// A marker name that stands for two columns.
    RepeatedMarker {
        /// File.
        place: Place,
        /// The name.
        name: String,
    },
    /// Spaces where tabs belong.
    SpacesForTabs {
        /// File.
        place: Place,
    },
    /// Rows with the time of the row above.
    TimeStandsStill {
        /// File.
        place: Place,
        /// How many rows.
        rows: u64,
        /// First of them, counted from 1.
        first: u64,
    },
    /// A field that is not there and was assumed.
    Assumed {
        /// File.
        place: Place,
        /// Name of the field.
        field: &'static str,
        /// Value taken.
        value: String,
    },
    /// Entries of a keypoint file that are no people.
    EntriesLeftOut {
        /// File.
        place: Place,
        /// How many.
        entries: u64,
        /// Why they are left out.
        why: &'static str,
    },
    /// The columns of a DeepLabCut file that belong to no individual.
    SingleLeftOut {
        /// File.
        place: Place,
        /// Points in these columns.
        points: usize,
    },
    /// A calibrated camera for which there is no data.
    NoKeypoints {
        /// Name in the calibration.
        camera: String,
        /// Names of the keypoint folders.
        folders: Vec<String>,
    },
}

/// Numbers listed before a list is cut short.
const LISTED: usize = 12;

/// What is said of DeepLabCut's individual `single`.
const SINGLE: &str = "is left out: it is DeepLabCut's name for points of no individual";

fn are(entries: u64) -> String {
    if entries == 1 { "1 entry is".into() } else { format!("{entries} entries are") }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPerson { camera, empty, frames, first } => {
                write!(f, "camera {camera}: {empty} of {frames} frames have no person (first: {first})")
            }
            Self::LacksFrames { camera, frames } => {
                let listed: Vec<String> = frames.iter().take(LISTED).map(u64::to_string).collect();
                write!(f, "{camera} lacks frames {}", listed.join(", "))?;
                if frames.len() > LISTED { write!(f, " and {} more", frames.len() - LISTED) } else { Ok(()) }
            }
            Self::NoCoordinates { points } => {
                write!(f, "{points} points have no coordinates but confidence > 0; treated as missing")
            }
            Self::AtOrigin { confidence, frames } => write!(
                f,
                "point at exactly (0,0) with confidence {confidence} in {frames} frames; is this your tracker's mark for 'not found'?"
            ),
            Self::RotationRepaired { place, deviation } => {
                write!(f, "{place}: R'R differs from identity by {}; repaired", Rough(*deviation))
            }
            Self::SkewIgnored { place, skew } => write!(f, "{place}: skew of {skew} px ignored"),
            Self::CameraLeftOut { place, camera, why } => write!(f, "{place}: camera `{camera}` is left out: {why}"),
            Self::MillimetresAssumed { place, distance } => write!(
                f,
                "{place}: no unit is stated and a camera stands {distance:.0} units from the origin; millimetres assumed (`unit = \"m\"` states metres)"
            ),
            Self::TurnedView { place, degrees } => write!(
                f,
                "{place}: the view is turned by {degrees} degrees; the calibration is that of the picture as it is recorded, not turned"
            ),
            Self::FarCameras { distance, height } => write!(
                f,
                "cameras stand {distance:.0} units from the origin but the skeleton is {height:.1} tall; are translations in millimetres?"
            ),
            Self::CountDisagrees { place, field, stated, found } => {
                write!(f, "{place}: {field} says {stated}, the file holds {found}")
            }
            Self::UnreadFrames { place, read, room } => write!(f, "{place}: {read} of {room} possible frames are read"),
            Self::OddLabels { place, first } => {
                write!(f, "{place}: coordinate labels start with `{first}` instead of `X1`; taken in order")
            }
            Self::RepeatedMarker { place, name } => {
                write!(f, "{place}: marker `{name}` is there twice; the first one is taken where it is named")
            }
            Self::SpacesForTabs { place } => {
                write!(f, "{place}: spaces instead of tabs; names cannot contain spaces then")
            }
            Self::TimeStandsStill { place, rows, first } => {
                write!(f, "{place}: {rows} rows have the time of the row above (first: row {first})")
            }
            Self::Assumed { place, field, value } => write!(f, "{place}: {field} is not given; {value} assumed"),
            Self::EntriesLeftOut { place, entries, why } => write!(f, "{place}: {} left out: {why}", are(*entries)),
            Self::SingleLeftOut { place, points } => write!(f, "{place}: `single` (points: {points}) {SINGLE}"),
            Self::NoKeypoints { camera, folders } => {
                write!(f, "no keypoints for calibrated camera `{camera}`; folders: {}", folders.join(", "))
            }
        }
    }
}
