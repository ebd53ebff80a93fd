//! Which settings change nothing beside the other settings of a run, and because of which one.
//!
//! Only a part of this follows from the list of methods: a method's own settings ([`About::settings`]) are idle with every other method. All other conditions are written out in [`idle_beside`], some of them in terms of what the chosen
//! method is ([`About`]): a setting that is common to all methods needs a line there.

use super::common::*;
use super::setting::SettingValues;
use crate::input::flag::{flag, flag_with};
use crate::methods::hmc::JOINT_LIMITS;
use crate::methods::{About, Gives, LatentUse};

/// The setting beside which another one is idle, in words; `None` for one that counts.
#[must_use]
pub fn idle_beside(key: &str, chosen: &About, methods: &[&'static About], values: &SettingValues) -> Option<String> {
    let method = flag_with("method", chosen.name);
    let (chains, masks) = (chosen.gives == Gives::Chains, values.of(&SILHOUETTES).is_some());
    let of_chains = [PRIOR.key, MAX_R_HAT.key, MAX_R_HAT_SHARE.key, MAX_DIVERGENT_SHARE.key];
    let of_masks = [IMAGES.key, MASK_SCALE.key, SCORE.key, KAPPA.key, RASTER.key];
    // Settings, when they are idle, and beside what; the first one that holds is named.
    let idle: [(&[&str], bool, String); 13] = [
        (&[PARTICLES.key], chosen.particles.is_none(), method.clone()),
        (&[MIN_ESS.key], chains, method.clone()),
        (&of_chains, !chains, method.clone()),
        (&of_masks, !masks, format!("no {}", flag(SILHOUETTES.key))),
        (&[IMAGES.key, SCORE.key, KAPPA.key], chosen.needs_gradients, method.clone()),
        (&[LATENT.key], chosen.latent == LatentUse::No, method.clone()),
        (&[PRIOR.key, JOINT_LIMITS.key], values.of(&LATENT).is_some(), flag(LATENT.key)),
        (&[MOTION_SCALE.key], values.of(&MOTION_MODEL).is_some(), flag(MOTION_MODEL.key)),
        (&[DEGREES.key], values.of(&NOISE) == NoiseShape::Floor, flag_with(NOISE.key, "floor")),
        (&[OUTLIER.key], values.of(&NOISE) == NoiseShape::StudentT, flag_with(NOISE.key, "student-t")),
        (&[PEOPLE.key], values.of(&PERSON).is_some(), flag(PERSON.key)),
        (&[PEOPLE.key], masks, flag(SILHOUETTES.key)),
        (&[SETUP_FRAMES.key, PEOPLE.key], values.of(&SETUP).is_some(), flag(SETUP.key)),
    ];
    if let Some((_, _, beside)) = idle.into_iter().find(|(keys, is_idle, _)| *is_idle && keys.contains(&key)) {
        return Some(beside);
    }
    let owner = methods.iter().find(|about| about.settings.iter().any(|setting| setting.row().key == key))?;
    match owner.gives {
        _ if owner.name == chosen.name => None,
        Gives::Chains => Some(method),
        _ => Some(format!("a method other than `{}`", owner.name)),
    }
}
