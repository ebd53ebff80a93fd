//! What a folder of masks or images holds, from an evenly spaced part of its files.

use super::facts::Facts;
use crate::Error;
use sinew::files::read_bytes;
use sinew::input::image_folder::{Kind, camera_files, camera_part};
use sinew::input::pictures::PICTURES;
use sinew::input::recording::listing::{self, CameraFiles};
use sinew::input::silhouettes::{LARGE_SHARE, MASKS};
use sinew_formats::{mask, picture};
use sinew_input::Error as InputError;
use std::collections::BTreeMap;
use std::path::Path;

/// Files of a camera that are read.
const READ: usize = 40;

/// Whether a folder holds images, side by side or in folders.
pub(super) fn is_images(folder: &Path) -> bool {
    let is_image = |path: &Path| {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        extension.is_some_and(|extension| PICTURES.extensions.contains(&extension.as_str()))
    };
    let entries = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries(folder).any(|path| is_image(&path) || (path.is_dir() && entries(&path).any(|path| is_image(&path))))
}

/// The files of each camera, by its name.
fn listed(folder: &Path, kind: &Kind) -> Result<Vec<CameraFiles>, Error> {
    let found = camera_files(folder, &[], kind)?;
    let files = found.into_iter().map(|files| {
        let name = camera_part(&files.name, &[], kind).to_owned();
        listing::files(files, &name, kind.many)
    });
    let mut files = files.collect::<Result<Vec<CameraFiles>, InputError>>()?;
    files.sort_by(|a, b| a.camera.cmp(&b.camera));
    Ok(files)
}

/// The masks of a folder, if its first file is one.
fn masks(folder: &Path) -> Option<Vec<CameraFiles>> {
    let cameras = listed(folder, &MASKS).ok()?;
    let first = cameras.first()?;
    let path = first.path(first.numbers().next()?)?;
    let bytes = read_bytes(&path, MASKS.max_bytes).ok()?;
    mask::read(&path.display().to_string(), &bytes).is_ok().then_some(cameras)
}

pub(super) fn facts(folder: &Path) -> Result<Facts, Error> {
    let (cameras, kind) = match masks(folder) {
        Some(cameras) => (cameras, &MASKS),
        None => (listed(folder, &PICTURES)?, &PICTURES),
    };
    let mut facts = Facts::new(format!("{}: {} of {} cameras", folder.display(), kind.many, cameras.len()));
    for camera in &cameras {
        camera_facts(camera, kind, &mut facts)?;
    }
    Ok(facts)
}

fn camera_facts(camera: &CameraFiles, kind: &Kind, facts: &mut Facts) -> Result<(), Error> {
    let numbers: Vec<u64> = camera.numbers().collect();
    let mut sizes: BTreeMap<[usize; 2], u64> = BTreeMap::new();
    let mut shares: Vec<(f64, u64)> = vec![];
    for &number in numbers.iter().step_by(numbers.len().div_ceil(READ).max(1)) {
        let Some(path) = camera.path(number) else { continue };
        let (name, bytes) = (path.display().to_string(), read_bytes(&path, kind.max_bytes)?);
        let size = if kind.one == MASKS.one {
            let image = mask::read(&name, &bytes)?.image;
            let size = [image.width(), image.height()];
            shares.push((image.count() as f64 / (size[0] * size[1]) as f64, number));
            size
        } else {
            let image = picture::read(&name, &bytes)?;
            [image.width, image.height]
        };
        sizes.entry(size).or_insert(number);
    }
    let range = camera.range();
    let all: Vec<String> = sizes.keys().map(|[width, height]| format!("{width}x{height}")).collect();
    let mut line =
        format!("{} files, frames {}..{}, {} pixels", camera.len(), range.start, range.end, all.join(" and "));
    let low = shares.iter().map(|(share, _)| *share).fold(f64::INFINITY, f64::min);
    let high = shares.iter().map(|(share, _)| *share).fold(0.0, f64::max);
    if !shares.is_empty() {
        let mean = shares.iter().map(|(share, _)| share).sum::<f64>() / shares.len() as f64;
        let [mean, low, high] = [mean, low, high].map(|share| 100.0 * share);
        line += &format!(", person {mean:.1} % of the image ({low:.1} to {high:.1} %)");
    }
    facts.row(&camera.camera, line);
    let (name, read) = (&camera.camera, shares.len());
    let missing = (range.end - range.start) as usize - camera.len();
    if missing > 0 && kind.one == MASKS.one {
        facts.odd.push(format!("{name}: {missing} frames between the first and the last have no mask").into());
    }
    if sizes.len() > 1 {
        facts.odd.push(format!("{name}: {} of several sizes: {}", kind.many, all.join(", ")).into());
    }
    let mut warn = |what: &str, found: Vec<u64>| {
        if let Some(first) = found.first() {
            facts.odd.push(
                format!("{name}: {} of {read} masks that were read {what} (first: frame {first})", found.len()).into(),
            );
        }
    };
    let with =
        |is: &dyn Fn(f64) -> bool| shares.iter().filter(|(share, _)| is(*share)).map(|(_, number)| *number).collect();
    warn("are empty", with(&|share| share == 0.0));
    warn("cover most of the image; inverted?", with(&|share| share > LARGE_SHARE));
    Ok(())
}
