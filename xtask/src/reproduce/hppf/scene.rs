//! A motion that is tracked, the body that follows it, and what one seed's cameras see of it.
//!
//! A seed dresses another person and draws other errors of segmentation. The tracker's body has the lengths of the person's segments and the girths that masks show of the pose that tracking starts from.

use super::motions::RATE_HZ;
use crate::outcome::Outcome;
use sinew::body::{KinematicTree, hppf24};
use sinew::core::lanes::Isa;
use sinew::core::part::PartTree;
use sinew::observe::Camera;
use sinew::observe::ObservationModel as _;
use sinew::observe::bit_image::BitImage;
use sinew::observe::contour_map::contour_map;
use sinew::observe::girth::{FittedGirth, Sight, fit_girth};
use sinew::observe::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew::observe::image_score::ImageScore;
use sinew::observe::solid_body::{SolidBody, part_tree};
use sinew_motion::follow::{NamedBody, follow};
use sinew_motion::points::Trajectories;
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::Level;
use std::sync::Arc;

/// A motion at the tracked rate.
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) motion: Trajectories,
    /// The body in the person's size.
    pub(super) tree: KinematicTree,
    /// States that follow the joints.
    pub(super) truth: Vec<Vec<f64>>,
    /// Mean distance of the body's joints to the recorded ones, metres.
    pub(super) fit_error_m: f64,
}

impl Scene {
    /// Makes the body follow a motion.
    pub(super) fn new(name: &str, motion: Trajectories) -> Outcome<Self> {
        let found = follow(NamedBody::Hppf24, &motion)?;
        let (tree, truth, fit_error_m) = (found.body, found.states, found.mean_error_m);
        Ok(Self { name: name.into(), motion, tree, truth, fit_error_m })
    }
}

/// What cameras see of a person, frame by frame, with the tracker's body before them.
pub(super) struct Seen {
    masks: Vec<Vec<BitImage>>,
    pub(super) model: ImageModel,
    pub(super) parts: PartTree,
    pub(super) girth: FittedGirth,
}

impl Seen {
    /// Draws a person and the errors of a level; `cameras` are their numbers in the ring, `start` the frame whose pose is known.
    pub(super) fn new(
        scene: &Scene,
        cameras: &[usize],
        level: Level,
        start: usize,
        seed: u64,
        isa: Isa,
    ) -> Outcome<Self> {
        let footage = SyntheticFootage::new(scene.motion.clone(), RATE_HZ, &Ring::SMALL_PICTURES, seed)?;
        let views: Vec<Camera> = cameras.iter().map(|&camera| footage.cameras[camera].clone()).collect();
        let frame = |frame| cameras.iter().map(|&camera| footage.mask(camera, frame, level)).collect();
        let masks: Vec<Vec<BitImage>> = (0..scene.truth.len()).map(frame).collect();
        let usual = hppf24::flesh_on(&scene.tree)?;
        let silhouettes = masks[start].iter().cloned().map(Some).collect();
        let first = Sight { state: scene.truth[start].clone(), silhouettes };
        let girth = fit_girth(&scene.tree, &usual, &views, &[first])?;
        let flesh = girth.girth.applied(&usual);
        let body = Arc::new(SolidBody::new(&scene.tree, &flesh)?);
        let model = ImageModel { body, cameras: views, score: ImageScore::Parts, colours: Arc::default(), isa };
        Ok(Self { masks, parts: part_tree(&scene.tree, &flesh)?, model, girth })
    }

    /// The likelihood of a frame.
    pub(super) fn bind(&self, frame: usize) -> ImageLikelihood {
        let cues = |silhouette: &BitImage| Cues {
            edges: Some(contour_map(silhouette)),
            silhouette: silhouette.clone(),
            picture: None,
        };
        self.model.bind(self.masks[frame].iter().map(|mask| Some(cues(mask))).collect())
    }
}
