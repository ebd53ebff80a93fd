//! Points in space from their pixels in several cameras, with covariance.

use crate::arrays::{array, numbers, record, room, shaped};
use crate::background::detached;
use crate::camera::PyCamera;
use crate::failure::Failure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use sinew::observe::Camera;
use sinew::observe::cameras::triangulate::{Config, Search, Seen, refined, triangulate as from_rays};

/// Numbers of a result: point, covariance, error.
const RESULT: usize = 3 + 9 + 1;
/// Numbers of a camera in a result: residual, whether it was used.
const VIEW: usize = 3;

/// Triangulate points that calibrated cameras see.
///
/// A direct linear transform finds each point, cameras that disagree are left out one by one, and Gauss-Newton steps with Huber's weights refine it, lenses included.
///
/// Parameters
/// ----------
/// cameras
///     The cameras.
/// pixels
///     (..., cameras, 2) or (..., cameras, 3): u, v in pixels and, as a third number, the detector's confidence (0 to 1). NaN is a point that was not seen.
/// sigma_px
///     Standard deviation of a pixel coordinate, of all cameras or one each.
/// error_px
///     Mean pixel distance from which on cameras are left out.
/// least_confidence
///     Detections of lower confidence do not count.
///
/// Returns
/// -------
/// A `Triangulated`.
#[pyfunction]
#[pyo3(signature = (cameras, pixels, *, sigma_px = None, error_px = 15.0, least_confidence = 0.3))]
pub(crate) fn triangulate<'py>(
    py: Python<'py>,
    cameras: Vec<PyRef<'_, PyCamera>>,
    pixels: &Bound<'_, PyAny>,
    sigma_px: Option<&Bound<'_, PyAny>>,
    error_px: f64,
    least_confidence: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let cameras: Vec<Camera> = cameras.iter().map(|camera| camera.0.clone()).collect();
    if cameras.len() < 2 {
        return Err(Failure::argument(format!("`cameras`: {} given; at least two are needed", cameras.len())).into());
    }
    let pixels = numbers("pixels", pixels)?;
    let width = if pixels.shape().last() == Some(&3) { 3 } else { 2 };
    let leading = pixels.leading(&[("cameras", Some(cameras.len())), ("2 or 3", Some(width))])?;
    let sigma_px = sigmas(sigma_px, cameras.len())?;
    let config = Config { least_confidence, error_px, search: Search::Greedy, ..Config::default() };
    let (values, views) = (pixels.values()?, cameras.len());
    let found = detached(py, || {
        let count = values.len() / (views * width);
        let mut found = room(&[count, RESULT + VIEW * views])?;
        let out = found.par_chunks_mut(RESULT + VIEW * views).zip(values.par_chunks(views * width));
        out.with_min_len(64).for_each(|(out, pixels)| point(&cameras, &sigma_px, &config, pixels, out));
        Ok(found)
    })?;
    let rows = || found.chunks_exact(RESULT + VIEW * views);
    let part = |from: usize, to: usize| rows().flat_map(|row| row[from..to].to_vec()).collect::<Vec<f64>>();
    let by_view = |row: &[f64]| row[RESULT..].as_chunks::<VIEW>().0.to_vec();
    let residuals = rows().flat_map(|row| by_view(row).into_iter().flat_map(|[u, v, _]| [u, v])).collect();
    let used = rows().flat_map(|row| by_view(row).into_iter().map(|[_, _, used]| used == 1.0)).collect();
    let made = PyDict::new(py);
    made.set_item("points", array(py, shaped(leading, &[3]), part(0, 3))?)?;
    made.set_item("covariances", array(py, shaped(leading, &[3, 3]), part(3, 12))?)?;
    made.set_item("errors_px", array(py, leading.iter().copied(), part(12, RESULT))?)?;
    made.set_item("residuals_px", array(py, shaped(leading, &[views, 2]), residuals)?)?;
    made.set_item("used", array(py, shaped(leading, &[views]), used)?)?;
    record(py, "Triangulated", &made)
}

fn sigmas(given: Option<&Bound<'_, PyAny>>, cameras: usize) -> PyResult<Vec<f64>> {
    let Some(given) = given else { return Ok(vec![1.0; cameras]) };
    let given = numbers("sigma_px", given)?;
    if !given.shape().is_empty() {
        given.exactly(&[("cameras", Some(cameras))])?;
    }
    let values = given.finite()?;
    if let Some(value) = values.iter().find(|sigma| **sigma <= 0.0) {
        return Err(Failure::argument(format!("`sigma_px` is {value}; it must be positive")).into());
    }
    Ok(values.iter().copied().cycle().take(cameras).collect())
}

/// One point into its row of the results.
fn point(cameras: &[Camera], sigma_px: &[f64], config: &Config, pixels: &[f64], out: &mut [f64]) {
    out.fill(f64::NAN);
    let (summary, views) = out.split_at_mut(RESULT);
    let views = views.as_chunks_mut::<VIEW>().0;
    views.iter_mut().for_each(|view| view[2] = 0.0);
    let width = pixels.len() / cameras.len();
    let seen: Vec<Seen<'_>> = cameras
        .iter()
        .zip(pixels.chunks_exact(width))
        .map(|(camera, at)| Seen { camera, pixel: [at[0], at[1]], confidence: at.get(2).copied().unwrap_or(1.0) })
        .collect();
    let Some(first) = from_rays(&seen, config) else { return };
    let used: Vec<Seen<'_>> = first.used.iter().map(|&view| seen[view]).collect();
    let sigma: Vec<f64> = first.used.iter().map(|&view| sigma_px[view]).collect();
    let Some(refined) = refined(&used, &sigma, first.point) else { return };
    summary[..3].copy_from_slice(&refined.point);
    summary[3..12].copy_from_slice(refined.covariance.as_flattened());
    summary[12] = first.error_px;
    for (&view, residual) in first.used.iter().zip(refined.residual_px) {
        let [u, v] = residual.unwrap_or([f64::NAN; 2]);
        views[view] = [u, v, 1.0];
    }
}
