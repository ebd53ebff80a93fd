//! The poses of a result folder, read back.
//!
//! No file of a folder holds states as such. The body is that of `setup.toml`; rotations come from `angles.csv`, by the names of the body's degrees of freedom; translations, which it lacks, are those that put the body's points on
//! `markers.trc`: points are affine in translations, so that least squares finds them exactly. Numbers of frames come from `frames.csv`.

use super::error::{Expected, ResultsError};
use crate::config::{Sources, TrackConfig, resolve};
use crate::input::lag::Lag;
use crate::input::recording::Calibrated;
use crate::input::up_axis::upright;
use crate::results::pose;
use crate::setup::Setup;
use crate::{Error, files};
use sinew_body::{Joint, KinematicTree};
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_formats::tidy_csv::{self, Cells};
use sinew_formats::{camera_name, trc};
use sinew_observe::Camera;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A body and its mean pose over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// The set-up of the run.
    pub setup: Setup,
    /// Size of the images in which its keypoints lie over that of the calibrated ones.
    pub image_scale: f64,
    /// How late cameras are.
    pub lag: Vec<(String, Lag)>,
    /// Frames a second.
    pub fps: f64,
    /// Number of each frame with the state of its mean pose, in the world turned to z up.
    pub frames: Vec<(u64, Vec<f64>)>,
}

/// Rounds of least squares, one translation after the other: one is enough for a root that moves along three axes.
const ROUNDS: usize = 50;

impl Tracked {
    /// Reads the poses of a run that came to its end.
    ///
    /// # Errors
    /// A folder without a summary, files that cannot be read, tables that do not belong together.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        if !folder.join("summary.json").exists() {
            std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
            return Err(ResultsError::NoSummary(folder.to_owned()).into());
        }
        let text = |name: &str, most| files::read_text(&folder.join(name), most);
        let shown = |name: &str| folder.join(name).display().to_string();
        let setup = Setup::from_toml(&shown("setup.toml"), &text("setup.toml", MAX_CONFIG_BYTES)?)?;
        let settings = resolve(&Sources { file: Some(folder.join("config.toml")), ..Sources::default() })?;
        let tree = setup.tree();
        let table = |name: &str| tidy_csv::read_cells(&shown(name), &text(name, MAX_TEXT_BYTES)?).map_err(Error::from);
        let numbers = numbers(&shown("frames.csv"), &table("frames.csv")?)?;
        let mut states = rotations(&shown("angles.csv"), &table("angles.csv")?, &tree, numbers.len())?;
        let markers = trc::read(&shown("markers.trc"), &text("markers.trc", MAX_TEXT_BYTES)?)?;
        if markers.frames.len() != numbers.len() {
            let (file, found) = (shown("markers.trc"), markers.frames.len());
            return Err(ResultsError::OtherLength { file, found, unit: "frames", expected: numbers.len() }.into());
        }
        let known: Vec<(usize, usize)> = (0..markers.header.markers.len())
            .filter_map(|marker| Some((tree.point_index(&markers.header.markers[marker])?, marker)))
            .collect();
        for (row, state) in states.iter_mut().enumerate() {
            let targets =
                known.iter().filter_map(|&(point, marker)| Some((point, markers.point_in_world(row, marker)?)));
            translate(&tree, state, &targets.collect::<Vec<_>>());
        }
        let TrackConfig { image_scale, lag, tracking, .. } = settings.track();
        Ok(Self { setup, image_scale, lag, fps: tracking.fps, frames: numbers.into_iter().zip(states).collect() })
    }

    /// The frames of a range of numbers, every n-th of them.
    ///
    /// # Errors
    /// A range without a frame.
    pub fn chosen(&self, range: Option<&Range<u64>>, every: usize) -> Result<Vec<&(u64, Vec<f64>)>, Error> {
        let in_range = |frame: &&(u64, Vec<f64>)| range.is_none_or(|range| range.contains(&frame.0));
        let chosen: Vec<_> = self.frames.iter().filter(in_range).step_by(every.max(1)).collect();
        if !chosen.is_empty() {
            return Ok(chosen);
        }
        let available = self.frames.first().zip(self.frames.last()).map(|((first, _), (last, _))| *first..last + 1);
        Err(ResultsError::NoSuchFrames { asked: range.cloned(), available }.into())
    }

    /// Cameras of [`Tracked::cameras`] that were resized for images of another size, with the offsets of the set-up: they show the body where it lies in the images.
    #[must_use]
    pub fn as_seen(&self, resized: &[Camera], calibrated: &[Camera]) -> Vec<Camera> {
        let ratio = |(resized, full): (&Camera, &Camera)| resized.image_size_px[0] / full.image_size_px[0];
        let scale = resized.iter().zip(calibrated).next().map_or(1.0, ratio);
        self.setup.as_they_are(resized, scale / self.image_scale)
    }

    /// [`calibrated`] of the run's set-up.
    ///
    /// # Errors
    /// As there.
    pub fn cameras(&self, calibration: &Path) -> Result<(Vec<Camera>, Vec<String>), Error> {
        calibrated(&self.setup, calibration)
    }
}

