//! `coarse-to-fine`: a grid of poses first, then its parts one by one, a search.

use super::about::{About, Gives, LatentUse, Making, Method, Steps, no_motion_model};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::{AnySetting, SettingKind, SettingValues, Typed, method_setting};
use crate::track::error::TrackError;
use sinew_samplers::grid::GridAxis;
use sinew_tracking::coarse_to_fine::{self, Config};
use std::sync::Arc;

/// The method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoarseToFineMethod(pub Config);

/// Its description.
pub const ABOUT: About = About {
    name: "coarse-to-fine",
    help: "two-level coarse-to-fine tracker, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: true,
    latent: LatentUse::No,
    score: Score::CoarseToFine,
    score_beside_keypoints: Score::CoarseToFine,
    particles: Some(|| CoarseToFineMethod::default().0.coarse),
    settings: SETTINGS,
    configure,
    mistake: |values| no_motion_model(values, ABOUT.name),
};

#[rustfmt::skip]
const FINE: Typed<usize> = method_setting(("fine", SettingKind::Count(1, 100_000_000), "N", || CoarseToFineMethod::default().0.fine, "particles of the fine level (coarse-to-fine)"));

const SETTINGS: &[&dyn AnySetting] = &[&FINE];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = CoarseToFineMethod::default().0;
    let coarse = values.of(&PARTICLES).unwrap_or(usual.coarse);
    Arc::new(CoarseToFineMethod(Config { coarse, fine: values.of(&FINE), ..usual }))
}

/// Range of a position about where tracking began, metres, in which the coarse level has partitions.
const RANGE_M: f64 = 2.0;

/// Partitions of the coarse level: as wide as a step of motion, positions within [`RANGE_M`] of the start, angles all around.
fn axes(start: &[f64], sd: &[f64]) -> Result<Vec<GridAxis>, sinew_samplers::Error> {
    use std::f64::consts::PI;
    let axis = |(j, (&at, &sd)): (usize, (&f64, &f64))| match j {
        0..3 => GridAxis::new(at - RANGE_M, at + RANGE_M, sd, false),
        _ => GridAxis::new(-PI, PI, sd, true),
    };
    start.iter().zip(sd).enumerate().map(axis).collect()
}

impl Method for CoarseToFineMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    /// It reports one pose.
    fn weighted_draws(&self) -> Option<usize> {
        Some(1)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let axes = axes(&start, making.walk(&ABOUT)?.sd()).map_err(TrackError::Sampler)?;
        let (config, parts) = (self.0.clone(), making.parts()?);
        let filter = coarse_to_fine::CoarseToFine::new(config, axes, parts, start, making.isa);
        Ok(Box::new(filter?))
    }
}
