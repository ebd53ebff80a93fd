//! `bootstrap`: the bootstrap particle filter of Gordon, Salmond & Smith 1993, in vision CONDENSATION.

use super::about::{About, Gives, LatentUse, Making, Method, Steps};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::SettingValues;
use sinew_tracking::bootstrap::{self, Config};
use std::sync::Arc;

/// The method; 32 degrees of freedom need more particles than the papers had.
#[derive(Clone, Debug, PartialEq)]
pub struct BootstrapMethod(pub Config);

impl Default for BootstrapMethod {
    fn default() -> Self {
        Self(Config { particles: 10_000, ..Config::default() })
    }
}

/// Its description.
pub const ABOUT: About = About {
    name: "bootstrap",
    help: "bootstrap particle filter",
    gives: Gives::Particles,
    needs_gradients: false,
    needs_parts: false,
    latent: LatentUse::No,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: Some(|| BootstrapMethod::default().0.particles),
    settings: &[],
    configure,
    mistake: |_| None,
};

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = BootstrapMethod::default().0;
    Arc::new(BootstrapMethod(Config { particles: values.of(&PARTICLES).unwrap_or(usual.particles), ..usual }))
}

impl Method for BootstrapMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.0.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let filter = bootstrap::Bootstrap::new(self.0.clone(), making.transition.clone(), start);
        Ok(Box::new(filter?))
    }
}
