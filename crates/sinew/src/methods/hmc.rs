//! `hmc`: the hybrid Monte Carlo filter of Choo & Fleet 2001.
//!
//! With a dense metric and a Gaussian prior between frames, which are not the paper's. With a latent model it samples [λ, θ]: the likelihood through the mean of the model's Gaussian processes, and in the prior of every frame how well
//! poses are known at a latent ([`LatentDensity::prior_of`]). Without one, `joint_limits` adds soft limits of joints to the prior ([`body_limits`]).

use super::about::{About, Gives, LatentUse, Making, Method, StepSize, Steps};
use super::latent_state::{ROOT, decoder, walk};
use super::score::Score;
use crate::Error;
use crate::config::setting::{
    AnySetting, NamedValues, SAMPLING, SHARE, SettingKind, SettingValues, Typed, choice, method_setting,
};
use crate::setup::Setup;
use crate::track::error::TrackError;
use sinew_body::leg_turns::shows_feet;
use sinew_body::motion_ranges::{motion_ranges, undecided_ranges};
use sinew_core::beside::Beside;
use sinew_core::combinators::{Sum, Through};
use sinew_core::decode::Decode;
use sinew_core::density::Lanes;
use sinew_core::random::Stage;
use sinew_core::within::Within;
use sinew_dynamics::joint_limits::JointLimits;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_latent::file::StoredModel;
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::space::Below;
use sinew_observe::frame_likelihood::FrameLikelihood;
use sinew_samplers::tuning;
use sinew_setup::body_limits::body_limits;
use sinew_tracking::decoded::Decoded;
use sinew_tracking::hmc_filter::{Config, HmcFilter};
use sinew_tracking::restrained::{Restrained, RestrainedFilter};
use sinew_tracking::with_prior::WithPrior;
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
    latent: LatentUse::Taken,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: None,
    settings: SETTINGS,
    configure,
    mistake,
};

/// Which limits of joints count. Without them a limb that hangs straight may turn about itself by
/// half a turn and then bends backward, which fits as well. Others change the mean of an angle that is badly known near its limit, in every frame again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhichLimits {
    /// Those of what keypoints leave undecided ([`undecided_ranges`]), and all where keypoints show no foot.
    Auto,
    /// None.
    Off,
    /// All.
    On,
}

impl NamedValues for WhichLimits {
    const NAMES: &'static [&'static str] = &["auto", "off", "on"];
    const ALL: &'static [Self] = &[Self::Auto, Self::Off, Self::On];
}

#[rustfmt::skip]
const CHAINS: Typed<usize> = method_setting(("chains", SettingKind::Count(1, 100_000), "N", || HmcMethod::default().0.chains, "chains of a frame (hmc)"));
#[rustfmt::skip]
const UPDATES: Typed<usize> = method_setting(("updates", SettingKind::Count(1, 1_000_000), "N", || HmcMethod::default().0.updates, "updates of each chain in a frame (hmc)"));
/// Times the updates that chains which disagree may take.
#[rustfmt::skip]
pub const PATIENCE: Typed<usize> = method_setting(("patience", SettingKind::Count(1, 64), "N", || HmcMethod::default().0.patience, "times the updates that chains which disagree may take; 1 for frames that take the same time (hmc)"));
#[rustfmt::skip]
const BURN_IN: Typed<usize> = method_setting(("burn_in", SettingKind::Count(0, 1_000_000), "N", || HmcMethod::default().0.burn_in, "first samples of each chain that are discarded (hmc)"));
#[rustfmt::skip]
const JITTER: Typed<f64> = method_setting(("jitter", SHARE, "X", || HmcMethod::default().0.jitter, "relative jitter of the step size (hmc)"));
/// Soft limits of joints.
#[rustfmt::skip]
pub const JOINT_LIMITS: Typed<WhichLimits> = choice((SAMPLING, "joint_limits", "WHEN", "soft limits of joints in the prior: off, on, or auto: of knees, elbows, turns of trunk and head, and of all where keypoints show no feet (hmc)")).rare();

const SETTINGS: &[&dyn AnySetting] = &[&CHAINS, &UPDATES, &PATIENCE, &BURN_IN, &JITTER, &JOINT_LIMITS];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let method = HmcMethod(Config {
        chains: values.of(&CHAINS),
        updates: values.of(&UPDATES),
        burn_in: values.of(&BURN_IN),
        patience: values.of(&PATIENCE),
        jitter: values.of(&JITTER),
        ..Config::real_recordings()
    });
    match values.of(&JOINT_LIMITS) {
        WhichLimits::Off => Arc::new(method),
        limits => Arc::new(LimitedHmc { method, all: limits == WhichLimits::On }),
    }
}

