//! From a step of a tracker to what is written of it.

use super::marginals::{Described, Marginals};
use super::scene::Scene;
use crate::config::settings::Settings;
use crate::results::estimate::{ActionShare, Draws, FrameEstimate, HmcStatistics, ParticleStatistics, Quality};
use sinew_core::random::Stage;
use sinew_dynamics::primitives::switching::Choice;
use sinew_tracking::StepInfo;
use sinew_tracking::moved::{EqualDraws, Moved};
use sinew_tracking::posterior::Posterior;

/// A step of the tracker.
pub(super) struct Stepped {
    /// Number of the frame.
    pub number: u64,
    /// What the tracker says.
    pub info: StepInfo,
    /// Where its draws go.
    pub moved: Option<Moved>,
    /// [`FrameEstimate::moves`].
    pub moves: Vec<f64>,
    /// Cameras whose masks show the person.
    pub silhouettes: usize,
}

/// Turns a step into what is written of it.
pub(super) fn describe(
    settings: &Settings,
    scene: &Scene,
    marginals: &mut Marginals,
    step: Stepped,
    posterior: &Posterior<'_>,
) -> FrameEstimate {
    let Stepped { number, info, moved, moves, silhouettes } = step;
    let stage = Stage::new(settings.seed, "thin").at_frame(number as u32);
    let kept = posterior.equal_weight(settings.draws, &mut stage.whole());
    let mut states = vec![0.0; kept.len() * posterior.dim];
    for (state, &index) in states.chunks_exact_mut(posterior.dim).zip(&kept) {
        posterior.state(index, state);
    }
    let stats = |index: &usize| posterior.chain_stats.get(*index);
    let chosen: Vec<_> = kept.iter().filter_map(stats).collect();
    let hmc = (!chosen.is_empty()).then(|| HmcStatistics {
        acceptance_rate: chosen.iter().map(|s| s.acceptance).collect(),
        step_size: chosen.iter().map(|s| s.step_factor * scene.step_size()).collect(),
        n_steps: vec![scene.leapfrog_steps(); chosen.len()],
        diverging: chosen.iter().map(|s| s.divergent).collect(),
        energy: chosen.iter().map(|s| s.energy).collect(),
    });
    let particles = posterior.chain_stats.is_empty().then(|| particles(posterior, &info));
    let Spread { mean_state, shape, detected, described } =
        spread(settings, scene, marginals, (number, &info.mean), posterior, (&mut states, moved.as_ref()));
    let Described { points, keypoints, state } = described;
    let size = marginals.size_draws(&mut states, posterior.dim);
    let cameras = scene.cameras_with_person().max(silhouettes);
    FrameEstimate {
        number,
        restarted: info.restarted,
        time_s: number as f64 / settings.fps,
        observed: cameras > 0,
        quality: match cameras {
            0 => Quality::Predicted,
            1 => Quality::OneCamera,
            _ => Quality::Good,
        },
        residual_px: scene.residual_px(&info.mean),
        seen: scene.seen(),
        mean_state,
        moves,
        missing: moved.map_or_else(Vec::new, |moved| moved.missing),
        points,
        keypoints,
        state,
        draws: Draws { states, shape, detected, size, lp: chosen.iter().map(|s| s.log_density).collect(), hmc },
        particles,
        actions: actions(&info.choices),
        ess: info.ess,
        log_evidence: info.log_evidence,
        r_hat: info.r_hat,
        energy_fraction: info.energy_fraction,
        acceptance: info.acceptance,
        off_manifold: info.off_manifold,
        divergences: info.divergences as u64,
        trajectories: info.trajectories as u64,
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
}

/// Mean, marginals and kept draws, moved where there is something to move them by.
fn spread(
    settings: &Settings,
    scene: &Scene,
    marginals: &mut Marginals,
    (number, mean): (u64, &[f64]),
    posterior: &Posterior<'_>,
    (kept, moved): (&mut [f64], Option<&Moved>),
) -> Spread {
    let Some(moved) = moved else {
        let described = marginals.of(posterior, None);
        return Spread { mean_state: mean.to_vec(), shape: vec![], detected: vec![], described };
    };
    moved.apply(kept);
    let [shape, detected] = moved.written(scene.points_of(kept), kept.len() / posterior.dim);
    let rng = &mut Stage::new(settings.seed, "equal weight").at_frame(number as u32).whole();
    let EqualDraws { states, weights } = moved.equal_draws(posterior, rng);
    let equal = Posterior { states: &states, weights: &weights, chain_stats: &[], ..*posterior };
    let described = marginals.of(&equal, Some(moved));
    let mean_state = mean.iter().zip(moved.mean()).map(|(x, by)| x + by).collect();
    Spread { mean_state, shape, detected, described }
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
