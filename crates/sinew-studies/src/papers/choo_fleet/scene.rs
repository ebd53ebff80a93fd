//! The frames of the study: people of the CMU database as CF28 before the paper's camera.
//!
//! Motion: 07_01 (walking) frames 60, 160, 260 and 131_04 (dancing) frames 200, 500, 900, counted from 1 at 120 frames a second; one step of the filter is four
//! recorded frames. The true state is CF28 in the subject's size, fitted to the recorded joints. The markers that are observed are the recorded joints themselves
//! ([`Source::Recorded`]), so that the body never fits exactly, or the markers of the fitted body ([`Source::Fitted`]), as a control. The recording has no marker on the
//! face: one is put before the head, at right angles to the line of the shoulders.
//!
//! The camera stands 4.8 m before the subject, at the height of the spine origin in the first frame of the motion that is used, and looks along +Y.

use crate::support::outcome::Outcome;
use sinew::body::{KinematicTree, Plan, standard};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::files::fnv;
use sinew_body::points::Trajectories;
use sinew_markers::{MarkerModel, MarkerView};
use sinew_motion::cmu;
use sinew_motion::retarget;
use sinew_tests::recorded_motion::recorded;
use std::path::Path;
use std::sync::Arc;

/// Standard deviation of an image coordinate, in focal lengths.
pub(super) const SIGMA: f64 = 0.003;
/// Distance of the camera, metres.
const DISTANCE_M: f64 = 4.8;
/// Recorded frames a step.
const STEP: usize = 4;

/// Where the observed markers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The recorded joints.
    Recorded,
    /// The points of the fitted body.
    Fitted,
}

impl Source {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::Fitted => "fitted",
        }
    }
}

/// A motion of one subject.
pub(super) struct Motion {
    pub(super) tree: KinematicTree,
    /// True states at 120 frames a second.
    states: Vec<Vec<f64>>,
    /// Markers in the order of the tree's points.
    recorded: Vec<Vec<[f64; 3]>>,
    fitted: Vec<Vec<[f64; 3]>>,
    /// Mean distance of the fitted body from the recorded joints, metres.
    pub(super) mean_error_m: f64,
}

/// One frame: what is seen, and what is true in it and one step before.
pub(super) struct Frame {
    pub(super) truth: Vec<f64>,
    pub(super) previous: Vec<f64>,
    /// Markers in space, in the order of the tree's points.
    pub(super) markers: Vec<[f64; 3]>,
}

/// A point before the head where CF28 has its second head marker.
fn with_face(points: &mut Trajectories) -> Outcome<()> {
    let index = |name: &str| points.index(name).ok_or(format!("the recording has no {name}"));
    let [neck, head, left, right] = [index("Neck")?, index("Head")?, index("LShoulder")?, index("RShoulder")?];
    points.names.push("Nose".into());
    for frame in &mut points.frames {
        let between = |a: usize, b: usize| [0, 1, 2].map(|k: usize| frame[b][k] - frame[a][k]);
        let (up, x) = (between(neck, head), between(left, right));
        let forward = [up[1] * x[2] - up[2] * x[1], up[2] * x[0] - up[0] * x[2], up[0] * x[1] - up[1] * x[0]];
        let norm = forward.iter().map(|f| f * f).sum::<f64>().sqrt();
        frame.push([0, 1, 2].map(|k: usize| frame[neck][k] + 0.48 * up[k] + 0.10 * forward[k] / norm));
    }
    Ok(())
}

/// Reads a motion and fits CF28 to it.
pub(super) fn motion(data: &Path, name: &str) -> Outcome<Motion> {
    let folder = data.join("cmu_amc");
    let subject = name.split('_').next().unwrap_or(name);
    let [motion, skeleton] = [format!("{name}.amc"), format!("{subject}.asf")].map(|file| folder.join(file));
    let mut points = recorded(&motion, &skeleton, cmu::RATE_HZ)?;
    with_face(&mut points)?;
    let fitted = retarget::retarget_to(standard::cf28, &points).ok_or("no pose in the first frame")?;
    let names: Vec<&str> = fitted.body.points().iter().map(|point| point.name.as_str()).collect();
    Ok(Motion {
        recorded: points.select(&names).frames,
        fitted: fitted.points.select(&names).frames,
        states: fitted.states,
        tree: fitted.body,
        mean_error_m: fitted.mean_error_m,
    })
}

impl Motion {
    /// Continues a hash over true states and markers.
    pub(super) fn hash(&self, hash: u64) -> u64 {
        let markers = self.recorded.iter().chain(&self.fitted).flatten().flatten();
        self.states.iter().flatten().chain(markers).fold(hash, |hash, x| fnv(hash, &x.to_le_bytes()))
    }

    /// A frame by its number from 1.
    pub(super) fn frame(&self, number: usize, source: Source) -> Outcome<Frame> {
        let (now, before) = (number - 1, number - 1 - STEP);
        let markers = match source {
            Source::Recorded => &self.recorded,
            Source::Fitted => &self.fitted,
        };
        let truth = self.states.get(now).ok_or(format!("the motion has no frame {number}"))?.clone();
        Ok(Frame { truth, previous: self.states[before].clone(), markers: markers[now].clone() })
    }

    /// The paper's camera before the subject in a frame.
    pub(super) fn camera(&self, number: usize, isa: Isa) -> MarkerModel {
        let [x, y, z] = [0, 1, 2].map(|k| self.states[number - 1][k]);
        let plan = Arc::new(Plan::with_all_points(&self.tree));
        MarkerModel { plan, centre: [x, y - DISTANCE_M, z], sigma: SIGMA, isa }
    }

    /// Cameras around the subject in a frame, at the paper's distance and these azimuths; the paper's stands at 0.
    pub(super) fn views(&self, number: usize, azimuths: &[f64]) -> Vec<MarkerView> {
        let subject = [0, 1, 2].map(|k| self.states[number - 1][k]);
        azimuths.iter().map(|&azimuth| MarkerView::around(subject, DISTANCE_M, azimuth)).collect()
    }
}

/// Standard normal errors of the image coordinates of markers, two each.
fn errors(markers: usize, stage: Stage) -> Vec<f64> {
    let mut noise = vec![sinew::core::lanes::Block::ZERO; (2 * markers).div_ceil(8)];
    stage.whole().fill_normal(Isa::baseline(), &mut noise);
    noise.iter().flat_map(|block| block.0).collect()
}

/// Markers as the camera sees them, with errors from a stage.
pub(super) fn seen(camera: &MarkerModel, markers: &[[f64; 3]], stage: Stage) -> Vec<Option<[f64; 2]>> {
    let noise = errors(markers.len(), stage);
    let project = |(k, marker): (usize, &[f64; 3])| {
        let [x, y, z] = [0, 1, 2].map(|a: usize| marker[a] - camera.centre[a]);
        Some([x / y + SIGMA * noise[2 * k], z / y + SIGMA * noise[2 * k + 1]])
    };
    markers.iter().enumerate().map(project).collect()
}

/// Markers as a view sees them, with errors of that standard deviation from a stage.
pub(super) fn seen_from(view: &MarkerView, markers: &[[f64; 3]], sigma: f64, stage: Stage) -> Vec<Option<[f64; 2]>> {
    let noise = errors(markers.len(), stage);
    let project = |(k, marker): (usize, &[f64; 3])| {
        let [u, v] = view.project(*marker)?;
        Some([u + sigma * noise[2 * k], v + sigma * noise[2 * k + 1]])
    };
    markers.iter().enumerate().map(project).collect()
}
