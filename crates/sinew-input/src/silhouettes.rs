//! Silhouettes on disk: masks of calibrated cameras, read one frame at a time.
//!
//! Masks lie side by side (`cam01_000.png`) or in a folder a camera (`cam01/000.png`, `cam01_masks/000.png`). Cameras are matched by name, frames go by the last
//! number in the file names, and a number without a file is a frame that the camera missed. [`sinew_formats::mask`] describes mask files.
//!
//! ```no_run
//! use sinew_input::recording::{Recording, RecordingOptions};
//! use sinew_input::silhouettes::{self, Silhouettes};
//! use std::path::Path;
//!
//! let mut recording = Recording::open(Path::new("Calib.toml"), Path::new("pose"), &RecordingOptions::default())?;
//! let options = silhouettes::ImageFolderOptions {
//!     scale: Some(0.5),
//!     frames: Some(recording.frames()),
//!     calibrated: recording.calibrated().to_vec(),
//!     ..silhouettes::ImageFolderOptions::default()
//! };
//! let mut silhouettes = Silhouettes::open(Path::new("masks"), recording.cameras(), &options)?;
//! for number in recording.frames() {
//!     let (people, masks) = (recording.frame(number)?, silhouettes.frame(number)?);
//!     assert_eq!(people.len(), masks.len());
//! }
//! # Ok::<(), sinew_input::Error>(())
//! ```

use crate::Error;
use crate::image_folder::{ImageFolder, Kind};
use sinew_formats::mask::{self, Mask};
use sinew_observe::Camera;
use sinew_observe::silhouettes::bit_image::BitImage;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use crate::image_folder::ImageFolderOptions;

/// Share of the image above which a mask gets a warning: a person fills less of the view of a camera that sees all of them.
pub const LARGE_SHARE: f64 = 0.5;

/// Words and files of masks.
pub const MASKS: Kind = Kind {
    one: "mask",
    many: "masks",
    extensions: &["png"],
    suffixes: &["_masks", "_mask", "_silhouettes", "_silhouette"],
    max_bytes: mask::MAX_BYTES,
};

/// An opened folder of masks.
#[derive(Debug)]
pub struct Silhouettes {
    folder: ImageFolder,
    tallies: Vec<Tally>,
}

impl Silhouettes {
    /// Opens the masks of these cameras, and looks at the size of the first mask of each.
    ///
    /// # Errors
    /// A folder without masks, with masks of cameras that are not calibrated or with two files for a frame; cameras that begin or end apart, unless trimmed; masks
    /// whose size does not fit the cameras; first masks that [`mask::read`] refuses.
    pub fn open(folder: &Path, cameras: &[Camera], options: &ImageFolderOptions) -> Result<Self, Error> {
        let mut folder = ImageFolder::open(folder, cameras, &MASKS, options)?;
        for (camera, path) in folder.first_files() {
            let name = path.display().to_string();
            let image = mask::read(&name, &crate::files::read_bytes(&path, MASKS.max_bytes)?)?.image;
            folder.check_size(camera, &name, [image.width(), image.height()])?;
        }
        Ok(Self { folder, tallies: vec![Tally::default(); cameras.len()] })
    }

    /// The cameras that were given, resized to the masks by the declared scale, in their order.
    #[must_use]
    pub fn cameras(&self) -> Vec<Camera> {
        self.folder.cameras()
    }

    /// Frames to be taken.
    #[must_use]
    pub fn frames(&self) -> Range<u64> {
        self.folder.frames()
    }

    /// Frames that all cameras have, from the first number to the last.
    #[must_use]
    pub fn available(&self) -> Range<u64> {
        self.folder.available()
    }

