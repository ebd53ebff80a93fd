//! From what a frame shows to the posterior of the pose.
//!
//! This is what `sinew track` and `sinew demo` run for every frame.
//!
//! For each frame, in order of their numbers:
//!
//! 1. the tracked person is found in each view, near to where the last pose projects ([`sinew_observe::association`]);
//! 2. the keypoints become the points of the body, and are bound to a likelihood at the predicted pose ([`sinew_observe::keypoints::keypoint_likelihood`]), images likewise;
//! 3. the tracker steps ([`sinew_tracking::run`]);
//! 4. while the next step runs, the draws of this one are moved by draws of what is constant over the run (cameras, lengths, biases, lags), and summarised as marginals of points and angles.
//!
//! Frames without the person continue on the motion prior and are flagged. Someone who was lost for some frames and is found elsewhere restarts the tracker at the pose that fits there.
//! Memory does not grow with the number of frames: kept are the tracker, the frame at hand, the moments of the last few frames (from which rates of angles come), and sums over the frames for the checks.

use super::describe::Describer;
use super::error::TrackError;
use super::identity::{seed_of, setup_hash, shown};
use super::images::{ImageState, Images};
use super::lasting::Lasting;
use super::marginals::Marginals;
use super::motion_prior::{motion_prior, turned_near};
use super::noted::Noted;
use super::restart::{Observation, Restarting};
use super::scene::{Scene, SceneState};
use crate::Error;
use crate::config::settings::Settings;
use crate::input::source::FrameSource;
use crate::methods::{FrameLikelihood, Gives, Making};
use crate::setup::Setup;
use crate::setup::unknown_size::UnknownSize;
use serde::{Deserialize, Serialize};
use sinew_angles::fixed_lag::FixedLag;
use sinew_angles::{AngleMarginals, AngleZero, JointAngles};
use sinew_body::{KinematicTree, Plan};
use sinew_core::random::Stage;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::silhouettes::solid_body::part_tree;
use sinew_results::estimate::{Carried, FrameEstimate};
use sinew_results::problem::{self, Problem};
use sinew_setup::predictive::Doubt;
use sinew_setup::silhouette_overlap::SilhouetteOverlap;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Harness, Resume as _, StepInfo, run};
use std::ops::ControlFlow;
use std::sync::Arc;

/// A tracker with all that surrounds it for one recording.
pub struct Pipeline {
    tracker: Restarting,
    scene: Scene,
    images: Option<Images>,
    /// Its settings have the seed of the streams, which is derived from that of the run.
    describer: Describer,
    seed: u64,
    identity: Option<u64>,
    pub(super) transition: MotionPrior,
    /// What the method says of how it was made.
    remarks: Vec<String>,
    /// Parts whose actions the method gives.
    acting_parts: Vec<String>,
}

