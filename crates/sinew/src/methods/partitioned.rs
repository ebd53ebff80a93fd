//! `partitioned`: the partitioned sampling of MacCormick & Blake 1999, part by part.

use super::about::{About, Gives, LatentUse, Making, Method, Steps, no_motion_model};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::SettingValues;
use sinew_tracking::partitioned::{self, Config};
use std::sync::Arc;

/// The method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartitionedMethod(pub Config);

/// Its description.
pub const ABOUT: About = About {
    name: "partitioned",
    help: "partitioned sampling",
    gives: Gives::Particles,
    needs_gradients: false,
    needs_parts: true,
    latent: LatentUse::No,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Parts,
    particles: Some(|| PartitionedMethod::default().0.particles),
    settings: &[],
    configure,
    mistake: |values| no_motion_model(values, ABOUT.name),
};

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = PartitionedMethod::default().0;
    Arc::new(PartitionedMethod(Config { particles: values.of(&PARTICLES).unwrap_or(usual.particles), ..usual }))
}

impl Method for PartitionedMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.0.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let parts = making.parts()?;
        let filter = partitioned::Partitioned::new(self.0.clone(), making.walk(&ABOUT)?, parts, start);
        Ok(Box::new(filter?))
    }
}
