//! One cell: a contender over all frames with one seed.
//!
//! All contenders of a motion are judged on the same frames, from [`Motion::first`](super::contender::Motion::first) on. The paper's tracker has D true poses before them as the history that its action primitives need.

use super::contender::{Contender, Method, USUAL_MODEL};
use super::figures;
use super::motions::RATE_HZ;
use crate::papers::masked_scene::{Scene, Seen};
use crate::papers::worth::{mean_poses, rounded, stored};
use crate::support::outcome::Outcome;
use crate::support::processor_time::thread_seconds;
use serde_json::{Value, json};
use sinew::body::hppf24;
use sinew::core::random::Stage;
use sinew::core::transition::MotionModel;
use sinew::dynamics::joint_ranges::JointRanges;
use sinew::dynamics::level_walk::{LevelPrimitives, LevelWalk};
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew::dynamics::primitives::motion::PrimitiveMotion;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::observe::Camera;
use sinew::observe::silhouettes::image_likelihood::ImageLikelihood;
use sinew::samplers::annealed_search;
use sinew::samplers::levels::Selection;
use sinew::samplers::resample::Truncation;
use sinew::tracking::{Tracker, annealed, bootstrap, hppf, partitioned};
use sinew_body::points::{Trajectories, points_of_states};

/// First coordinate that is an angle.
const FIRST_ANGLE: usize = 3;

/// The motion of the parts: by a model or at random with its steps, after a history of poses.
pub(super) fn level_walk(
    seen: &Seen,
    model: &PrimitiveModel,
    method: Method,
    steps: f64,
    history: &[Vec<f64>],
) -> Outcome<LevelWalk> {
    let mut scaled = model.clone();
    scaled.noise_sd.iter_mut().for_each(|sd| *sd *= steps);
    let sd = scaled.noise_sd.clone();
    let walk = LevelWalk::new(seen.parts.clone(), sd.clone(), sd, seen.model.isa)?
        .with_angles_from(FIRST_ANGLE)
        .with_ranges(JointRanges::new(hppf24::ranges().to_vec())?)?;
    let (length, which) = match method {
        Method::Primitives { length, which, .. } => (length, which),
        Method::Systematic(_) => (USUAL_MODEL.0, LevelPrimitives::Nested),
        _ => return Ok(walk),
    };
    let mut walk = walk.with_primitives(&scaled, 1.0 / RATE_HZ, which)?;
    follow_history(&mut walk, history, length);
    Ok(walk)
}

/// Shows a motion the last `length` poses of a history.
fn follow_history(motion: &mut impl MotionModel, history: &[Vec<f64>], length: usize) {
    for (k, pose) in history.iter().enumerate().skip(history.len().saturating_sub(length)) {
        motion.follow(k.checked_sub(1).map(|before| &history[before][..]), pose);
    }
}

type Running = Box<dyn Tracker<ImageLikelihood>>;

fn tracker(
    method: Method,
    model: &PrimitiveModel,
    seen: &Seen,
    history: &[Vec<f64>],
    start: Vec<f64>,
) -> Outcome<Option<Running>> {
    let (sd, isa) = (&model.noise_sd, seen.model.isa);
    let random = || RandomWalk::new(sd, 1.0, Between::Mixture, isa);
    let walked = |config| -> Outcome<Running> {
        Ok(Box::new(hppf::Hppf::new(
            config,
            level_walk(seen, model, method, 1.0, history)?,
            &seen.parts,
            start.clone(),
        )?))
    };
    Ok(Some(match method {
        Method::Primitives { particles, .. } | Method::Walk(particles) => {
            walked(hppf::Config { particles, ..hppf::Config::default() })?
        }
        Method::Systematic(share) => {
            let selection =
                Selection { truncation: Truncation::TruncateThenSystematic, surviving: 0.01 * f64::from(share) };
            walked(hppf::Config { selection, ..hppf::Config::default() })?
        }
        Method::WholeBody(particles) => {
            let mut motion = PrimitiveMotion::new(model, "body", 1.0 / RATE_HZ, isa)?;
            follow_history(&mut motion, history, model.length);
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            Box::new(bootstrap::Bootstrap::new(config, motion, start)?)
        }
        Method::Bootstrap(particles) => {
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            Box::new(bootstrap::Bootstrap::new(config, random()?, start)?)
        }
        Method::Annealed(particles) => {
            let config = annealed::Config { particles, layers: annealed_search::Config::default() };
            Box::new(annealed::Annealed::new(config, random()?, sd.clone(), start, isa)?)
        }
        Method::Partitioned(particles) => {
            let config = partitioned::Config { particles, ..partitioned::Config::default() };
            Box::new(partitioned::Partitioned::new(config, random()?, seen.parts.clone(), start)?)
        }
        Method::Truth | Method::MeanPose | Method::Frozen => return Ok(None),
    }))
}