    /// Mask of each camera, in the order in which the cameras were given, with as many pixels as the file has; `None` where a camera has no file.
    ///
    /// # Errors
    /// Files that cannot be read, that [`mask::read`] refuses, or of another size than the camera's first.
    pub fn frame(&mut self, number: u64) -> Result<Vec<Option<BitImage>>, Error> {
        let frame = self.folder.read(number)?;
        let mut masks = Vec::with_capacity(frame.files.len());
        for (camera, file) in frame.files.into_iter().enumerate() {
            let mask = match file {
                Some(file) => {
                    let mask = mask::read(&file.name, &file.bytes)?;
                    self.folder.check_size(camera, &file.name, [mask.image.width(), mask.image.height()])?;
                    Some(mask)
                }
                None => None,
            };
            if frame.counts {
                self.tallies[camera].add(number, mask.as_ref());
            }
            masks.push(mask.map(|mask| mask.image));
        }
        Ok(masks)
    }

    /// What is odd about the masks as far as they were read, each frame counted once however often it is read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let cameras = self.folder.cameras();
        let counted = cameras.iter().zip(&self.tallies).flat_map(|(camera, tally)| tally.warnings(&camera.name));
        self.folder.warnings().iter().cloned().chain(counted).collect()
    }

    /// Hash of the masks read so far, of the frames to be taken; it does not depend on the order in which they are read.
    #[must_use]
    pub fn input_hash(&self) -> String {
        self.folder.hash()
    }

    /// Folders that the masks are read from.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        self.folder.folders()
    }
}

/// How often something was found, and the first frame of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count {
    /// Number of frames.
    pub frames: u64,
    /// The first one.
    pub first: u64,
}

impl Count {
    /// Counts a frame.
    pub fn add(&mut self, number: u64) {
        if self.frames == 0 {
            self.first = number;
        }
        self.frames += 1;
    }
}

/// Counts over the frames of a camera, from which its warnings are made.
#[derive(Clone, Debug, Default)]
struct Tally {
    masks: u64,
    missing: Count,
    empty: Count,
    large: Count,
    largest: (f64, u64),
    between: Count,
    channels: Count,
}

impl Tally {
    fn add(&mut self, number: u64, mask: Option<&Mask>) {
        let Some(mask) = mask else { return self.missing.add(number) };
        self.masks += 1;
        let pixels = (mask.image.width() * mask.image.height()) as f64;
        let share = mask.image.count() as f64 / pixels;
        if share == 0.0 {
            self.empty.add(number);
        }
        if share > LARGE_SHARE {
            self.large.add(number);
            if share > self.largest.0 {
                self.largest = (share, number);
            }
        }
        if mask.between > 0 {
            self.between.add(number);
        }
        if mask.channels > 1 {
            self.channels.add(number);
        }
    }

    fn warnings(&self, camera: &str) -> Vec<String> {
        let Self { masks, missing, empty, large, largest, between, channels } = self;
        let frames = masks + missing.frames;
        // About a camera without any mask there is a warning already.
        let texts = [
            (*masks > 0).then_some(missing).map(|missing| {
                (missing, format!("{} of {frames} frames have no mask (first: {})", missing.frames, missing.first))
            }),
            Some((empty, format!("{} of {masks} masks are empty (first: frame {})", empty.frames, empty.first))),
            Some((
                large,
                format!(
                    "{} of {masks} masks cover more than {:.0} % of the image (first: frame {}; most: {:.0} % in frame {}); inverted?",
                    large.frames,
                    100.0 * LARGE_SHARE,
                    large.first,
                    100.0 * largest.0,
                    largest.1
                ),
            )),
            Some((
                between,
                format!(
                    "{} of {masks} masks have values other than 0 and 255 (first: frame {}); those from {} on are taken as the person",
                    between.frames,
                    between.first,
                    mask::THRESHOLD
                ),
            )),
            Some((
                channels,
                format!(
                    "{} of {masks} masks have several channels (first: frame {}); they are equal and taken as one",
                    channels.frames, channels.first
                ),
            )),
        ];
        let texts = texts.into_iter().flatten().filter(|(count, _)| count.frames > 0);
        texts.map(|(_, text)| format!("camera {camera}: {text}")).collect()
    }
}
