//! `hppf`: the hierarchical partitioned particle filter of Husz, Wallace & Green 2007, a search down the parts of the body.

use super::about::{About, Gives, LatentUse, Making, Method, Steps};
use super::score::Score;
use crate::Error;
use crate::config::common::PARTICLES;
use crate::config::setting::{AnySetting, NamedValues, SAMPLING, SettingValues, Typed, choice};
use crate::setup::Body;
use crate::track::error::TrackError;
use sinew_body::hppf24;
use sinew_dynamics::joint_ranges::JointRanges;
use sinew_dynamics::level_walk::{LevelPrimitives, LevelWalk};
use sinew_tracking::hppf::{self, Config};
use std::sync::Arc;

/// The method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HppfMethod {
    /// Settings of the tracker.
    pub config: Config,
    /// Which action primitives move a part.
    pub primitives: LevelPrimitives,
}

/// Its description.
pub const ABOUT: About = About {
    name: "hppf",
    help: "hierarchical partitioned particle filter, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: true,
    latent: LatentUse::No,
    score: Score::Parts,
    score_beside_keypoints: Score::Parts,
    particles: Some(|| HppfMethod::default().config.particles),
    settings: SETTINGS,
    configure,
    mistake: |_| None,
};

impl NamedValues for LevelPrimitives {
    const NAMES: &'static [&'static str] = &["nested", "own-parts"];
    const ALL: &'static [Self] = &[Self::Nested, Self::OwnParts];
}

#[rustfmt::skip]
const LEVEL_PRIMITIVES: Typed<LevelPrimitives> = choice((SAMPLING, "level_primitives", "NAME", "action primitives that move a part: nested, with all that hangs on it, or own-parts (hppf, with a motion model)")).rare();

const SETTINGS: &[&dyn AnySetting] = &[&LEVEL_PRIMITIVES];

fn configure(values: &SettingValues) -> Arc<dyn Method> {
    let usual = HppfMethod::default();
    let config = Config { particles: values.of(&PARTICLES).unwrap_or(usual.config.particles), ..usual.config };
    Arc::new(HppfMethod { config, primitives: values.of(&LEVEL_PRIMITIVES) })
}

/// First coordinate that is an angle, after the position.
const FIRST_ANGLE: usize = 3;

impl HppfMethod {
    /// The motion of the parts: by action primitives where there are some, else at random.
    fn motion(&self, making: &Making<'_>) -> Result<LevelWalk, Error> {
        let (tree, walk) = (making.parts()?, making.transition);
        let ranges = match making.setup.body {
            Body::HPPF24 => JointRanges::new(hppf24::ranges().to_vec()),
            _ => Ok(JointRanges::none(walk.sd().len())),
        };
        let motion = LevelWalk::new(tree, walk.sd().to_vec(), walk.initial_sd().to_vec(), making.isa)
            .and_then(|motion| motion.with_angles_from(FIRST_ANGLE).with_ranges(ranges?))
            .and_then(|motion| match making.motion_model {
                Some(model) => motion.with_primitives(model, making.dt, self.primitives),
                None => Ok(motion),
            });
        Ok(motion.map_err(TrackError::Motion)?)
    }
}

impl Method for HppfMethod {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn weighted_draws(&self) -> Option<usize> {
        Some(self.config.particles)
    }

    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let tracker = hppf::Hppf::new(self.config.clone(), self.motion(making)?, &making.parts()?, start);
        Ok(Box::new(tracker?))
    }

    fn gives_actions(&self, making: &Making<'_>) -> bool {
        making.motion_model.is_some()
    }

    fn remarks(&self, making: &Making<'_>) -> Vec<String> {
        match making.motion_model {
            Some(_) => vec![],
            None => {
                vec!["`hppf` has no motion model: parts of the body walk at random, without action primitives".into()]
            }
        }
    }
}
