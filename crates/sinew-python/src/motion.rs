//! Motion files: points, coordinates or a skeleton over time.

use crate::arrays::{array, numbers};
use crate::background::detached;
use crate::failure::Failure;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use sinew::formats::bvh::{Bvh, BvhJoint, Channel};
use sinew::formats::mot::Mot;
use sinew::formats::point_table::PointTable;
use sinew_motion::convert::{self, Content, Format, Motion};
use sinew_results::write_whole;
use std::path::{Path, PathBuf};

/// A motion: points (TRC, C3D, CSV), coordinates (MOT, CSV) or a skeleton (BVH, ASF/AMC) over time.
///
/// Times are seconds, places metres in a world with z up, angles degrees as in the files.
#[pyclass(frozen, name = "Motion", module = "sinew")]
pub(crate) struct PyMotion(Motion);

fn count_of(rate_hz: f64) -> Result<f64, Failure> {
    let is_rate = rate_hz > 0.0 && rate_hz.is_finite();
    if is_rate { Ok(rate_hz) } else { Err(Failure::argument(format!("`rate_hz` is {rate_hz}; it must be positive"))) }
}

#[pymethods]
impl PyMotion {
    /// A motion of points.
    ///
    /// Parameters
    /// ----------
    /// names
    ///     Names of the points.
    /// points
    ///     (frames, points, 3), metres, z up; NaN is a point that is missing.
    /// rate_hz
    ///     Frames per second.
    /// start_frame
    ///     Number of the first frame.
    #[staticmethod]
    #[pyo3(signature = (names, points, rate_hz, *, start_frame = 0))]
    fn from_points(names: Vec<String>, points: &Bound<'_, PyAny>, rate_hz: f64, start_frame: i64) -> PyResult<Self> {
        let (points, rate_hz) = (numbers("points", points)?, count_of(rate_hz)?);
        let shape = points.exactly(&[("frames", None), ("points", Some(names.len())), ("3", Some(3))])?;
        let place = |point: &[f64; 3]| point.iter().all(|x| x.is_finite()).then_some(*point);
        let width = 3 * names.len().max(1);
        let row = |row: &[f64]| row.as_chunks::<3>().0.iter().map(place).collect();
        let frames: Vec<Vec<Option<[f64; 3]>>> = points.values()?.chunks_exact(width).map(row).collect();
        let time_s = (0..shape[0]).map(|frame| (start_frame as f64 + frame as f64) / rate_hz).collect();
        let content = Content::Points(PointTable { names, time_s, frames });
        Ok(Self(Motion { format: Format::Trc, rate_hz, start_frame, content, warnings: vec![] }))
    }

    /// A motion of coordinates.
    ///
    /// Parameters
    /// ----------
    /// names
    ///     Names of the coordinates, OpenSim's for instance.
    /// values
    ///     (frames, coordinates), degrees and metres.
    /// rate_hz
    ///     Frames per second.
    #[staticmethod]
    fn from_coordinates(names: Vec<String>, values: &Bound<'_, PyAny>, rate_hz: f64) -> PyResult<Self> {
        let (values, rate_hz) = (numbers("values", values)?, count_of(rate_hz)?);
        let shape = values.exactly(&[("frames", None), ("coordinates", Some(names.len()))])?;
        let time_s = (0..shape[0]).map(|frame| frame as f64 / rate_hz).collect();
        let rows = values.values()?.chunks_exact(names.len().max(1)).map(<[f64]>::to_vec).collect();
        let title = "Coordinates".into();
        let content =
            Content::Coordinates(Mot { title, in_degrees: true, columns: names, time_s, rows, warnings: vec![] });
        Ok(Self(Motion { format: Format::Mot, rate_hz, start_frame: 0, content, warnings: vec![] }))
    }

    /// `points`, `coordinates` or `skeleton`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0.content {
            Content::Points(_) => "points",
            Content::Coordinates(_) => "coordinates",
            Content::Skeleton(_) => "skeleton",
        }
    }

    /// Format of the file: TRC, C3D, CSV, MOT, BVH or AMC.
    #[getter]
    fn format(&self) -> &'static str {
        self.0.format.name()
    }

    /// Frames per second; 0 where there are fewer than two frames.
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.0.rate_hz
    }

    /// Number of the first frame of the original recording.
    #[getter]
    fn start_frame(&self) -> i64 {
        self.0.start_frame
    }

    /// What was odd about the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// Names of the points, or of the coordinates.
    #[getter]
    fn names(&self) -> Vec<String> {
        match &self.0.content {
            Content::Coordinates(coordinates) => coordinates.columns.clone(),
            _ => self.0.points().map(|points| points.names).unwrap_or_default(),
        }
    }

    /// Time of each frame, (frames,), seconds.
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let time_s = match &self.0.content {
            Content::Coordinates(coordinates) => coordinates.time_s.clone(),
            _ => self.0.points().map(|points| points.time_s).unwrap_or_default(),
        };
        array(py, [time_s.len()], time_s)
    }

    /// Points (frames, points, 3) in metres, of a skeleton its joints and tips, NaN where missing; or coordinates (frames, coordinates), degrees and metres.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        if let Content::Coordinates(Mot { rows, columns, .. }) = &self.0.content {
            return array(py, [rows.len(), columns.len()], rows.concat());
        }
        let points = self.0.points().unwrap_or_default();
        let places = points.frames.iter().flatten().flat_map(|point| point.unwrap_or([f64::NAN; 3])).collect();
        array(py, [points.frames.len(), points.names.len(), 3], places)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, PickledMotion)> {
        let Motion { format, rate_hz, start_frame, content, warnings } = &self.0;
        let restored = py.import("sinew._sinew")?.getattr("restored_motion")?;
        let pickled = Pickled::from(content.clone());
        Ok((restored, (format.name().to_lowercase(), *rate_hz, *start_frame, pickled, warnings.clone())))
    }

    fn __repr__(&self) -> String {
        let (frames, rate) = (self.0.frames(), self.0.rate_hz);
        format!("Motion({} of {}: {frames} frames at {rate} per second)", self.kind(), self.format())
    }
}

