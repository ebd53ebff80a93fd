//! Where keypoints lie: folders of frames, files a camera, or one file of all cameras.
//!
//! | what is given | what is taken |
//! |---|---|
//! | a folder of folders with OpenPose-style files | a folder a camera, by its name |
//! | a folder of files of a [known format](sinew_formats::keypoint_formats) | a file a camera, whose name holds the camera's |
//! | a folder of folders with one such file each | a file a camera, by the name of its folder |
//! | one such file | all cameras that it names, or the one that its name holds |

use super::keypoint_camera::KeypointCamera;
use super::listing::{self, CameraFiles, Folder, has_extension};
use crate::input::error::InputError;
use crate::input::folder_contents::is_video;
use crate::{Error, files};
use sinew_formats::keypoint_formats::{self, FORMATS};
use sinew_formats::keypoint_table::{Frames, KeypointTable};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{Layout, camera_name};
use sinew_observe::Camera;
use std::fs;
use std::path::{Path, PathBuf};

/// Extensions of files that hold many frames.
const EXTENSIONS: [&str; 2] = ["json", "csv"];

/// Files of a folder that are looked at: cameras are fewer, frames are more.
const LOOKED_AT: usize = 100;

/// The keypoints of a camera, before it is known which one.
pub struct KeypointSource {
    /// Name of the camera, or of its folder or file.
    pub name: String,
    place: SourcePlace,
}

enum SourcePlace {
    Folder(Folder),
    Table { file: PathBuf, frames: Frames, layout: Option<Layout>, in_image_shares: bool },
}

impl KeypointSource {
    /// Keypoints of a camera of that name; coordinates that are shares of the image become pixels of `camera`.
    ///
    /// # Errors
    /// Files without a frame number or twice for a frame, no files.
    pub fn keypoints(self, name: &str, camera: Option<&Camera>) -> Result<KeypointCamera, Error> {
        match self.place {
            SourcePlace::Folder(folder) => Ok(KeypointCamera::folder(listing::files(folder, name, "keypoint files")?)),
            SourcePlace::Table { file, frames, in_image_shares, .. } => {
                if frames.is_empty() {
                    return Err(InputError::NoFrames { file }.into());
                }
                let files = CameraFiles::one_file(name, &file, frames.keys().copied());
                Ok(KeypointCamera::table(files, frames, camera.filter(|_| in_image_shares)))
            }
        }
    }

    /// File of many frames.
    fn file(&self) -> Option<&Path> {
        match &self.place {
            SourcePlace::Folder(_) => None,
            SourcePlace::Table { file, .. } => Some(file),
        }
    }

    fn layout(&self) -> Option<&Layout> {
        match &self.place {
            SourcePlace::Folder(_) => None,
            SourcePlace::Table { layout, .. } => layout.as_ref(),
        }
    }
}

