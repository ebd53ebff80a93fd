//! Calibrations, bodies, pictures, masks and layouts as files.

use crate::arrays::array;
use crate::background::detached;
use crate::body::PyBody;
use crate::camera::PyCamera;
use crate::failure::{Failure, USAGE};
use numpy::{PyArrayDyn, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sinew::files::{read_bytes, read_text};
use sinew::formats::calibration::{self, CalibrationFormat};
use sinew::formats::source_text::MAX_CONFIG_BYTES;
use sinew::formats::{layout, mask, picture};
use sinew::observe::RgbImage;
use sinew::observe::silhouettes::bit_image::BitImage;
use sinew_report::inspect::{Subject, subjects};
use sinew_results::write_whole;
use std::path::{Path, PathBuf};

/// What a path leads to, in a word.
#[pyfunction]
pub(crate) fn kind(py: Python<'_>, path: PathBuf) -> PyResult<&'static str> {
    let found = detached(py, || Ok(subjects(&[path])?))?;
    Ok(match found.first() {
        Some(Subject::Calibration(_)) => "calibration",
        Some(Subject::Body(_)) => "body",
        Some(Subject::Setup(_) | Subject::Configuration(_)) => "toml",
        Some(Subject::Layout(_)) => "layout",
        Some(Subject::Keypoints(_)) => "keypoints",
        Some(Subject::Images(_)) => "images",
        Some(Subject::Motion(_) | Subject::Acclaim { .. } | Subject::Skeleton(_)) => "motion",
        Some(Subject::Actions(_)) => "table",
        Some(Subject::MotionModel(_) | Subject::LatentModel(_)) => "model",
        Some(Subject::Results(_)) => "results",
        Some(Subject::Draws(_)) => "draws",
        None => "nothing",
    })
}

/// Cameras of a calibration file of any known program, and what is odd about it.
#[pyfunction]
pub(crate) fn read_calibration(py: Python<'_>, path: PathBuf) -> PyResult<(Vec<PyCamera>, Vec<String>)> {
    detached(py, || {
        let text = read_text(&path, MAX_CONFIG_BYTES)?;
        let read = calibration::read(&path.display().to_string(), &text)?;
        let warnings = read.warnings.iter().map(ToString::to_string).collect();
        Ok((read.cameras.into_iter().map(PyCamera).collect(), warnings))
    })
}

/// Writes a calibration in the format of its file name.
#[pyfunction]
pub(crate) fn write_calibration(py: Python<'_>, path: PathBuf, cameras: Vec<PyRef<'_, PyCamera>>) -> PyResult<()> {
    let cameras: Vec<_> = cameras.iter().map(|camera| camera.0.clone()).collect();
    detached(py, || {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let format = CalibrationFormat::from_file_name(&name).ok_or_else(|| Failure {
            code: USAGE,
            ..Failure::argument(format!(
                "`{name}` is no name of a calibration; expected .toml, .yml, .qca.txt or camera_array.toml"
            ))
        })?;
        Ok(write_whole(&path, calibration::write(&cameras, format)?.as_bytes())?)
    })
}

/// Writes a body file.
#[pyfunction]
pub(crate) fn write_body(py: Python<'_>, path: PathBuf, body: PyRef<'_, PyBody>) -> PyResult<()> {
    let text = body.to_toml();
    detached(py, || Ok(write_whole(&path, text.as_bytes())?))
}

/// A picture (PNG, JPEG) as (rows, columns, 3), 0 to 255.
#[pyfunction]
pub(crate) fn read_picture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArrayDyn<u8>>> {
    let RgbImage { width, height, pixels } = detached(py, || {
        let bytes = read_bytes(&path, picture::MAX_BYTES)?;
        Ok(picture::read(&path.display().to_string(), &bytes)?)
    })?;
    array(py, [height, width, 3], pixels.into_flattened())
}

/// A mask (PNG) as (rows, columns), true in the person.
#[pyfunction]
pub(crate) fn read_mask(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArrayDyn<bool>>> {
    let image = detached(py, || {
        let bytes = read_bytes(&path, mask::MAX_BYTES)?;
        Ok(mask::read(&path.display().to_string(), &bytes)?.image)
    })?;
    let (width, height) = (image.width(), image.height());
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| image.get(x, y)).collect();
    array(py, [height, width], pixels)
}

/// Writes a picture as PNG.
#[pyfunction]
pub(crate) fn write_picture(py: Python<'_>, path: PathBuf, pixels: PyReadonlyArray3<'_, u8>) -> PyResult<()> {
    let &[height, width, 3] = pixels.shape() else {
        let what = format!("a picture has the shape (rows, columns, 3), not {:?}", pixels.shape());
        return Err(Failure::argument(what).into());
    };
    let bytes: Vec<u8> = pixels.as_array().iter().copied().collect();
    let image = RgbImage { width, height, pixels: bytes.as_chunks::<3>().0.to_vec() };
    png(py, &path, |out| picture::write_png(out, &image))
}

/// Writes a mask as PNG.
#[pyfunction]
pub(crate) fn write_mask(py: Python<'_>, path: PathBuf, pixels: PyReadonlyArray2<'_, bool>) -> PyResult<()> {
    let pixels = pixels.as_array();
    let (height, width) = pixels.dim();
    let image = BitImage::from_fn(width, height, |x, y| pixels.get((y, x)).copied().unwrap_or(false));
    png(py, &path, |out| mask::write(out, &image))
}

fn png(py: Python<'_>, path: &Path, write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()> + Send) -> PyResult<()> {
    detached(py, || {
        let mut bytes = vec![];
        write(&mut bytes).map_err(sinew::Error::io("write", path))?;
        Ok(write_whole(path, &bytes)?)
    })
}

/// Keypoint layouts by name: the points in the order of the detector, None where a point has no use.
#[pyfunction]
pub(crate) fn layouts() -> PyResult<Vec<(String, Vec<Option<String>>)>> {
    let found = layout::names().into_iter().map(layout::find);
    let found = found.collect::<Result<Vec<_>, sinew::formats::Error>>().map_err(Failure::from)?;
    Ok(found.into_iter().map(|layout| (layout.name, layout.points)).collect())
}

/// A mapping file of keypoints: name and points.
#[pyfunction]
pub(crate) fn read_layout(py: Python<'_>, path: PathBuf) -> PyResult<(String, Vec<Option<String>>)> {
    detached(py, || {
        let read = layout::read(&path.display().to_string(), &read_text(&path, MAX_CONFIG_BYTES)?)?;
        Ok((read.name, read.points))
    })
}
