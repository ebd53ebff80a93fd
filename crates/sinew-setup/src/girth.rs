//! Girths of the subject, as the set-up stores them.

use serde::{Deserialize, Serialize};
use sinew_observe::silhouettes::girth::Girth;

/// Factors on the radii of the usual body, with what they make of masks that were held out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredGirth {
    /// Torso, pelvis, spine, neck and head.
    pub trunk: f64,
    /// Upper arms, forearms and hands.
    pub arms: f64,
    /// Thighs, shins and feet.
    pub legs: f64,
    /// Intersection over union of the body and the held-out masks, with usual radii and with these.
    pub held_out_iou: [f64; 2],
}

/// Factors beyond which a person is none.
const PLAUSIBLE: [f64; 2] = [0.3, 3.0];

impl MeasuredGirth {
    /// The factors.
    #[must_use]
    pub const fn girth(&self) -> Girth {
        Girth { trunk: self.trunk, arms: self.arms, legs: self.legs }
    }

    /// What cannot be about them, if anything.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let [least, most] = PLAUSIBLE;
        let factors = [("trunk", self.trunk), ("arms", self.arms), ("legs", self.legs)];
        let (name, found) = factors.into_iter().find(|(_, factor)| !(least..=most).contains(factor))?;
        Some(format!("girth: {name} = {found}; must be from {least} to {most}"))
    }
}
