//! Recorded motion of the CMU database as motion of the standard body.
//!
//! From ASF/AMC files, as points and as states.
//!
//! 1. [`joints`]: positions of the evaluation joints in our world, `(x, y, z) → (x, −z, y)`, in metres, resampled linearly to a lower rate. The names mean
//!    the *ends* of CMU's bones: hips and shoulders are the ends of the hip joints and clavicles, elbow, wrist, knee and ankle the ends of humerus, radius, femur and tibia, the
//!    neck base that of the thorax, the head top that of the head; `MidHip` is the middle of the hips and `Spine` the root. The balls of the feet (`LBigToe`, `RBigToe`) go beyond
//!    the fifteen: without them the feet's angles mean nothing.
//! 2. [`retarget`]: sizes of H32 as robust medians over the frames, refined together with the poses; then each frame's pose by Levenberg–Marquardt from the frame before, its
//!    angles continued without jumps. No smoothing. What the body cannot reach is reported as [`Retargeted::mean_error_m`].
//!
//! The recorded joints are the truth of an experiment with model error, the points of the fitted body that of one without.
//!
//! The database: "The data used in this project was obtained from mocap.cs.cmu.edu. The database was created with funding from NSF EIA-0196217."

use crate::points::{Trajectories, points_of_states};
use sinew_body::bundle;
use sinew_body::fit::{self, Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::standard::{EVALUATION_JOINTS, h32};
use sinew_body::subject::{self, Measured};
use sinew_body::{Joint, KinematicTree, Plan, Proportions};
use sinew_formats::amc::Amc;
use sinew_formats::asf::Asf;
use std::f64::consts::TAU;

/// Frames per second of the database's recordings.
pub const RATE_HZ: f64 = 120.0;

/// Our name and the bones whose ends it is the middle of.
const JOINTS: [(&str, &[&str]); 18] = [
    ("MidHip", &["lhipjoint", "rhipjoint"]),
    ("Neck", &["thorax"]),
    ("LShoulder", &["lclavicle"]),
    ("RShoulder", &["rclavicle"]),
    ("LElbow", &["lhumerus"]),
    ("RElbow", &["rhumerus"]),
    ("LWrist", &["lradius"]),
    ("RWrist", &["rradius"]),
    ("LHip", &["lhipjoint"]),
    ("RHip", &["rhipjoint"]),
    ("LKnee", &["lfemur"]),
    ("RKnee", &["rfemur"]),
    ("LAnkle", &["ltibia"]),
    ("RAnkle", &["rtibia"]),
    ("Head", &["head"]),
    ("LBigToe", &["lfoot"]),
    ("RBigToe", &["rfoot"]),
    ("Spine", &["root"]),
];

/// Positions of the joints that the skeleton has, at the given rate.
#[must_use]
pub fn joints(skeleton: &Asf, motion: &Amc, rate_hz: f64) -> Trajectories {
    let bones = skeleton.point_names();
    let sources: Vec<(&str, Vec<usize>)> = JOINTS
        .iter()
        .filter_map(|(name, ends)| {
            let ends = ends.iter().map(|end| bones.iter().position(|bone| bone == end));
            Some((*name, ends.collect::<Option<Vec<_>>>()?))
        })
        .collect();
    let recorded: Vec<Vec<[f64; 3]>> = motion
        .frames
        .iter()
        .map(|frame| {
            let ends = skeleton.bone_ends_m(&frame.values);
            let middle = |from: &[usize]| {
                let sum = |i: usize| from.iter().map(|&end| ends[end][i]).sum::<f64>() / from.len() as f64;
                [sum(0), -sum(2), sum(1)]
            };
            sources.iter().map(|(_, from)| middle(from)).collect()
        })
        .collect();
    let names = sources.iter().map(|(name, _)| (*name).to_owned()).collect();
    Trajectories { names, frames: resampled(&recorded, RATE_HZ / rate_hz) }
}

/// Every `step`-th frame (a fraction of a frame is interpolated), starting with the first.
pub(super) fn resampled(frames: &[Vec<[f64; 3]>], step: f64) -> Vec<Vec<[f64; 3]>> {
    let mut out = Vec::new();
    if !(step > 0.0 && step.is_finite()) {
        return out;
    }
    loop {
        let place = out.len() as f64 * step;
        let index = place as usize;
        let part = place - index as f64;
        let Some(here) = frames.get(index) else { return out };
        let next = match frames.get(index + 1) {
            Some(next) => next,
            None if part == 0.0 => here,
            None => return out,
        };
        let between = |(a, b): (&[f64; 3], &[f64; 3])| std::array::from_fn(|i| a[i] + part * (b[i] - a[i]));
        out.push(here.iter().zip(next).map(between).collect());
    }
}

/// A motion of the standard body that follows recorded points.
#[derive(Clone, Debug, PartialEq)]
pub struct Retargeted {
    /// The body in the subject's size.
    pub body: KinematicTree,
    /// Its sizes.
    pub proportions: Proportions,
    /// States, one per frame.
    pub states: Vec<Vec<f64>>,
    /// Positions of all points of the body.
    pub points: Trajectories,
    /// Mean distance of the evaluation joints to their recorded positions, metres.
    pub mean_error_m: f64,
}

/// Fits the standard body H32 to recorded points; `None` where the first frame's trunk does not determine a pose.
#[must_use]
pub fn retarget(recorded: &Trajectories) -> Option<Retargeted> {
    retarget_to(h32, recorded)
}

/// Fits a body that is built from a subject's sizes, as [`retarget`] does.
#[must_use]
pub fn retarget_to(build: fn(&Proportions) -> KinematicTree, recorded: &Trajectories) -> Option<Retargeted> {
    let names: Vec<&str> = recorded.names.iter().map(String::as_str).collect();
    let frames: Vec<Vec<Option<[f64; 3]>>> =
        recorded.frames.iter().map(|frame| frame.iter().map(|&point| Some(point)).collect()).collect();
    let Measured { proportions, .. } = subject::from_distances(&names, &frames);
    let start = build(&proportions);
    let columns: Vec<Option<usize>> = start.points().iter().map(|point| recorded.index(&point.name)).collect();
    let targets: Vec<Vec<Option<Target>>> = recorded
        .frames
        .iter()
        .map(|frame| columns.iter().map(|k| k.map(|k| Target { position: frame[k], weight: 1.0 })).collect())
        .collect();
    let config = bundle::Config::default();
    let sample: Vec<_> = targets.iter().step_by(targets.len().div_ceil(SIZING_FRAMES).max(1)).cloned().collect();
    let proportions = bundle::refine(build, &proportions, &sample, &config).proportions;
    let body = build(&proportions);
    let plan = Plan::with_all_points(&body);
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(targets.len());
    for targets in &targets {
        let previous = match states.last() {
            Some(last) => last.clone(),
            None => initial_pose(&body, targets)?,
        };
        let pose = fit_pose(&plan, targets, &previous, &fit::Config::default()).pose;
        states.push(if states.is_empty() { pose } else { continued(&body, &pose, &previous) });
    }
    let points = points_of_states(&body, &states);
    let mean_error_m = mean_distance(&points.select(&EVALUATION_JOINTS), &recorded.select(&EVALUATION_JOINTS));
    Some(Retargeted { body, proportions, states, points, mean_error_m })
}

/// Frames that the sizes come from; more add nothing but time.
const SIZING_FRAMES: usize = 60;

/// The pose with every rotation moved by whole turns to the one nearest to the previous pose.
fn continued(body: &KinematicTree, pose: &[f64], previous: &[f64]) -> Vec<f64> {
    let turned = |((q, before), (_, joint)): ((&f64, &f64), (usize, Joint))| match joint {
        Joint::Rotate(_) => q - TAU * ((q - before) / TAU).round(),
        Joint::Translate(_) => *q,
    };
    pose.iter().zip(previous).zip(body.joints()).map(turned).collect()
}

/// Mean distance of points of the same name, metres; NaN without any.
#[must_use]
pub fn mean_distance(a: &Trajectories, b: &Trajectories) -> f64 {
    let pairs: Vec<(usize, usize)> =
        a.names.iter().enumerate().filter_map(|(i, name)| Some((i, b.index(name)?))).collect();
    let mut sum = 0.0;
    let mut count = 0_u32;
    for (a, b) in a.frames.iter().zip(&b.frames) {
        for &(i, j) in &pairs {
            sum += (0..3).map(|k| (a[i][k] - b[j][k]).powi(2)).sum::<f64>().sqrt();
            count += 1;
        }
    }
    sum / f64::from(count)
}

#[cfg(test)]
#[path = "../../../tests/src/data.rs"]
mod shared_data;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::pixel;
    use crate::recording::{Script, SyntheticRecording};
    use sinew_formats::{amc, asf};
    use sinew_observe::Camera;

    /// Skeleton and motion of a trial of the shared recordings, if they are there.
    fn trial(name: &str) -> Option<(Asf, Amc)> {
        let folder = shared_data::shared("cmu_amc")?;
        let subject = name.split('_').next().unwrap();
        let text = |file: String| std::fs::read_to_string(folder.join(file)).unwrap();
        let skeleton = asf::read("a.asf", &text(format!("{subject}.asf"))).unwrap();
        let motion = amc::read("a.amc", &text(format!("{name}.amc")), &skeleton).unwrap();
        Some((skeleton, motion))
    }

    #[test]
    fn recorded_joints_stand_upright_in_our_world() {
        let Some((skeleton, motion)) = trial("07_01") else { return };
        let points = joints(&skeleton, &motion, 30.0);
        assert_eq!(points.frames.len(), 79);
        assert_eq!(&points.names[..15], EVALUATION_JOINTS);
        let head = points.index("Head").unwrap();
        let first = points.frames[0][head];
        for (found, expected) in first.into_iter().zip([0.505618, 1.836491, 1.511681]) {
            assert!((found - expected).abs() < 1e-5, "{first:?}");
        }
        let [low, high] = points.bounds().unwrap();
        assert!(low[2] > -0.06 && high[2] < 1.8);
    }

    #[test]
    fn the_standard_body_follows_walking_running_and_dancing() {
        // The aim for such conversions is 30 mm.
        for (name, frames) in [("07_01", 79), ("09_06", 36), ("131_04", 272)] {
            let Some((skeleton, motion)) = trial(name) else { return };
            let recorded = joints(&skeleton, &motion, 30.0);
            let fitted = retarget(&recorded).unwrap();
            assert_eq!(fitted.states.len(), frames, "{name}");
            let millimetres = 1000.0 * fitted.mean_error_m;
            println!("{name}: {millimetres:.1} mm");
            assert!(millimetres < 30.0, "{name}: {millimetres} mm");
            let film = |truth: &Trajectories| {
                let (body, states) = (fitted.body.clone(), fitted.states.clone());
                SyntheticRecording::from_motion(body, states, truth.clone(), &Script::default(), 1).unwrap()
            };
            for recording in [film(&recorded), film(&fitted.points)] {
                let inside = |camera: &Camera, point| {
                    let [u, v] = pixel(camera, point).unwrap();
                    (0.0..1280.0).contains(&u) && (0.0..960.0).contains(&v)
                };
                let mut points = recording.truth.frames.iter().flatten();
                assert!(points.all(|&point| recording.cameras.iter().all(|camera| inside(camera, point))), "{name}");
            }
            for (before, after) in fitted.states.iter().zip(&fitted.states[1..]) {
                let jump = before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(jump < 1.5, "{name}: {jump} rad");
            }
        }
    }

    #[test]
    fn resampling_interpolates() {
        let frames: Vec<_> = (0..9).map(|i| vec![[f64::from(i), 0.0, 0.0]]).collect();
        let times = |step| resampled(&frames, step).iter().map(|frame| frame[0][0]).collect::<Vec<_>>();
        assert_eq!(times(4.0), [0.0, 4.0, 8.0]);
        assert_eq!(times(2.5), [0.0, 2.5, 5.0, 7.5]);
        assert!(times(0.0).is_empty());
        assert!(times(f64::NAN).is_empty());
    }
}
