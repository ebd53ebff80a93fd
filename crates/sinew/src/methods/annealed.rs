//! `annealed`: the annealed particle filter of Deutscher, Blake & Reid 2000, a search.

use super::about::{About, Gives, Making, Method, Steps};
use super::score::Score;
use crate::Error;
use crate::config::setting::{Kind, SAMPLING, SHARE, Setting, computed};
use crate::config::values::Values;
use sinew_samplers::annealed_search;
use sinew_tracking::annealed::{self, Config};
use std::sync::Arc;

/// The method; half of the particles are crossed in each layer, which is not the publication of 2000.
#[derive(Clone, Debug, PartialEq)]
pub struct Annealed(pub Config);

impl Default for Annealed {
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
    score: Score::Bidirectional,
    particles: Some(|| Annealed::default().0.particles),
    settings: &SETTINGS,
    usual: || Arc::new(Annealed::default()),
    configure,
    mistake: |_| None,
};

const RATE_OF_SURVIVAL: Kind = Kind::Number { least: 0.0, excluded: true, most: 0.99 };

#[rustfmt::skip]
const SETTINGS: [Setting; 4] = [
    computed((SAMPLING, "layers", Kind::Count(1, 1000), "N", || Annealed::default().0.layers.layers.to_string(), "layers (annealed)")),
    computed((SAMPLING, "survival", RATE_OF_SURVIVAL, "X", || Annealed::default().0.layers.survival.to_string(), "share of the particles that survives a layer (annealed)")),
    computed((SAMPLING, "adaptive", Kind::Flag, "", || Annealed::default().0.layers.adaptive.to_string(), "diffuse no coordinate wider than the particles that survived, soft partitions (annealed)")),
    computed((SAMPLING, "crossover", SHARE, "X", || Annealed::default().0.layers.crossover.to_string(), "share of the particles that is crossed in each layer (annealed); 0 is the filter of 2000")),
];

fn configure(values: &Values) -> Arc<dyn Method> {
    let usual = Annealed::default().0;
    let layers = annealed_search::Config {
        layers: values.size("layers"),
        survival: values.number("survival").unwrap_or(usual.layers.survival),
        adaptive: values.flag("adaptive"),
        crossover: values.number("crossover").unwrap_or_default(),
        ..usual.layers
    };
    Arc::new(Annealed(Config { particles: values.size_or("particles", usual.particles), layers }))
}

impl Method for Annealed {
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
