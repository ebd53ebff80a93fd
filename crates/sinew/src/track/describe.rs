//! From a step of a tracker to what is written of it.

use super::error::TrackError;
use super::lasting::Lasting;
use super::marginals::{Described, Marginals};
use super::noted::Noted;
use crate::Error;
use crate::config::settings::Settings;
use crate::results::estimate::{ActionShare, Draws, FrameEstimate, HmcStatistics, ParticleStatistics, Quality};
use sinew_angles::fixed_lag::FixedLag;
use sinew_angles::{AngleMarginal, AngleMarginals};
use sinew_core::random::Stage;
use sinew_dynamics::primitives::switching::Choice;
use sinew_tracking::StepInfo;
use sinew_tracking::moved::{EqualDraws, Moved};
use sinew_tracking::posterior::Posterior;

/// Describes steps of a tracker, frame after frame.
pub(super) struct Describer {
    pub settings: Settings,
    /// Step size and leapfrog steps of the set-up.
    pub trajectories: (f64, u32),
    pub lasting: Option<Lasting>,
    pub marginals: Marginals,
    pub angles: AngleMarginals,
    pub lag: FixedLag,
}

impl Describer {
    /// Turns a step into what is written of it.
    pub(super) fn describe(
        &mut self,
        noted: Noted,
        residual_px: Vec<Option<f64>>,
        posterior: &Posterior<'_>,
    ) -> Result<FrameEstimate, Error> {
        let moved = self.lasting.as_mut().map(|lasting| lasting.step(&noted)).transpose()?;
        let moves = self.lasting.as_ref().map_or_else(Vec::new, Lasting::moves);
        let stage = Stage::new(self.settings.seed, "thin").at_frame(noted.number as u32);
        let kept = posterior.equal_weight(self.settings.draws, &mut stage.whole());
        let mut states = vec![0.0; kept.len() * posterior.dim];
        for (state, &index) in states.chunks_exact_mut(posterior.dim).zip(&kept) {
            posterior.state(index, state);
        }
        let stats = |index: &usize| posterior.chain_stats.get(*index);
        let chosen: Vec<_> = kept.iter().filter_map(stats).collect();
        let (step_size, leapfrog_steps) = self.trajectories;
        let hmc = (!chosen.is_empty()).then(|| HmcStatistics {
            acceptance_rate: chosen.iter().map(|s| s.acceptance).collect(),
            step_size: chosen.iter().map(|s| s.step_factor * step_size).collect(),
            n_steps: vec![leapfrog_steps; chosen.len()],
            diverging: chosen.iter().map(|s| s.divergent).collect(),
            energy: chosen.iter().map(|s| s.energy).collect(),
        });
        let lp = chosen.iter().map(|s| s.log_density).collect();
        if noted.info.restarted {
            self.lag.restart();
        }
        let Spread { mean_state, shape, detected, described, angles } =
            self.spread(&noted, posterior, (&mut states, moved.as_ref()), &moves)?;
        let size = self.marginals.size_draws(&mut states, posterior.dim);
        let draws = Draws { states, shape, detected, size, lp, hmc };
        let missing = moved.map_or_else(Vec::new, |moved| moved.missing);
        self.lag.push(posterior.moments(self.settings.isa), &missing, moves.clone()).map_err(TrackError::Motion)?;
        let particles = posterior.chain_stats.is_empty().then(|| particles(posterior, &noted.info));
        Ok(FrameEstimate {
            residual_px,
            mean_state,
            moves,
            missing,
            angles,
            draws,
            particles,
            ..self.estimate(noted, described)
        })
    }

    /// What a step says without its draws.
    fn estimate(&self, noted: Noted, described: Described) -> FrameEstimate {
        let Described { points, keypoints, state } = described;
        let (cameras, seen) = (noted.cameras(), noted.seen());
        let Noted { number, info, .. } = noted;
        FrameEstimate {
            number,
            restarted: info.restarted,
            time_s: number as f64 / self.settings.fps,
            observed: cameras > 0,
            quality: match cameras {
                0 => Quality::Predicted,
                1 => Quality::OneCamera,
                _ => Quality::Good,
            },
            seen,
            points,
            keypoints,
            state,
            actions: actions(&info.choices),
            ess: info.ess,
            log_evidence: info.log_evidence,
            r_hat: info.r_hat,
            energy_fraction: info.energy_fraction,
            acceptance: info.acceptance,
            off_manifold: info.off_manifold,
            divergences: info.divergences as u64,
            trajectories: info.trajectories as u64,
            ..FrameEstimate::default()
        }
    }

    /// Mean, marginals and kept draws, moved where there is something to move them by.
    fn spread(
        &mut self,
        noted: &Noted,
        posterior: &Posterior<'_>,
        (kept, moved): (&mut [f64], Option<&Moved>),
        moves: &[f64],
    ) -> Result<Spread, Error> {
        let (mean, number) = (&noted.info.mean, noted.number as u32);
        let Some((lasting, moved)) = self.lasting.as_ref().zip(moved) else {
            let described = self.marginals.of(posterior, None);
            let change = self.lag.change(posterior, &[], number).map_err(TrackError::Motion)?;
            let angles = self.angles.of(mean, posterior, change.as_ref());
            return Ok(Spread { mean_state: mean.clone(), shape: vec![], detected: vec![], described, angles });
        };
        moved.apply(kept);
        let [shape, detected] = lasting.written(moved, kept);
        let rng = &mut Stage::new(self.settings.seed, "equal weight").at_frame(number).whole();
        let EqualDraws { states, weights } = moved.equal_draws(posterior, rng);
        let equal = Posterior { states: &states, weights: &weights, chain_stats: &[], ..*posterior };
        let described = self.marginals.of(&equal, Some(moved));
        let mean_state: Vec<f64> = mean.iter().zip(moved.mean()).map(|(x, by)| x + by).collect();
        let change = self.lag.change(&equal, moves, number).map_err(TrackError::Motion)?;
        let angles = self.angles.of(&mean_state, &equal, change.as_ref());
        Ok(Spread { mean_state, shape, detected, described, angles })
    }
}

fn particles(posterior: &Posterior<'_>, info: &StepInfo) -> ParticleStatistics {
    let log_weight = posterior.weights.iter().map(|w| w.ln()).collect();
    ParticleStatistics { log_weight, resampled: info.resampled.unwrap_or(false) }
}

/// A frame's draws with what is constant in them.
struct Spread {
    mean_state: Vec<f64>,
    shape: Vec<f64>,
    detected: Vec<f64>,
    described: Described,
    angles: Vec<AngleMarginal>,
}

/// The choices of the motion, part by part, by their meaning.
fn actions(choices: &[Vec<(u32, f64)>]) -> Vec<ActionShare> {
    let meaning = |part: usize, number: u32, share: f64| {
        let (cluster, model) = Choice::from_number(number);
        ActionShare { part, cluster, model, share }
    };
    let meanings = |(part, choices): (usize, &Vec<(u32, f64)>)| {
        choices.iter().map(|&(number, share)| meaning(part, number, share)).collect::<Vec<_>>()
    };
    choices.iter().enumerate().flat_map(meanings).collect()
}
