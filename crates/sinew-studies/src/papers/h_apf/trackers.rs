//! The trackers with what they learned.
//!
//! Noise: half of the largest change between frames in every layer. With five layers and a survival rate of ½ the variances of a frame add up to 1.94 of a layer's, so that all layers together have 0.70 of the largest change, which is 1.44 times as much; CONDENSATION gets the same at once.

use super::contender::{LAYERS, Method};
use super::lessons::Taught;
use crate::support::outcome::Outcome;
use sinew::body::hapf31::FREE;
use sinew::core::beside::Beside;
use sinew::core::hierarchy::Hierarchy;
use sinew::core::lanes::Isa;
use sinew::core::side_by_side::SideBySide;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::latent::motion::{LatentMotion, StepNoise, step_sd};
use sinew::latent::space::Below;
use sinew::latent::tree::hierarchy_with_steps;
use sinew::observe::silhouettes::image_likelihood::ImageLikelihood;
use sinew::samplers::annealed_search;
use sinew::tracking::{Tracker, annealed, bootstrap, gpapf, h_apf};
use std::sync::Arc;

/// What the paper leaves open about latents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuning {
    /// Steps of the inverse maps of leaves after regression, of which H-APF needs one a particle, frame and leaf.
    pub(super) steps: usize,
    /// Standard deviation of a latent's noise over half of its largest step in training.
    pub(super) noise: f64,
}

/// As the pilot settled it. Three steps of inverse maps take nine tenths of the time.
pub(super) const TUNING: Tuning = Tuning { steps: 0, noise: 1.0 };

/// A tracker of poses from images.
pub(super) type Running = Box<dyn Tracker<ImageLikelihood>>;

/// Latent spaces with how latents move in them.
pub(super) struct Spaces {
    /// The single space, its motion, and the noise of a step.
    pub(super) single: Arc<Below>,
    single_motion: LatentMotion,
    single_sd: Vec<f64>,
    /// The hierarchy, and the motion of its root.
    pub(super) tree: Arc<Hierarchy>,
    tree_motion: LatentMotion,
    /// Half of the largest change of each coordinate of a pose.
    half: Vec<f64>,
    isa: Isa,
}

/// Noise of all layers of a frame over that of the first.
pub(super) fn all_layers() -> f64 {
    let annealing = annealed_search::Config { layers: LAYERS, ..annealed_search::Config::default() };
    (0..LAYERS).map(|layer| annealing.noise(&[1.0], layer)[0].powi(2)).sum::<f64>().sqrt()
}

impl Spaces {
    /// Makes maps of what was learned.
    pub(super) fn new(taught: &Taught, Tuning { steps, noise }: Tuning, isa: Isa) -> Outcome<Self> {
        let motion = |model, sd: &[f64]| LatentMotion::new(model, 0, StepNoise::Fixed(sd.to_vec()), isa);
        let (single, whole) = (&taught.gpdm.model, &taught.hierarchy.model);
        let root_sd = |model| -> Vec<f64> { step_sd(model, 0).into_iter().map(|sd| noise * sd).collect() };
        let (single_sd, root_sd) = (root_sd(single), root_sd(whole));
        Ok(Self {
            single: Arc::new(Below::new(single, 0, isa)?),
            single_motion: motion(single, &single_sd)?,
            single_sd,
            tree: Arc::new(hierarchy_with_steps(whole, steps, isa)?.with_noise(noise)),
            tree_motion: motion(whole, &root_sd)?,
            half: taught.fastest.iter().map(|step| 0.5 * step).collect(),
            isa,
        })
    }

    /// A tracker that starts at a pose; none for a reference row.
    pub(super) fn tracker(&self, method: Method, start: &[f64]) -> Outcome<Option<Running>> {
        let (half, isa) = (&self.half, self.isa);
        let walk = |sd: &[f64]| RandomWalk::new(sd, 1.0, Between::Mixture, isa);
        let place = || walk(&half[..FREE]);
        Ok(Some(match method {
            Method::Bootstrap(particles) => {
                let sd: Vec<f64> = half.iter().map(|sd| all_layers() * sd).collect();
                let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
                Box::new(bootstrap::Bootstrap::new(config, walk(&sd)?, start.to_vec())?)
            }
            Method::Annealed(particles) => {
                let config = annealed::Config { particles, ..annealed::Config::raskin() };
                Box::new(annealed::Annealed::new(config, walk(half)?, half.clone(), start.to_vec(), isa)?)
            }
            Method::Gpapf(particles) => {
                let annealing = annealed::Config { particles, ..annealed::Config::raskin() };
                let config = gpapf::Config { annealing, ..gpapf::Config::default() };
                let motion = SideBySide(place()?, self.single_motion.clone());
                let sd = [&half[..FREE], &self.single_sd].concat();
                let mapping = self.single.space().mapping.clone();
                let variance = move |x: &[f64]| mapping.variance_at(x) / mapping.prior_variance(x);
                let decoder = Beside::whole(FREE, self.single.clone())?;
                let tracker = gpapf::Gpapf::new(config, decoder, motion, sd, start, isa)?;
                Box::new(tracker.with_variance(Arc::new(variance)))
            }
            Method::HApf(particles) => {
                let config = h_apf::Config { particles, ..h_apf::Config::default() };
                let motion = SideBySide(place()?, self.tree_motion.clone());
                Box::new(h_apf::HApf::new(config, self.tree.clone(), motion, &half[..FREE], start, isa)?)
            }
            Method::Truth | Method::MeanPose | Method::Frozen => return Ok(None),
        }))
    }
}
