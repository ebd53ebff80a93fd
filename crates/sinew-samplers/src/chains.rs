//! Many Hamiltonian chains on one target: blocks of eight in parallel, all kept draws in one compact set.
//!
//! Every chain makes R updates from its start s^(0); the samples r = 0 … b − 1 are discarded (b = 6 in Choo & Fleet 2001), so M chains leave M (R + 1 − b) draws. Draw r of chain i has index (r − b) M + i and lies in lane
//! index mod 8 of block index / 8. Blocks have their own random streams; nothing depends on the number of threads.
//!
//! Starts come in blocks of eight, the last one padded, or one chain a block in its first lane: a density of single states then costs one evaluation a step and not eight, and chains run on all threads.

use crate::Error;
use crate::diagnostics::{effective_sample_size, energy_fraction, split_r_hat};
use crate::hmc::{Chains, Hmc, Update, Workspace, update};
use rayon::prelude::*;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::Stage;

/// What is known of one draw of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChainStat {
    /// Log density of the target.
    pub log_density: f64,
    /// Probability with which the trajectory was accepted; 1 for a start.
    pub acceptance: f64,
    /// Factor of the step size in this trajectory (jitter).
    pub step_factor: f64,
    /// Whether it diverged.
    pub divergent: bool,
    /// Hamiltonian of the draw; of a start its potential.
    pub energy: f64,
    /// Gradients that the trajectory took; 0 for a start.
    pub leapfrog_steps: u32,
    /// Doublings of a no-U-turn tree that were kept; 0 elsewhere.
    pub depth: u32,
}

/// How long chains run and what is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// Updates R of each chain.
    pub updates: usize,
    /// Samples b ≤ R to discard, the start included.
    pub burn_in: usize,
}

/// Kept draws of all chains.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChainDraws {
    /// Dimension of the state.
    pub dim: usize,
    /// Number of chains M.
    pub chains: usize,
    /// The draws, blocks of `dim`.
    pub states: Vec<Block>,
    /// One entry a draw.
    pub stats: Vec<ChainStat>,
    /// Last states of the chains, blocks of `dim`; lanes beyond `chains` mean nothing.
    pub last: Vec<Block>,
    /// Mean acceptance probability of all trajectories, discarded ones included.
    pub acceptance: f64,
    /// Divergent trajectories.
    pub divergences: usize,
}

impl ChainDraws {
    /// Values of one coordinate: one series a chain.
    #[must_use]
    pub fn series(&self, coordinate: usize) -> Vec<Vec<f64>> {
        (0..self.chains).map(|chain| self.chain(chain, coordinate).collect()).collect()
    }

    /// Values of one coordinate in one chain.
    fn chain(&self, chain: usize, coordinate: usize) -> impl Iterator<Item = f64> {
        let value = move |index: usize| self.states[index / LANES * self.dim + coordinate].0[index % LANES];
        (chain..self.stats.len()).step_by(self.chains).map(value)
    }

    /// Effective number of draws, the least over coordinates.
    pub(crate) fn least_effective(&self) -> f64 {
        (0..self.dim).map(|j| effective_sample_size(&self.series(j))).fold(f64::INFINITY, f64::min)
    }

    /// The draws of some of the chains from draw `first` on, in the order of `chosen`; acceptance and divergences are the kept draws' own, and there are no last states.
    #[must_use]
    pub fn select(&self, chosen: &[usize], first: usize) -> Self {
        let (dim, chains) = (self.dim, chosen.len());
        let count = (self.stats.len() / self.chains.max(1)).saturating_sub(first) * chains;
        let from = |draw: usize| (first + draw / chains) * self.chains + chosen[draw % chains];
        let mut states = vec![Block::ZERO; count.div_ceil(LANES) * dim];
        for draw in 0..count {
            for j in 0..dim {
                states[draw / LANES * dim + j].0[draw % LANES] =
                    self.states[from(draw) / LANES * dim + j].0[from(draw) % LANES];
            }
        }
        let stats: Vec<ChainStat> = (0..count).map(|draw| self.stats[from(draw)]).collect();
        let acceptance = stats.iter().map(|stat| stat.acceptance).sum::<f64>() / stats.len().max(1) as f64;
        let divergences = stats.iter().filter(|stat| stat.divergent).count();
        Self { dim, chains, states, stats, last: Vec::new(), acceptance, divergences }
    }
}

