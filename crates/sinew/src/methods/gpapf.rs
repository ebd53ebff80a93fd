//! `gpapf`: the annealed particle filter in a latent space of Raskin, Rudzsky & Rivlin 2007 and 2008, a search.

use super::about::{About, Gives, LatentUse, Making, Method, Steps, no_latent_model};
use super::latent_state::{ROOT, around, decoder, motion, stored};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::{AnySetting, SHARE, SettingKind, SettingValues, Typed, method_setting};
use sinew_core::injection::Injection;
use sinew_latent::motion::step_sd;
use sinew_tracking::gpapf::{self, Config};
use std::sync::Arc;

/// The method; the default is the paper's five layers of 100 particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpapfMethod {
    /// Settings of the tracker, but for what comes from the model.
    pub config: Config,
    /// Whether poses are diffused once more after the layers.
    pub refine: bool,
}

/// Its description.
pub const ABOUT: About = About {
    name: "gpapf",
    help: "annealed particle filter in a latent space, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: false,
    latent: LatentUse::Needed,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: Some(|| GpapfMethod::default().config.annealing.particles),
    settings: SETTINGS,
    configure,
    mistake: |values| no_latent_model(values, ABOUT.name),
};

#[rustfmt::skip]
const LATENT_LAYERS: Typed<usize> = method_setting(("latent_layers", SettingKind::Count(1, 1000), "N", || GpapfMethod::default().config.annealing.layers.layers, "layers (gpapf)"));
#[rustfmt::skip]
const INJECT: Typed<f64> = method_setting(("inject", SHARE, "P", || GpapfMethod::default().config.injection.probability, "probability that a particle begins a frame at a learned pose (gpapf)"));
#[rustfmt::skip]
const REFINE: Typed<bool> = method_setting(("refine", SettingKind::Flag, "", || GpapfMethod::default().refine, "one more layer among poses outside of the latent space (gpapf)"));

const SETTINGS: &[&dyn AnySetting] = &[&LATENT_LAYERS, &INJECT, &REFINE];

/// Noise of the layer among poses, as a share of the noise of a frame.
const REFINEMENT: f64 = 0.25;

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let mut method = GpapfMethod { refine: values.of(&REFINE), ..GpapfMethod::default() };
    let annealing = &mut method.config.annealing;
    annealing.particles = values.of(&PARTICLES).unwrap_or(annealing.particles);
    annealing.layers.layers = values.of(&LATENT_LAYERS);
    method.config.injection.probability = values.of(&INJECT);
    Arc::new(method)
}

impl Method for GpapfMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.config.annealing.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let stored = stored(making, &ABOUT)?;
        let decoder = decoder(making, stored)?;
        let mapping = decoder.decoder().space().mapping.clone();
        let sd = around(making, stored, making.transition.sd(), &step_sd(&stored.model, ROOT));
        let noise = || making.transition.sd()[stored.free..].iter().map(|sd| REFINEMENT * sd).collect();
        let config = Config {
            refine: self.refine.then(noise),
            injection: Injection { latents: mapping.latents().to_vec(), ..self.config.injection },
            ..self.config.clone()
        };
        let tracker = gpapf::Gpapf::new(config, decoder, motion(making, stored)?, sd, &start, making.isa)?;
        let share_left = move |x: &[f64]| mapping.variance_at(x) / mapping.prior_variance(x);
        Ok(Box::new(tracker.with_variance(Arc::new(share_left))))
    }
}
