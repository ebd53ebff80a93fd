//! Keypoints of whole recordings, of any known detector, as one array.

use crate::arrays::{affordable, array, frame_number, numbers};
use crate::background::detached;
use crate::failure::Failure;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use sinew::formats::openpose::{self, Keypoint, OpenposeFrame, OpenposeOptions, OpenposePerson};
use sinew::formats::source_text::MAX_CONFIG_BYTES;
use sinew::formats::{calibration, camera_name, layout};
use sinew::input::recording::keypoint_camera::KeypointCamera;
use sinew::input::recording::keypoint_sources::{layout as stated_layout, sources, stated_rate};
use sinew::observe::Camera;
use sinew_results::{place, write_whole};
use std::path::{Path, PathBuf};

/// Names of the points, where they are known.
type Names = Option<Vec<Option<String>>>;
/// Cameras, number of the first frame, names of the points, frames per second, keypoints.
type Read<'py> = (Vec<String>, u64, Names, Option<f64>, Bound<'py, PyArrayDyn<f64>>);

/// What each camera saw in each frame.
struct Seen {
    cameras: Vec<String>,
    first: u64,
    names: Names,
    rate_hz: Option<f64>,
    /// By frame and camera.
    frames: Vec<Vec<OpenposeFrame>>,
}

/// Keypoints of a folder or file: (frames, cameras, people, points, 3) with NaN where nothing was seen.
#[pyfunction]
pub(crate) fn read_keypoints<'py>(
    py: Python<'py>,
    path: PathBuf,
    calibration: Option<PathBuf>,
    named: Option<String>,
    confidence_scale: f64,
) -> PyResult<Read<'py>> {
    let seen = detached(py, || read(&path, calibration.as_deref(), named.as_deref(), confidence_scale))?;
    let all = || seen.frames.iter().flatten().flat_map(|frame| &frame.people);
    let people = all().map(|person| person.index + 1).max().unwrap_or_default();
    let points = all().map(|person| person.keypoints.len()).max().unwrap_or_default();
    let (count, views) = (seen.frames.len(), seen.cameras.len());
    let mut values = vec![f64::NAN; affordable(&[count, views, people, points, 3])?];
    for (number, frame) in seen.frames.iter().flatten().enumerate() {
        for person in &frame.people {
            let at = (number * people + person.index) * points * 3;
            let places = values[at..].as_chunks_mut::<3>().0;
            for (place, keypoint) in places.iter_mut().zip(&person.keypoints) {
                *place = keypoint.map_or([f64::NAN; 3], |Keypoint { x, y, confidence }| [x, y, confidence]);
            }
        }
    }
    let values = array(py, [count, views, people, points, 3], values)?;
    Ok((seen.cameras, seen.first, seen.names, seen.rate_hz, values))
}

fn cameras(path: Option<&Path>) -> Result<Vec<Camera>, Failure> {
    let Some(path) = path else { return Ok(vec![]) };
    let text = sinew::files::read_text(path, MAX_CONFIG_BYTES)?;
    Ok(calibration::read(&path.display().to_string(), &text)?.cameras)
}

fn read(path: &Path, calibration: Option<&Path>, named: Option<&str>, confidence_scale: f64) -> Result<Seen, Failure> {
    let cameras = cameras(calibration)?;
    let calibrated: Vec<String> = cameras.iter().map(|camera| camera.name.clone()).collect();
    let sources = sources(path, &calibrated, confidence_scale)?;
    let stated = stated_layout(&sources)?;
    let layout = named.map(layout::find).transpose()?.or(stated);
    let mut listed: Vec<(String, KeypointCamera)> = vec![];
    for source in sources {
        let is_it = |camera: &&Camera| camera_name::fold(&camera.name) == camera_name::fold(&source.name);
        let camera = cameras.iter().find(is_it);
        let name = camera.map_or_else(|| bare(&source.name), |camera| camera.name.clone());
        if source.in_image_shares() && camera.is_none() {
            let what = format!("`{}` has shares of the image; give `calibration` for pixels", path.display());
            return Err(Failure::argument(what));
        }
        listed.push((name.clone(), source.keypoints(&name, camera)?));
    }
    // In the order of the calibration, as `track` needs them.
    let order = |name: &String| calibrated.iter().position(|known| known == name).unwrap_or(usize::MAX);
    listed.sort_by_key(|(name, _)| order(name));
    let range = |keypoints: &KeypointCamera| keypoints.files().range();
    let first = listed.iter().map(|(_, keypoints)| range(keypoints).start).min().unwrap_or_default();
    let end = listed.iter().map(|(_, keypoints)| range(keypoints).end).max().unwrap_or_default();
    let mut frames = Vec::new();
    for number in first..end {
        let one = |(_, keypoints): &(String, KeypointCamera)| {
            let options = OpenposeOptions { frame: Some(number), layout: layout.as_ref(), confidence_scale };
            Ok(keypoints.read(number, &options, 0)?.map(|(frame, _)| frame).unwrap_or_default())
        };
        frames.push(listed.iter().map(one).collect::<Result<Vec<_>, Failure>>()?);
    }
    let cameras = listed.into_iter().map(|(name, _)| name).collect();
    Ok(Seen { cameras, first, names: layout.map(|layout| layout.points), rate_hz: stated_rate(path)?, frames })
}

/// Name of the camera of a folder `<camera>_json`.
fn bare(folder: &str) -> String {
    folder.strip_suffix("_json").unwrap_or(folder).to_owned()
}

/// Writes keypoints (frames, cameras, people, points, 3) as OpenPose files, a folder a camera.
#[pyfunction]
pub(crate) fn write_keypoints(
    py: Python<'_>,
    folder: PathBuf,
    cameras: Vec<String>,
    keypoints: &Bound<'_, PyAny>,
    first: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let first = frame_number("first_frame", first)?;
    let given = numbers("keypoints", keypoints)?;
    let due = [("frames", None), ("cameras", Some(cameras.len())), ("people", None), ("points", None)];
    let shape = given.exactly(&[due[0], due[1], due[2], due[3], ("u v confidence", Some(3))])?;
    let (people, points) = (shape[2], shape[3]);
    let values = given.values()?;
    detached(py, || {
        for camera in &cameras {
            let folder = place(&folder, format!("{camera}_json"))?;
            std::fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
        }
        for (index, people_there) in values.chunks((people * points * 3).max(1)).enumerate() {
            let (number, camera) = (first + (index / cameras.len()) as u64, &cameras[index % cameras.len()]);
            let person = |(index, person): (usize, &[f64])| OpenposePerson {
                index,
                keypoints: person.as_chunks::<3>().0.iter().map(|point| keypoint(*point)).collect(),
            };
            let people = people_there.chunks((points * 3).max(1)).enumerate().map(person);
            let seen: Vec<_> = people.filter(|person| person.keypoints.iter().any(Option::is_some)).collect();
            let path = place(&folder, format!("{camera}_json/{camera}.{number:06}.json"))?;
            write_whole(&path, openpose::write(&seen).as_bytes())?;
        }
        Ok(())
    })
}

fn keypoint([x, y, confidence]: [f64; 3]) -> Option<Keypoint> {
    let is_there = x.is_finite() && y.is_finite() && confidence > 0.0;
    is_there.then_some(Keypoint { x, y, confidence })
}
