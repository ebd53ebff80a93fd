//! Motion files as values, and what can become of them.
//!
//! A file holds *points* (TRC, CSV), *coordinates* (MOT, CSV) or a *skeleton* (BVH, ASF/AMC). A skeleton says where its points are, so it becomes points; nothing
//! becomes a skeleton or coordinates of OpenSim without inverse kinematics, which is tracking and not conversion:
//!
//! | from \ to | TRC | CSV | MOT | BVH |
//! |---|---|---|---|---|
//! | TRC | yes | points | no | no |
//! | CSV of points | yes | yes | no | no |
//! | MOT, CSV of coordinates | no | yes | yes | no |
//! | BVH | joints and tips | joints and tips | its channels | yes |
//! | AMC with ASF | bone ends | bone ends | channels of its BVH | yes |
//!
//! In between everything is in the world frame (Z up), metres and seconds; BVH files state no unit of length and are taken as metres.

mod acclaim;
pub(crate) mod error;
mod read;
mod write;

pub use error::MotionError;
pub use read::read;
pub use write::write;

use sinew_formats::bvh::{self, Bvh};
use sinew_formats::mot::Mot;
use sinew_formats::point_table::PointTable;
use std::path::Path;

/// Format of a motion file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Trajectories of markers.
    Trc,
    /// A table.
    Csv,
    /// Coordinates of OpenSim.
    Mot,
    /// Skeleton and angles.
    Bvh,
    /// Angles of an Acclaim skeleton.
    Amc,
}

const EXTENSIONS: [(&str, Format); 6] = [
    ("trc", Format::Trc),
    ("csv", Format::Csv),
    ("mot", Format::Mot),
    ("sto", Format::Mot),
    ("bvh", Format::Bvh),
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
            Self::Csv => "CSV",
            Self::Mot => "MOT",
            Self::Bvh => "BVH",
            Self::Amc => "AMC",
        }
    }
}

/// What a motion file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Points over time.
    Points(PointTable),
    /// Coordinates over time, degrees and metres.
    Coordinates(Mot),
    /// A skeleton over time.
    Skeleton(Bvh),
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Format of the file.
    pub format: Format,
    /// Frames per second; 0 where one frame or none tells nothing.
    pub rate_hz: f64,
    /// Number of the first frame of the original recording.
    pub start_frame: i64,
    /// What the file holds.
    pub content: Content,
    /// What was odd.
    pub warnings: Vec<String>,
}

impl Motion {
    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        match &self.content {
            Content::Points(points) => points.frames.len(),
            Content::Coordinates(coordinates) => coordinates.rows.len(),
            Content::Skeleton(skeleton) => skeleton.frames.len(),
        }
    }

    /// Points of the motion in the world, if it says where they are.
    #[must_use]
    pub fn points(&self) -> Option<PointTable> {
        match &self.content {
            Content::Points(points) => Some(points.clone()),
            Content::Coordinates(_) => None,
            Content::Skeleton(skeleton) => Some(PointTable {
                names: skeleton.point_names(),
                time_s: (0..skeleton.frames.len()).map(|i| i as f64 * skeleton.frame_time_s).collect(),
                frames: skeleton
                    .frames
                    .iter()
                    .map(|row| {
                        let points = bvh::forward_kinematics(&skeleton.joints, row);
                        points.into_iter().map(|point| Some(bvh::world_from_bvh(point))).collect()
                    })
                    .collect(),
            }),
        }
    }
}

/// Frames per second of rising times.
#[must_use]
pub fn rate_of(time_s: &[f64]) -> f64 {
    match (time_s.first(), time_s.last()) {
        (Some(first), Some(last)) if last > first => {
            let rate = (time_s.len() - 1) as f64 / (last - first);
            // Times are written with few digits: 59.9994 is 60.
            if (rate - rate.round()).abs() < 1e-3 * rate { rate.round() } else { rate }
        }
        _ => 0.0,
    }
}
