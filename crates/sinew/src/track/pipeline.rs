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

use super::describe::describe;
use super::images::{self, ImageState, Images};
use super::marginals::Marginals;
use super::method::Method;
use super::motion_prior::walk;
use super::observed::Observed;
use super::predictive::Doubt;
use super::restart::Restarting;
use super::scene::{Scene, SceneState};
use super::settings::Settings;
use super::trackers::tracker;
use super::unknown_size::UnknownSize;
use crate::Error;
use crate::input::source::FrameSource;
use crate::results::estimate::{Carried, FrameEstimate};
use crate::results::problem::{self, Problem};
use crate::results::silhouette_overlap::SilhouetteOverlap;
use crate::setup::Setup;
use serde::{Deserialize, Serialize};
use sinew_body::KinematicTree;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::random_walk::RandomWalk;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Resume as _, run};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

/// A tracker with all that surrounds it for one recording.
pub struct Pipeline {
    pub(super) settings: Settings,
    tracker: Restarting,
    scene: Scene,
    images: Option<Images>,
    pub(super) marginals: Marginals,
    pub(super) transition: RandomWalk,
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
    pub fn coverage(&self) -> &[SilhouetteOverlap] {
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
        let (scene, images) = (RefCell::new(scene), RefCell::new(images));
        let (seed, pending, restarted) = (settings.seed, tracker.pending(), tracker.restarted());
        run(
            tracker,
            numbers,
            |frame| Stage::new(seed, "track").at_frame(frame),
            |frame, estimate| {
                let people = source.people(u64::from(frame))?;
                let mut scene = scene.borrow_mut();
                let (keypoints, restart) = scene.observe(&people, estimate);
                if restart.is_some() {
                    *pending.lock().unwrap_or_else(PoisonError::into_inner) = restart;
                }
                let images = match &mut **images.borrow_mut() {
                    Some(images) => Some(images.bind(&source.images(u64::from(frame))?)),
                    None => None,
                };
                Ok::<Observed, Error>(Observed { keypoints, parts: scene.parts(), images })
            },
            |frame, info, posterior| {
                scene.borrow_mut().note(u64::from(frame), &info.mean, &some_draws(seed, frame, &posterior));
                let mut images = images.borrow_mut();
                if let Some(images) = &mut **images {
                    images.note(u64::from(frame), &info.mean);
                }
                let seen_by = images.as_ref().map_or(0, Images::cameras_with_person);
                let estimate =
                    describe(settings, &scene.borrow(), seen_by, marginals, u64::from(frame), info, &posterior);
                record(FrameEstimate { restarted: restarted.load(Ordering::Relaxed), ..estimate }, &posterior)
            },
        )?;
        refused.map_or(Ok(()), Err)
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

/// Moments that a smoother takes from a frame. They are not shrunk: correlations between the angles of a limb are what keeps its end in place.
#[must_use]
pub fn moments(posterior: &Posterior<'_>, isa: Isa) -> Moments {
    posterior.moments(isa)
}
