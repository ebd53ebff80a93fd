//! From the people in the views of a frame to the posterior of the pose: what `sinew track` and `sinew demo` run for every frame.
//!
//! For each frame, in order of their numbers:
//!
//! 1. the tracked person is found in each view, near to where the last pose projects ([`sinew_observe::association`]);
//! 2. his keypoints become the points of the body, and are bound to a likelihood at the predicted pose ([`sinew_observe::keypoint_likelihood`]);
//! 3. the tracker steps ([`sinew_tracking::run`]);
//! 4. its draws become marginals of points and angles.
//!
//! Frames without the person continue on the motion prior and are flagged. Someone who was lost for some frames and is found again elsewhere restarts the tracker at the pose that fits there.
//! Nothing is kept but the tracker and a few numbers a frame, so memory does not grow.

mod images;
mod marginals;
mod method;
pub mod motion;
mod observed;
mod oddities;
mod predictive;
mod restart;
mod scene;
mod smooth;
mod source;
mod trackers;
mod unknown_size;

pub use images::{Coverage, FrameImages, ImageState, Images};
pub use method::{METHODS, Method, Score};
pub use observed::{BoundImages, Observed};
pub use predictive::Doubt;
pub use scene::{Scene, SceneState};
pub use smooth::{Spool, TRAJECTORIES, smooth};
pub(crate) use source::upright;
pub use source::{FrameSource, Upright};

use crate::Error;
use crate::checkpoint::{self, Problem};
use crate::estimate::{Carried, Draws, FrameEstimate, HmcStatistics, ParticleStatistics, Quality};
use crate::setup::{self, Setup};
use marginals::Marginals;
use restart::Restarting;
use serde::{Deserialize, Serialize};
use sinew_body::KinematicTree;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_formats::Layout;
use sinew_observe::association::{self, Following, follow};
use sinew_observe::image_score::ImageScore;
use sinew_observe::{Camera, KeypointLikelihood, Noise};
use sinew_samplers::annealed_search;
use sinew_samplers::tuning;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Harness, Resume as _, StepInfo, hmc_filter, run};
use std::ops::{ControlFlow, Range};
use std::sync::PoisonError;
use trackers::hmc_config;
pub(crate) use trackers::tracker;
use unknown_size::UnknownSize;

/// How to track; the default is the preset for real recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The tracker.
    pub method: Method,
    /// Seed of all random streams.
    pub seed: u64,
    /// Frames per second.
    pub fps: f64,
    /// Instruction set.
    pub isa: Isa,
    /// Density of a keypoint.
    pub noise: Noise,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Prior between frames.
    pub between: Between,
    /// Factor on the motion noise that the set-up pass found.
    pub motion_scale: f64,
    /// Chains of `hmc`.
    pub chains: usize,
    /// Updates of each chain in a frame.
    pub updates: usize,
    /// First samples of each chain that are discarded.
    pub burn_in: usize,
    /// Jitter of the step size.
    pub jitter: f64,
    /// Particles; those of `coarse-to-fine` at its coarse level.
    pub particles: usize,
    /// Layers of `annealed`.
    pub layers: annealed_search::Config,
    /// Particles of the fine level of `coarse-to-fine`.
    pub fine: usize,
    /// Weighting function of images.
    pub score: ImageScore,
    /// Longest side of the raster in which silhouettes are compared, pixels.
    pub raster: usize,
    /// Thinned draws kept of each frame.
    pub draws: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Hmc,
            seed: 1,
            fps: 30.0,
            isa: Isa::best(),
            noise: Noise::OutlierFloor { outlier: 0.02 },
            least_confidence: 0.1,
            between: Between::Gaussian,
            motion_scale: 1.0,
            chains: 16,
            updates: 32,
            burn_in: 8,
            jitter: 0.2,
            particles: Method::default().usual_particles(),
            layers: annealed_search::Config { layers: 5, crossover: 0.5, ..annealed_search::Config::default() },
            fine: 500,
            score: Method::default().usual_score().with_kappa(100.0),
            raster: 320,
            draws: 64,
        }
    }
}

/// A tracker with all that surrounds it for one recording.
pub struct Pipeline {
    settings: Settings,
    tracker: Restarting,
    scene: Scene,
    images: Option<Images>,
    marginals: Marginals,
    transition: RandomWalk,
}

/// What a pipeline remembers from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    tracker: Vec<f64>,
    scene: SceneState,
    images: Option<ImageState>,
}

