//! Hamiltonian trajectories with jumps.
//!
//! Each update of a chain is one trajectory followed by some independence proposals (Tierney 1994) from a mixture fitted to warm-up draws.
//!
//! A jump proposes y ~ q, whatever the state x is, and accepts it with probability min(1, p(y) q(x) / (p(x) q(y))). It leaves p unchanged for any fixed q. Where q resembles p, one jump in a few is an independent draw
//! and chains go from mode to mode at once; where q is far too thin, a chain would wait for ever, and there the trajectories carry it on (Gabrié, Rotskoff & Vanden-Eijnden 2022 do so with
//! a flow). q must be fixed before the kept draws are made, and comes from draws that are thrown away.
//!
//! A proposal costs a gradient, which the next trajectory starts from. It does not depend on the state, so that where fewer than eight chains run, the idle lanes make proposals for them
//! too, one after the other (Jacob, Robert & Smith 2011): one chain alone gets eight jumps at the cost of one.

mod sample;

pub use sample::{Settings, sample};

use crate::Error;
use crate::chains::{ChainDraws, Lockstep, Schedule, active, gather, run_blocks};
use crate::gaussian_mixture::{GaussianMixture, Scratch};
use crate::hmc::{Chains, Hmc, Workspace, update};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::{BlockRng, Stage};

/// The proposal, and how many jumps follow each trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps {
    /// The fixed proposal q.
    pub proposal: GaussianMixture,
    /// Rounds of eight proposals after each trajectory: each is one jump for each of eight chains, eight jumps for one alone.
    pub count: usize,
}

/// Draws of all chains.
#[derive(Clone, Debug, PartialEq)]
pub struct JumpRun {
    /// Kept draws; acceptance and divergences count the trajectories.
    pub draws: ChainDraws,
    /// Mean acceptance probability of the jumps.
    pub acceptance: f64,
}

/// Scratch of [`jump`].
#[derive(Clone, Debug)]
pub struct JumpWorkspace {
    proposed: Vec<Block>,
    gradient: Vec<Block>,
    mixture: Scratch,
    target: Vec<Block>,
}

impl JumpWorkspace {
    /// Scratch for a target and a proposal.
    #[must_use]
    pub fn new<T: GradLogDensity + ?Sized>(target: &T, jumps: &Jumps) -> Self {
        let blocks = vec![Block::ZERO; target.dim()];
        let target = vec![Block::ZERO; target.workspace()];
        Self { proposed: blocks.clone(), gradient: blocks, mixture: jumps.proposal.scratch(), target }
    }
}

/// Eight proposals for the first `active` chains, in turns; `log_weight` holds log p − log q of their states on entry and on return. Returns the acceptance probabilities of the proposals.
pub fn jump<T: GradLogDensity + ?Sized>(
    target: &T,
    proposal: &GaussianMixture,
    chains: &mut Chains,
    active: usize,
    log_weight: &mut Block,
    ws: &mut JumpWorkspace,
    rng: &mut BlockRng,
) -> Block {
    let mut uniform = Block::ZERO;
    rng.fill_uniform(std::slice::from_mut(&mut uniform));
    proposal.sample_block(&mut ws.proposed, &mut ws.mixture, rng);
    let log_q = proposal.log_density_block(&ws.proposed, &mut ws.mixture);
    let log_p = target.log_density_grad_block(&ws.proposed, &mut ws.gradient, &mut ws.target);
    let mut acceptance = Block::ZERO;
    for proposed in 0..LANES {
        let lane = proposed % active.max(1);
        let weight = log_p.0[proposed] - log_q.0[proposed];
        let ratio = (weight - log_weight.0[lane]).exp();
        // NaN is refused.
        acceptance.0[proposed] = if ratio > 0.0 { ratio.min(1.0) } else { 0.0 };
        if uniform.0[proposed] < acceptance.0[proposed] {
            log_weight.0[lane] = weight;
            chains.log_density.0[lane] = log_p.0[proposed];
            for (old, new) in chains.position.iter_mut().zip(&ws.proposed) {
                old.0[lane] = new.0[proposed];
            }
            for (old, new) in chains.gradient.iter_mut().zip(&ws.gradient) {
                old.0[lane] = new.0[proposed];
            }
        }
    }
    acceptance
}

/// Runs `chains` chains from `starts` as [`crate::chains::draw_trajectories`] does, with jumps after each trajectory.
///
/// # Errors
/// [`Error::Empty`], [`Error::OutOfRange`] for a schedule that keeps nothing, [`Error::BadStart`].
pub fn draw_with_jumps<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    jumps: &Jumps,
    starts: &[Block],
    chains: usize,
    schedule: Schedule,
    stage: &Stage,
) -> Result<JumpRun, Error> {
    let dim = target.dim();
    let runs = run_blocks(dim, starts, chains, schedule, |start, block| {
        let active = active(starts.len() / dim, chains, block);
        lockstep(target, hmc, jumps, start, active, schedule, &mut stage.block(block as u32))
    })?;
    let (runs, accepted): (Vec<Lockstep>, Vec<f64>) = runs.into_iter().unzip();
    let count = (accepted.len() * LANES * schedule.updates * jumps.count).max(1);
    let acceptance = accepted.iter().sum::<f64>() / count as f64;
    Ok(JumpRun { draws: gather(dim, chains, schedule, &runs), acceptance })
}

fn lockstep<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    jumps: &Jumps,
    start: &[Block],
    active: usize,
    schedule: Schedule,
    rng: &mut BlockRng,
) -> Result<(Lockstep, f64), Error> {
    let mut chains = Chains::new(target, start.to_vec())?;
    let mut ws = Workspace::new(target);
    let mut jump_ws = JumpWorkspace::new(target, jumps);
    let mut kept = Vec::with_capacity((schedule.updates + 1 - schedule.burn_in) * start.len());
    let mut log = Vec::with_capacity(schedule.updates + 1);
    let mut accepted = 0.0;
    for r in 0..=schedule.updates {
        let moved = (r > 0).then(|| {
            let mut moved = update(target, hmc, &mut chains, &mut ws, rng);
            let before = chains.log_density;
            let mut log_weight = jumps.proposal.log_density_block(&chains.position, &mut jump_ws.mixture);
            for (weight, log_density) in log_weight.0.iter_mut().zip(before.0) {
                *weight = log_density - *weight;
            }
            for _ in 0..jumps.count {
                let (chains, weight, ws) = (&mut chains, &mut log_weight, &mut jump_ws);
                accepted += jump(target, &jumps.proposal, chains, active, weight, ws, rng).0.iter().sum::<f64>();
            }
            // A jump keeps the kinetic energy.
            for lane in 0..LANES {
                moved.energy.0[lane] += before.0[lane] - chains.log_density.0[lane];
            }
            moved
        });
        log.push((chains.log_density, moved));
        if r >= schedule.burn_in {
            kept.extend_from_slice(&chains.position);
        }
    }
    Ok((Lockstep { kept, log, last: chains.position }, accepted))
}
