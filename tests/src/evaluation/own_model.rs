//! The tracker on truths that its own model drew.
//!
//! There its posterior is the right one, whatever it is, and ranks of the truth must be uniform.
//!
//! 1. `s_0 ~ N(start, initial spread)`, `s_t ~ N(s_{t−1}, Σ)`: the tracker's own start and random walk, body H32 of the default size, [`motion_noise::default_sd`].
//! 2. Each point of the body in each of four cameras is seen with an independent Gaussian error of the stated size: the tracker's own likelihood, with neither outliers nor model error. The cameras stand where the start
//!    is, not where the drawn motion goes, since that would betray it.
//! 3. The tracker filters the frames from the same start, without the association and the restarts that surround it in a recording; ranks are taken in the last frame.
//!
//! What is left between the ranks and uniform ones is the tracker's own approximation: draws that depend on each other, and with [`Between::Gaussian`](sinew::dynamics::random_walk::Between::Gaussian) the prior of each frame.

use super::ranks;
use crate::simulated_source::source;
use sinew::Error;
use sinew::body::standard::{EVALUATION_JOINTS, STANDING_HEIGHT_M, h32};
use sinew::body::{KinematicTree, Plan, Proportions, point_positions};
use sinew::config::settings::Settings;
use sinew::core::lanes::Block;
use sinew::core::random::Stage;
use sinew::core::transition::Transition as _;
use sinew::dynamics::motion_prior::MotionPrior;
use sinew::formats::openpose::Keypoint;
use sinew::input::up_axis::Z_UP;
use sinew::methods::{BoundKeypoints, Making};
use sinew::observe::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel as _, View};
use sinew::setup::{Body, CameraSetup, Setup, motion_noise};
use sinew::track;
use sinew::tracking::hmc_filter::R_HAT_BOUND;
use sinew::tracking::posterior::Posterior;
use sinew_body::points::points_of_states;
use sinew_results::estimate::{Draws, FrameEstimate};
use sinew_simulate::detector::{DetectorNoise, detect};
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

/// Keypoints that the detector gives.
const LAYOUT: &str = "BODY_25B";

/// Share of the image's height that the person spans: small enough for wide motion.
const SPAN: f64 = 0.35;

/// Draws a motion of `frames` frames and its keypoints from the model, tracks it, and ranks the truth in its last frame.
///
/// # Errors
/// Errors of the tracker.
pub fn ranked(frames: usize, sigma_px: f64, settings: &Settings, seed: u64) -> Result<Ranked, Error> {
    let frames = frames.max(1);
    let settings = Settings { noise: Noise::OutlierFloor { outlier: 1e-12 }, seed, ..settings.clone() };
    let body = h32(&Proportions::default());
    let (mut setup, cameras) = stated_setup(&body, sigma_px)?;
    let walk = track::motion_prior(&setup, &body, &settings)?;
    let [first, steps, errors] = Stage::new(seed, "own model").split(["first", "steps", "errors"]);
    let states = drawn_states(&walk, &setup.start_pose, frames, [first, steps]);
    let film = filmed(&body, states, cameras, sigma_px, settings.fps, errors)?;
    track::tune(&mut setup, &body, &mut source(&film), 0, &settings)?;
    let dt = 1.0 / settings.fps;
    let names: Vec<String> = body.points().iter().map(|point| point.name.clone()).collect();
    let making = Making {
        setup: &setup,
        transition: &walk,
        parts: None,
        motion_model: None,
        latent: None,
        keypoints: &names,
        dt,
        isa: settings.isa,
    };
    let mut tracker = settings.method.tracker(&making, setup.start_pose.clone())?;
    let mut seen = Seen::new(&film, sigma_px, &settings);
    let mut disagreeing = 0.0;
    for frame in 0..frames {
        let bound = seen.bind(&film, frame, tracker.estimate());
        let stage = Stage::new(seed, "track").at_frame(frame as u32);
        let info = tracker.step(&bound.into(), stage)?;
        disagreeing += f64::from(u8::from(info.r_hat.is_some_and(|r| r > R_HAT_BOUND))) / frames as f64;
    }
    let (state, points) = last_ranks(&tracker.posterior(), &film, &settings);
    Ok(Ranked { state, points, disagreeing })
}

/// The set-up as the model knows it, and cameras around the standing body.
fn stated_setup(body: &KinematicTree, sigma_px: f64) -> Result<(Setup, Vec<Camera>), Error> {
    let mut start = vec![0.0; body.dof()];
    start[2] = STANDING_HEIGHT_M;
    let ring = Ring { span: SPAN, ..Ring::default() };
    let cameras = around(&points_of_states(body, std::slice::from_ref(&start)), &ring)
        .expect("a ring of cameras sees a standing body");
    let camera = |camera: &Camera| CameraSetup {
        name: camera.name.clone(),
        offset_px: [0.0; 2],
        sigma_px,
        usual_confidence: 1.0,
        exchanged: 0.0,
        elsewhere: 0.0,
    };
    let setup = Setup {
        schema: sinew::setup::SCHEMA,
        body: Body::H32,
        layout: LAYOUT.into(),
        person: 0,
        world_up: Z_UP.into(),
        world_up_sd_deg: None,
        up_axis: Z_UP.into(),
        model_error_m: 0.0,
        size_sd: 0.0,
        girth: None,
        colours: None,
        lasting: None,
        start_frame: 0,
        start_pose: start,
        step_size: None,
        leapfrog_steps: None,
        motion_sd: Some(motion_noise::default_sd(body)),
        proportions: Proportions::default(),
        camera: cameras.iter().map(camera).collect(),
    };
    Ok((setup, cameras))
}