impl Pipeline {
    /// A pipeline that starts at the set-up's pose.
    ///
    /// # Errors
    /// A set-up that does not fit the cameras, the layout or the body.
    pub fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        layout: &Layout,
        settings: Settings,
    ) -> Result<Self, Error> {
        Self::with_images(setup, tree, cameras, layout, settings, None)
    }

    /// The same with silhouettes in cameras that are sized like the masks.
    ///
    /// # Errors
    /// As [`Pipeline::new`]; a body without flesh.
    pub fn with_images(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        layout: &Layout,
        settings: Settings,
        image_cameras: Option<&[Camera]>,
    ) -> Result<Self, Error> {
        let scene = Scene::new(setup, tree, cameras, layout, &settings)?;
        let with_flesh = |sized: &[Camera]| {
            let ratio = |(sized, camera): (&Camera, &Camera)| sized.image_size_px[0] / camera.image_size_px[0];
            let scale = sized.iter().zip(cameras).next().map_or(1.0, ratio);
            Images::new(tree, setup.flesh()?, &setup.with_offsets(sized, scale), &settings)
        };
        let images = image_cameras.map(with_flesh).transpose()?;
        let transition = walk(setup, tree, &settings)?;
        let (for_new, walk, known) = (settings.clone(), transition.clone(), setup.clone());
        let parts = if settings.method.takes_parts() { Some(images::part_tree(tree, &setup.flesh()?)?) } else { None };
        let make = Box::new(move |start| tracker(&known, &for_new, &walk, parts.as_ref(), start));
        let tracker = Restarting::new(make, scene.start().to_vec())?;
        let marginals = Marginals::new(tree, settings.isa, UnknownSize::of(setup, cameras, settings.seed));
        Ok(Self { settings, tracker, scene, images, marginals, transition })
    }

    /// Statistics that each frame brings.
    #[must_use]
    pub fn carried(&self) -> Carried {
        let hmc = self.settings.method == Method::Hmc;
        let size = self.marginals.size().is_some();
        let particles = match self.settings.method {
            Method::Hmc => None,
            Method::CoarseToFine => Some(1),
            _ => Some(self.settings.particles),
        };
        Carried { lp: hmc, hmc, log_evidence: !self.settings.method.is_search(), particles, size }
    }

    /// Names of the keypoints that are points of the body.
    #[must_use]
    pub fn keypoints(&self) -> Vec<String> {
        self.scene.keypoints()
    }

    /// What was odd in the frames tracked so far.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let search = self.settings.method.is_search().then(|| {
            format!(
                "`{}` is a search: its intervals and draws are what survived it, not a posterior",
                self.settings.method.name()
            )
        });
        let of_images = self.images.iter().flat_map(Images::warnings);
        self.scene.warnings().into_iter().chain(search).chain(of_images).collect()
    }

    /// How well the tracked body covers the silhouettes, camera by camera; empty without silhouettes.
    #[must_use]
    pub fn coverage(&self) -> &[Coverage] {
        self.images.as_ref().map_or(&[], Images::coverage)
    }

    /// What the next frame needs of those before it.
    #[must_use]
    pub fn save(&self) -> State {
        State { tracker: self.tracker.save(), scene: self.scene.save(), images: self.images.as_ref().map(Images::save) }
    }

    /// Goes on where a pipeline of the same set-up and settings stood, to the same bits.
    ///
    /// # Errors
    /// A state of another pipeline.
    pub fn restore(&mut self, saved: &State) -> Result<(), Problem> {
        self.scene.restore(&saved.scene)?;
        if let (Some(images), Some(saved)) = (&mut self.images, &saved.images) {
            images.restore(saved)?;
        }
        self.tracker.restore(&saved.tracker).map_err(|error| match error {
            sinew_tracking::Error::Dimension { found, expected, .. } => {
                checkpoint::state("tracker", format!("{found} numbers"), expected)
            }
            other => checkpoint::state("tracker", other, "its numbers"),
        })
    }

    /// What does not look as the model says in the frames tracked so far; [`Pipeline::warnings`] has it in words.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        self.scene.doubts()
    }

    /// Tracks the frames of `numbers`, in order, and gives each estimate with the moments of its posterior to `record`, which may stop the run. Call it again to go on.
    ///
    /// # Errors
    /// Those of the source and of `record`; frames without a posterior.
    pub fn track(
        &mut self,
        source: &mut dyn FrameSource,
        numbers: impl IntoIterator<Item = u64>,
        mut record: impl FnMut(FrameEstimate, &Posterior<'_>) -> Result<ControlFlow<()>, Error>,
    ) -> Result<(), Error> {
        let mut refused = None;
        let numbers = numbers.into_iter().map_while(|number| frame_index(number).map_err(|e| refused = Some(e)).ok());
        let Self { settings, tracker, scene, images, marginals, .. } = self;
        let (seed, pending) = (settings.seed, tracker.pending());
        let mut around = Around { settings, scene, images, marginals, pending, source, record: &mut record };
        run(tracker, numbers, |frame| Stage::new(seed, "track").at_frame(frame), &mut around)?;
        refused.map_or(Ok(()), Err)
    }
}

