//! Pictures on disk: colour images of calibrated cameras, read one frame at a time.
//!
//! Files lie and are matched as in [`crate::silhouettes`], as PNG or JPEG. They may be sparse, every fifth frame for example: then [`Pictures::numbers`] says
//! which there are.

use crate::Error;
use crate::image_folder::{ImageFolder, Kind};
use sinew_formats::picture;
use sinew_observe::{Camera, RgbImage};
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use crate::image_folder::ImageFolderOptions;

/// Words and files of pictures.
pub const PICTURES: Kind = Kind {
    one: "image",
    many: "images",
    extensions: &["jpg", "jpeg", "png"],
    suffixes: &["_images", "_image", "_img", "_frames"],
    max_bytes: picture::MAX_BYTES,
};

/// An opened folder of pictures.
#[derive(Debug)]
pub struct Pictures {
    folder: ImageFolder,
    /// Frames that a camera lacks although another has them, and the first of them.
    lacking: Vec<(u64, Option<u64>)>,
}

impl Pictures {
    /// Opens the pictures of these cameras, and looks at the size of the first picture of each.
    ///
    /// # Errors
    /// As [`crate::silhouettes::Silhouettes::open`], with [`picture::read`] for [`sinew_formats::mask::read`].
    pub fn open(folder: &Path, cameras: &[Camera], options: &ImageFolderOptions) -> Result<Self, Error> {
        let mut folder = ImageFolder::open(folder, cameras, &PICTURES, options)?;
        for (camera, path) in folder.first_files() {
            let name = path.display().to_string();
            let image = picture::read(&name, &crate::files::read_bytes(&path, PICTURES.max_bytes)?)?;
            folder.check_size(camera, &name, [image.width, image.height])?;
        }
        Ok(Self { folder, lacking: vec![(0, None); cameras.len()] })
    }

    /// The cameras that were given, resized to the pictures by the declared scale, in their order.
    #[must_use]
    pub fn cameras(&self) -> Vec<Camera> {
        self.folder.cameras()
    }

    /// Frames to be taken, whether there are pictures of them or not.
    #[must_use]
    pub fn frames(&self) -> Range<u64> {
        self.folder.frames()
    }

    /// Numbers of those frames of which some camera has a picture, rising.
    #[must_use]
    pub fn numbers(&self) -> Vec<u64> {
        self.numbers_in(&self.frames())
    }

    /// Numbers of the given frames of which some camera has a picture, whether they are to be taken or not, rising.
    #[must_use]
    pub fn numbers_in(&self, frames: &Range<u64>) -> Vec<u64> {
        self.folder.numbers_in(frames)
    }

    /// Picture of each camera, in the order in which the cameras were given; `None` where a camera has no file.
    ///
    /// # Errors
    /// Files that cannot be read, that [`picture::read`] refuses, or of another size than the camera's first.
    pub fn frame(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        let frame = self.folder.read(number)?;
        let is_there = frame.files.iter().any(Option::is_some);
        let mut images = Vec::with_capacity(frame.files.len());
        for (camera, file) in frame.files.into_iter().enumerate() {
            if file.is_none() && is_there && frame.counts && self.folder.has_files(camera) {
                let (count, first) = &mut self.lacking[camera];
                *count += 1;
                first.get_or_insert(number);
            }
            images.push(match file {
                Some(file) => {
                    let image = picture::read(&file.name, &file.bytes)?;
                    self.folder.check_size(camera, &file.name, [image.width, image.height])?;
                    Some(image)
                }
                None => None,
            });
        }
        Ok(images)
    }

    /// What is odd about the pictures as far as they were read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let cameras = self.folder.cameras();
        let lacking = cameras.iter().zip(&self.lacking).filter_map(|(camera, (count, first))| {
            let first = (*first)?;
            Some(format!(
                "camera {}: {count} frames have no image although others have one (first: {first})",
                camera.name
            ))
        });
        self.folder.warnings().iter().cloned().chain(lacking).collect()
    }

    /// Hash of the pictures read so far, of the frames to be taken; it does not depend on the order in which they are read.
    #[must_use]
    pub fn input_hash(&self) -> String {
        self.folder.hash()
    }

    /// Folders that the pictures are read from.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        self.folder.folders()
    }
}
