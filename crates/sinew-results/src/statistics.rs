//! Running sums over the frames of a run, for its summary.
//!
//! Read at its end from the diagnostics of its frames ([`super::journal`]). What is said of them stands in [`run_warnings`].

mod run_warnings;

use super::summary::{AnglesSummary, CameraSummary, Diagnostics, Ending, R_HAT_NOTED, SCHEMA_VERSION, Spread, Summary};
use super::texts::Texts;
use crate::estimate::{EstimateKind, FrameEstimate, RunInfo};
use sinew_angles::AngleZero;
use sinew_body::Point;
use sinew_core::estimators::quantile;
use sinew_setup::uncertainty::{Uncertainty, uncertainty};

/// E-BFMI below which chains are said not to reach the tails (the Stan developers' bound).
const ENERGY_FRACTION_NEEDED: f64 = 0.3;

/// Share of particles off the manifold of learned poses above which a frame is named.
const OFF_MANIFOLD_USUAL: f64 = 0.5;

/// Running sums over the frames.
pub(crate) struct Statistics {
    texts: Texts,
    frames: u64,
    first: Option<u64>,
    last: u64,
    observed: u64,
    restarted: u64,
    unobserved: Vec<[u64; 2]>,
    unobserved_spans: u64,
    in_span: bool,
    // Four bytes a number and frame are kept for the quantiles.
    r_hat: Vec<f32>,
    r_hat_frames: Vec<u32>,
    energy_fraction: Vec<f32>,
    energy_frames: Vec<u32>,
    divergent_frames: Vec<u32>,
    off_manifold: Vec<f32>,
    off_manifold_frames: Vec<u32>,
    ess: Vec<f32>,
    acceptance: [f64; 2],
    divergences: u64,
    trajectories: u64,
    log_evidence: Option<f64>,
    residual_px: Vec<Vec<f32>>,
    /// Variance of each point, the sum over axes and frames.
    variances: Vec<f64>,
    particles: bool,
}

/// Spans without observation that are listed.
const SPANS_LISTED: usize = 5;

impl Statistics {
    pub(crate) fn new(info: &RunInfo, texts: Texts) -> Self {
        Self {
            texts,
            frames: 0,
            first: None,
            last: 0,
            observed: 0,
            restarted: 0,
            unobserved: Vec::new(),
            unobserved_spans: 0,
            in_span: false,
            r_hat: Vec::new(),
            r_hat_frames: Vec::new(),
            energy_fraction: Vec::new(),
            energy_frames: Vec::new(),
            divergent_frames: Vec::new(),
            off_manifold: Vec::new(),
            off_manifold_frames: Vec::new(),
            ess: Vec::new(),
            acceptance: [0.0; 2],
            divergences: 0,
            trajectories: 0,
            log_evidence: None,
            residual_px: vec![Vec::new(); info.cameras.len()],
            variances: vec![0.0; info.body.points().len()],
            particles: info.is_weighted,
        }
    }

    pub(crate) fn add(&mut self, estimate: &FrameEstimate) {
        self.restarted += u64::from(estimate.restarted && self.first.is_some());
        self.first.get_or_insert(estimate.number);
        if estimate.observed {
            self.observed += 1;
        } else if self.in_span {
            if self.unobserved_spans <= SPANS_LISTED as u64
                && let Some([_, last]) = self.unobserved.last_mut()
            {
                *last = estimate.number;
            }
        } else {
            self.unobserved_spans += 1;
            if self.unobserved.len() < SPANS_LISTED {
                self.unobserved.push([estimate.number; 2]);
            }
        }
        self.in_span = !estimate.observed;
        self.frames += 1;
        self.last = estimate.number;
        self.ess.push(estimate.ess as f32);
        if let Some(r_hat) = estimate.r_hat {
            self.r_hat.push(r_hat as f32);
            self.r_hat_frames.push(estimate.number as u32);
        }
        if let Some(fraction) = estimate.energy_fraction {
            self.energy_fraction.push(fraction as f32);
            if fraction < ENERGY_FRACTION_NEEDED {
                self.energy_frames.push(estimate.number as u32);
            }
        }
        if estimate.divergences > 0 {
            self.divergent_frames.push(estimate.number as u32);
        }
        if let Some(share) = estimate.off_manifold {
            self.off_manifold.push(share as f32);
            if share > OFF_MANIFOLD_USUAL {
                self.off_manifold_frames.push(estimate.number as u32);
            }
        }
        if let Some(acceptance) = estimate.acceptance {
            self.acceptance = [self.acceptance[0] + acceptance, self.acceptance[1] + 1.0];
        }
        self.divergences += estimate.divergences;
        self.trajectories += estimate.trajectories;
        if let Some(evidence) = estimate.log_evidence {
            *self.log_evidence.get_or_insert(0.0) += evidence;
        }
        for (all, point) in self.variances.iter_mut().zip(&estimate.points) {
            *all += point.sd.iter().map(|sd| sd * sd).sum::<f64>();
        }
        for (all, residual) in self.residual_px.iter_mut().zip(&estimate.residual_px) {
            all.extend(residual.map(|residual| residual as f32));
        }
    }

