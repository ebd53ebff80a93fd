//! The pose near a known one in which a body covers masks best.
//!
//! ```text
//! min_q  (1 − IoU(q)) / s + ½ Σ_j ((q_j − start_j) / sd_j)²,   s = 0.001
//! ```
//!
//! IoU is the intersection over union of body and masks over all cameras, as for girths; it is a step function of the pose and has no gradient. The search is that of Hooke & Jeeves (J. ACM 8, 1961), with
//! eight poses judged at a time:
//!
//! 1. *Explore*: for each coordinate j try q_j ± r sd_j {1, ½, ¼, ⅛}; the best of them is kept where it costs less.
//! 2. *Move*: try the change of the whole sweep again, times ¼ … 8: coordinates that must move together are followed so.
//! 3. After a sweep that gained less than half a unit of cost, or the most sweeps that were allowed, take the next reach r.
//!
//! A local search: a limb that masks show elsewhere, farther than a few standard deviations, is not found.

use crate::silhouettes::bit_image::Overlap;
use crate::silhouettes::girth::{IOU_SCALE, intersection_over_union};
use crate::silhouettes::image_likelihood::ImageLikelihood;
use sinew_core::lanes::{Block, LANES};

/// A pose with what it makes of the masks.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskPose {
    /// State of the body.
    pub state: Vec<f64>,
    /// What was minimised.
    pub cost: f64,
}

/// Steps of a coordinate, in its reach.
const STEPS: [f64; LANES] = [1.0, -1.0, 0.5, -0.5, 0.25, -0.25, 0.125, -0.125];
/// Factors on the change of a sweep.
const MOVES: [f64; LANES] = [0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0];
/// Cost that a sweep must gain to be followed by another of the same reach.
const LEAST_GAIN: f64 = 0.5;

/// How far and how long is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Reaches r, in standard deviations, one after the other.
    pub reaches: &'static [f64],
    /// Sweeps of a reach at most.
    pub sweeps: usize,
}

impl Effort {
    /// From a pose of which only the start is known.
    pub const AFRESH: Self = Self { reaches: &[1.0, 0.5, 0.25, 0.125], sweeps: 12 };
    /// From a pose that was fitted to a body that is hardly thicker or thinner.
    pub const AGAIN: Self = Self { reaches: &[0.5, 0.25], sweeps: 3 };
}

/// Costs of eight states.
struct Cost<'a> {
    likelihood: &'a ImageLikelihood,
    start: &'a [f64],
    sd: &'a [f64],
}

impl Cost<'_> {
    fn of(&self, x: &[Block]) -> [f64; LANES] {
        let mut sums = [Overlap::default(); LANES];
        self.likelihood.overlaps_block(x, |_, overlaps| {
            sums.iter_mut().zip(overlaps).for_each(|(sum, overlap)| *sum = [*sum, *overlap].into_iter().sum());
        });
        std::array::from_fn(|i| {
            let off = |((x, start), sd): ((&Block, &f64), &f64)| ((x.0[i] - start) / sd).powi(2);
            let prior = 0.5 * x.iter().zip(self.start).zip(self.sd).map(off).sum::<f64>();
            (1.0 - intersection_over_union(sums[i])) / IOU_SCALE + prior
        })
    }

    /// Tries eight changes of a pose; the best is taken where it costs less.
    fn try_eight(&self, found: &mut MaskPose, change: impl Fn(usize, usize) -> f64) {
        let x: Vec<Block> = found
            .state
            .iter()
            .enumerate()
            .map(|(j, q)| Block(std::array::from_fn(|lane| q + change(lane, j))))
            .collect();
        let costs = self.of(&x);
        let best = (0..LANES).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or_default();
        if costs[best] < found.cost {
            found.cost = costs[best];
            found.state.iter_mut().zip(&x).for_each(|(q, x)| *q = x.0[best]);
        }
    }
}

/// The pose about `start`, from which it is some standard deviations `sd` away; the search begins at `from`. All three in state order, metres and radians.
#[must_use]
pub fn fit_pose_to_masks(likelihood: &ImageLikelihood, [start, sd, from]: [&[f64]; 3], effort: Effort) -> MaskPose {
    let cost = Cost { likelihood, start, sd };
    let mut found = MaskPose { state: from.to_vec(), cost: f64::INFINITY };
    cost.try_eight(&mut found, |_, _| 0.0);
    for &reach in effort.reaches {
        for _ in 0..effort.sweeps {
            let before = found.clone();
            for (j, sd) in sd.iter().enumerate() {
                cost.try_eight(&mut found, |lane, k| if k == j { reach * sd * STEPS[lane] } else { 0.0 });
            }
            let change: Vec<f64> = found.state.iter().zip(&before.state).map(|(now, then)| now - then).collect();
            cost.try_eight(&mut found, |lane, k| MOVES[lane] * change[k]);
            if before.cost - found.cost < LEAST_GAIN {
                break;
            }
        }
    }
    found
}
