//! A motion in memory: its contents, frame rate and first frame.

use super::format::Format;
use sinew_formats::bvh::{self, Bvh};
use sinew_formats::mot::Mot;
use sinew_formats::point_table::PointTable;

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
    /// Frames per second; 0 where there are fewer than two frames.
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