    fn diagnostics(&self) -> Diagnostics {
        let [sum, count] = self.acceptance;
        let r_hat = quantiles(&self.r_hat, [0.5, 0.95]).map(|[median, p95]| Spread {
            median,
            p95,
            frames_above_1_05: above(&self.r_hat, R_HAT_NOTED),
        });
        let ess = quantiles(&self.ess, [0.5, 0.0]);
        Diagnostics {
            acceptance: (count > 0.0).then(|| sum / count),
            r_hat,
            energy_fraction: quantiles(&self.energy_fraction, [0.5]).map(|[median]| median),
            off_manifold: quantiles(&self.off_manifold, [0.5]).map(|[median]| median),
            ess_median: ess.map(|[median, _]| median),
            ess_least: ess.map(|[_, least]| least),
            divergences: self.divergences,
            trajectories: self.trajectories,
            log_evidence: self.log_evidence,
        }
    }

    /// Numbers of the frames whose R-hat is above a limit.
    fn above(&self, limit: f64) -> Vec<u32> {
        let high = self.r_hat.iter().zip(&self.r_hat_frames).filter(|(r_hat, _)| is_above(**r_hat, limit));
        high.map(|(_, &number)| number).collect()
    }

    fn residuals(&self) -> Vec<Option<f64>> {
        self.residual_px.iter().map(|all| quantiles(all, [0.5]).map(|[median]| median)).collect()
    }

    /// What the uncertainty of the run comes from.
    fn uncertainty(&self, info: &RunInfo) -> Option<Uncertainty> {
        let of = |(point, sum): (&Point, &f64)| (point.name.clone(), sum / self.frames as f64);
        let variances: Vec<_> = info.body.points().iter().zip(&self.variances).map(of).collect();
        let variances: Vec<_> = variances.iter().map(|(name, variance)| (name.as_str(), *variance)).collect();
        uncertainty(&info.sources, &variances, info.kind != EstimateKind::Filtered)
    }

    /// What is said of the angles, which were not seen in a number of frames each.
    fn angles(&self, info: &RunInfo, unseen: &[u64]) -> AnglesSummary {
        let share = |count: &u64| *count as f64 / self.frames.max(1) as f64;
        let unseen = info.angles.names().iter().zip(unseen).filter(|(_, count)| **count > 0);
        let zero = |zero: &AngleZero| {
            let of = |(k, name): (usize, &String)| (name.clone(), [zero.means[k], zero.sd(k)].map(f64::to_degrees));
            info.angles.names().iter().enumerate().map(of).filter(|(_, [_, sd])| *sd > 0.0).collect()
        };
        AnglesSummary {
            convention: info.angles.convention().name(),
            unseen: unseen.map(|(name, count)| (name.clone(), share(count))).collect(),
            zero_deg: info.zero.as_ref().map(zero).unwrap_or_default(),
        }
    }

    pub(crate) fn summary(self, info: &RunInfo, ending: &Ending, unseen: &[u64]) -> Summary {
        let names = info.cameras.iter().map(|camera| camera.name.clone());
        let cameras = names.zip(self.residuals()).enumerate().map(|(i, (name, residual_px))| CameraSummary {
            name,
            frames: self.residual_px[i].len() as u64,
            residual_px,
            offset_px: info.camera_offset_px.get(i).copied().unwrap_or_default(),
            silhouettes: ending.coverage.get(i).copied(),
        });
        let mut warnings = ending.warnings.clone();
        warnings.extend(self.warnings(info, !ending.coverage.is_empty()));
        Summary {
            schema_version: SCHEMA_VERSION,
            complete: ending.complete,
            sinew_version: env!("CARGO_PKG_VERSION"),
            method: info.method.clone(),
            kind: info.kind.name(),
            seed: info.seed,
            identity: ending.identity.clone(),
            isa: info.isa.clone(),
            fps: info.fps,
            frames: match self.first {
                Some(first) => [first, self.last + 1],
                None => [info.first_frame; 2],
            },
            frame_count: self.frames,
            observed_frames: self.observed,
            restarted_frames: self.restarted,
            skipped_frames: ending.skipped_frames,
            degrees_of_freedom: info.body.dof(),
            world: info.world.clone(),
            angles: self.angles(info, unseen),
            cameras: cameras.collect(),
            diagnostics: self.diagnostics(),
            uncertainty: self.uncertainty(info),
            failed_diagnostics: self.failed(&ending.limits),
            warnings,
            input_hashes: ending.input_hashes.clone(),
            settings: self.texts.settings,
            settings_hash: self.texts.settings_hash,
        }
    }
}

