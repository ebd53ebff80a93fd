//! Masks of people before a background that does not move.
//!
//! Images in, a folder of masks out that [`sinew::input::silhouettes`] reads.
//!
//! For each camera, one image in memory at a time:
//!
//! 1. mean and variance of every pixel over the images of the background ([`sinew_observe::silhouettes::background`]);
//! 2. for each image, the pixels that are far from it, cleaned by a median of 3 x 3 and by leaving small parts out ([`sinew_observe::silhouettes::cleaning`]);
//! 3. a mask `<out>/<camera>/<frame>.png`, which gets its name when it is whole.
//!
//! Folders of images are laid out as in [`sinew::input::pictures`]; cameras are matched by name.

pub(crate) mod error;

pub use error::SegmentError;

use crate::Error;
use sinew::files;
use sinew::input::image_folder::{camera_files, camera_part};
use sinew::input::pictures::PICTURES;
use sinew::input::recording::listing::{self, CameraFiles};
use sinew::input::silhouettes::{Count, LARGE_SHARE};
use sinew_formats::{camera_name, mask, picture};
use sinew_input::Error as InputError;
use sinew_observe::RgbImage;
use sinew_observe::silhouettes::background::{Background, Config};
use sinew_observe::silhouettes::cleaning::{large_parts, median};
use sinew_results::{Staged, claim};
use std::path::{Path, PathBuf};

/// Share of the image below which a part is no person, however large the others are: 260 pixels of 540 x 960.
const LEAST_SHARE: f64 = 5e-4;

/// Images of the background below which its variance is hardly known.
const FEW_IMAGES: u32 = 5;

/// What to make masks from.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentRequest {
    /// Folders of images without anybody; all images of a camera in them are taken.
    pub background: Vec<PathBuf>,
    /// Folder of images.
    pub images: PathBuf,
    /// When a pixel is foreground.
    pub config: Config,
    /// Share of the largest part's pixels below which a part of a mask is left out.
    pub least_part: f64,
}

/// The masks of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraMasks {
    /// Name, as the folder of images has it.
    pub name: String,
    /// Images that the background was learned from.
    pub background_images: u32,
    /// Masks written.
    pub masks: u64,
    /// Share of the image that they cover, on average.
    pub mean_share: f64,
}

/// The masks of all cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct Masks {
    /// By name.
    pub cameras: Vec<CameraMasks>,
    /// What is odd.
    pub warnings: Vec<String>,
}

/// Makes masks and writes them; the callback `progress` gets the number of images done, and of all.
///
/// # Errors
/// Settings out of range; folders without images; a camera without a background; images that [`picture::read`] refuses or that differ in size; an output folder that
/// holds something (unless forced), is an input or cannot be written.
pub fn segment(
    request: &SegmentRequest,
    out: &Path,
    force: bool,
    mut progress: impl FnMut(u64, u64),
) -> Result<Masks, Error> {
    check(request)?;
    let cameras = listed(&request.images)?;
    let backgrounds = request.background.iter().map(|folder| listed(folder)).collect::<Result<Vec<_>, _>>()?;
    let mut pairs = Vec::new();
    for camera in cameras {
        let background = background_files(&camera, &backgrounds, request)?;
        pairs.push((camera, background));
    }
    let mut inputs = request.background.clone();
    inputs.push(request.images.clone());
    let claim = claim(out, &inputs, force)?;
    let images = |(camera, background): &(CameraFiles, Vec<&CameraFiles>)| {
        (camera.len() + background.iter().map(|files| files.len()).sum::<usize>()) as u64
    };
    let total = pairs.iter().map(images).sum();
    let mut done = 0;
    let mut step = || {
        done += 1;
        progress(done, total);
    };
    let staged = claim.staged()?;
    let mut made = Masks { cameras: Vec::new(), warnings: Vec::new() };
    for (camera, background) in &pairs {
        let background = learned(&camera.camera, background, &mut step)?;
        if background.images() < FEW_IMAGES {
            made.warnings.push(format!(
                "camera {}: {} images of the background; its noise is hardly known, take {FEW_IMAGES} or more",
                camera.camera,
                background.images()
            ));
        }
        made.cameras.push(masks(camera, &background, request, &staged, &mut made.warnings, &mut step)?);
    }
    staged.finish(|name| name.ends_with(".png") && name.contains('/'))?;
    Ok(made)
}

fn check(request: &SegmentRequest) -> Result<(), SegmentError> {
    let Config { threshold, least_std, shadow } = request.config;
    let wrong = |setting, value, range| Err(SegmentError::OutOfRange { setting, value, range });
    let is_positive = |value: f32| value > 0.0 && value.is_finite();
    if !is_positive(threshold) {
        return wrong("threshold", threshold.into(), "greater than 0");
    }
    if !is_positive(least_std) {
        return wrong("least-std", least_std.into(), "greater than 0");
    }
    if let Some(shadow) = shadow.filter(|share| !(*share > 0.0 && *share < 1.0)) {
        return wrong("shadow", shadow.into(), "between 0 and 1");
    }
    if !(0.0..=1.0).contains(&request.least_part) {
        return wrong("least-part", request.least_part, "from 0 to 1");
    }
    Ok(())
}