/// How well the draws represent their target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainQuality {
    /// Effective number of draws, the least over coordinates.
    pub ess: f64,
    /// Split R̂ over the chains, the largest over coordinates; NaN where it does not exist.
    pub r_hat: f64,
    /// Effective number of draws for second moments: that of the squared deviations, averaged over coordinates.
    pub ess_of_squares: f64,
    /// E-BFMI (Betancourt 2016), the mean over the chains: how far a fresh momentum moves the energy. Small where chains do not reach the tails.
    pub energy_fraction: f64,
}

impl ChainDraws {
    /// Diagnostics of the draws about their mean.
    #[must_use]
    pub fn quality(&self, mean: &[f64]) -> ChainQuality {
        let kept = self.stats.len() / self.chains.max(1);
        let coordinate = |values: &mut Vec<f64>, j: usize| {
            values.clear();
            (0..self.chains).for_each(|chain| values.extend(self.chain(chain, j)));
            let series: Vec<&[f64]> = values.chunks_exact(kept.max(1)).collect();
            let (ess, r_hat) = (effective_sample_size(&series), split_r_hat(&series));
            values.iter_mut().for_each(|x| *x = (*x - mean[j]) * (*x - mean[j]));
            let series: Vec<&[f64]> = values.chunks_exact(kept.max(1)).collect();
            (ess, r_hat, effective_sample_size(&series))
        };
        let all: Vec<(f64, f64, f64)> = (0..mean.len()).into_par_iter().map_init(Vec::new, coordinate).collect();
        ChainQuality {
            ess: all.iter().map(|found| found.0).fold(f64::INFINITY, f64::min),
            r_hat: all.iter().map(|found| found.1).fold(f64::NAN, f64::max),
            ess_of_squares: all.iter().map(|found| found.2 / self.dim as f64).sum(),
            energy_fraction: self.energy_fraction(),
        }
    }

    fn energy_fraction(&self) -> f64 {
        let fraction = |i: usize| {
            let energies: Vec<f64> = self.stats.iter().skip(i).step_by(self.chains).map(|stat| stat.energy).collect();
            energy_fraction(&energies)
        };
        (0..self.chains).map(fraction).sum::<f64>() / self.chains as f64
    }
}

/// A block of eight chains that has run.
pub(crate) struct Lockstep {
    /// Kept states, blocks of the target's dimension.
    pub(crate) kept: Vec<Block>,
    /// For every sample, the start included, its log density and the update that led there.
    pub(crate) log: Vec<(Block, Option<Update>)>,
    /// Last states.
    pub(crate) last: Vec<Block>,
}

fn lockstep<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    start: &[Block],
    schedule: Schedule,
    stage: &Stage,
    block: usize,
) -> Result<Lockstep, Error> {
    let mut rng = stage.block(block as u32);
    let mut chains = Chains::new(target, start.to_vec())?;
    let mut ws = Workspace::new(target);
    let mut kept = Vec::with_capacity((schedule.updates + 1 - schedule.burn_in) * start.len());
    let mut log = Vec::with_capacity(schedule.updates + 1);
    for r in 0..=schedule.updates {
        let moved = (r > 0).then(|| update(target, hmc, &mut chains, &mut ws, &mut rng));
        log.push((chains.log_density, moved));
        if r >= schedule.burn_in {
            kept.extend_from_slice(&chains.position);
        }
    }
    Ok(Lockstep { kept, log, last: chains.position })
}

/// Runs `chains` chains from `starts` (blocks of the target's dimension; every lane must hold a state of finite log density, idle ones too).
///
/// # Errors
/// [`Error::Empty`], [`Error::OutOfRange`] for a schedule that keeps nothing, [`Error::BadStart`].
pub fn draw_trajectories<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    starts: &[Block],
    chains: usize,
    schedule: Schedule,
    stage: &Stage,
) -> Result<ChainDraws, Error> {
    ChainRun::new(target, hmc, starts, chains, schedule, stage)?.draws(schedule.burn_in)
}