/// Who takes the estimates of a run.
type Record<'a> = dyn FnMut(FrameEstimate, &Posterior<'_>) -> Result<ControlFlow<()>, Error> + 'a;

/// All of a pipeline but its tracker, during a run.
struct Around<'a> {
    settings: &'a Settings,
    scene: &'a mut Scene,
    images: &'a mut Option<Images>,
    marginals: &'a mut Marginals,
    pending: restart::Pending,
    source: &'a mut dyn FrameSource,
    record: &'a mut Record<'a>,
}

impl Harness<Observed> for Around<'_> {
    type Bound = Observed;
    type Error = Error;

    fn observe(&mut self, frame: u32, estimate: &[f64]) -> Result<Observed, Error> {
        let people = self.source.people(u64::from(frame))?;
        let (keypoints, restart) = self.scene.observe(&people, estimate);
        if restart.is_some() {
            *self.pending.lock().unwrap_or_else(PoisonError::into_inner) = restart;
        }
        let images = match self.images {
            Some(images) => Some(images.bind(&self.source.images(u64::from(frame))?)),
            None => None,
        };
        Ok(Observed { keypoints, parts: self.scene.parts(), images })
    }

    fn record(&mut self, frame: u32, info: StepInfo, posterior: Posterior<'_>) -> Result<ControlFlow<()>, Error> {
        let number = u64::from(frame);
        self.scene.note(number, &info.mean, &some_draws(self.settings.seed, frame, &posterior));
        if let Some(images) = self.images {
            images.note(number, &info.mean);
        }
        let seen_by = self.images.as_ref().map_or(0, Images::cameras_with_person);
        let estimate = describe(self.settings, self.scene, seen_by, self.marginals, number, info, &posterior);
        (self.record)(estimate, &posterior)
    }
}

/// Draws of a frame that its keypoints are held against.
const CHECKED_DRAWS: usize = 4;

fn some_draws(seed: u64, frame: u32, posterior: &Posterior<'_>) -> Vec<Vec<f64>> {
    let mut rng = Stage::new(seed, "predictive check").at_frame(frame).whole();
    let state = |&index: &usize| {
        let mut state = vec![0.0; posterior.dim];
        posterior.state(index, &mut state);
        state
    };
    posterior.equal_weight(CHECKED_DRAWS, &mut rng).iter().map(state).collect()
}

fn frame_index(number: u64) -> Result<u32, Error> {
    u32::try_from(number).map_err(|_| Error::Input {
        message: format!("frame number {number} is above {}", u32::MAX),
        help: Some("renumber the files".into()),
    })
}

/// The motion prior of a recording.
pub(crate) fn walk(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Result<RandomWalk, Error> {
    let sd = match &setup.motion_sd {
        Some(sd) if sd.len() == tree.dof() => sd.clone(),
        _ => motion::default_sd(tree),
    };
    let sd: Vec<f64> = sd.iter().map(|sd| sd * settings.motion_scale).collect();
    let walk = RandomWalk::new(&sd, 1.0 / settings.fps, settings.between, settings.isa);
    walk.and_then(|walk| walk.with_initial_sd(motion::initial_sd(tree))).map_err(numerical)
}

fn numerical(error: impl std::fmt::Display) -> Error {
    Error::Numerical { message: error.to_string() }
}

/// Trajectory lengths to choose from. In units of the dense metric a trajectory should take a quarter to half of a period, 2π; longer ones come back to where they began.
const LENGTHS: [usize; 2] = [6, 7];

/// Frames from which the motion noise is measured: so many runs of so many consecutive frames, evenly spaced.
const MOTION_RUNS: u64 = 5;
const MOTION_FRAMES: u64 = 30;

/// Motion noise of a recording, from poses fitted to some of its frames one by one ([`motion::measured_sd`]).
///
/// # Errors
/// Those of the source.
pub fn measure_motion(
    setup: &Setup,
    tree: &KinematicTree,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    fps: f64,
) -> Result<Vec<f64>, Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let total = numbers.end - numbers.start;
    let stride = (total / MOTION_RUNS).max(MOTION_FRAMES);
    let mut poses = vec![];
    for first in numbers.clone().step_by(stride as usize) {
        let mut following = Following { person: setup.person, ..Following::default() };
        poses.push(None);
        for number in first..(first + MOTION_FRAMES).min(numbers.end) {
            let people = source.people(number)?;
            let found = follow(&mut following, &cameras, &people, None, &association::Config::default());
            let former: Option<&[f64]> = poses.last().and_then(Option::as_deref);
            let pose = setup::pose_of(setup, &cameras, &layout, &found.people, former);
            poses.push(pose.filter(|pose| pose.len() == tree.dof()));
        }
    }
    Ok(motion::measured_sd(tree, &poses, fps))
}