fn mistake(values: &SettingValues) -> Option<String> {
    let (burn_in, updates) = (values.of(&BURN_IN), values.of(&UPDATES));
    (burn_in >= updates).then(|| format!("`burn_in` is {burn_in}; it must be less than `updates`, which is {updates}"))
}

/// Trajectory lengths to choose from. In units of the dense metric a trajectory should take a quarter to half of a period, 2π; longer ones come back to where they began.
const LENGTHS: [usize; 2] = [6, 7];

impl HmcMethod {
    /// How step size and length are found.
    fn tuning(&self) -> tuning::Config {
        tuning::Config { jitter: self.0.jitter, lengths: LENGTHS.to_vec(), ..tuning::Config::default() }
    }

    fn with_steps(&self, setup: &Setup) -> Config {
        Config {
            step_size: setup.step_size.unwrap_or(self.0.step_size),
            leapfrog_steps: setup.leapfrog_steps.map_or(self.0.leapfrog_steps, |l| l as usize),
            ..self.0.clone()
        }
    }
}

/// What the filter on [λ, θ] is made of.
struct LatentParts {
    decoder: Beside<Below>,
    prior: Within<Lanes<LatentDensity>>,
    walk: RandomWalk,
}

fn latent_parts(making: &Making<'_>, stored: &StoredModel) -> Result<LatentParts, Error> {
    let decoder = decoder(making, stored)?;
    let mapping = decoder.decoder().space().mapping.clone();
    let leaf = LatentDensity::prior_of(mapping, LatentPrior::of(&stored.model, ROOT));
    let target = Lanes { leaf, isa: making.isa };
    let prior = Within { target, first: stored.free, dim: decoder.source_dim() };
    Ok(LatentParts { decoder, prior, walk: walk(making, stored, Between::Gaussian)? })
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
        if let Some(stored) = making.latent {
            let LatentParts { decoder, prior, walk } = latent_parts(making, stored)?;
            let filter = |start| -> Result<_, Error> {
                Ok(WithPrior { prior, tracker: HmcFilter::new(config, walk, start, making.isa)? })
            };
            return Ok(Box::new(Decoded::new(decoder, &start, filter)?));
        }
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
        let tuning = self.tuning();
        let tuned = match making.latent {
            None => {
                HmcFilter::new(config, making.transition.clone(), start, making.isa)?.tune(observed, &tuning, stage)?
            }
            Some(stored) => {
                let LatentParts { decoder, prior, walk } = latent_parts(making, stored)?;
                let start = decoder.encode(&start).ok_or(sinew_tracking::Error::NotEncoded)?;
                let target = Sum(Through { target: observed, decoder: &decoder }, &prior);
                HmcFilter::new(config, walk, start, making.isa)?.tune(&target, &tuning, stage)?
            }
        };
        Ok(Some(StepSize { step_size: tuned.step_size, leapfrog_steps: tuned.leapfrog_steps }))
    }
}

/// The method with limits of joints as a soft factor of every frame's prior, where no latent model says what poses are like.
#[derive(Clone, Debug, PartialEq)]
struct LimitedHmc {
    method: HmcMethod,
    all: bool,
}

impl LimitedHmc {
    fn limits(&self, making: &Making<'_>) -> Result<Lanes<JointLimits>, TrackError> {
        let tree = making.setup.tree();
        let all = self.all || !shows_feet(&tree, |name| making.keypoints.iter().any(|shown| shown == name));
        body_limits(if all { motion_ranges(&tree) } else { undecided_ranges(&tree) }, making.isa)
            .map_err(TrackError::Motion)
    }
}

impl Method for LimitedHmc {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn limits_joints(&self) -> bool {
        true
    }

    fn weighted_draws(&self) -> Option<usize> {
        None
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        if making.latent.is_some() {
            return self.method.tracker(making, start);
        }
        let config = self.method.with_steps(making.setup);
        let filter = HmcFilter::new(config, making.transition.clone(), start, making.isa)?;
        Ok(Box::new(RestrainedFilter { filter, prior: self.limits(making)? }))
    }

    fn tuned(
        &self,
        making: &Making<'_>,
        start: Vec<f64>,
        observed: &FrameLikelihood,
        stage: Stage,
    ) -> Result<Option<StepSize>, Error> {
        if making.latent.is_some() {
            return self.method.tuned(making, start, observed, stage);
        }
        let filter =
            HmcFilter::new(self.method.with_steps(making.setup), making.transition.clone(), start, making.isa)?;
        let limits = self.limits(making)?;
        let tuned = filter.tune(&Restrained(Sum(observed, &limits)), &self.method.tuning(), stage)?;
        Ok(Some(StepSize { step_size: tuned.step_size, leapfrog_steps: tuned.leapfrog_steps }))
    }
}
