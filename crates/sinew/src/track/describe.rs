//! From a step of a tracker to the estimate of its frame that is written.
//!
//! In two parts. The first has what a live run answers at once: marginals of points, keypoints and angles. The second adds the draws and the rates of the
//! angles, and remembers what the next frame needs of this one.

use super::error::TrackError;
use super::lasting::Lasting;
use super::marginals::{Described, Marginals};
use super::noted::Noted;
use crate::Error;
use crate::config::settings::Settings;
use sinew_angles::AngleMarginals;
use sinew_angles::fixed_lag::FixedLag;
use sinew_core::random::Stage;
use sinew_dynamics::primitives::switching::Choice;
use sinew_results::estimate::{ActionShare, Draws, FrameEstimate, HmcStatistics, ParticleStatistics, Quality};
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
    /// Says where a frame's points and angles are; [`Describer::complete`] does the rest.
    pub(super) fn begin(
        &mut self,
        noted: Noted,
        residual_px: Vec<Option<f64>>,
        posterior: &Posterior<'_>,
    ) -> Result<(FrameEstimate, Begun), Error> {
        let moved = self.lasting.as_mut().map(|lasting| lasting.step(&noted, self.settings.seed)).transpose()?;
        let moves = self.lasting.as_ref().map_or_else(Vec::new, Lasting::moves);
        if noted.info.restarted {
            self.lag.restart();
        }
        let mut mean_state = noted.info.mean.clone();
        let rng = || Stage::new(self.settings.seed, "equal weight").at_frame(noted.number as u32).whole();
        let equal = moved.as_ref().map(|moved| moved.equal_draws(posterior, &mut rng()));
        if let Some(moved) = &moved {
            mean_state.iter_mut().zip(moved.mean()).for_each(|(x, by)| *x += by);
        }
        let begun = Begun { info: noted.info.clone(), moved, equal };
        let draws = begun.draws(posterior);
        let described = self.marginals.of(&draws, begun.moved.as_ref());
        let angles = self.angles.without_rates(&mean_state, &draws);
        let estimate = self.estimate(noted, described);
        Ok((FrameEstimate { residual_px, mean_state, moves, angles, ..estimate }, begun))
    }

    /// Adds draws and rates of angles, and takes in the frame for those after it.
    pub(super) fn complete(
        &mut self,
        estimate: &mut FrameEstimate,
        begun: Begun,
        posterior: &Posterior<'_>,
    ) -> Result<(), Error> {
        let number = estimate.number as u32;
        let stage = Stage::new(self.settings.seed, "rates of change").at_frame(number);
        let change = self.lag.change(&begun.draws(posterior), &estimate.moves, stage).map_err(TrackError::Motion)?;
        if let Some(change) = &change {
            self.angles.add_rates(&mut estimate.angles, change, posterior.dim);
        }
        estimate.draws = self.kept(number, begun.moved.as_ref(), posterior);
        estimate.particles = posterior.chain_stats.is_empty().then(|| particles(posterior, &begun.info));
        let drawn = posterior.moments(self.settings.isa);
        estimate.filtered = match &self.lasting {
            Some(lasting) => lasting.filtered(drawn).map_err(TrackError::Motion)?,
            None => drawn,
        };
        Ok(self.lag.push(estimate.filtered.clone(), estimate.moves.clone()).map_err(TrackError::Motion)?)
    }

    /// Some draws of equal weight, moved where there is something to move them by.
    fn kept(&mut self, number: u32, moved: Option<&Moved>, posterior: &Posterior<'_>) -> Draws {
        let stage = Stage::new(self.settings.seed, "thin").at_frame(number);
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
        let written = self.lasting.as_ref().zip(moved).map(|(lasting, moved)| {
            moved.apply(&mut states);
            lasting.written(moved, &states)
        });
        let [shape, detected] = written.unwrap_or_default();
        let size = self.marginals.size_draws(&mut states, posterior.dim);
        Draws { states, shape, detected, size, lp, hmc }
    }

    /// What a step says without its draws.
    fn estimate(&self, noted: Noted, described: Described) -> FrameEstimate {
        let Described { points, keypoints, state } = described;
        let Noted { number, info, shown, silhouettes } = noted;
        let (cameras, seen) = (shown.cameras().max(silhouettes), shown.seen());
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
}

fn particles(posterior: &Posterior<'_>, info: &StepInfo) -> ParticleStatistics {
    let log_weight = posterior.weights.iter().map(|w| w.ln()).collect();
    ParticleStatistics { log_weight, resampled: info.resampled.unwrap_or(false) }
}

/// What completing a frame takes from its beginning.
pub(super) struct Begun {
    info: StepInfo,
    moved: Option<Moved>,
    /// The draws with what is constant in them, of equal weight.
    equal: Option<EqualDraws>,
}

impl Begun {
    fn draws<'a>(&'a self, posterior: &Posterior<'a>) -> Posterior<'a> {
        match &self.equal {
            Some(EqualDraws { states, weights }) => Posterior { states, weights, chain_stats: &[], ..*posterior },
            None => *posterior,
        }
    }
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