/// What a pipeline remembers from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The state of the tracker. In a run with draws of what is constant, the state of that part follows, and as the last number its length.
    tracker: Vec<f64>,
    scene: SceneState,
    images: Option<ImageState>,
    /// Angles of the mean pose, to which the next ones are nearest.
    angles: Vec<f64>,
    /// Moments of the last frames, from which angles change.
    past: Vec<f64>,
    /// What is tracked.
    identity: Option<u64>,
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
        let seed = settings.seed;
        let settings = Settings { seed: seed_of(seed, setup_hash(setup)), ..settings };
        let scene = Scene::new(setup, tree, cameras, layout, &settings)?;
        let with_flesh = |sized: &[Camera]| {
            let ratio = |(sized, camera): (&Camera, &Camera)| sized.image_size_px[0] / camera.image_size_px[0];
            let scale = sized.iter().zip(cameras).next().map_or(1.0, ratio);
            let colours = setup.colours.as_ref().filter(|_| settings.compares_colours());
            Images::new(tree, setup.flesh()?, colours, &setup.as_they_are(sized, scale), &settings)
        };
        let images = image_cameras.map(with_flesh).transpose()?;
        let transition = motion_prior(setup, tree, &settings)?;
        let parts = match settings.method.about().needs_parts {
            true => Some(part_tree(tree, &setup.flesh()?).map_err(TrackError::Parts)?),
            false => None,
        };
        let (method, isa, dt) = (settings.method.clone(), settings.isa, 1.0 / settings.fps);
        let (prior, known, body) = (transition.clone(), setup.clone(), tree.clone());
        let (model, latent_model) = (settings.motion_model.clone(), settings.latent_model.clone());
        let (motion_model, latent) = (model.as_deref(), latent_model.as_deref());
        let names: Vec<String> = scene.keypoints();
        let keypoints = names.as_slice();
        let making =
            Making { setup, transition: &transition, parts: parts.as_ref(), motion_model, latent, keypoints, dt, isa };
        let mut remarks = method.remarks(&making);
        if let Some(standing) = &settings.standing {
            remarks.extend(standing.remarks(setup, tree)?);
        }
        let acting_parts = match method.gives_actions(&making) {
            true => setup.flesh()?.solids().iter().map(|solid| solid.name.clone()).collect(),
            false => vec![],
        };
        let shown = names.clone();
        let make = move |start| {
            let (parts, motion_model, latent) = (parts.as_ref(), model.as_deref(), latent_model.as_deref());
            let (setup, transition, keypoints) = (&known, &prior, shown.as_slice());
            let start = turned_near(motion_model, latent, &body, start);
            method.tracker(&Making { setup, transition, parts, motion_model, latent, keypoints, dt, isa }, start)
        };
        let tracker = Restarting::new(Box::new(make), scene.start().to_vec())?;
        let lasting = Lasting::new(setup, tree, cameras, &scene, &transition, dt);
        let detected = lasting.is_some().then(|| scene.model().plan.clone());
        let size = UnknownSize::of(setup, cameras, settings.seed);
        let marginals = Marginals::new(tree, detected, settings.isa, size);
        let trajectories = (setup.step_size.unwrap_or(f64::NAN), setup.leapfrog_steps.unwrap_or(0));
        let angles = JointAngles::new(tree, &names, images.is_some(), settings.angles);
        let lag = FixedLag::new(transition.sd(), settings.fps, settings.isa);
        let zero = settings.standing.as_ref().map(|standing| standing.zero(&angles, setup.lasting.as_ref()));
        let angles = AngleMarginals::new(angles, zero);
        let describer = Describer { settings, trajectories, lasting, marginals, angles, lag };
        Ok(Self { tracker, scene, images, describer, seed, identity: None, transition, remarks, acting_parts })
    }

    /// Statistics that each frame brings.
    #[must_use]
    pub fn carried(&self) -> Carried {
        let method = &self.settings().method;
        let (chains, is_search) = (method.about().gives == Gives::Chains, method.about().gives == Gives::Search);
        let (particles, size) = (method.weighted_draws(), self.size().is_some());
        Carried {
            lp: chains,
            hmc: chains,
            log_evidence: !is_search,
            particles,
            size,
            detected: self.lasting().is_some(),
        }
    }

    pub(super) const fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) const fn lasting(&self) -> Option<&Lasting> {
        self.describer.lasting.as_ref()
    }

    /// Draws of what is constant; 0 where the set-up has none.
    #[must_use]
    pub fn lasting_draws(&self) -> usize {
        self.lasting().map_or(0, Lasting::draws)
    }

    /// The keypoints where the detectors see them, if that is known apart from the points of the body.
    pub(super) fn detected_plan(&self) -> Option<Arc<Plan>> {
        self.lasting().map(|_| self.scene().model().plan.clone())
    }

    /// The angles of joints that each frame brings.
    #[must_use]
    pub const fn angles(&self) -> &JointAngles {
        self.describer.angles.angles()
    }

    /// What a standing trial takes off them.
    #[must_use]
    pub const fn zero(&self) -> Option<&AngleZero> {
        self.describer.angles.zero()
    }

    pub(super) fn size(&self) -> Option<&UnknownSize> {
        self.describer.marginals.size()
    }

    pub(super) const fn settings(&self) -> &Settings {
        &self.describer.settings
    }

    /// Parts of the body whose actions each frame brings.
    #[must_use]
    pub fn acting_parts(&self) -> &[String] {
        &self.acting_parts
    }

    /// Names of the keypoints that are points of the body.
    #[must_use]
    pub fn keypoints(&self) -> Vec<String> {
        self.scene.keypoints()
    }

    /// What was odd in the frames tracked so far.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let Self { scene, images, remarks, .. } = self;
        let method = self.settings().method.about();
        let search = (method.gives == Gives::Search).then(|| {
            format!("`{}` is a search: its intervals and draws are what survived it, not a posterior", method.name)
        });
        let image_warnings = images.iter().flat_map(Images::warnings);
        scene.warnings().into_iter().chain(search).chain(remarks.iter().cloned()).chain(image_warnings).collect()
    }

    /// How well the tracked body covers the silhouettes, camera by camera; empty without silhouettes.
    #[must_use]
    pub fn coverage(&self) -> &[SilhouetteOverlap] {
        self.images.as_ref().map_or(&[], Images::coverage)
    }

    /// What the next frame needs of those before it.
    #[must_use]
    pub fn save(&self) -> State {
        let Self { scene, images, .. } = self;
        let mut tracker = self.tracker.save();
        if let Some(lasting) = self.lasting() {
            let own = lasting.save();
            tracker.extend(&own);
            tracker.push(own.len() as f64);
        }
        let Describer { angles, lag, .. } = &self.describer;
        let (angles, past) = (angles.before().to_vec(), lag.save());
        let (images, identity) = (images.as_ref().map(Images::save), self.identity);
        State { tracker, scene: scene.save(), images, angles, past, identity }
    }

    /// Resumes where a pipeline of the same set-up and settings stood, to the same bits.
    ///
    /// # Errors
    /// A state of another pipeline.
    pub fn restore(&mut self, saved: &State) -> Result<(), Problem> {
        if let Some(identity) = saved.identity {
            self.identify(identity);
        }
        self.scene.restore(&saved.scene)?;
        if let (Some(images), Some(saved)) = (&mut self.images, &saved.images) {
            images.restore(saved)?;
        }
        let lasting_draws = self.lasting_draws();
        let Describer { angles, lag, .. } = &mut self.describer;
        if !angles.continue_behind(&saved.angles) {
            return Err(problem::state("angles", saved.angles.len(), angles.angles().raw_count()));
        }
        if !lag.restore(&saved.past, lasting_draws) {
            return Err(problem::state("moments of the last frames", saved.past.len(), "their numbers"));
        }
        let mut numbers = saved.tracker.as_slice();
        if let Some(lasting) = &mut self.describer.lasting {
            let wrong = |found: String| problem::state("what is constant", found, "its numbers");
            let (count, rest) = numbers.split_last().ok_or_else(|| wrong("nothing".into()))?;
            let kept = rest.len().checked_sub(*count as usize).ok_or_else(|| wrong(format!("{count} numbers")))?;
            let (tracker, own) = rest.split_at(kept);
            lasting.restore(own).map_err(|error| wrong(error.to_string()))?;
            numbers = tracker;
        }
        self.tracker.restore(numbers).map_err(|error| match error {
            sinew_tracking::Error::Dimension { found, expected, .. } => {
                problem::state("tracker", format!("{found} numbers"), expected)
            }
            other => problem::state("tracker", other, "its numbers"),
        })
    }

    /// What does not look as the model says in the frames tracked so far; [`Pipeline::warnings`] has it in words.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        self.scene.doubts()
    }

    /// Tracks the frames of `numbers`, in order, and gives each estimate with its posterior to `keep`, which may stop the run. Call it again to continue.
    ///
    /// # Errors
    /// Errors of the source and of `keep`; frames without a posterior.
    pub fn track(
        &mut self,
        source: &mut dyn FrameSource,
        numbers: impl IntoIterator<Item = u64>,
        mut keep: impl KeepFrames,
    ) -> Result<(), Error> {
        let mut refused = None;
        let numbers = numbers.into_iter().map_while(|number| frame_index(number).map_err(|e| refused = Some(e)).ok());
        let (mut numbers, mut is_first) = (numbers.peekable(), true);
        while let (None, Some(&number)) = (self.identity, numbers.peek()) {
            if !std::mem::take(&mut is_first) && keep.flow().is_break() {
                return Ok(());
            }
            match shown(&source.frame(u64::from(number))?) {
                Some(identity) => self.identify(identity),
                None => self.pass(source, numbers.next(), &mut keep)?,
            }
        }
        self.pass(source, numbers, &mut keep)?;
        refused.map_or(Ok(()), Err)
    }

    /// Frames whose streams have one seed.
    fn pass(
        &mut self,
        source: &mut dyn FrameSource,
        numbers: impl IntoIterator<Item = u32>,
        keep: &mut dyn KeepFrames,
    ) -> Result<(), Error> {
        let Self { tracker, scene, images, describer, .. } = self;
        let seed = describer.settings.seed;
        keep.seed(seed);
        let mut passage = Passage { scene, images, describer, source, keep };
        run(tracker, numbers, |frame| Stage::new(seed, "track").at_frame(frame), &mut passage)
    }

    /// From here on random streams are those of what is tracked.
    fn identify(&mut self, identity: u64) {
        self.identity = Some(identity);
        self.describer.settings.seed = seed_of(self.seed, identity);
    }

    /// What is tracked, as random streams know it: a hash of what the first frame that shows the person shows; none before it.
    #[must_use]
    pub const fn identity(&self) -> Option<u64> {
        self.identity
    }
}

