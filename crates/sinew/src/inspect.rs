//! What files contain, in a few lines, and what is odd about them.
//!
//! | module | looks at |
//! |---|---|
//! | [`file_facts`] | one file or folder, by what it is ([`Subject`]) |
//! | [`fit`] | a calibration and keypoints together: do they belong to each other? |

mod acclaim;
mod body_file;
mod calibration;
mod draws;
pub(crate) mod error;
pub mod fit;
mod image_files;
mod keypoints;
mod motion_file;
mod results;
mod settings_file;
mod setup_file;
mod table_file;
mod toml_file;

pub use error::InspectError;

use crate::Error;
use crate::files::read_text;
use crate::input::folder_contents::is_video;
use crate::input::qualisys::refuse_qualisys;
use crate::input::recording::Options;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use std::path::{Path, PathBuf};

/// What is known about something.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// What it is.
    pub title: String,
    /// Name and value of each fact.
    pub rows: Vec<(String, String)>,
    /// What is odd.
    pub odd: Vec<String>,
}

impl Facts {
    pub(crate) fn new(title: String) -> Self {
        Self { title, ..Self::default() }
    }

    pub(crate) fn row(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.rows.push((name.into(), value.into()));
    }
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Calibration file.
    Calibration(PathBuf),
    /// Set-up of a run.
    Setup(PathBuf),
    /// Configuration.
    Configuration(PathBuf),
    /// Body file.
    Body(PathBuf),
    /// Mapping of keypoints.
    Layout(PathBuf),
    /// Keypoint folder.
    Keypoints(PathBuf),
    /// Folder of masks or images.
    Images(PathBuf),
    /// Motion file or table of a result folder.
    Motion(PathBuf),
    /// Acclaim skeleton.
    Skeleton(PathBuf),
    /// Acclaim motion.
    Acclaim {
        /// AMC file.
        motion: PathBuf,
        /// ASF file.
        skeleton: Option<PathBuf>,
    },
    /// Result folder.
    Results(PathBuf),
    /// Zarr store.
    Draws(PathBuf),
}

/// Tells what paths lead to, by their names and what lies in them; Acclaim motions get the skeleton that is among the paths.
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
    let found = std::fs::metadata(path).map_err(Error::io("read", path))?;
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
        Some("trc" | "bvh" | "mot" | "sto" | "csv") => Ok(Subject::Motion(path_buf)),
        Some("asf") => Ok(Subject::Skeleton(path_buf)),
        Some("amc") => Ok(Subject::Acclaim { motion: path_buf, skeleton: None }),
        _ if is_video(path) => Err(InspectError::Video { path: path_buf }.into()),
        _ => {
            if let Ok(text) = read_text(path, MAX_CONFIG_BYTES) {
                refuse_qualisys(path, &text)?;
            }
            Err(InspectError::UnknownKind { path: path_buf }.into())
        }
    }
}

/// What is known about one subject; keypoints are read with the options.
///
/// # Errors
/// What the readers refuse.
pub fn file_facts(subject: &Subject, options: &Options) -> Result<Facts, Error> {
    match subject {
        Subject::Calibration(path) => calibration::facts(path),
        Subject::Setup(path) => setup_file::facts(path),
        Subject::Configuration(path) => settings_file::facts(path),
        Subject::Body(path) => body_file::body(path),
        Subject::Layout(path) => body_file::mapping(path),
        Subject::Keypoints(path) => keypoints::facts(path, options),
        Subject::Images(path) => image_files::facts(path),
        Subject::Motion(path) => match path.extension().filter(|extension| extension.eq_ignore_ascii_case("csv")) {
            Some(_) => table_file::facts(path)?.map_or_else(|| motion_file::facts(path, None), Ok),
            None => motion_file::facts(path, None),
        },
        Subject::Skeleton(path) => acclaim::skeleton(path),
        Subject::Acclaim { motion, skeleton: None } => acclaim::motion(motion),
        Subject::Acclaim { motion, skeleton } => motion_file::facts(motion, skeleton.as_deref()),
        Subject::Results(path) => results::facts(path),
        Subject::Draws(path) => draws::facts(path),
    }
}

/// Names shown before a list is cut short.
const LISTED: usize = 12;

fn shortened(names: &[String]) -> String {
    let listed = names.iter().take(LISTED).cloned().collect::<Vec<_>>().join(" ");
    if names.len() > LISTED { format!("{listed} and {} more", names.len() - LISTED) } else { listed }
}
