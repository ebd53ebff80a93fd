//! What a path leads to, by its name and contents.

use super::error::InspectError;
use super::subject::Subject;
use super::{draws, image_files, results, toml_file};
use crate::Error;
use sinew::files::{read_beginning, read_text};
use sinew::input::folder_contents::is_video;
use sinew::input::recording::keypoint_sources::refused;
use sinew_dynamics::model_file::{MAX_BYTES, is_of};
use sinew_dynamics::primitives::file;
use sinew_formats::calibration;
use sinew_formats::keypoint_formats::recognised;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_latent::file as latent_file;
use sinew_results::result_table::ResultTable;
use std::path::{Path, PathBuf};

/// What paths lead to, by their names and contents; Acclaim motions get the skeleton that is among the paths.
///
/// # Errors
/// A path that does not exist, or is nothing that can be inspected; several skeletons for a motion.
pub fn subjects(paths: &[PathBuf]) -> Result<Vec<Subject>, Error> {
    let mut subjects = paths.iter().map(|path| subject(path)).collect::<Result<Vec<Subject>, Error>>()?;
    let skeletons: Vec<PathBuf> = subjects
        .iter()
        .filter_map(|subject| if let Subject::Skeleton(path) = subject { Some(path.clone()) } else { None })
        .collect();
    for subject in &mut subjects {
        let Subject::Acclaim { motion, skeleton } = subject else { continue };
        if let [first, second, ..] = &skeletons[..] {
            let [motion, first, second] = [motion, first, second].map(|path| path.to_path_buf());
            return Err(InspectError::TwoSkeletons { motion, first, second }.into());
        }
        *skeleton = skeletons.first().cloned();
    }
    Ok(subjects)
}

fn subject(path: &Path) -> Result<Subject, Error> {
    let found = std::fs::metadata(path).map_err(sinew::Error::io("read", path))?;
    let path_buf = path.to_owned();
    if found.is_dir() {
        return Ok(if draws::is_store(path) {
            Subject::Draws(path_buf)
        } else if results::is_results(path) {
            Subject::Results(path_buf)
        } else if image_files::is_images(path) {
            Subject::Images(path_buf)
        } else {
            Subject::Keypoints(path_buf)
        });
    }
    // A file of a result folder that is no table, motion or set-up speaks for its folder.
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    if ["summary.json", "timings.json", "load.py"].contains(&name) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if results::is_results(folder) {
            return Ok(Subject::Results(folder.to_owned()));
        }
    }
    match path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).as_deref() {
        Some("toml") => Ok(toml_file::subject(path_buf, &read_text(path, MAX_CONFIG_BYTES)?)),
        Some("csv" | "json") if is_keypoint_file(path) => Ok(Subject::Keypoints(path_buf)),
        Some("csv") if is_action_file(path) => Ok(Subject::Actions(path_buf)),
        Some("trc" | "c3d" | "bvh" | "mot" | "sto" | "csv") => Ok(Subject::Motion(path_buf)),
        Some("asf") => Ok(Subject::Skeleton(path_buf)),
        Some("amc") => Ok(Subject::Acclaim { motion: path_buf, skeleton: None }),
        Some("json") if model(path).is_none() => {
            let beginning = read_beginning(path).map_err(sinew::Error::from)?;
            Err(sinew::Error::from(sinew_input::Error::from(refused(path, &beginning))).into())
        }
        _ if is_video(path) => Err(InspectError::Video { path: path_buf }.into()),
        _ => {
            if let Some(model) = model(path) {
                return Ok(model);
            }
            let text = read_text(path, MAX_CONFIG_BYTES).unwrap_or_default();
            match calibration::recognised(&path.display().to_string(), &text) {
                Ok(_) => Ok(Subject::Calibration(path_buf)),
                Err(sinew_formats::Error::UnknownCalibration { .. }) => {
                    Err(InspectError::UnknownKind { path: path_buf }.into())
                }
                Err(damaged) => Err(damaged.into()),
            }
        }
    }
}

/// Whether a file holds the keypoints of a recording.
fn is_keypoint_file(path: &Path) -> bool {
    read_beginning(path).is_ok_and(|beginning| recognised(&beginning).is_some())
}

fn is_action_file(path: &Path) -> bool {
    read_text(path, MAX_TEXT_BYTES).is_ok_and(|text| ResultTable::of(&text) == Some(ResultTable::Actions))
}

fn model(path: &Path) -> Option<Subject> {
    let text = read_text(path, MAX_BYTES).ok()?;
    if is_of(file::FORMAT, &text) {
        return Some(Subject::MotionModel(path.to_owned()));
    }
    is_of(latent_file::FORMAT, &text).then(|| Subject::LatentModel(path.to_owned()))
}