/// Takes what a pipeline gives.
pub trait KeepFrames {
    /// Takes an estimate, with the posterior that it describes.
    ///
    /// # Errors
    /// The run ends with it.
    fn keep(&mut self, estimate: FrameEstimate, posterior: &Posterior<'_>) -> Result<(), Error>;

    /// Hears where points and angles are in a frame, before its draws and the rates of its angles are known and it is to be kept.
    fn known(&mut self, estimate: &FrameEstimate) {
        let _ = estimate;
    }

    /// Hears, before frames are tracked, the seed of their streams, which is derived from that of the run.
    fn seed(&mut self, seed: u64) {
        let _ = seed;
    }

    /// Whether to stop; asked before every frame but the first, while the last one is still to be kept.
    fn flow(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(FrameEstimate, &Posterior<'_>) -> Result<(), Error>> KeepFrames for F {
    fn keep(&mut self, estimate: FrameEstimate, posterior: &Posterior<'_>) -> Result<(), Error> {
        self(estimate, posterior)
    }
}

/// What the loop of [`run`] calls for each frame of a source: the parts of a pipeline besides its tracker, the source, and who keeps the results.
struct Passage<'a> {
    scene: &'a mut Scene,
    images: &'a mut Option<Images>,
    describer: &'a mut Describer,
    source: &'a mut dyn FrameSource,
    keep: &'a mut dyn KeepFrames,
}

impl Harness<Observation> for Passage<'_> {
    type Bound = Observation;
    type Noted = Noted;
    type Error = Error;

    fn observe(&mut self, frame: u32, estimate: &[f64]) -> Result<Observation, Error> {
        let frame = self.source.frame(u64::from(frame))?;
        let (keypoints, restart) = self.scene.observe(&frame.people, &frame.others, estimate);
        let images = self.images.as_mut().map(|images| images.bind(&frame.images));
        Ok(Observation { likelihood: FrameLikelihood { keypoints, parts: self.scene.parts(), images }, restart })
    }

    fn note(&mut self, frame: u32, info: StepInfo) -> Result<Noted, Error> {
        let number = u64::from(frame);
        if let Some(images) = self.images {
            images.note(number, &info.mean);
        }
        self.scene.note(&info.mean, info.restarted);
        let silhouettes = self.images.as_ref().map_or(0, Images::cameras_with_person);
        Ok(Noted { number, info, shown: self.scene.shown().clone(), silhouettes })
    }

    fn record(&mut self, noted: Noted, posterior: Posterior<'_>) -> Result<(), Error> {
        let (number, mean, shown) = (noted.number, noted.info.mean.clone(), noted.shown.clone());
        let residual_px = self.scene.residual_px(&shown, &mean);
        let (mut estimate, begun) = self.describer.begin(noted, residual_px, &posterior)?;
        self.keep.known(&estimate);
        self.describer.complete(&mut estimate, begun, &posterior)?;
        let draws = some_draws(self.describer.settings.seed, number as u32, &posterior);
        self.scene.check_frame(number, &shown, &mean, &draws);
        rayon::yield_now();
        self.keep.keep(estimate, &posterior)
    }

    fn flow(&mut self) -> ControlFlow<()> {
        self.keep.flow()
    }
}

/// Number of draws of a frame about which the residuals of its keypoints are taken.
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
    Ok(u32::try_from(number).map_err(|_| TrackError::FrameNumber { number })?)
}
