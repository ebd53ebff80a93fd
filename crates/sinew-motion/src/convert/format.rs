//! Format of a motion file, by its extension.

use super::error::MotionError;
use std::path::Path;

/// Format of a motion file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Trajectories of markers.
    Trc,
    /// Trajectories of markers of a laboratory.
    C3d,
    /// A table.
    Csv,
    /// Coordinates of OpenSim.
    Mot,
    /// Skeleton and angles.
    Bvh,
    /// Skeleton, motion and a mesh of the bones for viewers and engines; only written.
    Glb,
    /// Angles of an Acclaim skeleton; only read.
    Amc,
}

const EXTENSIONS: [(&str, Format); 8] = [
    ("trc", Format::Trc),
    ("c3d", Format::C3d),
    ("csv", Format::Csv),
    ("mot", Format::Mot),
    ("sto", Format::Mot),
    ("bvh", Format::Bvh),
    ("glb", Format::Glb),
    ("amc", Format::Amc),
];

impl Format {
    /// Format that the extension of a path names.
    ///
    /// # Errors
    /// Any other extension.
    pub fn of(path: &Path) -> Result<Self, MotionError> {
        let extension =
            path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
        let found = EXTENSIONS.iter().find(|(known, _)| *known == extension).map(|(_, format)| *format);
        found.ok_or_else(|| MotionError::UnknownExtension { path: path.to_owned(), extension })
    }

    /// Name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Trc => "TRC",
            Self::C3d => "C3D",
            Self::Csv => "CSV",
            Self::Mot => "MOT",
            Self::Bvh => "BVH",
            Self::Glb => "glTF",
            Self::Amc => "AMC",
        }
    }
}