/// Chains that can be continued.
pub struct ChainRun {
    dim: usize,
    chains: usize,
    /// What has run, and what was discarded at first.
    schedule: Schedule,
    blocks: Vec<Lockstep>,
}

impl ChainRun {
    /// Runs chains as [`draw_trajectories`] does.
    ///
    /// # Errors
    /// As [`draw_trajectories`].
    pub fn new<T: GradLogDensity + ?Sized>(
        target: &T,
        hmc: &Hmc,
        starts: &[Block],
        chains: usize,
        schedule: Schedule,
        stage: &Stage,
    ) -> Result<Self, Error> {
        let dim = target.dim();
        let run = |start: &[Block], block| lockstep(target, hmc, start, schedule, stage, block);
        let blocks = run_blocks(dim, starts, chains, schedule, run)?;
        Ok(Self { dim, chains, schedule, blocks })
    }

    /// Runs every chain on for `updates` more; the stage must be another one.
    ///
    /// # Errors
    /// [`Error::BadStart`] for a target that is 0 where a chain stands, as the one that it has run on is not.
    pub fn resume<T: GradLogDensity + ?Sized>(
        &mut self,
        target: &T,
        hmc: &Hmc,
        updates: usize,
        stage: &Stage,
    ) -> Result<(), Error> {
        // Sample 0 is where the chain stands, which has been counted.
        let schedule = Schedule { updates, burn_in: 1 };
        self.schedule.updates += updates;
        self.blocks.par_iter_mut().enumerate().try_for_each(|(block, run)| {
            let Lockstep { kept, log, last } = lockstep(target, hmc, &run.last, schedule, stage, block)?;
            run.kept.extend(kept);
            run.log.extend(log.into_iter().skip(1));
            run.last = last;
            Ok(())
        })
    }

    /// The draws without the first `burn_in` samples of each chain.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where nothing is left, or for fewer samples than the first schedule discarded.
    pub fn draws(&self, burn_in: usize) -> Result<ChainDraws, Error> {
        let schedule = Schedule { burn_in, ..self.schedule };
        check(schedule)?;
        if burn_in < self.schedule.burn_in {
            let (name, value, expected) =
                ("burn-in", burn_in as f64, "must not be less than what was discarded before");
            return Err(Error::OutOfRange { name, value, expected });
        }
        Ok(gather(self.dim, self.chains, schedule, &self.blocks))
    }
}

/// Refuses a schedule that keeps nothing.
fn check(schedule: Schedule) -> Result<(), Error> {
    if schedule.burn_in > schedule.updates {
        let (name, value) = ("burn-in", schedule.burn_in as f64);
        return Err(Error::OutOfRange { name, value, expected: "must not exceed the number of updates" });
    }
    Ok(())
}

/// Chains of one block: eight, or one where there is a block for each.
pub(crate) fn width(blocks: usize, chains: usize) -> usize {
    if blocks == chains { 1 } else { LANES }
}

/// Chains of the block with this number.
pub(crate) fn active(blocks: usize, chains: usize, block: usize) -> usize {
    let width = width(blocks, chains);
    (chains - block * width).min(width)
}

/// Runs every block of starts.
pub(crate) fn run_blocks<B: Send>(
    dim: usize,
    starts: &[Block],
    chains: usize,
    schedule: Schedule,
    run: impl Fn(&[Block], usize) -> Result<B, Error> + Sync,
) -> Result<Vec<B>, Error> {
    if chains == 0 || dim == 0 || starts.len() != chains.div_ceil(width(starts.len() / dim, chains)) * dim {
        return Err(Error::Empty { count: chains, dim });
    }
    check(schedule)?;
    starts.par_chunks(dim).enumerate().map(|(block, start)| run(start, block)).collect()
}

