//! `hmc`: the hybrid Monte Carlo filter of Choo & Fleet 2001.
//!
//! With a dense metric and a Gaussian prior between frames, which are not the paper's.

use super::about::{About, Gives, Making, Method, StepSize, Steps};
use super::frame_likelihood::FrameLikelihood;
use super::score::Score;
use crate::Error;
use crate::config::setting::{SAMPLING, SHARE, Setting, SettingKind, computed};
use crate::config::values::SettingValues;
use crate::setup::Setup;
use sinew_core::random::Stage;
use sinew_samplers::tuning;
use sinew_tracking::hmc_filter::{Config, HmcFilter};
use std::sync::Arc;

/// The method; the default is the preset for real recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct HmcMethod(pub Config);

impl Default for HmcMethod {
    fn default() -> Self {
        Self(Config::real_recordings())
    }
}

/// Its description.
pub const ABOUT: About = About {
    name: "hmc",
    help: "Hamiltonian Monte Carlo filter",
    gives: Gives::Chains,
    needs_gradients: true,
    needs_parts: false,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: None,
    settings: &SETTINGS,
    usual: || Arc::new(HmcMethod::default()),
    configure,
    mistake,
};

#[rustfmt::skip]
const SETTINGS: [Setting; 4] = [
    computed((SAMPLING, "chains", SettingKind::Count(1, 100_000), "N", || HmcMethod::default().0.chains.to_string(), "chains of a frame (hmc)")),
    computed((SAMPLING, "updates", SettingKind::Count(1, 1_000_000), "N", || HmcMethod::default().0.updates.to_string(), "updates of each chain in a frame; four times as many where the chains disagree (hmc)")),
    computed((SAMPLING, "burn_in", SettingKind::Count(0, 1_000_000), "N", || HmcMethod::default().0.burn_in.to_string(), "first samples of each chain that are discarded (hmc)")),
    computed((SAMPLING, "jitter", SHARE, "X", || HmcMethod::default().0.jitter.to_string(), "relative jitter of the step size (hmc)")),
];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    Arc::new(HmcMethod(Config {
        chains: values.size("chains"),
        updates: values.size("updates"),
        burn_in: values.size("burn_in"),
        jitter: values.number("jitter").unwrap_or_default(),
        ..Config::real_recordings()
    }))
}

fn mistake(values: &SettingValues) -> Option<String> {
    let (burn_in, updates) = (values.count("burn_in").unwrap_or_default(), values.count("updates").unwrap_or(1));
    (burn_in >= updates).then(|| format!("`burn_in` is {burn_in}; it must be less than `updates`, which is {updates}"))
}

/// Trajectory lengths to choose from. In units of the dense metric a trajectory should take a quarter to half of a period, 2π; longer ones come back to where they began.
const LENGTHS: [usize; 2] = [6, 7];

impl HmcMethod {
    fn with_steps(&self, setup: &Setup) -> Config {
        Config {
            step_size: setup.step_size.unwrap_or(self.0.step_size),
            leapfrog_steps: setup.leapfrog_steps.map_or(self.0.leapfrog_steps, |l| l as usize),
            ..self.0.clone()
        }
    }
}

impl Method for HmcMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        None
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let config = self.with_steps(making.setup);
        let filter = HmcFilter::new(config, making.transition.clone(), start, making.isa)?;
        Ok(Box::new(filter))
    }

    fn tuned(
        &self,
        making: &Making<'_>,
        start: Vec<f64>,
        observed: &FrameLikelihood,
        stage: Stage,
    ) -> Result<Option<StepSize>, Error> {
        let config = self.with_steps(making.setup);
        let filter = HmcFilter::new(config, making.transition.clone(), start, making.isa)?;
        let config = tuning::Config { jitter: self.0.jitter, lengths: LENGTHS.to_vec(), ..tuning::Config::default() };
        let tuned = filter.tune(observed, &config, stage)?;
        Ok(Some(StepSize { step_size: tuned.step_size, leapfrog_steps: tuned.leapfrog_steps }))
    }
}
