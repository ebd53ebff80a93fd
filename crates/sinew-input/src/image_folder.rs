//! A folder of image files of calibrated cameras: file of each camera and frame, and its size.
//!
//! Files lie side by side (`cam01_000.png`) or in a folder a camera (`cam01/000.png`, `cam01_masks/000.png`). Cameras are matched by name as with keypoints,
//! frames go by the last number in the file names.

use crate::folder_contents::{FolderContents, folder_contents};
use crate::input_error::InputError;
use crate::lag::ClockLag;
use crate::recording::{lag_of, listing, ranges};
use crate::size_misfit::SizeMisfit;
use crate::{Error, files};
use listing::CameraFiles;
use sinew_formats::{Error as FormatError, camera_name};
use sinew_observe::Camera;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Share of the width or height by which images may miss the size that is declared.
const SIZE_TOLERANCE: f64 = 0.01;

/// What to take from a folder of images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageFolderOptions {
    /// Size of the images over that of the cameras' images; then 1 % of width and height may differ. If `None`, the sizes must be equal.
    pub scale: Option<f64>,
    /// Frames to take, by number, whether all of them are there or not; those that all cameras have if `None`.
    pub frames: Option<Range<u64>>,
    /// Whether cameras may begin and end apart.
    pub trim: bool,
    /// Frames that cameras are late: frame f of such a camera is in its file numbered f + lag.
    pub lag: Vec<(String, ClockLag)>,
    /// Names of all calibrated cameras, of which some may not be in use; those in use if empty.
    pub calibrated: Vec<String>,
}

/// A kind of images: its words and files.
#[derive(Debug)]
pub struct Kind {
    /// Word for one of them.
    pub one: &'static str,
    /// Word for several.
    pub many: &'static str,
    /// Extensions of their files, in lower case.
    pub extensions: &'static [&'static str],
    /// What may follow the name of the camera.
    pub suffixes: &'static [&'static str],
    /// Largest file that is read.
    pub max_bytes: u64,
}

/// A file of a camera and frame.
pub struct File {
    /// Path, for messages.
    pub name: String,
    /// Contents.
    pub bytes: Vec<u8>,
}

/// The files of a frame.
pub struct FrameFiles {
    /// In the order of the cameras.
    pub files: Vec<Option<File>>,
    /// Whether the frame is one of those to be taken and is read for the first time.
    pub counts: bool,
}

/// An opened folder of images.
#[derive(Debug)]
pub struct ImageFolder {
    kind: &'static Kind,
    cameras: Vec<Camera>,
    scale: Option<f64>,
    files: Vec<Option<CameraFiles>>,
    sizes: Vec<Option<[usize; 2]>>,
    available: Range<u64>,
    frames: Range<u64>,
    counted: Vec<bool>,
    warnings: Vec<String>,
    hash: u64,
}

impl ImageFolder {
    /// Opens the files of the cameras in a folder.
    ///
    /// # Errors
    /// A scale that is not positive; a folder without such files; files of no calibrated camera; no common frame.
    pub fn open(
        folder: &Path,
        cameras: &[Camera],
        kind: &'static Kind,
        options: &ImageFolderOptions,
    ) -> Result<Self, Error> {
        if let Some(scale) = options.scale.filter(|scale| !(*scale > 0.0 && scale.is_finite())) {
            return Err(InputError::ImageScale { many: kind.many, scale }.into());
        }
        let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        let found = camera_files(folder, &names, kind)?;
        let calibrated: Vec<&str> = match options.calibrated.as_slice() {
            [] => names.clone(),
            all => all.iter().map(String::as_str).collect(),
        };
        let labels: Vec<String> =
            found.iter().map(|files| camera_part(&files.name, &calibrated, kind).to_owned()).collect();
        // What belongs to no calibrated camera is refused; what belongs to one that is not in use is left alone.
        camera_name::match_names(&labels, &calibrated)?;
        let found = labels.iter().map(|label| camera_name::fold(label)).zip(found).collect();
        let files = listed_by_camera(cameras, found, kind, &options.lag)?;
        let lacking = cameras.iter().zip(&files).filter(|(_, files)| files.is_none());
        let warnings = lacking.map(|(camera, _)| {
            format!("no {} for camera `{}`; there are: {}", kind.many, camera.name, labels.join(", "))
        });
        let warnings = warnings.collect();
        let listed: Vec<&CameraFiles> = files.iter().flatten().collect();
        if listed.is_empty() {
            return Err(InputError::ImagesOfOtherCameras {
                folder: folder.to_owned(),
                many: kind.many,
                found: labels,
                cameras: names.into_iter().map(str::to_owned).collect(),
            }
            .into());
        }
        let (available, common) = ranges(&listed, options.frames.as_ref(), options.trim)?;
        let frames = options.frames.clone().unwrap_or(common);
        Ok(Self {
            kind,
            cameras: cameras.to_vec(),
            scale: options.scale,
            sizes: vec![None; files.len()],
            files,
            counted: vec![false; usize::try_from(frames.end - frames.start).unwrap_or_default()],
            available,
            frames,
            warnings,
            hash: 0,
        })
    }

