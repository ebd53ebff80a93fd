//! A person who walks before cameras, with known truth.

use crate::arrays::{array, record};
use crate::background::detached;
use crate::camera::PyCamera;
use crate::failure::{Failure, USAGE};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::core::random::Stage;
use sinew::formats::openpose::Keypoint;
use sinew_simulate::detector::{Detections, DetectorNoise, detect};
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_simulate::ring::Ring;

/// Frames of all cameras beyond which a simulation is refused.
const MOST_FRAMES: f64 = 1e6;

/// Simulate a person who stands, walks and stops, seen by calibrated cameras.
///
/// Parameters
/// ----------
/// cameras
///     Number of cameras on a circle, or the cameras of your own rig.
/// duration_s
///     Duration, seconds; the first one is spent standing.
/// fps
///     Frames per second.
/// sigma_px
///     Independent Gaussian errors of this size and nothing else; by default a detector with offsets, jitter, missing keypoints and gross outliers, which grow with the rows of the images.
/// seed
///     The same seed gives the same recording on every machine.
///
/// Returns
/// -------
/// A `Simulated`; the walker goes along y, from about -1 m to 1 m in four seconds. Keypoints outside an image are missing.
#[pyfunction]
#[pyo3(signature = (cameras = None, *, duration_s = 4.0, fps = 30.0, sigma_px = None, seed = 1))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    cameras: Option<&Bound<'_, PyAny>>,
    duration_s: f64,
    fps: f64,
    sigma_px: Option<f64>,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let (count, rig) = match cameras {
        None => (Ring::default().cameras, None),
        Some(given) => match given.extract::<usize>() {
            Ok(count) => (count, None),
            Err(_) => {
                let rig = given.extract::<Vec<PyRef<'_, PyCamera>>>().map_err(|_| {
                    Failure::argument("`cameras` is neither a number of cameras nor a list of `sinew.Camera`")
                })?;
                (rig.len(), Some(rig))
            }
        },
    };
    let rig: Option<Vec<_>> = rig.map(|rig| rig.iter().map(|camera| camera.0.clone()).collect());
    let positive = |name: &str, value: f64| {
        let refused = format!("`{name}` is {value}; it must be positive");
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Failure { code: USAGE, ..Failure::argument(refused) })
        }
    };
    positive("duration_s", duration_s)?;
    positive("fps", fps)?;
    sigma_px.map_or(Ok(()), |sigma| positive("sigma_px", sigma))?;
    if duration_s * fps * count as f64 > MOST_FRAMES || count == 0 {
        let what = format!("{duration_s} s at {fps} per second before {count} cameras cannot be simulated");
        return Err(Failure { code: USAGE, ..Failure::argument(what) }.into());
    }
    let noise = sigma_px.map_or(DetectorNoise::DETECTOR_LIKE, DetectorNoise::stated_gaussian);
    let ring = Ring { cameras: if rig.is_some() { 1 } else { count }, ..Ring::default() };
    let script = Script { duration_s, rate_hz: fps, ring, noise, ..Script::default() };
    let recording = detached(py, || {
        let mut recording = SyntheticRecording::new(&script, seed)?;
        if let Some(rig) = rig {
            let rows = rig.iter().map(|camera| camera.image_size_px[1]).sum::<f64>() / rig.len() as f64;
            let noise = sigma_px.map_or_else(|| noise.in_rows(rows), DetectorNoise::stated_gaussian);
            let stage = Stage::new(seed, "simulated rig");
            let lags = vec![0.0; rig.len()];
            let seen = detect(&recording.truth, &recording.layout, (&rig, &lags), &noise, stage);
            let Detections { offsets_px, keypoints } = seen;
            (recording.cameras, recording.keypoints, recording.offsets_px) = (rig, keypoints, offsets_px);
            hide_outside(&mut recording);
        }
        Ok(recording)
    })?;
    simulated(py, recording)
}

/// What lies outside an image was not seen.
fn hide_outside(recording: &mut SyntheticRecording) {
    for (camera, frames) in recording.cameras.iter().zip(&mut recording.keypoints) {
        let [width, height] = camera.image_size_px;
        for keypoint in frames.iter_mut().flatten() {
            *keypoint = keypoint.filter(|at| (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y));
        }
    }
}

fn simulated(py: Python<'_>, recording: SyntheticRecording) -> PyResult<Bound<'_, PyAny>> {
    let SyntheticRecording { body, states, truth, cameras, layout, keypoints, rate_hz, .. } = recording;
    let (frames, views, width) = (states.len(), cameras.len(), layout.points.len());
    let mut values = vec![f64::NAN; frames * views * width * 3];
    for (view, seen) in keypoints.iter().enumerate() {
        for (frame, points) in seen.iter().enumerate() {
            let places = values[(frame * views + view) * width * 3..].as_chunks_mut::<3>().0;
            for (place, keypoint) in places.iter_mut().zip(points) {
                *place = keypoint.map_or([f64::NAN; 3], |Keypoint { x, y, confidence }| [x, y, confidence]);
            }
        }
    }
    let places = truth.frames.iter().flatten().flatten().copied().collect();
    let cameras = cameras.into_iter().map(|camera| Py::new(py, PyCamera(camera))).collect::<PyResult<Vec<_>>>()?;
    let made = PyDict::new(py);
    made.set_item("cameras", cameras)?;
    made.set_item("keypoints", array(py, [frames, views, 1, width, 3], values)?)?;
    made.set_item("layout", layout.points)?;
    made.set_item("truth", array(py, [frames, truth.names.len(), 3], places)?)?;
    made.set_item("points", truth.names.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    made.set_item("poses", array(py, [frames, body.dof()], states.concat())?)?;
    made.set_item("rate_hz", rate_hz)?;
    record(py, "Simulated", &made)
}
