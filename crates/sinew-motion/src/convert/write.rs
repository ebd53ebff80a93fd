//! Writes a motion in another format, or says why it cannot be.

use super::c3d_points;
use super::content::{Content, Motion};
use super::error::MotionError;
use super::format::Format;
use super::read::is_length;
use crate::gltf;
use sinew_formats::bvh::{self, Bvh, Channel};
use sinew_formats::tidy_csv::{self, Cell};
use sinew_formats::{mot, point_table, trc};
use std::io;

/// The motion as a file of the given format; `file_name` stands in the header of TRC files.
///
/// # Errors
/// A conversion that needs inverse kinematics; names that the format cannot hold.
pub fn write(motion: &Motion, format: Format, file_name: &str) -> Result<Vec<u8>, MotionError> {
    let mut out = Vec::new();
    let written = match (format, &motion.content) {
        (Format::Trc | Format::C3d, _) => match motion.points() {
            Some(points) if format == Format::C3d => c3d_points::write(&mut out, motion.rate_hz, &points),
            Some(points) => as_trc(&mut out, motion, &points, file_name),
            None => return Err(impossible(motion, format, "coordinates do not say where the markers are")),
        },
        (Format::Csv, Content::Coordinates(coordinates)) => as_table(&mut out, coordinates),
        (Format::Csv, _) => match motion.points() {
            Some(points) => as_points(&mut out, &points),
            None => Ok(()),
        },
        (Format::Mot, Content::Coordinates(coordinates)) => as_mot(&mut out, coordinates),
        (Format::Mot, Content::Skeleton(skeleton)) => as_mot(&mut out, &channels(skeleton)),
        (Format::Mot, Content::Points(_)) => return Err(impossible(motion, format, "points have no joint angles")),
        (Format::Bvh, Content::Skeleton(skeleton)) => bvh::write(&mut out, skeleton),
        (Format::Glb, Content::Skeleton(skeleton)) => gltf::write(&mut out, skeleton),
        (Format::Bvh | Format::Glb, Content::Points(_)) => {
            return Err(impossible(motion, format, "points have no bones"));
        }
        (Format::Bvh | Format::Glb, Content::Coordinates(_)) => {
            return Err(impossible(motion, format, "coordinates have no bones"));
        }
        (Format::Amc, _) => {
            return Err(MotionError::ReadOnly);
        }
    };
    match written {
        Ok(()) => Ok(out),
        Err(refusal) => Err(MotionError::Unwritable { format: format.name(), refusal }),
    }
}

fn impossible(motion: &Motion, format: Format, reason: &'static str) -> MotionError {
    let instead = match &motion.content {
        Content::Points(_) => {
            "that takes inverse kinematics: track the keypoints with `sinew track`, or use OpenSim; .trc, .c3d and .csv are possible"
        }
        Content::Coordinates(_) => "take the marker file of the same motion; .csv is possible",
        Content::Skeleton(_) => ".trc, .c3d, .csv, .mot, .bvh and .glb are possible",
    };
    MotionError::Impossible { from: motion.format.name(), to: format.name(), reason, instead }
}

fn as_trc(out: &mut Vec<u8>, motion: &Motion, points: &point_table::PointTable, file_name: &str) -> io::Result<()> {
    let mut header = trc::Header::new(file_name, motion.rate_hz, points.names.clone());
    header.start_frame = motion.start_frame;
    let frames = points.frames.iter().zip(&points.time_s).zip(1..).map(|((frame, &time_s), number)| trc::TrcFrame {
        number,
        time_s,
        points: frame.iter().map(|point| point.map(trc::trc_from_world)).collect(),
    });
    trc::write(out, &trc::Trc { header, frames: frames.collect(), warnings: Vec::new() })
}

fn as_points(out: &mut Vec<u8>, points: &point_table::PointTable) -> io::Result<()> {
    tidy_csv::write_header(out, &point_table::columns(&points.names))?;
    points
        .frames
        .iter()
        .zip(&points.time_s)
        .try_for_each(|(frame, &time_s)| point_table::write_frame(out, time_s, frame))
}

fn as_table(out: &mut Vec<u8>, coordinates: &mot::Mot) -> io::Result<()> {
    let unit = |column: &String| format!("{column}_{}", if is_length(column) { "m" } else { "deg" });
    let columns: Vec<String> =
        std::iter::once("time_s".to_owned()).chain(coordinates.columns.iter().map(unit)).collect();
    tidy_csv::write_header(out, &columns)?;
    coordinates.rows.iter().zip(&coordinates.time_s).try_for_each(|(row, &time_s)| {
        let cells: Vec<Cell<'_>> = std::iter::once(time_s).chain(row.iter().copied()).map(Cell::Number).collect();
        tidy_csv::write_row(out, &cells)
    })
}

fn as_mot(out: &mut Vec<u8>, coordinates: &mot::Mot) -> io::Result<()> {
    let rows = u32::try_from(coordinates.rows.len()).map_err(io::Error::other)?;
    mot::write_header(out, "Coordinates", &coordinates.columns, rows)?;
    coordinates.rows.iter().zip(&coordinates.time_s).try_for_each(|(row, &time_s)| mot::write_row(out, time_s, row))
}

/// The columns of a skeleton's BVH file as coordinates: `<joint>_rz` in degrees, `<joint>_tx` in the file's unit (metres where it comes from Acclaim). The names are
/// the skeleton's, not the names of a model of OpenSim.
fn channels(skeleton: &Bvh) -> mot::Mot {
    let named = skeleton.joints.iter().flat_map(|joint| joint.channels.iter().map(move |channel| (joint, channel)));
    let columns = named.map(|(joint, channel)| {
        let name = joint.name.split_whitespace().collect::<Vec<_>>().join("_");
        match channel {
            Channel::Position(axis) => format!("{name}_t{}", ['x', 'y', 'z'][*axis]),
            Channel::Rotation(axis) => format!("{name}_r{}", ['x', 'y', 'z'][*axis]),
        }
    });
    mot::Mot {
        title: "Coordinates".into(),
        in_degrees: true,
        columns: columns.collect(),
        time_s: (0..skeleton.frames.len()).map(|i| i as f64 * skeleton.frame_time_s).collect(),
        rows: skeleton.frames.clone(),
        warnings: Vec::new(),
    }
}