/// Mean distance of the joints in a camera's image, pixels, frame by frame: as they are, and from the pelvis.
fn pixel_errors(camera: &Camera, found: &Trajectories, truth: &Trajectories) -> [Vec<f64>; 2] {
    let columns: Vec<(usize, usize)> =
        found.names.iter().enumerate().filter_map(|(i, name)| Some((i, truth.index(name)?))).collect();
    let pelvis = columns.iter().position(|&(i, _)| found.names[i] == "MidHip").unwrap_or_default();
    let mut errors = [vec![], vec![]];
    for (a, b) in found.frames.iter().zip(&truth.frames) {
        let offset = |&(i, j): &(usize, usize)| {
            let [p, q] = [camera.project_ideal(a[i])?, camera.project_ideal(b[j])?];
            Some([p[0] - q[0], p[1] - q[1]])
        };
        let offsets: Vec<[f64; 2]> = columns.iter().filter_map(offset).collect();
        let middle = offsets.get(pelvis).copied().unwrap_or_default();
        let mean = |from: [f64; 2]| {
            offsets.iter().map(|o| (o[0] - from[0]).hypot(o[1] - from[1])).sum::<f64>() / offsets.len() as f64
        };
        errors[0].push(mean([0.0; 2]));
        errors[1].push(mean(middle));
    }
    errors
}

/// Runs a contender.
pub(super) fn cell(
    scene: &Scene,
    seen: &Seen,
    contender: &Contender,
    (model, mean_pose): (&PrimitiveModel, &[f64]),
    seed: u64,
) -> Outcome<Value> {
    let first = contender.motion.first();
    let (history, judged) = scene.truth.split_at(first);
    let start = &history[first - 1];
    let mut running = tracker(contender.method, model, seen, history, start.clone())?;
    let (mut estimates, mut actions, mut seconds) = (Vec::with_capacity(judged.len()), vec![], 0.0);
    let means = mean_poses(scene, mean_pose);
    let purpose = format!("hppf {}", contender.method.name());
    for (frame, truth) in judged.iter().enumerate().map(|(k, truth)| (first + k, truth)) {
        let before = thread_seconds();
        estimates.push(match (&mut running, contender.method) {
            (Some(running), _) => {
                let info = running.step(&seen.bind(frame), Stage::new(seed, &purpose).at_frame(frame as u32))?;
                if figures::is_drawn(contender, seed) {
                    actions.push(figures::stored(&info.choices));
                }
                info.mean
            }
            (None, Method::Truth) => truth.clone(),
            (None, Method::MeanPose) => means[frame].clone(),
            (None, _) => start.clone(),
        });
        seconds += thread_seconds() - before;
    }
    let truth = Trajectories { names: scene.motion.names.clone(), frames: scene.motion.frames[first..].to_vec() };
    let points = points_of_states(&scene.tree, &estimates);
    let pixels: Vec<Value> = seen
        .model
        .cameras
        .iter()
        .take(2)
        .map(|camera| {
            let [absolute, relative] = pixel_errors(camera, &points, &truth);
            json!({ "absolute": rounded(&absolute, 3), "relative": rounded(&relative, 3) })
        })
        .collect();
    let mut cell = stored(scene, &estimates, &means, seconds, 3);
    cell["pixels"] = pixels.into();
    if !actions.is_empty() {
        cell["actions"] = actions.into();
    }
    Ok(cell)
}
