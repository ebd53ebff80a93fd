//! The files of each camera, by frame number.
//!
//! Keypoints lie in a folder a camera, images in such folders or side by side in one.

use crate::folder_contents::{FolderContents, folder_contents, is_video};
use crate::input_error::InputError;
use crate::lag::ClockLag;
use crate::{Error, files as text_files};
use sinew_formats::{Error as FormatError, frame_number, keypoint_formats};
use std::collections::{BTreeMap, HashMap};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What the names of many files have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Pattern {
    /// Text around the frame number, which is filled with zeros to a width.
    Numbered { before: String, width: usize, after: String },
    /// A name without a number, or that is no text.
    Exact(OsString),
}

impl Pattern {
    fn of(name: OsString) -> (Option<u64>, Self) {
        let numbered = name.to_str().and_then(|name| {
            let place = frame_number::place(name)?;
            let digits = &name[place.clone()];
            let width = if digits.starts_with('0') { digits.len() } else { 0 };
            let (before, after) = (name[..place.start].to_owned(), name[place.end..].to_owned());
            Some((digits.parse().ok()?, Self::Numbered { before, width, after }))
        });
        match numbered {
            Some((number, pattern)) => (Some(number), pattern),
            None => (frame_number::parse(&name.to_string_lossy()), Self::Exact(name)),
        }
    }

    fn name(&self, number: u64) -> OsString {
        match self {
            Self::Numbered { before, width, after } => format!("{before}{number:0width$}{after}").into(),
            Self::Exact(name) => name.clone(),
        }
    }
}

/// Names of files, sixteen bytes each: number and place of the pattern. A recording has hundreds of thousands.
#[derive(Debug, Default)]
struct Names {
    files: Vec<(u64, u32)>,
    unnumbered: Vec<OsString>,
    patterns: Vec<Pattern>,
    known: HashMap<Pattern, u32>,
}

impl Names {
    fn is_empty(&self) -> bool {
        self.files.is_empty() && self.unnumbered.is_empty()
    }

    fn add(&mut self, name: OsString) {
        match Pattern::of(name.clone()) {
            (None, _) => self.unnumbered.push(name),
            (Some(number), pattern) => {
                let next = self.patterns.len() as u32;
                let place = *self.known.entry(pattern.clone()).or_insert_with(|| {
                    self.patterns.push(pattern);
                    next
                });
                self.files.push((number, place));
            }
        }
    }
}

/// What may be the files of a camera.
#[derive(Debug)]
pub struct Folder {
    /// Name of the folder, or what the names of the files begin with.
    pub name: String,
    path: PathBuf,
    names: Names,
}

/// Files of a camera, by rising frame number.
#[derive(Debug)]
pub struct CameraFiles {
    /// Name of the camera.
    pub camera: String,
    /// Where its files lie.
    pub folder: PathBuf,
    /// How late the camera is: whole frames f are in the file numbered f + lag.
    pub lag: ClockLag,
    /// Whether a frame that shows nobody is missing.
    pub leaves_out_nobody: bool,
    names: Names,
}

impl CameraFiles {
    /// Frames with these numbers, rising, that lie in one file, which may leave out frames that show nobody.
    #[must_use]
    pub fn one_file(camera: &str, file: &Path, numbers: impl Iterator<Item = u64>, leaves_out_nobody: bool) -> Self {
        let name = file.file_name().map(OsString::from).unwrap_or_default();
        let names = Names {
            files: numbers.map(|number| (number, 0)).collect(),
            patterns: vec![Pattern::Exact(name)],
            ..Names::default()
        };
        Self {
            camera: camera.into(),
            folder: file.parent().unwrap_or(Path::new("")).to_owned(),
            lag: ClockLag::default(),
            leaves_out_nobody,
            names,
        }
    }

    /// The only file, if it holds all frames.
    #[must_use]
    pub fn file(&self) -> Option<PathBuf> {
        match self.names.patterns.as_slice() {
            [Pattern::Exact(name)] => Some(self.folder.join(name)),
            _ => None,
        }
    }

