//! Camera folders and the keypoint files in them, by frame number.

use crate::Error;
use sinew_formats::{Error as FormatError, frame_number};
use std::collections::HashMap;
use std::ffi::OsString;
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
}

/// A folder that may belong to a camera.
#[derive(Debug)]
pub(super) struct Folder {
    pub(super) name: String,
    path: PathBuf,
    names: Names,
}

/// Keypoint files of a camera, by rising frame number.
#[derive(Debug)]
pub(super) struct CameraFiles {
    pub(super) camera: String,
    pub(super) folder: PathBuf,
    names: Names,
}

impl CameraFiles {
    pub(super) fn len(&self) -> usize {
        self.names.files.len()
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = u64> + '_ {
        self.names.files.iter().map(|(number, _)| *number)
    }

    /// From the first number to the last, holes included.
    pub(super) fn range(&self) -> Range<u64> {
        match (self.names.files.first(), self.names.files.last()) {
            (Some((first, _)), Some((last, _))) => *first..last.saturating_add(1),
            _ => 0..0,
        }
    }

    pub(super) fn path(&self, number: u64) -> Option<PathBuf> {
        let index = self.names.files.binary_search_by_key(&number, |(found, _)| *found).ok()?;
        let pattern = self.names.files[index].1 as usize;
        Some(self.folder.join(self.names.patterns[pattern].name(number)))
    }
}

fn is_json(name: &OsString) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

fn json_files(folder: &Path) -> Result<Names, Error> {
    let mut names = Names::default();
    let mut known: HashMap<Pattern, u32> = HashMap::new();
    for entry in fs::read_dir(folder).map_err(Error::io("read", folder))? {
        let name = entry.map_err(Error::io("read", folder))?.file_name();
        if !is_json(&name) {
            continue;
        }
        match Pattern::of(name.clone()) {
            (None, _) => names.unnumbered.push(name),
            (Some(number), pattern) => {
                let next = known.len() as u32;
                let place = *known.entry(pattern.clone()).or_insert_with(|| {
                    names.patterns.push(pattern);
                    next
                });
                names.files.push((number, place));
            }
        }
    }
    Ok(names)
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
            let names = json_files(&path)?;
            if !names.files.is_empty() || !names.unnumbered.is_empty() || name.ends_with("_json") {
                folders.push(Folder { name, path, names });
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
    let Folder { name: folder_name, path, mut names } = folder;
    let shown = |name: &OsString| format!("{folder_name}/{}", name.to_string_lossy());
    if let Some(name) = names.unnumbered.iter().min() {
        return Err(FormatError::NoFrameNumber { name: shown(name) }.into());
    }
    if names.files.is_empty() {
        return Err(Error::Input {
            message: format!("`{}` holds no keypoint files", path.display()),
            help: Some("fill the folder or remove it, or leave the camera out of `--cameras`".into()),
        });
    }
    names.files.sort_unstable();
    if let Some(&[(frame, a), (_, b)]) =
        names.files.windows(2).filter_map(|pair| pair.first_chunk()).find(|[a, b]| a.0 == b.0)
    {
        let mut both = [a, b].map(|place| shown(&names.patterns[place as usize].name(frame)));
        both.sort();
        let [first, second] = both;
        return Err(FormatError::DuplicateFrame { frame, first, second }.into());
    }
    Ok(CameraFiles { camera: camera.into(), folder: path, names })
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