/// The files of each camera, by its name.
fn listed(root: &Path) -> Result<Vec<CameraFiles>, Error> {
    let folders = camera_files(root, &[], &PICTURES)?;
    let names: Vec<String> =
        folders.iter().map(|folder| camera_part(&folder.name, &[], &PICTURES).to_owned()).collect();
    camera_name::match_names(&names, &names)?;
    let files = folders.into_iter().zip(&names).map(|(folder, name)| listing::files(folder, name, PICTURES.many));
    Ok(files.collect::<Result<_, InputError>>()?)
}

/// The files of the background of a camera.
fn background_files<'a>(
    camera: &CameraFiles,
    backgrounds: &'a [Vec<CameraFiles>],
    request: &SegmentRequest,
) -> Result<Vec<&'a CameraFiles>, SegmentError> {
    let name = camera_name::fold(&camera.camera);
    let found: Vec<&CameraFiles> =
        backgrounds.iter().flatten().filter(|files| camera_name::fold(&files.camera) == name).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    Err(SegmentError::NoBackground {
        camera: camera.camera.clone(),
        folders: request.background.clone(),
        cameras: backgrounds.iter().flatten().map(|files| files.camera.clone()).collect(),
    })
}

fn read(path: &Path) -> Result<(String, RgbImage), Error> {
    let name = path.display().to_string();
    let image = picture::read(&name, &files::read_bytes(path, picture::MAX_BYTES)?)?;
    Ok((name, image))
}

fn paths(files: &CameraFiles) -> impl Iterator<Item = (u64, PathBuf)> + '_ {
    files.numbers().filter_map(|number| Some((number, files.path(number)?)))
}

fn other_size(camera: &str, name: &str, image: &RgbImage, background: &Background) -> SegmentError {
    let size = [image.width, image.height];
    SegmentError::OtherSize { file: name.into(), camera: camera.into(), size, background: background.size() }
}

fn learned(camera: &str, files: &[&CameraFiles], step: &mut impl FnMut()) -> Result<Background, Error> {
    let mut learned: Option<Background> = None;
    for (_, path) in files.iter().flat_map(|files| paths(files)) {
        let (name, image) = read(&path)?;
        let background = learned.get_or_insert_with(|| Background::new(image.width, image.height));
        if background.add(&image).is_err() {
            return Err(other_size(camera, &name, &image, background).into());
        }
        step();
    }
    Ok(learned.unwrap_or_default())
}

fn masks(
    camera: &CameraFiles,
    background: &Background,
    request: &SegmentRequest,
    staged: &Staged<'_>,
    warnings: &mut Vec<String>,
    step: &mut impl FnMut(),
) -> Result<CameraMasks, Error> {
    let (mut empty, mut large, mut shares, mut masks) = (Count::default(), Count::default(), 0.0, 0);
    let pixels: usize = background.size().iter().product();
    let least_pixels = (LEAST_SHARE * pixels as f64) as usize;
    for (number, path) in paths(camera) {
        let (name, image) = read(&path)?;
        let raw = background
            .foreground(&image, &request.config)
            .map_err(|_| other_size(&camera.camera, &name, &image, background))?;
        let mask = large_parts(&median(&raw), request.least_part, least_pixels);
        let mut bytes = Vec::new();
        let name = format!("{}/{number:06}.png", camera.camera);
        mask::write(&mut bytes, &mask).map_err(sinew::Error::io("write", &name))?;
        staged.write(&name, &bytes)?;
        let share = mask.count() as f64 / pixels as f64;
        if share == 0.0 {
            empty.add(number);
        }
        if share > LARGE_SHARE {
            large.add(number);
        }
        shares += share;
        masks += 1;
        step();
    }
    let name = camera.camera.clone();
    let texts = [
        (empty, "are empty".to_owned(), "nobody there, or a threshold too high?"),
        (
            large,
            format!("cover more than {:.0} % of the image", 100.0 * LARGE_SHARE),
            "is this the background of this camera, in this light?",
        ),
    ];
    warnings.extend(texts.into_iter().filter(|(count, ..)| count.frames > 0).map(|(count, what, ask)| {
        format!("camera {name}: {} of {masks} masks {what} (first: frame {}); {ask}", count.frames, count.first)
    }));
    let mean_share = shares / (masks as f64).max(1.0);
    Ok(CameraMasks { name, background_images: background.images(), masks, mean_share })
}
