//! `annealed`: the annealed particle filter of Deutscher, Blake & Reid 2000, a search.

use super::about::{About, Gives, LatentUse, Making, Method, Steps};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::{AnySetting, SHARE, SettingKind, SettingValues, Typed, method_setting};
use sinew_samplers::annealed_search;
use sinew_tracking::annealed::{self, Config};
use std::sync::Arc;

/// The method; half of the particles are crossed in each layer, which is not the publication of 2000.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnealedMethod(pub Config);

impl Default for AnnealedMethod {
    fn default() -> Self {
        let layers = annealed_search::Config { layers: 5, crossover: 0.5, ..annealed_search::Config::default() };
        Self(Config { particles: 200, layers })
    }
}

/// Its description.
pub const ABOUT: About = About {
    name: "annealed",
    help: "annealed particle filter, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: false,
    latent: LatentUse::No,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: Some(|| AnnealedMethod::default().0.particles),
    settings: SETTINGS,
    configure,
    mistake: |_| None,
};

const RATE_OF_SURVIVAL: SettingKind = SettingKind::Number { least: 0.0, excluded: true, most: 0.99 };

#[rustfmt::skip]
const LAYERS: Typed<usize> = method_setting(("layers", SettingKind::Count(1, 1000), "N", || AnnealedMethod::default().0.layers.layers, "layers (annealed)"));
#[rustfmt::skip]
const SURVIVAL: Typed<f64> = method_setting(("survival", RATE_OF_SURVIVAL, "X", || AnnealedMethod::default().0.layers.survival, "share of the particles that survives a layer (annealed)"));
#[rustfmt::skip]
const ADAPTIVE: Typed<bool> = method_setting(("adaptive", SettingKind::Flag, "", || AnnealedMethod::default().0.layers.adaptive, "diffuse no coordinate wider than the particles that survived, soft partitions (annealed)"));
#[rustfmt::skip]
const CROSSOVER: Typed<f64> = method_setting(("crossover", SHARE, "X", || AnnealedMethod::default().0.layers.crossover, "share of the particles that is crossed in each layer (annealed); 0 is the filter of 2000"));

const SETTINGS: &[&dyn AnySetting] = &[&LAYERS, &SURVIVAL, &ADAPTIVE, &CROSSOVER];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = AnnealedMethod::default().0;
    let layers = annealed_search::Config {
        layers: values.of(&LAYERS),
        survival: values.of(&SURVIVAL),
        adaptive: values.of(&ADAPTIVE),
        crossover: values.of(&CROSSOVER),
        ..usual.layers
    };
    Arc::new(AnnealedMethod(Config { particles: values.of(&PARTICLES).unwrap_or(usual.particles), layers }))
}

impl Method for AnnealedMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.0.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let sd = making.transition.sd().to_vec();
        let filter = annealed::Annealed::new(self.0.clone(), making.transition.clone(), sd, start, making.isa);
        Ok(Box::new(filter?))
    }
}