/// The draws of all blocks after those that the schedule discards.
pub(crate) fn gather(dim: usize, chains: usize, schedule: Schedule, runs: &[Lockstep]) -> ChainDraws {
    let per_chain = schedule.updates + 1 - schedule.burn_in;
    let count = chains * per_chain;
    let mut states = vec![Block::ZERO; count.div_ceil(LANES) * dim];
    let mut stats = Vec::with_capacity(count);
    let first = runs.first().map_or(0, |run| run.log.len() - run.kept.len() / dim);
    let (mut acceptance, mut divergences) = (0.0, 0);
    let width = width(runs.len(), chains);
    for r in 0..=schedule.updates {
        for chain in 0..chains {
            let (run, lane) = (&runs[chain / width], chain % width);
            let (log_density, moved) = (run.log[r].0.0[lane], run.log[r].1.as_ref());
            let divergent = moved.is_some_and(|m| m.divergent[lane]);
            acceptance += moved.map_or(0.0, |m| m.acceptance.0[lane]);
            divergences += usize::from(divergent);
            if r < schedule.burn_in {
                continue;
            }
            let index = stats.len();
            let old = &run.kept[(r - first) * dim..][..dim];
            for (new, old) in states[index / LANES * dim..].iter_mut().zip(old) {
                new.0[index % LANES] = old.0[lane];
            }
            let start = ChainStat {
                acceptance: 1.0,
                step_factor: 1.0,
                energy: -log_density,
                log_density,
                ..ChainStat::default()
            };
            stats.push(moved.map_or(start, |m| m.stat(lane, log_density)));
        }
    }
    let last = runs.iter().flat_map(|run| run.last.iter().copied()).collect();
    acceptance /= (chains * schedule.updates.max(1)) as f64;
    ChainDraws { dim, chains, states, stats, last, acceptance, divergences }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{Lanes, LogDensity};
    use sinew_core::lanes::Isa;
    use sinew_core::toy::Quadratic;

    #[test]
    fn draws_are_compact_and_counted() {
        let leaf = Quadratic { centre: vec![0.0, 3.0], precision: vec![1.0, 1.0] };
        let target = Lanes { leaf, isa: Isa::best() };
        let hmc = Hmc::new(0.9, &[1.0, 1.0], 3, 0.2, Isa::best()).expect("valid");
        let starts = vec![Block::ZERO; 4];
        let schedule = Schedule { updates: 9, burn_in: 6 };
        let draws = draw_trajectories(&target, &hmc, &starts, 10, schedule, &Stage::new(1, "compact")).expect("valid");
        assert_eq!((draws.stats.len(), draws.states.len(), draws.last.len()), (40, 10, 4));
        let series: Vec<_> = (0..2).map(|j| draws.series(j)).collect();
        for (index, stat) in draws.stats.iter().enumerate() {
            let state = [series[0][index % 10][index / 10], series[1][index % 10][index / 10]];
            assert!((target.log_density(&state) - stat.log_density).abs() < 1e-13);
            assert!(stat.energy >= -stat.log_density && stat.acceptance <= 1.0 && !stat.divergent);
        }
        let fraction = |i: usize| {
            let energies: Vec<f64> = draws.stats.iter().skip(i).step_by(10).map(|stat| stat.energy).collect();
            energy_fraction(&energies) / 10.0
        };
        let expected: f64 = (0..10).map(fraction).sum();
        assert!((draws.quality(&[0.0, 3.0]).energy_fraction - expected).abs() < 1e-12);
        for (chain, series) in series[1].iter().enumerate() {
            assert_eq!(series[3], draws.last[chain / 8 * 2 + 1].0[chain % 8]);
        }
        let run = ChainRun::new(&target, &hmc, &starts, 10, schedule, &Stage::new(1, "compact")).expect("valid");
        assert_eq!(run.draws(6).expect("valid"), draws);
        for burn_in in [5, 10] {
            assert!(matches!(run.draws(burn_in), Err(Error::OutOfRange { name: "burn-in", .. })), "{burn_in}");
        }
        let none =
            draw_trajectories(&target, &hmc, &starts, 10, Schedule { updates: 5, burn_in: 6 }, &Stage::new(1, "none"));
        assert!(matches!(none, Err(Error::OutOfRange { name: "burn-in", .. })));
        assert!(matches!(
            draw_trajectories(&target, &hmc, &starts, 17, schedule, &Stage::new(1, "few")),
            Err(Error::Empty { count: 17, dim: 2 })
        ));
    }
}
