//! `h-apf`: the hierarchical annealed particle filter of Raskin, Rudzsky & Rivlin 2011, a search down a tree of latent spaces.

use super::about::{About, Gives, LatentUse, Making, Method, Steps, no_latent_model};
use super::latent_state::{leading, motion, rest, stored};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::{AnySetting, SettingKind, SettingValues, Typed, method_setting};
use crate::track::error::TrackError;
use sinew_latent::tree::hierarchy;
use sinew_tracking::h_apf::{Config, HApf};
use std::sync::Arc;

/// The method; the default has the paper's five visits of layers, (1, 1, 2, 3, 3) where there are three.
#[derive(Clone, Debug, PartialEq)]
pub struct HApfMethod {
    /// Settings of the tracker, but for the schedule, which depends on the model's layers.
    pub config: Config,
    /// Visits of layers.
    pub visits: usize,
}

impl Default for HApfMethod {
    fn default() -> Self {
        let config = Config::default();
        Self { visits: config.schedule.len(), config }
    }
}

/// Its description.
pub const ABOUT: About = About {
    name: "h-apf",
    help: "annealed particle filter down a hierarchy of latent spaces, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: false,
    latent: LatentUse::Needed,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: Some(|| HApfMethod::default().config.particles),
    settings: SETTINGS,
    configure,
    mistake: |values| no_latent_model(values, ABOUT.name),
};

#[rustfmt::skip]
const VISITS: Typed<usize> = method_setting(("visits", SettingKind::Count(2, 1000), "N", || HApfMethod::default().visits, "visits of layers of the hierarchy: one more of the root and of the leaves than of the layers between, the rest of the leaves (h-apf)"));

const SETTINGS: &[&dyn AnySetting] = &[&VISITS];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let mut config = HApfMethod::default().config;
    config.particles = values.of(&PARTICLES).unwrap_or(config.particles);
    Arc::new(HApfMethod { config, visits: values.of(&VISITS) })
}

/// A schedule of a number of visits over a number of layers: the root twice, every layer between once, the last one for the rest; with one layer all visits are its own. The paper's (1, 1, 2, 3, 3) is that of five visits and three layers.
fn schedule(visits: usize, layers: usize) -> Vec<usize> {
    let twice = usize::from(visits > layers && layers > 1);
    let walk = std::iter::repeat_n(1, twice).chain(1..layers);
    let mut schedule: Vec<usize> = walk.collect();
    schedule.resize(visits.max(schedule.len() + 1), layers);
    schedule
}

impl Method for HApfMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.config.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let stored = stored(making, &ABOUT)?;
        if !rest(making, stored).is_empty() {
            return Err(TrackError::LatentRest { method: ABOUT.name, body: stored.state.clone() }.into());
        }
        let tree = Arc::new(hierarchy(&stored.model, making.isa).map_err(TrackError::Latent)?);
        let config = Config { schedule: schedule(self.visits, tree.layers()), ..self.config.clone() };
        let motion = motion(making, stored)?;
        let place = &making.transition.sd()[leading(stored)];
        Ok(Box::new(HApf::new(config, tree, motion, place, &start, making.isa)?))
    }
}

#[cfg(test)]
mod tests {
    use super::schedule;

    #[test]
    fn schedules_walk_down_and_stay_at_the_leaves() {
        assert_eq!(schedule(5, 3), [1, 1, 2, 3, 3]);
        assert_eq!(schedule(3, 3), [1, 2, 3]);
        assert_eq!(schedule(2, 3), [1, 2, 3]);
        assert_eq!(schedule(5, 1), [1; 5]);
        assert_eq!(schedule(6, 2), [1, 1, 2, 2, 2, 2]);
    }
}