/// Step size and trajectory length for a recording, from its first frames: the last value of the set-up pass.
///
/// # Errors
/// Those of the source; no step size found.
pub fn tune(
    setup: &mut Setup,
    tree: &KinematicTree,
    source: &mut dyn FrameSource,
    number: u64,
    settings: &Settings,
) -> Result<(), Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let mut scene = Scene::new(setup, tree, &cameras, &layout, settings)?;
    let transition =
        walk(setup, tree, settings)?.with_initial_sd(steady_sd(setup, tree, settings)).map_err(numerical)?;
    let start = scene.start().to_vec();
    let (observed, found) = scene.observe(&source.people(number)?, &start);
    let start = found.unwrap_or(start);
    let filter =
        hmc_filter::HmcFilter::new(hmc_config(setup, settings), transition, start, settings.isa).map_err(numerical)?;
    let config = tuning::Config { jitter: settings.jitter, lengths: LENGTHS.to_vec(), ..tuning::Config::default() };
    let tuned = filter.tune(&observed, &config, Stage::new(settings.seed, "set-up")).map_err(numerical)?;
    setup.step_size = Some(tuned.step_size);
    setup.leapfrog_steps = u32::try_from(tuned.leapfrog_steps).ok();
    Ok(())
}

/// Spread of the prior in the middle of a recording, where step sizes are tuned: that of one step of motion.
fn steady_sd(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Vec<f64> {
    walk(setup, tree, settings).map_or_else(|_| motion::initial_sd(tree), |walk| walk.sd().to_vec())
}

/// Turns a step into what is written of it.
fn describe(
    settings: &Settings,
    scene: &Scene,
    silhouettes: usize,
    marginals: &mut Marginals,
    number: u64,
    info: StepInfo,
    posterior: &Posterior<'_>,
) -> FrameEstimate {
    let stage = Stage::new(settings.seed, "thin").at_frame(number as u32);
    let kept = posterior.equal_weight(settings.draws, &mut stage.whole());
    let mut states = vec![0.0; kept.len() * posterior.dim];
    for (state, &index) in states.chunks_exact_mut(posterior.dim).zip(&kept) {
        posterior.state(index, state);
    }
    let stats = |index: &usize| posterior.chain_stats.get(*index);
    let chosen: Vec<_> = kept.iter().filter_map(stats).collect();
    let hmc = (!chosen.is_empty()).then(|| HmcStatistics {
        acceptance_rate: chosen.iter().map(|s| s.acceptance).collect(),
        step_size: chosen.iter().map(|s| s.step_factor * scene.step_size()).collect(),
        n_steps: vec![scene.leapfrog_steps(); chosen.len()],
        diverging: chosen.iter().map(|s| s.divergent).collect(),
        energy: chosen.iter().map(|s| s.energy).collect(),
    });
    let particles = posterior.chain_stats.is_empty().then(|| ParticleStatistics {
        log_weight: posterior.weights.iter().map(|w| w.ln()).collect(),
        resampled: info.resampled.unwrap_or(false),
    });
    let (points, state) = marginals.of(posterior);
    let size = marginals.size_draws(kept.iter().copied(), &mut states, posterior.dim);
    let cameras = scene.cameras_with_person().max(silhouettes);
    FrameEstimate {
        number,
        restarted: info.restarted,
        time_s: number as f64 / settings.fps,
        observed: cameras > 0,
        quality: match cameras {
            0 => Quality::Predicted,
            1 => Quality::OneCamera,
            _ => Quality::Good,
        },
        residual_px: scene.residual_px(&info.mean),
        seen: scene.seen(),
        mean_state: info.mean,
        points,
        state,
        draws: Draws { states, size, lp: chosen.iter().map(|s| s.log_density).collect(), hmc },
        particles,
        ess: info.ess,
        log_evidence: info.log_evidence,
        r_hat: info.r_hat,
        energy_fraction: info.energy_fraction,
        acceptance: info.acceptance,
        divergences: info.divergences as u64,
        trajectories: info.trajectories as u64,
    }
}

/// Moments that a smoother takes from a frame. They are not shrunk: correlations between the angles of a limb are what keeps its end in place.
#[must_use]
pub fn moments(posterior: &Posterior<'_>, isa: Isa) -> Moments {
    posterior.moments(isa)
}

/// What a keypoint likelihood is made of in a frame.
pub type Bound = sinew_core::density::Lanes<KeypointLikelihood>;
