//! The tracker on truths that its own model drew.
//!
//! There its posterior is the right one, whatever it is, and ranks of the truth must be uniform.
//!
//! 1. `s_0 ~ N(start, initial spread)`, `s_t ~ N(s_{t−1}, Σ)`: the tracker's own start and random walk, body H32 of the default size, [`motion_noise::default_sd`].
//! 2. Each point of the body in each of four cameras is seen with an independent Gaussian error of the stated size: the tracker's own likelihood, with neither outliers nor model error. The cameras stand where the start
//!    is, not where the drawn motion goes, since that would tell of it.
//! 3. The tracker filters the frames from the same start, without the association and the restarts that surround it in a recording; ranks are those of the last frame.
//!
//! What is left between the ranks and uniform ones is the tracker's own approximation: draws that depend on each other, and with [`Between::Gaussian`](sinew::dynamics::random_walk::Between::Gaussian) the prior of each frame.

use super::ranks;
use crate::simulated_source::source;
use sinew::Error;
use sinew::body::standard::{EVALUATION_JOINTS, STANDING_HEIGHT_M, h32};
use sinew::body::{Plan, Proportions, point_positions};
use sinew::config::settings::Settings;
use sinew::core::lanes::Block;
use sinew::core::random::Stage;
use sinew::core::transition::Transition as _;
use sinew::input::up_axis::Z_UP;
use sinew::methods::Making;
use sinew::observe::{Detection, KeypointFrame, KeypointModel, Noise, ObservationModel as _, View};
use sinew::results::estimate::{Draws, FrameEstimate};
use sinew::setup::{Body, CameraSetup, Setup, motion_noise};
use sinew::track;
use sinew::tracking::hmc_filter::R_HAT_BOUND;
use sinew_simulate::detector::{DetectorNoise, detect};
use sinew_simulate::points::of_states;
use sinew_simulate::recording::SyntheticRecording;
use sinew_simulate::ring::{Ring, around};
use std::sync::Arc;

/// Ranks of a truth in the last frame, among [`Settings::draws`] draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranked {
    /// Of each degree of freedom.
    pub state: Vec<u32>,
    /// Of the coordinates of the evaluation joints.
    pub points: Vec<[u32; 3]>,
    /// Share of the frames whose chains disagree: split R̂ above [`R_HAT_BOUND`].
    pub disagreeing: f64,
}

/// Share of the image's height that the person spans: small enough for wide motion.
const SPAN: f64 = 0.35;

