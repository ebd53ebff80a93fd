//! `guided`: a particle filter whose particles move with the observation in view (Doucet, Godsill & Andrieu 2000).

use super::about::{About, Making, Method, Steps};
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::SettingValues;
use sinew_tracking::guided::{Config, Guided};
use std::sync::Arc;

/// The method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuidedMethod(pub Config);

/// Its description; what is not said is as of `bootstrap`.
pub const ABOUT: About = About {
    name: "guided",
    help: "particle filter whose particles see the frame before they move",
    needs_gradients: true,
    particles: Some(|| GuidedMethod::default().0.particles),
    configure,
    ..super::bootstrap::ABOUT
};

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = GuidedMethod::default().0;
    Arc::new(GuidedMethod(Config { particles: values.of(&PARTICLES).unwrap_or(usual.particles), ..usual }))
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