    /// The cameras as they see these images: with `scale`, resized by it.
    pub fn cameras(&self) -> Vec<Camera> {
        self.cameras.iter().map(|camera| camera.resized(self.scale.unwrap_or(1.0))).collect()
    }

    /// Frames to be taken, by number.
    #[must_use]
    pub fn frames(&self) -> Range<u64> {
        self.frames.clone()
    }

    /// Frames that are there, by number.
    #[must_use]
    pub fn available(&self) -> Range<u64> {
        self.available.clone()
    }

    /// What was odd when the folder was opened.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Hash of all files read so far, in hexadecimal digits.
    #[must_use]
    pub fn hash(&self) -> String {
        format!("{:016x}", self.hash)
    }

    /// Folders of the cameras that have files.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        let mut folders: Vec<PathBuf> = self.files.iter().flatten().map(|files| files.folder.clone()).collect();
        folders.dedup();
        folders
    }

    /// Whether there is any file of a camera.
    pub fn has_files(&self, camera: usize) -> bool {
        self.files[camera].is_some()
    }

    /// Numbers of the given frames that some camera has, rising.
    pub fn numbers_in(&self, frames: &Range<u64>) -> Vec<u64> {
        let all = self.files.iter().flatten().flat_map(CameraFiles::numbers);
        let numbers: BTreeSet<u64> = all.filter(|number| frames.contains(number)).collect();
        numbers.into_iter().collect()
    }

    /// Path of the first file of each camera that is to be taken, with the place of the camera.
    pub fn first_files(&self) -> Vec<(usize, PathBuf)> {
        let first = |files: &CameraFiles| files.path(files.numbers().find(|number| self.frames.contains(number))?);
        self.files.iter().enumerate().filter_map(|(place, files)| Some((place, first(files.as_ref()?)?))).collect()
    }

    /// The files of a frame.
    ///
    /// # Errors
    /// A file that cannot be read or is too large.
    pub fn read(&mut self, number: u64) -> Result<FrameFiles, Error> {
        let slot = number.checked_sub(self.frames.start).and_then(|i| self.counted.get_mut(usize::try_from(i).ok()?));
        let counts = slot.is_some_and(|counted| !std::mem::replace(counted, true));
        let mut read = Vec::with_capacity(self.files.len());
        for (index, files) in self.files.iter().enumerate() {
            let Some(path) = files.as_ref().and_then(|files| files.path(number)) else {
                read.push(None);
                continue;
            };
            let bytes = files::read_bytes(&path, self.kind.max_bytes)?;
            if counts {
                // A sum does not depend on the order in which frames are read.
                let place = files::fnv(files::fnv(files::FNV_START, &number.to_le_bytes()), &index.to_le_bytes());
                self.hash = self.hash.wrapping_add(files::fnv(place, &bytes));
            }
            read.push(Some(File { name: path.display().to_string(), bytes }));
        }
        Ok(FrameFiles { files: read, counts })
    }

    /// Refuses an image whose size does not fit the calibration, or is not that of the camera's first one.
    ///
    /// # Errors
    /// That misfit, with the camera and both sizes.
    pub fn check_size(&mut self, camera: usize, name: &str, size: [usize; 2]) -> Result<(), Error> {
        if let Some(first) = self.sizes[camera] {
            if first == size {
                return Ok(());
            }
            let camera = self.cameras[camera].name.clone();
            return Err(InputError::SizeChanges { file: name.into(), many: self.kind.many, camera, size, first }.into());
        }
        self.sizes[camera] = Some(size);
        let fits = size_fits(&self.cameras[camera], self.kind, size, self.scale);
        let warning = fits.map_err(|misfit| InputError::SizeMisfit { file: name.into(), misfit })?;
        self.warnings.extend(warning);
        Ok(())
    }
}

/// The files of each camera among folders, which come with their folded names; `None` where a camera has none.
fn listed_by_camera(
    cameras: &[Camera],
    mut found: Vec<(String, listing::Folder)>,
    kind: &Kind,
    lag: &[(String, ClockLag)],
) -> Result<Vec<Option<CameraFiles>>, Error> {
    let mut listed = Vec::with_capacity(cameras.len());
    for camera in cameras {
        let name = camera_name::fold(&camera.name);
        let Some(place) = found.iter().position(|(label, _)| *label == name) else {
            listed.push(None);
            continue;
        };
        let files = listing::files(found.swap_remove(place).1, &camera.name, kind.many)?;
        listed.push(Some(files.late_by(lag_of(lag, &camera.name))));
    }
    Ok(listed)
}