fn above(values: &[f32], limit: f64) -> u64 {
    values.iter().filter(|value| is_above(**value, limit)).count() as u64
}

/// Whether a value is above a limit, or none at all.
fn is_above(value: f32, limit: f64) -> bool {
    f64::from(value) > limit || value.is_nan()
}

/// Quantiles; none of nothing.
fn quantiles<const N: usize>(values: &[f32], at: [f64; N]) -> Option<[f64; N]> {
    let mut rising: Vec<f64> = values.iter().copied().map(f64::from).collect();
    rising.sort_by(f64::total_cmp);
    (!rising.is_empty()).then(|| at.map(|p| quantile(&rising, p)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_angles::{Convention, JointAngles};
    use sinew_observe::Camera;

    fn info(is_weighted: bool) -> RunInfo {
        let camera = Camera::look_at("C1", [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        RunInfo {
            method: "toy".into(),
            is_weighted,
            kind: Default::default(),
            zero: None,
            world: None,
            fps: 30.0,
            first_frame: 10,
            draws: 1,
            carried: Default::default(),
            acting_parts: vec![],
            seed: 1,
            isa: "baseline".into(),
            cameras: vec![camera],
            has_masks: false,
            keypoints: vec!["Nose".into()],
            camera_offset_px: vec![[0.0; 2]],
            sigma_px: 4.0,
            sources: vec![],
            setup_toml: String::new(),
            angles: JointAngles::new(&sinew_setup::bodies::find("cf28").unwrap(), &[], false, Convention::OpenSim),
            body: sinew_setup::bodies::find("cf28").unwrap(),
        }
    }

    /// Warnings and failed diagnostics of frames with the numbers 10, 11, …
    fn judged(is_weighted: bool, frames: impl IntoIterator<Item = FrameEstimate>) -> (Vec<String>, Vec<String>) {
        let info = info(is_weighted);
        let mut statistics = Statistics::new(&info, Texts::default());
        for (number, frame) in (10..).zip(frames) {
            statistics.add(&FrameEstimate { number, ..frame });
        }
        let summary = statistics.summary(&info, &Ending::default(), &[]);
        (summary.warnings, summary.failed_diagnostics)
    }

    fn usual() -> FrameEstimate {
        let residual_px = vec![Some(4.0)];
        FrameEstimate {
            observed: true,
            ess: 40.0,
            r_hat: Some(1.01),
            trajectories: 100,
            residual_px,
            ..FrameEstimate::default()
        }
    }

    #[test]
    fn restarts_are_warned_of_when_they_are_many() {
        let with = |restarts: usize| {
            judged(false, (0..20).map(move |i| FrameEstimate { restarted: i <= restarts, ..usual() }))
        };
        // The first frame always begins.
        assert_eq!(with(2), (vec![], vec![]));
        let (warnings, _) = with(3);
        assert_eq!(
            warnings,
            [
                "tracking was restarted in 3 of 20 frames: each of these starts from a fit of that frame alone (`restarted` in frames.csv)"
            ]
        );
    }

    #[test]
    fn spans_without_observation_and_large_residuals_are_reported() {
        let frame = |i: u64| FrameEstimate {
            observed: !matches!(i, 3 | 5..8),
            residual_px: vec![(i > 2).then_some(12.5)],
            ..usual()
        };
        let (warnings, _) = judged(false, (0..12).map(frame));
        let expected = [
            "frame 13: no observation in any camera; estimates come from the motion model only",
            "frames 15-17: no observation in any camera; estimates come from the motion model only",
            "C1: residual of 12.5 px, more than three times the noise of 4.0 px",
        ];
        assert_eq!(warnings, expected);
        let (warnings, _) = judged(false, (0..12).map(|i| FrameEstimate { observed: i % 2 == 1, ..usual() }));
        assert_eq!((warnings.len(), warnings[5].as_str()), (6, "1 more spans without observation"));
        let unseen = |i: u64| FrameEstimate { observed: i > 8, residual_px: vec![None], ..usual() };
        let (warnings, failed) = judged(false, (0..10).map(unseen));
        assert_eq!((warnings[1].as_str(), failed.len()), ("C1: the person was found in none of 10 frames", 0));
        let (_, failed) = judged(false, (0..5).map(unseen));
        assert_eq!(failed, ["no camera saw the person in any of 5 frames"]);
    }

    #[test]
    fn frames_whose_energies_move_slowly_or_diverge_are_named() {
        let slow = |i: u64| FrameEstimate { energy_fraction: Some(if i < 2 { 0.1 } else { 0.9 }), ..usual() };
        let (warnings, failed) = judged(false, (0..20).map(slow));
        assert_eq!(
            warnings,
            [
                "E-BFMI is below 0.3 in 2 of 20 frames (10, 11): the chains may not reach the tails, the intervals there may be too narrow; try more updates"
            ]
        );
        assert!(failed.is_empty());
        let diverged = |i: u64| FrameEstimate { divergences: if i == 4 { 50 } else { 0 }, ..usual() };
        let (_, failed) = judged(false, (0..20).map(diverged));
        assert_eq!(
            failed,
            ["50 of 2000 trajectories diverged (in frames 14): the intervals may be wrong there; at most 1 % may"]
        );
    }

    #[test]
    fn frames_off_the_manifold_are_named() {
        let frame = |i: u64| FrameEstimate { off_manifold: Some(if i < 2 { 0.51 } else { 0.5 }), ..usual() };
        let (warnings, failed) = judged(false, (0..20).map(frame));
        assert_eq!(
            warnings,
            [
                "more than half of the particles are where the latent model knows no pose in 2 of 20 frames (10, 11): the motion is not what the model was learned from, or the person is lost"
            ]
        );
        assert!(failed.is_empty());
    }

    #[test]
    fn each_diagnostic_fails_beyond_its_limit() {
        let frames = |high: usize| {
            (0..40).map(move |i| FrameEstimate { r_hat: Some(if i < high { 1.2 } else { 1.0 }), ..usual() })
        };
        assert_eq!(judged(false, frames(2)).1, Vec::<String>::new());
        assert_eq!(
            judged(false, frames(3)).1,
            [
                "split R-hat is above 1.05 in 3 of 40 frames (10, 11, 12): the chains disagree, do not trust the intervals there; at most 5 % may be"
            ]
        );
        let diverging = (0..4).map(|_| FrameEstimate { divergences: 2, ..usual() });
        assert_eq!(
            judged(false, diverging).1,
            [
                "8 of 400 trajectories diverged (in frames 10, 11, 12, 13): the intervals may be wrong there; at most 1 % may"
            ]
        );
        let few = || (0..4).map(|_| FrameEstimate { ess: 9.4, ..usual() });
        let message = "the median effective sample size is 9.4; at least 10 is needed";
        assert_eq!((judged(false, few()).1, judged(true, few()).1), (vec![], vec![message.to_owned()]));
    }

    /// Of four frames two show nobody: an angle that is unseen in three is unseen in three of four.
    #[test]
    fn shares_are_of_all_frames() {
        let info = info(false);
        let mut statistics = Statistics::new(&info, Texts::default());
        (10..14).for_each(|number| statistics.add(&FrameEstimate { number, observed: number < 12, ..usual() }));
        let mut unseen = vec![0; info.angles.names().len()];
        unseen[1] = 3;
        let found = statistics.summary(&info, &Ending::default(), &unseen).angles.unseen;
        assert_eq!(found.into_iter().collect::<Vec<_>>(), [(info.angles.names()[1].clone(), 0.75)]);
    }

    /// Two draws at 1° and 3°: 2° ± 1°.
    #[test]
    fn the_zero_of_a_standing_trial_is_in_degrees() {
        let mut info = info(false);
        let name = info.angles.names().iter().rfind(|name| sinew_angles::zero::has_zero(name)).unwrap().clone();
        let drawn = [1.0_f64, 3.0].map(f64::to_radians);
        info.zero = Some(AngleZero::new(&info.angles, std::slice::from_ref(&name), &drawn, None));
        let found = Statistics::new(&info, Texts::default()).summary(&info, &Ending::default(), &[]).angles.zero_deg;
        let [mean, sd] = found[&name];
        assert!(found.len() == 1 && (mean - 2.0).abs() < 1e-9 && (sd - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_least_effective_sample_size_is_that_of_one_frame() {
        let info = info(false);
        let mut statistics = Statistics::new(&info, Texts::default());
        (0..41).for_each(|k| statistics.add(&FrameEstimate { number: k, ess: 7.0 + k as f64, ..usual() }));
        let found = statistics.summary(&info, &Ending::default(), &[]).diagnostics;
        assert_eq!((found.ess_least, found.ess_median), (Some(7.0), Some(27.0)));
    }
}