    /// The same files of a camera that is late.
    #[must_use]
    pub fn late_by(self, lag: ClockLag) -> Self {
        Self { lag, ..self }
    }

    /// Number of files.
    #[allow(clippy::len_without_is_empty)]
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.files.len()
    }

    /// Numbers of the frames, rising, to which its files are nearest in time.
    pub fn numbers(&self) -> impl DoubleEndedIterator<Item = u64> + '_ {
        let range = self.range();
        let number = |(own, _): &(u64, u32)| self.lag.time_of(*own).round();
        let numbers = self.names.files.iter().map(number).filter(|number| *number >= 0.0);
        numbers.map(|number| number as u64).filter(move |number| range.contains(number))
    }

    /// From the first number to the last, holes included, between its first file and its last in time.
    pub fn range(&self) -> Range<u64> {
        let Range { start, end } = self.range_in_names();
        if start == end {
            return 0..0;
        }
        let [first, last] = [self.lag.time_of(start).ceil(), self.lag.time_of(end - 1).floor()];
        if last < 0.0 { 0..0 } else { first.max(0.0) as u64..(last as u64).saturating_add(1) }
    }

    /// As [`CameraFiles::range`], in the numbers of the file names.
    pub fn range_in_names(&self) -> Range<u64> {
        match (self.names.files.first(), self.names.files.last()) {
            (Some((first, _)), Some((last, _))) => *first..last.saturating_add(1),
            _ => 0..0,
        }
    }

    /// File that is nearest to a frame in time.
    #[must_use]
    pub fn path(&self, number: u64) -> Option<PathBuf> {
        self.own_path(self.lag.nearest(number)?)
    }

    /// File by the number in its name.
    #[must_use]
    pub fn own_path(&self, own: u64) -> Option<PathBuf> {
        let index = self.names.files.binary_search_by_key(&own, |(found, _)| *found).ok()?;
        let pattern = self.names.files[index].1 as usize;
        Some(self.folder.join(self.names.patterns[pattern].name(own)))
    }
}

pub(super) fn has_extension(name: &OsStr, extensions: &[&str]) -> bool {
    let extension = Path::new(name).extension();
    extension.is_some_and(|found| extensions.iter().any(|wanted| found.eq_ignore_ascii_case(wanted)))
}

fn names_in(folder: &Path, extensions: &[&str]) -> Result<Names, Error> {
    let mut names = Names::default();
    for entry in fs::read_dir(folder).map_err(Error::io("read", folder))? {
        let name = entry.map_err(Error::io("read", folder))?.file_name();
        if has_extension(&name, extensions) {
            names.add(name);
        }
    }
    Ok(names)
}

/// Refuses a file where a folder of `many` is expected.
pub fn expect_folder(path: &Path, many: &'static str) -> Result<(), InputError> {
    if !path.is_file() {
        return Ok(());
    }
    Err(InputError::FileForFolder { file: path.to_owned(), many, is_video: is_video(path) })
}

/// Folders with keypoint files, and folders whose names say that they should have some, by name.
pub fn camera_folders(keypoints: &Path) -> Result<Vec<Folder>, Error> {
    expect_folder(keypoints, "keypoints")?;
    let mut folders = Vec::new();
    let mut loose: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(keypoints).map_err(Error::io("read", keypoints))? {
        let entry = entry.map_err(Error::io("read", keypoints))?;
        let path = entry.path();
        if path.is_dir() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let names = names_in(&path, &["json"])?;
            if !names.is_empty() || name.ends_with("_json") {
                folders.push(Folder { name, path, names });
            }
        } else if has_extension(&entry.file_name(), &["json"]) {
            loose.push(path);
        }
    }
    if folders.is_empty() {
        let folder = keypoints.to_owned();
        return Err(match loose.iter().min() {
            None => match folder_contents(&folder) {
                FolderContents::Videos(videos) => InputError::VideosForKeypoints { folder, videos },
                _ => InputError::NoKeypoints { folder },
            },
            Some(file) if keypoint_formats::is_frame(&text_files::read_beginning(file)?) => {
                InputError::FolderOfOneCamera { folder, files: loose.len() }
            }
            Some(file) => InputError::unknown_keypoint_file(file),
        }
        .into());
    }
    folders.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(folders)
}

