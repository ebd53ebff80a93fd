//! What is refused of motion files and their conversion.

use std::io;
use std::path::PathBuf;

/// A motion that cannot be read or converted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A file of another extension.
    #[error("{}: no motion format has the extension `.{extension}`", path.display())]
    UnknownExtension {
        /// File.
        path: PathBuf,
        /// Its extension.
        extension: String,
    },
    /// A skeleton for a file that has its own or needs none.
    #[error("{} needs no skeleton", path.display())]
    NeedlessSkeleton {
        /// File.
        path: PathBuf,
    },
    /// An AMC file without its ASF file.
    #[error("{file} holds angles without a skeleton")]
    NoSkeleton {
        /// File.
        file: String,
    },
    /// A table of results that is no motion.
    #[error("{file} is a table of results and no motion: {table}")]
    NoMotion {
        /// File.
        file: String,
        /// What the table holds.
        table: String,
        /// Files of a result folder that hold motions.
        motions: &'static str,
    },
    /// A table without times.
    #[error(
        "{file}: no column `time_s`; expected time_s and points (`RHip_x_m` …) or coordinates (`knee_angle_r_deg` …)"
    )]
    NoTimes {
        /// File.
        file: String,
    },
    /// A table without points and coordinates.
    #[error("{file}: neither points (`RHip_x_m` …) nor coordinates (`knee_angle_r_deg` …) among its columns")]
    NoColumns {
        /// File.
        file: String,
    },
    /// A format that is only read.
    #[error("AMC files are read, not written")]
    ReadOnly,
    /// A format that is only written.
    #[error("{}: glTF files are written, not read", path.display())]
    WriteOnly {
        /// File.
        path: PathBuf,
    },
    /// A conversion that takes more than the file holds.
    #[error("{from} cannot become {to}: {reason}")]
    Impossible {
        /// Format of the motion.
        from: &'static str,
        /// Format to be written.
        to: &'static str,
        /// What is lacking.
        reason: &'static str,
        /// What is possible.
        instead: &'static str,
    },
    /// Bones that are not ours, to be renamed.
    #[error("bones are renamed in a skeleton of `sinew track`, which has {wanted}")]
    OtherBones {
        /// Bones that it has.
        wanted: String,
    },
    /// Names or numbers that the format cannot hold.
    #[error("the motion cannot be written as {format}: {refusal}")]
    Unwritable {
        /// Format to be written.
        format: &'static str,
        /// What its writer says.
        refusal: io::Error,
    },
    /// A file of coordinates whose body is unknown.
    #[error("{}: coordinates without a body give no points", path.display())]
    NoPoints {
        /// File.
        path: PathBuf,
    },
    /// A file without one of the joints, or with a joint that is missing in a frame.
    #[error("{}: {problem}", path.display())]
    Joints {
        /// File.
        path: PathBuf,
        /// Why.
        problem: crate::FollowError,
    },
}