/// The cameras of a set-up, as a calibration has them, in the world turned to z up; and the names of all that are calibrated.
///
/// # Errors
/// A calibration that cannot be read or lacks a camera of the set-up.
pub fn calibrated(setup: &Setup, calibration: &Path) -> Result<(Vec<Camera>, Vec<String>), Error> {
    let Calibrated { cameras, names, .. } = Calibrated::read(calibration)?;
    let seen = setup.camera.iter().map(|known| {
        let is_it = |camera: &&Camera| camera_name::fold(&camera.name) == camera_name::fold(&known.name);
        cameras.iter().find(is_it).cloned().ok_or_else(|| ResultsError::UnknownCamera {
            calibration: calibration.to_owned(),
            camera: known.name.clone(),
            calibrated: names.clone(),
        })
    });
    let seen = seen.collect::<Result<Vec<Camera>, _>>()?;
    Ok((upright(seen, &setup.world_up), names))
}

/// What a command read that must not be written over: a result folder, a calibration and perhaps a folder of images.
#[must_use]
pub fn inputs(results: &Path, calibration: &Path, images: Option<&PathBuf>) -> Vec<PathBuf> {
    [results, calibration].into_iter().map(Path::to_owned).chain(images.cloned()).collect()
}

pub(super) fn column(file: &str, table: &Cells, wanted: &'static str) -> Result<usize, ResultsError> {
    let place = table.columns.iter().position(|column| column == wanted);
    place.ok_or_else(|| ResultsError::NoColumn { file: file.into(), wanted, columns: table.columns.clone() })
}

pub(super) fn bad_cell(file: &str, line: usize, found: &str, expected: Expected) -> ResultsError {
    ResultsError::Cell { file: file.into(), line, found: found.into(), expected }
}

fn numbers(name: &str, table: &Cells) -> Result<Vec<u64>, ResultsError> {
    let place = column(name, table, "frame")?;
    let number = |(line, row): &(usize, Vec<String>)| {
        row[place].parse().map_err(|_| bad_cell(name, *line, &row[place], Expected::FrameNumber))
    };
    table.rows.iter().map(number).collect()
}

/// States of `frames` frames, translations 0.
fn rotations(name: &str, table: &Cells, tree: &KinematicTree, frames: usize) -> Result<Vec<Vec<f64>>, ResultsError> {
    let [name_column, mean_column] = [column(name, table, "name")?, column(name, table, "mean_deg")?];
    let rotations: Vec<(usize, String)> = tree
        .joints()
        .zip(tree.dof_names())
        .enumerate()
        .filter(|(_, ((_, joint), _))| matches!(joint, Joint::Rotate(_)))
        .map(|(dof, (_, name))| (dof, name))
        .collect();
    if table.rows.len() != frames * rotations.len() {
        let (file, found, expected) = (name.into(), table.rows.len(), frames * rotations.len());
        return Err(ResultsError::OtherLength { file, found, unit: "rows", expected });
    }
    let mut states = vec![vec![0.0; tree.dof()]; frames];
    for (index, (line, row)) in table.rows.iter().enumerate() {
        let (dof, expected) = &rotations[index % rotations.len()];
        if row[name_column] != *expected {
            return Err(bad_cell(name, *line, &row[name_column], Expected::Coordinate(expected.clone())));
        }
        let degrees = row[mean_column].parse().ok().filter(|degrees: &f64| degrees.is_finite());
        let degrees = degrees.ok_or_else(|| bad_cell(name, *line, &row[mean_column], Expected::Number))?;
        states[index / rotations.len()][*dof] = degrees.to_radians();
    }
    Ok(states)
}

/// Moves a body along its translations until its points are as near to their targets as they get.
fn translate(tree: &KinematicTree, state: &mut [f64], targets: &[(usize, [f64; 3])]) {
    let points = |state: &[f64]| {
        let pose = pose(tree, state);
        targets.iter().flat_map(|(point, _)| pose.points[*point]).collect::<Vec<f64>>()
    };
    let start = points(state);
    let mut left: Vec<f64> = targets.iter().flat_map(|(_, at)| *at).zip(&start).map(|(at, is)| at - is).collect();
    let moving = tree.joints().enumerate().filter(|(_, (_, joint))| matches!(joint, Joint::Translate(_)));
    let columns: Vec<(usize, Vec<f64>)> = moving
        .map(|(dof, _)| {
            let mut moved = state.to_vec();
            moved[dof] += 1.0;
            (dof, points(&moved).iter().zip(&start).map(|(a, b)| a - b).collect())
        })
        .collect();
    for _ in 0..ROUNDS {
        for (dof, column) in &columns {
            let length: f64 = column.iter().map(|x| x * x).sum();
            if length > 0.0 {
                let step = column.iter().zip(&left).map(|(c, r)| c * r).sum::<f64>() / length;
                state[*dof] += step;
                left.iter_mut().zip(column).for_each(|(r, c)| *r -= step * c);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::Proportions;
    use sinew_body::standard::h32;

    #[test]
    fn translations_come_from_the_points() {
        let tree = h32(&Proportions::default());
        let truth: Vec<f64> = (0..tree.dof()).map(|dof| 0.4 * (1.7 * dof as f64).sin()).collect();
        let posed = pose(&tree, &truth);
        let targets: Vec<(usize, [f64; 3])> = posed.points.iter().copied().enumerate().collect();
        let mut state = truth.clone();
        for (dof, (_, joint)) in tree.joints().enumerate() {
            if matches!(joint, Joint::Translate(_)) {
                state[dof] = 0.0;
            }
        }
        assert!(state != truth);
        translate(&tree, &mut state, &targets);
        assert!(state.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-12), "{state:?}");
    }
}
