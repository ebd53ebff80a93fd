//! `guided`: a particle filter whose particles move with the observation in view (Doucet, Godsill & Andrieu 2000).

use super::about::{About, Gives, LatentUse, Making, Method, Steps};
use super::score::Score;
use crate::Error;
use crate::config::values::SettingValues;
use sinew_tracking::guided::{Config, Guided};
use std::sync::Arc;

/// The method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuidedMethod(pub Config);

/// Its description.
pub const ABOUT: About = About {
    name: "guided",
    help: "particle filter whose particles see the frame before they move",
    gives: Gives::Particles,
    needs_gradients: true,
    needs_parts: false,
    latent: LatentUse::No,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: Some(|| GuidedMethod::default().0.particles),
    settings: &[],
    usual: || Arc::new(GuidedMethod::default()),
    configure,
    mistake: |_| None,
};

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = GuidedMethod::default().0;
    Arc::new(GuidedMethod(Config { particles: values.size_or("particles", usual.particles), ..usual }))
}

impl Method for GuidedMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.0.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let filter = Guided::new(self.0.clone(), making.transition.clone(), start, making.isa);
        Ok(Box::new(filter?))
    }
}