/// Draws a motion of so many frames and its keypoints from the model, tracks it, and ranks the truth in its last frame.
///
/// # Errors
/// Those of the tracker.
pub fn ranked(frames: usize, sigma_px: f64, settings: &Settings, seed: u64) -> Result<Ranked, Error> {
    let frames = frames.max(1);
    let settings = Settings { noise: Noise::OutlierFloor { outlier: 1e-12 }, seed, ..settings.clone() };
    let body = h32(&Proportions::default());
    let mut start = vec![0.0; body.dof()];
    start[2] = STANDING_HEIGHT_M;
    let ring = Ring { span: SPAN, ..Ring::default() };
    let failed = |error: sinew::observe::Error| Error::Numerical { message: error.to_string() };
    let cameras = around(&of_states(&body, std::slice::from_ref(&start)), &ring).map_err(failed)?;
    let layout = sinew::formats::layout::find("BODY_25B")?;
    let camera = |camera: &sinew::observe::Camera| CameraSetup {
        name: camera.name.clone(),
        offset_px: [0.0; 2],
        sigma_px,
        usual_confidence: 1.0,
    };
    let mut setup = Setup {
        schema: sinew::setup::SCHEMA,
        body: Body::H32,
        layout: layout.name.clone(),
        person: 0,
        world_up: Z_UP.into(),
        up_axis: Z_UP.into(),
        model_error_m: 0.0,
        size_sd: 0.0,
        start_frame: 0,
        start_pose: start.clone(),
        step_size: None,
        leapfrog_steps: None,
        motion_sd: Some(motion_noise::default_sd(&body)),
        proportions: Proportions::default(),
        camera: cameras.iter().map(camera).collect(),
    };
    let walk = track::walk(&setup, &body, &settings)?;
    let [first, steps, errors] = Stage::new(seed, "own model").split(["first", "steps", "errors"]);
    let mut state = vec![Block::ZERO; body.dof()];
    walk.sample_initial_block(&start, &mut state, &mut first.whole());
    let mut rng = steps.whole();
    let mut states = vec![];
    for _ in 0..frames {
        states.push(state.iter().map(|block| block.0[0]).collect::<Vec<f64>>());
        let mut next = state.clone();
        walk.sample_block(&state, &mut next, &mut rng);
        state = next;
    }
    let truth = of_states(&body, &states);
    let seen = detect(&truth, &layout, &cameras, &DetectorNoise::stated_gaussian(sigma_px), errors);
    let film = SyntheticRecording {
        body: body.clone(),
        states,
        truth,
        cameras: cameras.clone(),
        offsets_px: seen.offsets_px,
        layout: layout.clone(),
        keypoints: seen.keypoints,
        rate_hz: settings.fps,
    };
    track::tune(&mut setup, &body, &mut source(&film), 0, &settings)?;
    let shared: Vec<(usize, usize)> =
        body.points().iter().enumerate().filter_map(|(p, point)| Some((p, layout.index(&point.name)?))).collect();
    let plan = Arc::new(Plan::new(&body, &shared.iter().map(|(p, _)| *p).collect::<Vec<_>>()));
    let view = |camera: &sinew::observe::Camera| View {
        camera: camera.clone(),
        offset_px: [0.0; 2],
        sigma_px,
        usual_confidence: 1.0,
    };
    let model = KeypointModel {
        plan: Arc::clone(&plan),
        views: cameras.iter().map(view).collect(),
        noise: settings.noise,
        model_error_m: 0.0,
        least_confidence: settings.least_confidence,
        isa: settings.isa,
    };
    let making = Making { setup: &setup, transition: &walk, parts: None, isa: settings.isa };
    let mut tracker = settings.method.tracker(&making, start)?;
    let mut predicted = vec![0.0; 3 * plan.points()];
    let mut disagreeing = 0.0;
    for frame in 0..frames {
        let found = |camera: &Vec<Vec<Option<sinew::formats::openpose::Keypoint>>>| {
            let detection = |&(_, k): &(usize, usize)| {
                camera[frame][k].map(|d| Detection { pixel: [d.x, d.y], confidence: d.confidence })
            };
            shared.iter().map(detection).collect()
        };
        let detections: Vec<Vec<Option<Detection>>> = film.keypoints.iter().map(found).collect();
        point_positions(&plan, settings.isa, tracker.estimate(), &mut predicted);
        let bound = model.bind(KeypointFrame { detections: &detections, predicted: &predicted });
        let stage = Stage::new(seed, "track").at_frame(frame as u32);
        let info =
            tracker.step(&bound.into(), stage).map_err(|error| Error::Numerical { message: error.to_string() })?;
        disagreeing += f64::from(u8::from(info.r_hat.is_some_and(|r| r > R_HAT_BOUND))) / frames as f64;
    }
    let posterior = tracker.posterior();
    let kept = posterior.equal_weight(settings.draws, &mut Stage::new(seed, "thin").whole());
    let mut draws = vec![0.0; kept.len() * posterior.dim];
    for (state, &index) in draws.chunks_exact_mut(posterior.dim).zip(&kept) {
        posterior.state(index, state);
    }
    let last = &film.states[frames - 1];
    let below = |j: usize| draws.iter().skip(j).step_by(posterior.dim).filter(|x| **x < last[j]).count() as u32;
    let estimate = FrameEstimate {
        number: frames as u64 - 1,
        draws: Draws { states: draws.clone(), ..Draws::default() },
        ..FrameEstimate::default()
    };
    let points = ranks::of_points(&body, &[estimate], &film.truth, &EVALUATION_JOINTS);
    let (state, points) = ((0..posterior.dim).map(below).collect(), points.into_iter().flatten().collect());
    Ok(Ranked { state, points, disagreeing })
}