/// The keypoints of each camera, with the names of the cameras in a calibration where names of files hold them.
///
/// # Errors
/// Nothing to read, files of no known format, and names that hold no camera's.
pub fn sources(keypoints: &Path, calibrated: &[String], confidence_scale: f64) -> Result<Vec<KeypointSource>, Error> {
    let files =
        if keypoints.is_file() { vec![(stem(keypoints), keypoints.to_owned())] } else { table_files(keypoints)? };
    if files.is_empty() {
        let folders = listing::camera_folders(keypoints)?.into_iter();
        let source = |folder: Folder| KeypointSource { name: folder.name.clone(), place: SourcePlace::Folder(folder) };
        return Ok(folders.map(source).collect());
    }
    let mut sources = vec![];
    for (label, file) in files {
        sources.extend(from_file(&label, &file, calibrated, confidence_scale)?);
    }
    let is_only = sources.len() == 1 && calibrated.len() == 1;
    for source in &mut sources {
        let is_known = |name: &String| camera_name::fold(name) == camera_name::fold(&source.name);
        if calibrated.is_empty() || calibrated.iter().any(is_known) {
            continue;
        }
        let file = source.file().unwrap_or(keypoints).to_owned();
        match calibrated.first() {
            Some(only) if is_only => source.name.clone_from(only),
            _ => {
                return Err(InputError::FileOfNoCamera {
                    file,
                    camera: source.name.clone(),
                    calibrated: calibrated.to_vec(),
                }
                .into());
            }
        }
    }
    Ok(sources)
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The keypoints of some cameras.
///
/// # Errors
/// A camera without keypoints.
pub fn chosen(sources: Vec<KeypointSource>, names: &[String]) -> Result<Vec<KeypointSource>, InputError> {
    let wanted: Vec<String> = names.iter().map(|name| camera_name::fold(name)).collect();
    for (name, wanted) in names.iter().zip(&wanted) {
        if !sources.iter().any(|source| camera_name::fold(&source.name) == *wanted) {
            let folders = sources.into_iter().map(|source| source.name).collect();
            return Err(InputError::NoKeypointsOfCamera { name: name.clone(), folders });
        }
    }
    Ok(sources.into_iter().filter(|source| wanted.contains(&camera_name::fold(&source.name))).collect())
}

/// The layout that files of many frames say, which must be one.
///
/// # Errors
/// Two files with other points.
pub fn layout(sources: &[KeypointSource]) -> Result<Option<Layout>, Error> {
    let said = |source: &KeypointSource| Some((source.file()?.to_owned(), source.layout()?.clone()));
    let mut found = sources.iter().filter_map(said);
    let Some((first, layout)) = found.next() else { return Ok(None) };
    match found.find(|(_, other)| *other != layout) {
        Some((second, _)) => Err(InputError::LayoutsDiffer { first, second }.into()),
        None => Ok(Some(layout)),
    }
}

/// Files of a known format in a folder, and lone ones of the folders in it, by the name that holds the camera's.
fn table_files(folder: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let mut found = vec![];
    for path in entries(folder)? {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let lone = if path.is_dir() { entries(&path).unwrap_or_default() } else { vec![path.clone()] };
        let mut files = lone.into_iter().filter(|file| file.is_file() && has_extension(file.as_os_str(), &EXTENSIONS));
        let (Some(file), None) = (files.next(), files.next()) else { continue };
        let beginning = files::read_beginning(&file)?;
        if keypoint_formats::recognised(&beginning).is_some() {
            found.push((if path.is_dir() { name } else { stem(&path) }, file));
        }
    }
    Ok(found)
}

/// Some entries of a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut paths = vec![];
    for entry in fs::read_dir(folder).map_err(Error::io("read", folder))? {
        paths.push(entry.map_err(Error::io("read", folder))?.path());
        if paths.len() > LOOKED_AT {
            return Ok(vec![]);
        }
    }
    paths.sort();
    Ok(paths)
}

/// The cameras of a file.
fn from_file(
    label: &str,
    file: &Path,
    calibrated: &[String],
    confidence_scale: f64,
) -> Result<Vec<KeypointSource>, Error> {
    if is_video(file) {
        return Err(InputError::FileForFolder { file: file.to_owned(), many: "keypoints", is_video: true }.into());
    }
    let text = files::read_text(file, MAX_TEXT_BYTES)?;
    if keypoint_formats::recognised(&text).is_none() {
        let known = FORMATS.map(|format| format.name).to_vec();
        return Err(InputError::UnknownKeypointFile { file: file.to_owned(), known }.into());
    }
    let table = keypoint_formats::read(&file.display().to_string(), &text, confidence_scale)?;
    let KeypointTable { layout, in_image_shares, cameras } = table;
    let named = |camera: Option<usize>, else_named: &str| {
        camera.and_then(|camera| calibrated.get(camera)).map_or_else(|| else_named.to_owned(), Clone::clone)
    };
    let source = |camera: sinew_formats::keypoint_table::TableCamera| {
        let name = match &camera.name {
            Some(number) => named(camera_name::numbered(number, calibrated), number),
            None => named(camera_name::held(label, calibrated), label),
        };
        let (file, layout) = (file.to_owned(), layout.clone());
        KeypointSource { name, place: SourcePlace::Table { file, frames: camera.frames, layout, in_image_shares } }
    };
    Ok(cameras.into_iter().map(source).collect())
}
