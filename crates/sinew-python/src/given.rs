//! Keypoints and cameras of arrays, as a recording in memory.

use crate::arrays::Numbers;
use crate::camera::PyCamera;
use crate::failure::Failure;
use pyo3::prelude::*;
use sinew::formats::keypoint_table::Frames;
use sinew::formats::openpose::{Keypoint, OpenposeFrame, OpenposePerson};
use sinew::formats::{Layout, layout};
use sinew::input::recording::given::GivenRecording;
use sinew::observe::Camera;

/// Cameras with the keypoints that they saw.
pub(crate) struct Given<'py> {
    pub(crate) cameras: Vec<Camera>,
    pub(crate) keypoints: Numbers<'py>,
    pub(crate) points: Option<Vec<Option<String>>>,
    pub(crate) first_frame: u64,
}

impl<'py> Given<'py> {
    /// Checks shapes: (frames, cameras, people, points, 3).
    pub(crate) fn new(
        cameras: &[PyRef<'_, PyCamera>],
        keypoints: Numbers<'py>,
        points: Option<Vec<Option<String>>>,
        first_frame: u64,
    ) -> Result<Self, Failure> {
        let count = points.as_ref().map(Vec::len);
        let due = [("frames", None), ("cameras", Some(cameras.len())), ("people", None), ("points", count)];
        keypoints.exactly(&[due[0], due[1], due[2], due[3], ("u v confidence", Some(3))])?;
        if keypoints.shape().contains(&0) {
            return Err(Failure::argument("`keypoints` is empty; give frames of at least one camera"));
        }
        let cameras = cameras.iter().map(|camera| camera.0.clone()).collect();
        Ok(Self { cameras, keypoints, points, first_frame })
    }

    /// The recording; `confidence_scale` is the confidence that means certainty.
    pub(crate) fn recording(&self, confidence_scale: f64) -> Result<GivenRecording, Failure> {
        let Self { cameras, keypoints, points, first_frame } = self;
        let (views, people, width) = (keypoints.shape()[1], keypoints.shape()[2], keypoints.shape()[3]);
        let mut frames = vec![Frames::new(); views];
        let by_frame = keypoints.values()?.chunks(views * people * width * 3).enumerate();
        for (number, by_view) in by_frame {
            for (view, by_person) in by_view.chunks(people * width * 3).enumerate() {
                let place = || format!("frame {number}, camera `{}`", cameras[view].name);
                let mut frame = OpenposeFrame::default();
                for (index, by_point) in by_person.chunks(width * 3).enumerate() {
                    let (points, _) = by_point.as_chunks::<3>();
                    let keypoints = points.iter().enumerate().map(|(k, point)| {
                        keypoint(*point, confidence_scale).map_err(|what| {
                            Failure::argument(format!("`keypoints`: {}, person {index}, point {k}: {what}", place()))
                        })
                    });
                    let keypoints = keypoints.collect::<Result<Vec<_>, Failure>>()?;
                    if keypoints.iter().any(Option::is_some) {
                        frame.people.push(OpenposePerson { index, keypoints });
                    }
                }
                frames[view].insert(first_frame + number as u64, frame);
            }
        }
        let layout = points.clone().map(named);
        Ok(GivenRecording { cameras: cameras.clone(), frames, layout })
    }
}

/// The known layout with these points, or one of its own name.
fn named(points: Vec<Option<String>>) -> Layout {
    let known = layout::with_numbers(3 * points.len()).into_iter().find(|layout| layout.points == points);
    let known = known.map(|layout| layout.name);
    Layout { name: known.unwrap_or_else(|| "keypoints".into()), points }
}

/// A keypoint; none where a number is NaN or the confidence is zero.
fn keypoint([x, y, confidence]: [f64; 3], scale: f64) -> Result<Option<Keypoint>, String> {
    let confidence = confidence / scale;
    if !confidence.is_nan() && !(0.0..=1.0).contains(&confidence) {
        return Err(format!("the confidence is {confidence}; it must lie between 0 and 1 (`confidence_scale`)"));
    }
    let is_there = x.is_finite() && y.is_finite() && confidence > 0.0;
    Ok(is_there.then_some(Keypoint { x, y, confidence }))
}
