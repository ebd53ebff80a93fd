//! The poses of a result folder, read back.
//!
//! The body is that of `setup.toml`; states come from `state.csv`, by the names of the body's degrees of freedom; numbers of frames from `frames.csv`.

use crate::Error;
use crate::people::refuse_several;
use crate::results_error::{Expected, ResultsError};
use serde_json::Value;
use sinew_body::{Joint, KinematicTree};
use sinew_formats::camera_name;
use sinew_formats::json_text;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_formats::tidy_csv::{self, Cells};
use sinew_input::files;
use sinew_input::lag::ClockLag;
use sinew_input::recording::Calibrated;
use sinew_input::up_axis::upright;
use sinew_observe::Camera;
use sinew_setup::Setup;
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
    pub lag: Vec<(String, ClockLag)>,
    /// Frames a second.
    pub fps: f64,
    /// Number of each frame with the state of its mean pose, in the world turned to z up.
    pub frames: Vec<(u64, Vec<f64>)>,
}

impl Tracked {
    /// Reads the poses of a run that came to its end.
    ///
    /// # Errors
    /// A folder without a summary, files that cannot be read, tables that do not belong together.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        refuse_several(folder)?;
        if !folder.join("summary.json").exists() {
            std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
            return Err(ResultsError::NoSummary(folder.to_owned()).into());
        }
        let text = |name: &str, most| files::read_text(&folder.join(name), most);
        let shown = |name: &str| folder.join(name).display().to_string();
        let setup = Setup::from_toml(&shown("setup.toml"), &text("setup.toml", MAX_CONFIG_BYTES)?)?;
        let summary: Value = json_text::parse(&shown("summary.json"), &text("summary.json", MAX_TEXT_BYTES)?)?;
        let tree = setup.tree();
        let table = |name: &str| tidy_csv::read_cells(&shown(name), &text(name, MAX_TEXT_BYTES)?).map_err(Error::from);
        let numbers = numbers(&shown("frames.csv"), &table("frames.csv")?)?;
        let states = states(&shown("state.csv"), &table("state.csv")?, &tree, numbers.len())?;
        let number = |value: &Value, expected| {
            value
                .as_f64()
                .filter(|value| *value > 0.0)
                .ok_or_else(|| bad_value(&shown("summary.json"), value, expected))
        };
        let fps = number(&summary["fps"], Expected::Number)?;
        let image_scale = number(&summary["settings"]["image_scale"]["value"], Expected::Number)?;
        let lags = summary["settings"]["lag"]["value"].as_array().map_or(&[][..], Vec::as_slice);
        let lag = lags.iter().map(|lag| {
            let stated = lag.as_str().and_then(|text| text.split_once('='));
            let stated = stated.and_then(|(camera, lag)| Some((camera.to_owned(), lag.parse::<ClockLag>().ok()?)));
            stated.ok_or_else(|| bad_value(&shown("summary.json"), lag, Expected::Lag))
        });
        let lag = lag.collect::<Result<_, _>>()?;
        Ok(Self { setup, image_scale, lag, fps, frames: numbers.into_iter().zip(states).collect() })
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

/// Place of a column of a table.
///
/// # Errors
/// A table without it.
pub fn column(file: &str, table: &Cells, wanted: &'static str) -> Result<usize, ResultsError> {
    let place = table.columns.iter().position(|column| column == wanted);
    place.ok_or_else(|| ResultsError::NoColumn { file: file.into(), wanted, columns: table.columns.clone() })
}

/// What is wrong with a cell of a table.
#[must_use]
pub fn bad_cell(file: &str, line: usize, found: &str, expected: Expected) -> ResultsError {
    ResultsError::Cell { file: file.into(), line, found: found.into(), expected }
}

/// What is wrong with a value of a summary.
fn bad_value(file: &str, found: &Value, expected: Expected) -> ResultsError {
    ResultsError::Value { file: file.into(), found: found.to_string(), expected }
}

fn numbers(name: &str, table: &Cells) -> Result<Vec<u64>, ResultsError> {
    let place = column(name, table, "frame")?;
    let number = |(line, row): &(usize, Vec<String>)| {
        row[place].parse().map_err(|_| bad_cell(name, *line, &row[place], Expected::FrameNumber))
    };
    table.rows.iter().map(number).collect()
}

/// States of `frames` frames.
fn states(name: &str, table: &Cells, tree: &KinematicTree, frames: usize) -> Result<Vec<Vec<f64>>, ResultsError> {
    let [name_column, mean_column] = [column(name, table, "name")?, column(name, table, "mean")?];
    let (names, joints): (Vec<String>, Vec<Joint>) =
        tree.dof_names().into_iter().zip(tree.joints().map(|(_, joint)| joint)).unzip();
    if table.rows.len() != frames * tree.dof() {
        let (file, found, expected) = (name.into(), table.rows.len(), frames * tree.dof());
        return Err(ResultsError::OtherLength { file, found, unit: "rows", expected });
    }
    let number = |(index, (line, row)): (usize, &(usize, Vec<String>))| {
        let dof = index % tree.dof();
        if row[name_column] != names[dof] {
            return Err(bad_cell(name, *line, &row[name_column], Expected::Coordinate(names[dof].clone())));
        }
        let value = row[mean_column].parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| bad_cell(name, *line, &row[mean_column], Expected::Number))?;
        Ok(if matches!(joints[dof], Joint::Rotate(_)) { value.to_radians() } else { value })
    };
    let numbers = table.rows.iter().enumerate().map(number).collect::<Result<Vec<f64>, _>>()?;
    Ok(numbers.chunks_exact(tree.dof()).map(<[f64]>::to_vec).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_setup::CameraSetup;

    /// Offsets were found in images of half the calibrated size; in a picture of three quarters of it they are one and a half times as large.
    #[test]
    fn offsets_go_with_the_size_of_the_picture() {
        let camera = Camera::look_at("C1", [1000.0; 2], 1000.0, [5.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let own = CameraSetup {
            name: "C1".into(),
            offset_px: [4.0, -2.0],
            sigma_px: 3.0,
            usual_confidence: 1.0,
            exchanged: 0.0,
            elsewhere: 0.0,
        };
        let layout = sinew_formats::layout::find("body-25b").unwrap();
        let setup = sinew_setup::unmeasured(&layout, &sinew_setup::SetupRequest::default(), vec![own]);
        let tracked = Tracked { setup, image_scale: 0.5, lag: vec![], fps: 30.0, frames: vec![] };
        let picture = camera.resized(0.75);
        let seen = tracked.as_seen(std::slice::from_ref(&picture), &[camera]).pop().unwrap();
        let pixel = |camera: &Camera| camera.project([0.3, 0.2, 1.1]).pixel().unwrap();
        let moved = [0, 1].map(|axis: usize| pixel(&seen)[axis] - pixel(&picture)[axis]);
        assert!((moved[0] - 6.0).abs() < 1e-9 && (moved[1] + 3.0).abs() < 1e-9, "{moved:?}");
    }
}
