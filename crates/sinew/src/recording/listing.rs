//! Camera folders and the keypoint files in them, by frame number.

use crate::Error;
use sinew_formats::frame_number;
use std::ffi::OsString;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A folder that may belong to a camera.
#[derive(Debug)]
pub(super) struct Folder {
    pub(super) name: String,
    path: PathBuf,
    files: Vec<OsString>,
}

/// Keypoint files of a camera, by rising frame number.
#[derive(Debug)]
pub(super) struct CameraFiles {
    pub(super) camera: String,
    pub(super) folder: PathBuf,
    files: Vec<(u64, OsString)>,
}

impl CameraFiles {
    pub(super) fn len(&self) -> usize {
        self.files.len()
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = u64> + '_ {
        self.files.iter().map(|(number, _)| *number)
    }

    /// From the first number to the last, holes included.
    pub(super) fn range(&self) -> Range<u64> {
        match (self.files.first(), self.files.last()) {
            (Some((first, _)), Some((last, _))) => *first..last.saturating_add(1),
            _ => 0..0,
        }
    }

    pub(super) fn path(&self, number: u64) -> Option<PathBuf> {
        let index = self.files.binary_search_by_key(&number, |(found, _)| *found).ok()?;
        Some(self.folder.join(&self.files.get(index)?.1))
    }
}

fn is_json(name: &OsString) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

fn json_files(folder: &Path) -> Result<Vec<OsString>, Error> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(Error::io("read", folder))? {
        let name = entry.map_err(Error::io("read", folder))?.file_name();
        if is_json(&name) {
            files.push(name);
        }
    }
    files.sort();
    Ok(files)
}

/// Folders with keypoint files, and those whose name says that they should have some, by name.
pub(super) fn camera_folders(keypoints: &Path) -> Result<Vec<Folder>, Error> {
    let mut folders = Vec::new();
    let mut loose = 0;
    for entry in fs::read_dir(keypoints).map_err(Error::io("read", keypoints))? {
        let entry = entry.map_err(Error::io("read", keypoints))?;
        let path = entry.path();
        if path.is_dir() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let files = json_files(&path)?;
            if !files.is_empty() || name.ends_with("_json") {
                folders.push(Folder { name, path, files });
            }
        } else if is_json(&entry.file_name()) {
            loose += 1;
        }
    }
    if folders.is_empty() {
        let (message, help) = if loose > 0 {
            (
                format!(
                    "`{}` holds {loose} keypoint files itself; expected a folder for each camera",
                    keypoints.display()
                ),
                "give the folder above it, which holds one folder `<camera>_json` for each camera",
            )
        } else {
            (
                format!(
                    "`{}` holds no keypoints; expected folders `<camera>_json` with JSON files",
                    keypoints.display()
                ),
                "`--keypoints` takes the folder that a detector fills, for example `pose`",
            )
        };
        return Err(Error::Input { message, help: Some(help.into()) });
    }
    folders.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(folders)
}

/// The files of a folder in the order of their numbers.
pub(super) fn files(folder: Folder, camera: &str) -> Result<CameraFiles, Error> {
    let shown: Vec<String> =
        folder.files.iter().map(|name| format!("{}/{}", folder.name, name.to_string_lossy())).collect();
    let order = frame_number::order(&shown)?;
    let mut names: Vec<Option<OsString>> = folder.files.into_iter().map(Some).collect();
    let files = order.into_iter().filter_map(|(number, index)| Some((number, names.get_mut(index)?.take()?))).collect();
    Ok(CameraFiles { camera: camera.into(), folder: folder.path, files })
}
