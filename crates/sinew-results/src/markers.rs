//! `markers.trc`, the points of the mean pose for OpenSim, and `markers_sd.csv`, how well each is known.
//!
//! The points of the Pose2Sim reference come first, in its order; the body's other points follow in theirs. Axes are Y up, metres. The standard deviation of a marker
//! within the run, without the shift that all markers share, is the root mean square over its axes, metres: one weight for inverse kinematics.

use super::partial::{FilePlace, PartialFile};
use super::tables::integer;
use crate::Error;
use crate::estimate::{FrameEstimate, RunInfo};
use sinew_body::KinematicTree;
use sinew_formats::tidy_csv::Cell;
use sinew_formats::trc;
use sinew_setup::posed_body::Pose;

/// Order of the points in the marker files of Pose2Sim.
pub const REFERENCE_ORDER: [&str; 21] = [
    "RHip",
    "RKnee",
    "RAnkle",
    "RBigToe",
    "RSmallToe",
    "RHeel",
    "LHip",
    "LKnee",
    "LAnkle",
    "LBigToe",
    "LSmallToe",
    "LHeel",
    "Neck",
    "Head",
    "Nose",
    "RShoulder",
    "RElbow",
    "RWrist",
    "LShoulder",
    "LElbow",
    "LWrist",
];

/// Points of a body in the order of marker files.
#[must_use]
pub fn order(body: &KinematicTree) -> Vec<usize> {
    let mut order: Vec<usize> = REFERENCE_ORDER.iter().filter_map(|name| body.point_index(name)).collect();
    order.extend(
        (0..body.points().len()).filter(|index| !REFERENCE_ORDER.contains(&body.points()[*index].name.as_str())),
    );
    order
}

pub(crate) struct Markers {
    order: Vec<usize>,
    header: trc::Header,
    pub(crate) trc: PartialFile,
    pub(crate) sd: PartialFile,
}

impl Markers {
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo) -> Result<Self, Error> {
        let order = order(&info.body);
        let names: Vec<String> = order.iter().map(|&index| info.body.points()[index].name.clone()).collect();
        let mut header = trc::Header::new("markers.trc", info.fps, names.clone());
        header.start_frame = i64::try_from(info.first_frame).unwrap_or(i64::MAX);
        let trc = place.file("markers.trc", |out| trc::write_header(out, &header, 0))?;
        let columns =
            ["frame".into(), "time_s".into()].into_iter().chain(names.iter().map(|name| format!("{name}_sd_m")));
        let sd = place.table("markers_sd.csv", &columns.collect::<Vec<String>>())?;
        Ok(Self { order, header, trc, sd })
    }

    pub(crate) fn append(&mut self, row: u64, estimate: &FrameEstimate, pose: &Pose) -> Result<(), Error> {
        let points: Vec<Option<[f64; 3]>> =
            self.order.iter().map(|&index| Some(trc::trc_from_world(pose.points[index]))).collect();
        let number = i64::try_from(row + 1).unwrap_or(i64::MAX);
        self.trc.write(|out| trc::write_frame(out, number, estimate.time_s, &points))?;
        let deviation = |index: &usize| {
            let [x, y, z] = estimate.points[*index].sd_within;
            Cell::Number(((x * x + y * y + z * z) / 3.0).sqrt())
        };
        let mut cells = vec![integer(estimate.number), Cell::Number(estimate.time_s)];
        cells.extend(self.order.iter().map(deviation));
        self.sd.row(&cells)
    }

    pub(crate) fn finish(mut self, frames: u64) -> Result<[PartialFile; 2], Error> {
        let frames = u32::try_from(frames).unwrap_or(u32::MAX);
        self.trc.rewrite_start(|out| trc::write_header(out, &self.header, frames))?;
        Ok([self.trc, self.sd])
    }
}
