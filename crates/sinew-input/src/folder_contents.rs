//! What a folder holds in place of what was expected: videos, keypoints, calibrations.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Extensions of videos.
const VIDEOS: [&str; 10] = ["mp4", "avi", "mov", "mkv", "mts", "m4v", "wmv", "webm", "mpg", "mpeg"];

/// Videos hold one of these marks, at this offset in bytes: MP4 and MOV, AVI, Matroska and WebM.
const MARKS: [(usize, &[u8]); 3] = [(4, b"ftyp"), (8, b"AVI "), (0, &[0x1a, 0x45, 0xdf, 0xa3])];

/// What lies in a folder or in those in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FolderContents {
    /// Videos, by name.
    Videos(Vec<String>),
    /// Keypoint files, in the folder itself or in folders of cameras.
    Keypoints,
    /// Files `.toml`.
    Toml(Vec<PathBuf>),
    /// Something else, or nothing.
    Other,
}

fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Whether a file is a video, by its extension or its first bytes.
#[must_use]
pub fn is_video(path: &Path) -> bool {
    let mut start = [0; 12];
    let mut is_marked = || {
        let read = fs::File::open(path).and_then(|mut file| file.read(&mut start)).unwrap_or(0);
        MARKS.iter().any(|(at, mark)| start[..read].get(*at..at + mark.len()) == Some(*mark))
    };
    path.is_file() && (VIDEOS.contains(&extension(path).as_str()) || is_marked())
}

/// Files of a folder and of the folders in it, by name; of a folder with thousands of files some.
fn files(folder: &Path) -> Vec<PathBuf> {
    /// Files of a folder that are looked at.
    const MOST: usize = 200;
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let mut paths: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
        paths.sort();
        paths.truncate(MOST);
        paths
    };
    let (below, mut files): (Vec<PathBuf>, Vec<PathBuf>) = entries(folder).into_iter().partition(|path| path.is_dir());
    files.extend(below.iter().flat_map(|folder| entries(folder)).filter(|path| path.is_file()));
    files
}

/// What a folder holds.
#[must_use]
pub fn folder_contents(folder: &Path) -> FolderContents {
    let files = files(folder);
    if files.iter().any(|path| extension(path) == "json") {
        return FolderContents::Keypoints;
    }
    let videos: Vec<String> = files
        .iter()
        .filter(|path| is_video(path))
        .filter_map(|path| Some(path.strip_prefix(folder).ok()?.display().to_string()))
        .collect();
    if !videos.is_empty() {
        return FolderContents::Videos(videos);
    }
    let toml: Vec<PathBuf> = files.into_iter().filter(|path| extension(path) == "toml").collect();
    if toml.is_empty() { FolderContents::Other } else { FolderContents::Toml(toml) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn videos_are_known_by_name_and_by_content() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        assert_eq!(folder_contents(root.path()), FolderContents::Other);
        fs::write(at("Calib.toml"), "").unwrap();
        assert_eq!(folder_contents(root.path()), FolderContents::Toml(vec![at("Calib.toml")]));
        fs::write(at("cam1.mp4"), "").unwrap();
        fs::write(at("cam2"), b"\0\0\0\x20ftypisom").unwrap();
        fs::write(at("cam3"), b"RIFF....AVI LIST").unwrap();
        fs::write(at("notes"), b"RIFF").unwrap();
        let videos = FolderContents::Videos(["cam1.mp4", "cam2", "cam3"].map(str::to_owned).to_vec());
        assert_eq!(folder_contents(root.path()), videos);
        fs::create_dir(at("C1_json")).unwrap();
        fs::write(at("C1_json/0.json"), "").unwrap();
        assert_eq!(folder_contents(root.path()), FolderContents::Keypoints);
    }
}