/// Extension of the format, frames per second, number of the first frame, content, what was odd.
type PickledMotion = (String, f64, i64, Pickled, Vec<String>);
/// Name, parent, offset, channels (whether a rotation, axis), tip.
type PickledJoint = (String, Option<usize>, [f64; 3], Vec<(bool, usize)>, Option<[f64; 3]>);

/// The content of a motion as plain values of Python.
#[derive(FromPyObject, IntoPyObject)]
pub(crate) enum Pickled {
    /// Names, times, frames.
    Points(Vec<String>, Vec<f64>, Vec<Vec<Option<[f64; 3]>>>),
    /// Title, whether in degrees, columns, times, rows.
    Coordinates(String, bool, Vec<String>, Vec<f64>, Vec<Vec<f64>>),
    /// Joints, duration of a frame, frames.
    Skeleton(Vec<PickledJoint>, f64, Vec<Vec<f64>>),
}

impl From<Content> for Pickled {
    fn from(content: Content) -> Self {
        let pair = |channel: &Channel| match *channel {
            Channel::Position(axis) => (false, axis),
            Channel::Rotation(axis) => (true, axis),
        };
        let joint = |BvhJoint { name, parent, offset, channels, end_site }| {
            let channels: Vec<Channel> = channels;
            (name, parent, offset, channels.iter().map(pair).collect(), end_site)
        };
        match content {
            Content::Points(PointTable { names, time_s, frames }) => Self::Points(names, time_s, frames),
            Content::Coordinates(Mot { title, in_degrees, columns, time_s, rows, .. }) => {
                Self::Coordinates(title, in_degrees, columns, time_s, rows)
            }
            Content::Skeleton(Bvh { joints, frame_time_s, frames, .. }) => {
                Self::Skeleton(joints.into_iter().map(joint).collect(), frame_time_s, frames)
            }
        }
    }
}

impl From<Pickled> for Content {
    fn from(pickled: Pickled) -> Self {
        let channel = |(rotates, axis)| if rotates { Channel::Rotation(axis) } else { Channel::Position(axis) };
        let joint = |(name, parent, offset, channels, end_site): PickledJoint| {
            let channels = channels.into_iter().map(channel).collect();
            BvhJoint { name, parent, offset, channels, end_site }
        };
        let warnings = vec![];
        match pickled {
            Pickled::Points(names, time_s, frames) => Self::Points(PointTable { names, time_s, frames }),
            Pickled::Coordinates(title, in_degrees, columns, time_s, rows) => {
                Self::Coordinates(Mot { title, in_degrees, columns, time_s, rows, warnings })
            }
            Pickled::Skeleton(joints, frame_time_s, frames) => {
                let joints = joints.into_iter().map(joint).collect();
                Self::Skeleton(Bvh { joints, frame_time_s, frames, warnings })
            }
        }
    }
}

/// A motion that was pickled.
#[pyfunction]
pub(crate) fn restored_motion(
    extension: &str,
    rate_hz: f64,
    start_frame: i64,
    content: Pickled,
    warnings: Vec<String>,
) -> PyResult<PyMotion> {
    let format = Format::of(Path::new(&format!("motion.{extension}"))).map_err(sinew_motion::Error::from);
    let format = format.map_err(Failure::from)?;
    Ok(PyMotion(Motion { format, rate_hz, start_frame, content: content.into(), warnings }))
}

/// Reads a motion file, for AMC files with their skeleton.
#[pyfunction]
pub(crate) fn read_motion(
    py: Python<'_>,
    path: PathBuf,
    skeleton: Option<PathBuf>,
    fps: Option<f64>,
) -> PyResult<PyMotion> {
    detached(py, || Ok(PyMotion(convert::read(&path, skeleton.as_deref(), fps)?)))
}

/// Writes a motion file in the format of its extension.
#[pyfunction]
pub(crate) fn write_motion(py: Python<'_>, path: PathBuf, motion: PyRef<'_, PyMotion>) -> PyResult<()> {
    let motion = &motion.0;
    detached(py, || {
        let format = Format::of(&path).map_err(sinew_motion::Error::from)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let bytes = convert::write(motion, format, &name).map_err(sinew_motion::Error::from)?;
        Ok(write_whole(&path, &bytes)?)
    })
}
