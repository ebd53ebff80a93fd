//! Many no-U-turn chains on one target: blocks of eight in parallel, a fixed number of transitions each.

use super::step::step;
use super::transition::{Nuts, TreeTransition};
use super::trees::Trees;
use crate::Error;
use crate::chains::{ChainDraws, Lockstep, Schedule, active, gather, run_blocks, width};
use crate::dual_averaging::DualAveraging;
use crate::hmc::Update;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::{BlockRng, Stage};

/// Draws of all chains with what their trees were like.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeRun {
    /// Kept draws.
    pub draws: ChainDraws,
    /// Transitions by depth, discarded ones included: `depths[k]` kept k doublings.
    pub depths: Vec<usize>,
    /// Gradients of all chains.
    pub leapfrog_steps: usize,
    /// Calls of the gradient of eight lanes; where lanes end together, an eighth of the above.
    pub block_gradients: usize,
}

impl TreeRun {
    /// Mean depth of a tree.
    #[must_use]
    pub fn mean_depth(&self) -> f64 {
        let sum: usize = self.depths.iter().enumerate().map(|(depth, count)| depth * count).sum();
        sum as f64 / self.depths.iter().sum::<usize>().max(1) as f64
    }
}

/// Trees of one block.
struct Forest {
    chains: Lockstep,
    depths: Vec<usize>,
    leapfrog_steps: usize,
    block_gradients: usize,
}

impl Forest {
    fn take(&mut self, trees: &Trees, lane: usize, r: usize, burn_in: usize, tree: &TreeTransition) {
        self.depths[tree.depth] += 1;
        self.leapfrog_steps += tree.leapfrog_steps;
        let (log_density, update) = &mut self.chains.log[r];
        log_density.0[lane] = trees.log_density().0[lane];
        let update = update.get_or_insert(Update {
            acceptance: Block::ZERO,
            accepted: [false; LANES],
            divergent: [false; LANES],
            energy: Block::ZERO,
            factor: Block::ZERO,
            leapfrog_steps: [0; LANES],
            depth: [0; LANES],
        });
        update.acceptance.0[lane] = tree.acceptance;
        update.accepted[lane] = tree.moved;
        update.divergent[lane] = tree.divergent;
        update.energy.0[lane] = tree.energy;
        update.factor.0[lane] = tree.factor;
        update.leapfrog_steps[lane] = tree.leapfrog_steps as u32;
        update.depth[lane] = tree.depth as u32;
        if r >= burn_in {
            let position = trees.position();
            let kept = &mut self.chains.kept[(r - burn_in) * position.len()..][..position.len()];
            for (kept, x) in kept.iter_mut().zip(position) {
                kept.0[lane] = x.0[lane];
            }
        }
    }
}

/// Grows the trees of one block; `after` hears of every transition that is complete.
fn grow<T: GradLogDensity + ?Sized>(
    target: &T,
    nuts: &Nuts,
    mut trees: Trees,
    active: usize,
    schedule: Schedule,
    rng: &mut BlockRng,
    mut after: impl FnMut(&mut Trees, usize, &TreeTransition),
) -> Forest {
    let Schedule { updates, burn_in } = schedule;
    let start = trees.position();
    let mut kept = vec![Block::ZERO; (updates + 1 - burn_in) * start.len()];
    if burn_in == 0 {
        kept[..start.len()].copy_from_slice(start);
    }
    let log = vec![(*trees.log_density(), None); updates + 1];
    let chains = Lockstep { kept, log, last: Vec::new() };
    let mut forest = Forest { chains, depths: vec![0; nuts.max_depth + 1], leapfrog_steps: 0, block_gradients: 0 };
    let mut complete = [0; LANES];
    let mut running: [bool; LANES] = std::array::from_fn(|lane| lane < active && updates > 0);
    while running.contains(&true) {
        forest.block_gradients += 1;
        for (lane, tree) in step(target, nuts, &mut trees, &running, rng).iter().enumerate() {
            if let Some(tree) = tree {
                complete[lane] += 1;
                running[lane] = complete[lane] < updates;
                forest.take(&trees, lane, complete[lane], burn_in, tree);
                after(&mut trees, lane, tree);
            }
        }
    }
    forest.chains.last = trees.position().to_vec();
    forest
}

/// Runs `chains` chains from `starts` (blocks of the target's dimension; every lane must hold a state of finite log density, idle ones too); every chain makes as many transitions.
///
/// # Errors
/// [`Error::Empty`], [`Error::OutOfRange`] for a schedule that keeps nothing, [`Error::BadStart`].
pub fn draw_trees<T: GradLogDensity + ?Sized>(
    target: &T,
    nuts: &Nuts,
    starts: &[Block],
    chains: usize,
    schedule: Schedule,
    stage: &Stage,
) -> Result<TreeRun, Error> {
    let dim = target.dim();
    let forests = run_blocks(dim, starts, chains, schedule, |start, block| {
        let active = active(starts.len() / dim, chains, block);
        let trees = Trees::new(target, nuts, start.to_vec())?;
        Ok(grow(target, nuts, trees, active, schedule, &mut stage.block(block as u32), |_, _, _| {}))
    })?;
    Ok(collect(dim, chains, schedule, nuts, forests))
}

/// Runs the chains of a warm-up as [`draw_trees`] does, each with a step size of its own, which `search` seeks. Returns the draws and the average step size of every chain, in units of the step size of `nuts`.
///
/// # Errors
/// As [`draw_trees`].
pub fn adapt<T: GradLogDensity + ?Sized>(
    target: &T,
    nuts: &Nuts,
    starts: &[Block],
    chains: usize,
    schedule: Schedule,
    search: DualAveraging,
    stage: &Stage,
) -> Result<(TreeRun, Vec<f64>), Error> {
    let dim = target.dim();
    let adapted = run_blocks(dim, starts, chains, schedule, |start, block| {
        let active = active(starts.len() / dim, chains, block);
        let mut trees = Trees::new(target, nuts, start.to_vec())?;
        trees.scale = Block::splat(search.step_size());
        let mut searches = [search; LANES];
        let after = |trees: &mut Trees, lane: usize, tree: &TreeTransition| {
            searches[lane].update(tree.acceptance);
            trees.scale.0[lane] = searches[lane].step_size();
        };
        let forest = grow(target, nuts, trees, active, schedule, &mut stage.block(block as u32), after);
        Ok((forest, searches))
    })?;
    let (forests, searches): (Vec<Forest>, Vec<_>) = adapted.into_iter().unzip();
    let width = width(starts.len() / dim, chains);
    let step_sizes =
        searches.iter().flat_map(|block| &block[..width]).take(chains).map(DualAveraging::average).collect();
    Ok((collect(dim, chains, schedule, nuts, forests), step_sizes))
}

/// The draws and counts of all blocks.
fn collect(dim: usize, chains: usize, schedule: Schedule, nuts: &Nuts, forests: Vec<Forest>) -> TreeRun {
    let mut depths = vec![0; nuts.max_depth + 1];
    let (mut leapfrog_steps, mut block_gradients, mut runs) = (0, 0, Vec::with_capacity(forests.len()));
    for forest in forests {
        depths.iter_mut().zip(&forest.depths).for_each(|(sum, count)| *sum += count);
        leapfrog_steps += forest.leapfrog_steps;
        block_gradients += forest.block_gradients;
        runs.push(forest.chains);
    }
    TreeRun { draws: gather(dim, chains, schedule, &runs), depths, leapfrog_steps, block_gradients }
}
