//! Which settings change nothing beside the other settings of a run, and because of which one.
//!
//! Only a part of this follows from the list of methods: a method's own settings ([`About::settings`]) are idle with every other method. All other conditions are written out in [`idle_beside`], some of them in terms of what the chosen
//! method is ([`About`]): a setting that is common to all methods needs a line there.

use super::values::SettingValues;
use crate::methods::{About, Gives, LatentUse};

/// The setting beside which another one is idle, in words; `None` for one that counts.
#[must_use]
pub fn idle_beside(key: &str, chosen: &About, methods: &[&'static About], values: &SettingValues) -> Option<String> {
    let is = |key: &str, value: &str| values.text(key).as_deref() == Some(value);
    let owner = methods.iter().find(|about| about.settings.iter().any(|setting| setting.key == key));
    match key {
        "particles" if chosen.particles.is_none() => Some(format!("`--method {}`", chosen.name)),
        "min_ess" if chosen.gives == Gives::Chains => Some(format!("`--method {}`", chosen.name)),
        "prior" | "max_r_hat" | "max_r_hat_share" | "max_divergent_share" if chosen.gives != Gives::Chains => {
            Some(format!("`--method {}`", chosen.name))
        }
        "images" | "mask_scale" | "score" | "kappa" | "raster" if values.get("silhouettes").is_none() => {
            Some("no `--silhouettes`".to_owned())
        }
        "images" | "score" | "kappa" if chosen.needs_gradients => Some(format!("`--method {}`", chosen.name)),
        "latent" if chosen.latent == LatentUse::No => Some(format!("`--method {}`", chosen.name)),
        "prior" | "joint_limits" if values.get("latent").is_some() => Some("`--latent`".to_owned()),
        "motion_scale" if values.get("motion_model").is_some() => Some("`--motion-model`".to_owned()),
        "degrees" if is("noise", "floor") => Some("`--noise floor`".to_owned()),
        "outlier" if is("noise", "student-t") => Some("`--noise student-t`".to_owned()),
        "people" if values.get("person").is_some() => Some("`--person`".to_owned()),
        "people" if values.get("silhouettes").is_some() => Some("`--silhouettes`".to_owned()),
        "setup_frames" | "people" if values.get("setup").is_some() => Some("`--setup`".to_owned()),
        _ => match owner {
            Some(owner) if owner.name != chosen.name && owner.gives == Gives::Chains => {
                Some(format!("`--method {}`", chosen.name))
            }
            Some(owner) if owner.name != chosen.name => Some(format!("a method other than `{}`", owner.name)),
            _ => None,
        },
    }
}
