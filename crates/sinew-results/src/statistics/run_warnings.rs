//! What is said of a run at its end: diagnostics that failed, frames without observation, restarts, chains and particles that went astray.

use super::{ENERGY_FRACTION_NEEDED, SPANS_LISTED, Statistics, above, quantiles};
use crate::estimate::RunInfo;
use crate::summary::Limits;

/// Share of frames in which tracking may restart without a warning.
const RESTARTS_USUAL: f64 = 0.1;

/// Frames that are listed.
const FRAMES_LISTED: usize = 8;

/// The first numbers of a list, and how many more there are.
fn listed(frames: &[u32]) -> String {
    let shown = &frames[..frames.len().min(FRAMES_LISTED)];
    let listed = shown.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    match frames.len() - shown.len() {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}

impl Statistics {
    /// Diagnostics that fail.
    pub(super) fn failed(&self, limits: &Limits) -> Vec<String> {
        let mut failed = Vec::new();
        if self.frames > 0 && self.observed == 0 {
            failed.push(format!("no camera saw the person in any of {} frames", self.frames));
        }
        let high = above(&self.r_hat, limits.r_hat);
        if high as f64 > limits.r_hat_share * self.r_hat.len() as f64 {
            failed.push(format!(
                "split R-hat is above {} in {high} of {} frames ({}): the chains disagree, do not trust the intervals there; at most {} % may be",
                limits.r_hat,
                self.r_hat.len(),
                listed(&self.above(limits.r_hat)),
                100.0 * limits.r_hat_share
            ));
        }
        if self.divergences as f64 > limits.divergent_share * self.trajectories as f64 {
            failed.push(format!(
                "{} of {} trajectories diverged (in frames {}): the intervals may be wrong there; at most {} % may",
                self.divergences,
                self.trajectories,
                listed(&self.divergent_frames),
                100.0 * limits.divergent_share
            ));
        }
        if self.particles
            && let Some([median]) = quantiles(&self.ess, [0.5])
            && median < limits.ess
        {
            failed.push(format!("the median effective sample size is {median:.1}; at least {} is needed", limits.ess));
        }
        failed
    }

    /// What is odd and fails nothing.
    pub(super) fn warnings(&self, info: &RunInfo, has_masks: bool) -> Vec<String> {
        let mut warnings = Vec::new();
        for [first, last] in &self.unobserved {
            let which = if first == last { format!("frame {first}") } else { format!("frames {first}-{last}") };
            warnings.push(format!("{which}: no observation in any camera; estimates come from the motion model only"));
        }
        if self.unobserved_spans > SPANS_LISTED as u64 {
            warnings.push(format!("{} more spans without observation", self.unobserved_spans - SPANS_LISTED as u64));
        }
        if self.restarted as f64 > RESTARTS_USUAL * self.frames as f64 {
            let (restarted, frames) = (self.restarted, self.frames);
            warnings.push(format!(
                "tracking was restarted in {restarted} of {frames} frames: each of these starts from a fit of that frame alone (`restarted` in frames.csv)"
            ));
        }
        if !self.energy_frames.is_empty() {
            warnings.push(format!(
                "E-BFMI is below {ENERGY_FRACTION_NEEDED} in {} of {} frames ({}): the chains may not reach the tails, the intervals there may be too narrow; try more updates",
                self.energy_frames.len(),
                self.energy_fraction.len(),
                listed(&self.energy_frames)
            ));
        }
        if !self.off_manifold_frames.is_empty() {
            warnings.push(format!(
                "more than half of the particles are where the latent model knows no pose in {} of {} frames ({}): the motion is not what the model was learned from, or the person is lost",
                self.off_manifold_frames.len(),
                self.off_manifold.len(),
                listed(&self.off_manifold_frames)
            ));
        }
        // Where masks are there and no camera has keypoints, masks are what was observed.
        let are_masks = has_masks && self.residual_px.iter().all(Vec::is_empty);
        for (camera, seen) in info.cameras.iter().zip(&self.residual_px).filter(|_| self.observed > 0) {
            if seen.is_empty() && !are_masks {
                warnings.push(format!("{}: the person was found in none of {} frames", camera.name, self.frames));
            }
        }
        for (camera, residual) in info.cameras.iter().zip(self.residuals()) {
            if let Some(residual) = residual.filter(|&residual| residual > 3.0 * info.sigma_px) {
                let (name, sigma) = (&camera.name, info.sigma_px);
                warnings.push(format!(
                    "{name}: residual of {residual:.1} px, more than three times the noise of {sigma:.1} px"
                ));
            }
        }
        warnings
    }
}
