//! What is known about one file or folder of any kind.

use super::facts::Facts;
use super::subject::Subject;
use super::{
    acclaim, actions, body_file, c3d_file, calibration, draws, image_files, keypoints, latent_model, motion_file,
    motion_model, results, settings_file, setup_file, table_file,
};
use crate::Error;
use sinew::input::recording::{Calibrated, RecordingOptions};
use sinew_motion::convert::Format;
use std::path::Path;

/// What is known about one subject; keypoints are read with the options, and set-ups beside the cameras of the calibration.
///
/// # Errors
/// What the readers refuse.
pub fn file_facts(subject: &Subject, options: &RecordingOptions, calibration: Option<&Path>) -> Result<Facts, Error> {
    match subject {
        Subject::Calibration(path) => calibration::facts(path),
        Subject::Setup(path) => {
            let calibrated = calibration.map(Calibrated::read).transpose()?;
            setup_file::facts(path, calibrated.as_ref().map_or(&[], |calibrated| &calibrated.cameras))
        }
        Subject::Configuration(path) => settings_file::facts(path),
        Subject::Body(path) => body_file::body(path),
        Subject::Layout(path) => body_file::mapping(path),
        Subject::Keypoints(path) => keypoints::facts(path, options),
        Subject::Images(path) => image_files::facts(path),
        Subject::Motion(path) => match Format::of(path) {
            Ok(Format::Csv) => table_file::facts(path)?.map_or_else(|| motion_file::facts(path, None), Ok),
            Ok(Format::C3d) => c3d_file::facts(path),
            _ => motion_file::facts(path, None),
        },
        Subject::Actions(path) => actions::facts(path),
        Subject::Skeleton(path) => acclaim::skeleton(path),
        Subject::Acclaim { motion, skeleton: None } => acclaim::motion(motion),
        Subject::Acclaim { motion, skeleton } => motion_file::facts(motion, skeleton.as_deref()),
        Subject::MotionModel(path) => motion_model::facts(path),
        Subject::LatentModel(path) => latent_model::facts(path),
        Subject::Results(path) => results::facts(path),
        Subject::Draws(path) => draws::facts(path),
    }
}