/// States that the motion prior draws, a random walk.
fn drawn_states(walk: &MotionPrior, start: &[f64], frames: usize, [first, steps]: [Stage; 2]) -> Vec<Vec<f64>> {
    let mut state = vec![Block::ZERO; start.len()];
    walk.sample_initial_block(start, &mut state, &mut first.whole());
    let mut rng = steps.whole();
    let mut states = vec![];
    for _ in 0..frames {
        states.push(state.iter().map(|block| block.0[0]).collect::<Vec<f64>>());
        let mut next = state.clone();
        walk.sample_block(&state, &mut next, &mut rng);
        state = next;
    }
    states
}

/// A recording of the states with errors of the stated size.
fn filmed(
    body: &KinematicTree,
    states: Vec<Vec<f64>>,
    cameras: Vec<Camera>,
    sigma_px: f64,
    rate_hz: f64,
    errors: Stage,
) -> Result<SyntheticRecording, Error> {
    let layout = sinew::formats::layout::find(LAYOUT)?;
    let truth = points_of_states(body, &states);
    let seen = detect(&truth, &layout, (&cameras, &[]), &DetectorNoise::stated_gaussian(sigma_px), errors);
    Ok(SyntheticRecording {
        lags_frames: vec![],
        body: body.clone(),
        states,
        truth,
        cameras,
        offsets_px: seen.offsets_px,
        layout,
        keypoints: seen.keypoints,
        rate_hz,
    })
}

/// The tracker's own likelihood of the keypoints.
struct Seen {
    /// Points of the body with the numbers of their keypoints.
    shared: Vec<(usize, usize)>,
    model: KeypointModel,
    predicted: Vec<f64>,
}

impl Seen {
    fn new(film: &SyntheticRecording, sigma_px: f64, settings: &Settings) -> Self {
        let points = film.body.points().iter().enumerate();
        let shared: Vec<(usize, usize)> =
            points.filter_map(|(p, point)| Some((p, film.layout.index(&point.name)?))).collect();
        let plan = Arc::new(Plan::new(&film.body, &shared.iter().map(|(p, _)| *p).collect::<Vec<_>>()));
        let view = |camera: &Camera| View { camera: camera.clone(), bias_px: vec![], sigma_px, usual_confidence: 1.0 };
        let predicted = vec![0.0; 3 * plan.points()];
        let model = KeypointModel {
            plan,
            views: film.cameras.iter().map(view).collect(),
            noise: settings.noise,
            model_error_m: 0.0,
            least_confidence: settings.least_confidence,
            mistakes: Mistakes::default(),
            isa: settings.isa,
        };
        Self { shared, model, predicted }
    }

    /// The likelihood of a frame, with the estimate of the frame before.
    fn bind(&mut self, film: &SyntheticRecording, frame: usize, estimate: &[f64]) -> BoundKeypoints {
        let found = |camera: &Vec<Vec<Option<Keypoint>>>| {
            let detection =
                |&(_, k): &(usize, usize)| camera[frame][k].map(|d| Detection::new([d.x, d.y], d.confidence));
            self.shared.iter().map(detection).collect()
        };
        let detections: Vec<Vec<Option<Detection>>> = film.keypoints.iter().map(found).collect();
        point_positions(&self.model.plan, self.model.isa, estimate, &mut self.predicted);
        self.model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &self.predicted })
    }
}

/// Ranks of the last state and its points.
fn last_ranks(posterior: &Posterior<'_>, film: &SyntheticRecording, settings: &Settings) -> (Vec<u32>, Vec<[u32; 3]>) {
    let kept = posterior.equal_weight(settings.draws, &mut Stage::new(settings.seed, "thin").whole());
    let mut draws = vec![0.0; kept.len() * posterior.dim];
    for (state, &index) in draws.chunks_exact_mut(posterior.dim).zip(&kept) {
        posterior.state(index, state);
    }
    let number = film.states.len() - 1;
    let last = &film.states[number];
    let below = |j: usize| draws.iter().skip(j).step_by(posterior.dim).filter(|x| **x < last[j]).count() as u32;
    let state = (0..posterior.dim).map(below).collect();
    let estimate = FrameEstimate {
        number: number as u64,
        draws: Draws { states: draws, ..Draws::default() },
        ..FrameEstimate::default()
    };
    let points = ranks::at_points(&film.body, &[estimate], &film.truth, &EVALUATION_JOINTS);
    (state, points.into_iter().flatten().collect())
}
