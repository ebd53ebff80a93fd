//! Which settings change nothing beside the other settings of a run, and because of which one.
//!
//! Only a part of this follows from the list of methods: a method's own settings ([`About::settings`]) are idle with every other method. All other conditions are written out in [`idle_beside`], some of them in terms of what the chosen
//! method is ([`About`]): a setting that is common to all methods needs a line there.

use super::values::SettingValues;
use crate::input::flag::{flag, flag_with};
use crate::methods::{About, Gives, LatentUse};

/// The setting beside which another one is idle, in words; `None` for one that counts.
#[must_use]
pub fn idle_beside(key: &str, chosen: &About, methods: &[&'static About], values: &SettingValues) -> Option<String> {
    let is = |key: &str, value: &str| values.text(key).as_deref() == Some(value);
    let owner = methods.iter().find(|about| about.settings.iter().any(|setting| setting.key == key));
    match key {
        "particles" if chosen.particles.is_none() => Some(flag_with("method", chosen.name)),
        "min_ess" if chosen.gives == Gives::Chains => Some(flag_with("method", chosen.name)),
        "prior" | "max_r_hat" | "max_r_hat_share" | "max_divergent_share" if chosen.gives != Gives::Chains => {
            Some(flag_with("method", chosen.name))
        }
        "images" | "mask_scale" | "score" | "kappa" | "raster" if values.get("silhouettes").is_none() => {
            Some(format!("no {}", flag("silhouettes")))
        }
        "images" | "score" | "kappa" if chosen.needs_gradients => Some(flag_with("method", chosen.name)),
        "latent" if chosen.latent == LatentUse::No => Some(flag_with("method", chosen.name)),
        "prior" | "joint_limits" if values.get("latent").is_some() => Some(flag("latent")),
        "motion_scale" if values.get("motion_model").is_some() => Some(flag("motion_model")),
        "degrees" if is("noise", "floor") => Some(flag_with("noise", "floor")),
        "outlier" if is("noise", "student-t") => Some(flag_with("noise", "student-t")),
        "people" if values.get("person").is_some() => Some(flag("person")),
        "people" if values.get("silhouettes").is_some() => Some(flag("silhouettes")),
        "setup_frames" | "people" if values.get("setup").is_some() => Some(flag("setup")),
        _ => match owner {
            Some(owner) if owner.name != chosen.name && owner.gives == Gives::Chains => {
                Some(flag_with("method", chosen.name))
            }
            Some(owner) if owner.name != chosen.name => Some(format!("a method other than `{}`", owner.name)),
            _ => None,
        },
    }
}