/// What is odd about a size that fits its camera.
fn size_fits(camera: &Camera, kind: &Kind, size: [usize; 2], scale: Option<f64>) -> Result<Option<String>, SizeMisfit> {
    let [width, height] = size;
    let [full_width, full_height] = camera.image_size_px;
    let wanted = camera.image_size_px.map(|full| full * scale.unwrap_or(1.0));
    let off: Vec<f64> = wanted.iter().zip(size).map(|(wanted, found)| (wanted - found as f64).abs()).collect();
    if off.iter().all(|off| *off < 1.0) {
        return Ok(None);
    }
    let misfit = SizeMisfit {
        camera: camera.name.clone(),
        many: kind.many,
        calibrated: camera.image_size_px,
        scale,
        size,
        fitting: None,
    };
    if scale.is_some() && off.iter().zip(wanted).all(|(off, wanted)| *off <= SIZE_TOLERANCE * wanted) {
        return Ok(Some(format!("{misfit}; taken as they are")));
    }
    let ratios = [width as f64 / full_width, height as f64 / full_height];
    // The ratio is most precise along the longer side.
    let ratio = (1000.0 * if full_width < full_height { ratios[1] } else { ratios[0] }).round() / 1000.0;
    let is_ratio = ratios.iter().all(|found| (found - ratio).abs() <= SIZE_TOLERANCE * ratio);
    Err(SizeMisfit { fitting: is_ratio.then_some(ratio), ..misfit })
}

/// Name of the camera in the name of a folder or the beginning of file names.
pub fn camera_part<'a>(name: &'a str, calibrated: &[&str], kind: &Kind) -> &'a str {
    if calibrated.iter().any(|camera| camera_name::fold(camera) == camera_name::fold(name)) {
        return name;
    }
    let lower = name.to_ascii_lowercase();
    let suffix = kind.suffixes.iter().find(|suffix| lower.len() > suffix.len() && lower.ends_with(**suffix));
    suffix.map_or(name, |suffix| &name[..name.len() - suffix.len()])
}

/// The files that may belong to cameras; folders of `names` are listed even where they are empty.
pub fn camera_files(root: &Path, names: &[&str], kind: &Kind) -> Result<Vec<listing::Folder>, Error> {
    let is_camera = |name: &str| {
        let name = camera_name::fold(camera_part(name, names, kind));
        names.iter().any(|camera| camera_name::fold(camera) == name)
    };
    listing::expect_folder(root, kind.many)?;
    let listing::ListedImages { folders, loose, unnumbered } = listing::images(root, kind.extensions, is_camera)?;
    if let Some(name) = unnumbered {
        return Err(FormatError::NoFrameNumber { name: name.to_string_lossy().into_owned() }.into());
    }
    let (folder, many, extensions) = (root.to_owned(), kind.many, kind.extensions);
    match (folders.is_empty(), loose.as_slice()) {
        (true, []) => Err(match folder_contents(&folder) {
            FolderContents::Videos(videos) => InputError::VideosForImages { folder, many, videos },
            _ => InputError::NoImages { folder, many, extensions },
        }
        .into()),
        (false, [_, ..]) => Err(InputError::ImagesTwice { folder, many, extensions }.into()),
        (true, loose) if loose.iter().any(|files| files.name.is_empty()) => {
            Err(InputError::ImagesWithoutCamera { folder, many, extensions }.into())
        }
        (false, []) => Ok(folders),
        (true, _) => Ok(loose),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: Kind =
        Kind { one: "mask", many: "masks", extensions: &["png"], suffixes: &["_masks", "_mask"], max_bytes: 1 };

    fn camera(width: f64, height: f64) -> Camera {
        Camera::look_at("cam01", [width, height], 900.0, [-3.0, -4.0, 2.0], [0.0, 0.0, 1.0]).unwrap()
    }

    fn check(full: [f64; 2], size: [usize; 2], scale: Option<f64>, wanted: &str) {
        let found = match size_fits(&camera(full[0], full[1]), &KIND, size, scale) {
            Ok(warning) => warning.unwrap_or_default(),
            Err(misfit) => format!("{misfit} | {:?}", misfit.fitting),
        };
        assert_eq!(found, wanted);
    }

    #[test]
    fn sizes_fit_the_calibration_or_a_declared_scale() {
        check([1088.0, 1920.0], [1088, 1920], None, "");
        check([1088.0, 1920.0], [544, 960], Some(0.5), "");
        check([1087.0, 1921.0], [544, 960], Some(0.5), "");
        check(
            [1088.0, 1920.0],
            [540, 960],
            Some(0.5),
            "cam01 calibrated at 1088x1920, times 0.5 is 544x960, masks are 540x960; taken as they are",
        );
        check([1088.0, 1920.0], [540, 960], None, "cam01 calibrated at 1088x1920, masks are 540x960 | Some(0.5)");
        check(
            [1920.0, 1080.0],
            [1280, 720],
            Some(0.5),
            "cam01 calibrated at 1920x1080, times 0.5 is 960x540, masks are 1280x720 | Some(0.667)",
        );
        check([1920.0, 1080.0], [1080, 1920], None, "cam01 calibrated at 1920x1080, masks are 1080x1920 | None");
    }

    #[test]
    fn a_suffix_is_no_part_of_the_name_unless_the_camera_has_it() {
        assert_eq!(camera_part("cam01_Masks", &["cam01"], &KIND), "cam01");
        assert_eq!(camera_part("cam01_masks", &["cam01_masks"], &KIND), "cam01_masks");
        assert_eq!(camera_part("_masks", &["cam01"], &KIND), "_masks");
    }
}
