//! How thick a person is: girths of trunk, arms and legs from masks of a body in known poses.
//!
//! A girth is a factor on all radii of one kind of solid. One-sided likelihoods make limbs that are too thin free of charge, and those that are too thick wrong wherever they are; so girths are chosen by what both sides of a contour
//! say, the intersection over union (IoU) of body and masks:
//!
//! minimise (1 − IoU) / s + ½ Σ (ln g / σ)², s = 0.001, σ = 0.15,
//!
//! one kind after the other by golden sections. The prior is log-normal: circumferences of thigh, calf, upper arm and waist of 4082 men have coefficients of variation of 8 to 12 % (ANSUR II, Gordon et al. 2014); clothes add to that. Poses stay as they are; where they are known roughly, the module `girth_with_pose` fits both.

use crate::Camera;
use crate::golden_section::golden_section;
use crate::silhouettes::bit_image::{BitImage, Overlap, overlap};
use crate::silhouettes::image_likelihood::ImageModel;
use crate::silhouettes::image_score::ImageScore;
use crate::silhouettes::solid_body::SolidBody;
use sinew_body::flesh::{Flesh, Solid};
use sinew_body::{Error, KinematicTree};
use sinew_core::lanes::Isa;
use std::sync::Arc;

/// A state with what the cameras saw of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    /// State of the body.
    pub state: Vec<f64>,
    /// Masks, in the order and size of the cameras; none where a camera saw nothing.
    pub silhouettes: Vec<Option<BitImage>>,
}

/// Factors on the radii of three kinds of solids; 1 leaves them as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Girth {
    /// Torso, pelvis, spine, neck and head.
    pub trunk: f64,
    /// Upper arms, forearms and hands.
    pub arms: f64,
    /// Thighs, shins and feet.
    pub legs: f64,
}

/// Girths with what they make of the masks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedGirth {
    /// The girths.
    pub girth: Girth,
    /// Intersection over union of body and masks with the radii as they were, and with the girths.
    pub iou: [f64; 2],
}

/// A loss of IoU that makes girths e times less likely: small, so that the prior decides only what masks do not show.
pub(crate) const IOU_SCALE: f64 = 0.001;
/// Standard deviation of the logarithm of a girth before anything is seen.
pub(crate) const LOG_SD: f64 = 0.15;
/// Kinds of solids that have a girth of their own.
pub(crate) const KINDS: usize = 3;
/// Half widths of the brackets of each round, in logarithms.
const ROUNDS: [f64; 3] = [0.6, 0.2, 0.05];
/// Steps of a golden section: its bracket becomes 47 times narrower.
const STEPS: usize = 8;
/// Parts of names by which solids of arms and of legs are known.
const LIMBS: [&[&str]; 2] = [&["arm", "hand"], &["thigh", "shin", "foot", "leg"]];

impl Default for Girth {
    fn default() -> Self {
        Self { trunk: 1.0, arms: 1.0, legs: 1.0 }
    }
}

impl Girth {
    /// The factor of a solid, by its name.
    #[must_use]
    pub fn of(&self, solid: &Solid) -> f64 {
        let is_of = |names: &[&str]| names.iter().any(|name| solid.name.contains(name));
        if is_of(LIMBS[0]) {
            self.arms
        } else if is_of(LIMBS[1]) {
            self.legs
        } else {
            self.trunk
        }
    }

    /// Solids with these girths.
    #[must_use]
    pub fn applied(&self, flesh: &Flesh) -> Flesh {
        flesh.with_radii(|solid| [self.of(solid); 2])
    }
}

/// A body before cameras, to be compared with masks.
///
/// # Errors
/// Solids that do not belong to the tree.
pub fn before_cameras(tree: &KinematicTree, flesh: &Flesh, cameras: &[Camera]) -> Result<ImageModel, Error> {
    Ok(ImageModel {
        body: Arc::new(SolidBody::new(tree, flesh)?),
        cameras: cameras.to_vec(),
        score: ImageScore::Parts,
        colours: Arc::default(),
        isa: Isa::baseline(),
    })
}

/// Pixels of the masks (first) and of the body in those cameras (second), by who has them.
#[must_use]
pub fn mask_overlap(model: &ImageModel, sight: &Sight) -> Overlap {
    let bodies = model.silhouettes(&sight.state);
    let pairs = bodies.iter().zip(&sight.silhouettes).filter_map(|(body, mask)| Some((body, mask.as_ref()?)));
    pairs.map(|(body, mask)| overlap(mask, body, 0..mask.width())).sum()
}

/// Intersection over union; 0 where neither has a pixel.
#[must_use]
pub fn intersection_over_union(Overlap { both, first_only, second_only }: Overlap) -> f64 {
    both as f64 / (both + first_only + second_only).max(1) as f64
}

/// Girths with which a body in known states fits masks; `cameras` have perfect lenses and the size of the masks.
///
/// # Errors
/// As [`before_cameras`].
pub fn fit_girth(
    tree: &KinematicTree,
    flesh: &Flesh,
    cameras: &[Camera],
    sights: &[Sight],
) -> Result<FittedGirth, Error> {
    let iou = |logs: &[f64; KINDS]| {
        let model = before_cameras(tree, &from_logs(logs).applied(flesh), cameras)?;
        Ok(intersection_over_union(sights.iter().map(|sight| mask_overlap(&model, sight)).sum()))
    };
    let cost = |logs: &[f64; KINDS]| {
        let prior = 0.5 * logs.iter().map(|log| (log / LOG_SD).powi(2)).sum::<f64>();
        Ok((1.0 - iou(logs)?) / IOU_SCALE + prior)
    };
    let mut logs = [0.0; KINDS];
    let mut least: f64 = cost(&logs)?;
    for reach in ROUNDS {
        for kind in 0..logs.len() {
            let from = logs;
            let with = |step: f64| {
                let mut logs = from;
                logs[kind] += step;
                logs
            };
            let (step, found) = golden_section([-reach, reach], STEPS, |step| cost(&with(step)))?;
            if found < least {
                (least, logs) = (found, with(step));
            }
        }
    }
    Ok(FittedGirth { girth: from_logs(&logs), iou: [iou(&[0.0; KINDS])?, iou(&logs)?] })
}

pub(crate) fn to_logs(Girth { trunk, arms, legs }: &Girth) -> [f64; KINDS] {
    [trunk, arms, legs].map(|factor| factor.ln())
}

pub(crate) fn from_logs(logs: &[f64; KINDS]) -> Girth {
    let [trunk, arms, legs] = logs.map(f64::exp);
    Girth { trunk, arms, legs }
}