/// Files in folders, and those that lie side by side by what their names begin with before the frame number.
#[derive(Debug, Default)]
pub struct ListedImages {
    /// A folder each, by name: folders with files, and wanted ones.
    pub folders: Vec<Folder>,
    /// Files of the folder itself, by the beginning of their names.
    pub loose: Vec<Folder>,
    /// A file without a frame number in the folder itself.
    pub unnumbered: Option<OsString>,
}

/// Files with one of the extensions in a folder and in the folders in it.
pub fn images(root: &Path, extensions: &[&str], is_wanted: impl Fn(&str) -> bool) -> Result<ListedImages, Error> {
    let mut found = ListedImages::default();
    let mut loose: BTreeMap<String, Names> = BTreeMap::new();
    for entry in fs::read_dir(root).map_err(Error::io("read", root))? {
        let entry = entry.map_err(Error::io("read", root))?;
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() {
            let names = names_in(&path, extensions)?;
            let name = name.to_string_lossy().into_owned();
            if !names.is_empty() || is_wanted(&name) {
                found.folders.push(Folder { name, path, names });
            }
        } else if has_extension(&name, extensions) {
            match Pattern::of(name.clone()) {
                (Some(_), Pattern::Numbered { before, .. }) => {
                    let camera = before.trim_end_matches(|c: char| !c.is_alphanumeric()).to_owned();
                    loose.entry(camera).or_default().add(name);
                }
                _ => found.unnumbered = found.unnumbered.into_iter().chain([name]).min(),
            }
        }
    }
    found.folders.sort_by(|a, b| a.name.cmp(&b.name));
    found.loose = loose.into_iter().map(|(name, names)| Folder { name, path: root.to_owned(), names }).collect();
    Ok(found)
}

/// The files of a camera in the order of their numbers; `kind` is a word for them.
pub fn files(folder: Folder, camera: &str, kind: &str) -> Result<CameraFiles, Error> {
    let Folder { path, mut names, .. } = folder;
    let within = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let shown = |name: &OsString| format!("{within}/{}", name.to_string_lossy());
    if let Some(name) = names.unnumbered.iter().min() {
        return Err(FormatError::NoFrameNumber { name: shown(name) }.into());
    }
    if names.files.is_empty() {
        return Err(InputError::NoFiles { folder: path, kind: kind.into() }.into());
    }
    names.files.sort_unstable();
    names.known = HashMap::new();
    if let Some(&[(frame, a), (_, b)]) =
        names.files.windows(2).filter_map(|pair| pair.first_chunk()).find(|[a, b]| a.0 == b.0)
    {
        let mut both = [a, b].map(|place| shown(&names.patterns[place as usize].name(frame)));
        both.sort();
        let [first, second] = both;
        return Err(FormatError::DuplicateFrame { frame, first, second }.into());
    }
    Ok(CameraFiles { camera: camera.into(), folder: path, lag: ClockLag::default(), leaves_out_nobody: false, names })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_again_from_their_patterns() {
        for name in
            ["cam01.0034.json", "c_000000000000_keypoints.json", "c.10.json", "c.0.json", "7.json", "a1b20c.json"]
        {
            let (number, pattern) = Pattern::of(name.into());
            assert_eq!(number, frame_number::parse(name), "{name}");
            assert_eq!(pattern.name(number.unwrap()), name);
        }
        let unnumbered: OsString = "keypoints.json".into();
        assert_eq!(Pattern::of(unnumbered.clone()), (None, Pattern::Exact(unnumbered)));
    }
}
