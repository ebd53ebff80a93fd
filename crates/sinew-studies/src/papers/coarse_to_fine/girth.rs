//! How thick the tracker's body is: two girths, both settled on training motion.
//!
//! - *Printed*: one factor on all radii, such that recall over precision of the true pose is that of the paper's tables. That is the area of the projected body over the area of the silhouette.
//! - *Fitted*: a factor for trunk, arms and legs each, by [`fit_girth`] on masks of the first second.
//!
//! Persons, errors of segmentation and camera are the study's own.

use crate::support::outcome::Outcome;
use sinew::body::KinematicTree;
use sinew::body::hppf24;
use sinew::observe::silhouettes::girth::{Girth, Sight, before_cameras, fit_girth, mask_overlap};
use sinew_body::points::Trajectories;
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::Level;

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thickness {
    Printed,
    Fitted,
}

/// Both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Girths {
    pub(super) printed: Girth,
    pub(super) fitted: Girth,
    /// Intersection over union on the first second of training, with the radii as they are and as fitted.
    pub(super) iou: [f64; 2],
    /// Recall over precision of the true pose with the radii as they are.
    pub(super) ratio: f64,
}

/// Recall over precision in the paper's tables.
const PRINTED_RATIO: f64 = 1.19;
/// Persons that training shows.
const PERSONS: u64 = 3;
/// Frames from one that is compared to the next.
const EVERY: usize = 12;
/// Frames of the first second that are compared.
const SECOND: std::ops::Range<usize> = 0..6;
/// Halvings of the bracket of the printed girth.
const HALVINGS: usize = 12;

impl Girths {
    pub(super) const fn of(&self, thickness: Thickness) -> Girth {
        match thickness {
            Thickness::Printed => self.printed,
            Thickness::Fitted => self.fitted,
        }
    }

    /// Girths of the body `tree` of a scale along a training motion with fitted `states`, seen by the camera number `camera` of the ring.
    pub(super) fn new(
        tree: &KinematicTree,
        scale: f64,
        motion: &Trajectories,
        states: &[Vec<f64>],
        rate_hz: f64,
        camera: usize,
    ) -> Outcome<Self> {
        let (mut sights, mut seen_by) = (vec![], vec![]);
        for person in 1..=PERSONS {
            let footage = SyntheticFootage::new(motion.clone(), rate_hz, &Ring::SMALL_PICTURES, person)?;
            seen_by = vec![footage.cameras[camera].clone()];
            let sight = |(frame, state): (usize, &Vec<f64>)| {
                let mask = footage.mask(camera, frame, Level::Normal);
                Sight { state: state.clone(), silhouettes: vec![Some(mask)] }
            };
            sights.push(states.iter().enumerate().step_by(EVERY).map(sight).collect::<Vec<_>>());
        }
        let flesh = hppf24::cylinders(scale);
        let first: Vec<Sight> =
            sights.iter().flat_map(|person| &person[SECOND.start..SECOND.end.min(person.len())]).cloned().collect();
        let fitted = fit_girth(tree, &flesh, &seen_by, &first)?;
        let all = sights.concat();
        let ratio = |factor: f64| -> Outcome<f64> {
            let same = Girth { trunk: factor, arms: factor, legs: factor };
            let model = before_cameras(tree, &same.applied(&flesh), &seen_by)?;
            let area = |sight| {
                let counts = mask_overlap(&model, sight);
                let [body, mask] = [counts.both + counts.second_only, counts.both + counts.first_only];
                body as f64 / mask.max(1) as f64
            };
            Ok(all.iter().map(area).sum::<f64>() / all.len() as f64)
        };
        let [mut low, mut high] = [0.5, 4.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *if ratio(middle)? < PRINTED_RATIO { &mut low } else { &mut high } = middle;
        }
        let printed = 0.5 * (low + high);
        let printed = Girth { trunk: printed, arms: printed, legs: printed };
        Ok(Self { printed, fitted: fitted.girth, iou: fitted.iou, ratio: ratio(1.0)? })
    }
}
