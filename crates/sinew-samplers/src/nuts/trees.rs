//! Growing trees of eight chains: candidates, ends, open pieces and weights.
//!
//! What happens when a lane arrives at a new state is [`Trees::grow`], steps 1 to 4 of [`crate::nuts`].

use super::transition::{Nuts, TreeTransition};
use crate::Error;
use crate::hmc::kernel::DIVERGENCE;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::BlockRng;

/// Weights are taken relative to another energy where they pass the exponential of this.
const LARGEST_EXPONENT: f64 = 300.0;

/// States with the forces there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct States {
    pub(super) position: Vec<Block>,
    pub(super) force: Vec<Block>,
}

impl States {
    fn copy(&mut self, from: &Self, lane: usize) {
        copy(&mut self.position, &from.position, lane);
        copy(&mut self.force, &from.force, lane);
    }
}

/// An end of the trajectories.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct End {
    pub(super) at: States,
    pub(super) momentum: Vec<Block>,
}

fn copy(to: &mut [Block], from: &[Block], lane: usize) {
    for (to, from) in to.iter_mut().zip(from) {
        to.0[lane] = from.0[lane];
    }
}

fn swap(a: &mut [Block], b: &mut [Block], lane: usize) {
    for (a, b) in a.iter_mut().zip(b) {
        std::mem::swap(&mut a.0[lane], &mut b.0[lane]);
    }
}

/// Whether the piece from the state with momentum `first` to the one with momentum `last` turns; `sum` of momenta up to `last`, `before` of those before `first`.
fn turns(first: &[Block], last: &[Block], sum: &[Block], before: &[Block], lane: usize) -> bool {
    let (mut at_first, mut at_last) = (0.0, 0.0);
    for (((first, last), sum), before) in first.iter().zip(last).zip(sum).zip(before) {
        let (first, last) = (first.0[lane], last.0[lane]);
        let span = sum.0[lane] - before.0[lane] - 0.5 * (first + last);
        at_first += span * first;
        at_last += span * last;
    }
    at_first <= 0.0 || at_last <= 0.0
}

/// Scalars of one lane's tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lane {
    /// Whether a tree is growing.
    pub(super) growing: bool,
    /// H₀, and the energy to which weights are relative.
    initial: f64,
    reference: f64,
    depth: usize,
    /// States of the new half so far.
    leaves: usize,
    weight: f64,
    half_weight: f64,
    /// Energy and log density of the half's candidate.
    half_energy: f64,
    half_log_density: f64,
    energy: f64,
    moved: bool,
    acceptance: f64,
    leapfrog_steps: usize,
    factor: f64,
}

/// Momenta for the next transitions of whichever lanes end first: the columns of one block each.
#[derive(Clone, Debug, PartialEq)]
struct Momenta {
    normal: Vec<Block>,
    uniform: Block,
    used: usize,
}

/// Eight chains and their growing trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Trees {
    /// Candidates: a chain's state wherever its transition is complete.
    candidate: States,
    log_density: Block,
    pub(super) moving: End,
    other: End,
    half_candidate: States,
    sum: Vec<Block>,
    pub(super) half_sum: Vec<Block>,
    /// Momenta and sums before them at the places of the open pieces, d blocks a place.
    opened: Vec<Block>,
    opened_before: Vec<Block>,
    zero: Vec<Block>,
    pub(super) gradient: Vec<Block>,
    pub(super) workspace: Vec<Block>,
    /// Signed factors of the steps; 0 in lanes that stand still.
    pub(super) factor: Block,
    /// What the steps of each lane's next transitions are multiplied with.
    pub(super) scale: Block,
    momenta: Momenta,
    pub(super) lanes: [Lane; LANES],
}

impl Trees {
    /// Evaluates the target at the starting states.
    ///
    /// # Errors
    /// [`Error::BadStart`] where the log density is not finite.
    pub fn new<T: GradLogDensity + ?Sized>(target: &T, nuts: &Nuts, position: Vec<Block>) -> Result<Self, Error> {
        let blocks = vec![Block::ZERO; position.len()];
        let (mut gradient, mut force) = (blocks.clone(), blocks.clone());
        let mut workspace = vec![Block::ZERO; target.workspace()];
        let log_density = target.log_density_grad_block(&position, &mut gradient, &mut workspace);
        if let Some(lane) = log_density.0.iter().position(|l| !l.is_finite()) {
            return Err(Error::BadStart { lane, value: log_density.0[lane] });
        }
        nuts.leapfrog.force(&gradient, &mut force);
        let candidate = States { position, force };
        let end = End { at: candidate.clone(), momentum: blocks.clone() };
        let places = vec![Block::ZERO; nuts.max_depth * blocks.len()];
        Ok(Self {
            half_candidate: candidate.clone(),
            candidate,
            log_density,
            moving: end.clone(),
            other: end,
            sum: blocks.clone(),
            half_sum: blocks.clone(),
            opened: places.clone(),
            opened_before: places,
            zero: blocks.clone(),
            gradient,
            workspace,
            factor: Block::ZERO,
            scale: Block::splat(1.0),
            momenta: Momenta { normal: blocks, uniform: Block::ZERO, used: LANES },
            lanes: [Lane::default(); LANES],
        })
    }

    /// States of the chains, one block a dimension; a lane's is a draw from when `step` reports its transition until the next call.
    #[must_use]
    pub fn position(&self) -> &[Block] {
        &self.candidate.position
    }

    /// Log density of each state.
    #[must_use]
    pub fn log_density(&self) -> &Block {
        &self.log_density
    }

    /// A new momentum for a lane, and the first half of one state.
    pub(super) fn begin(&mut self, nuts: &Nuts, lane: usize, backwards: bool, rng: &mut BlockRng) {
        let Momenta { normal, uniform, used } = &mut self.momenta;
        if *used == LANES {
            rng.fill_normal(nuts.leapfrog.isa(), normal);
            rng.fill_uniform(std::slice::from_mut(uniform));
            *used = 0;
        }
        let mut square = 0.0;
        for (to, from) in self.moving.momentum.iter_mut().zip(&*normal) {
            to.0[lane] = from.0[*used];
            square += from.0[*used] * from.0[*used];
        }
        let factor = self.scale.0[lane] * (1.0 + nuts.jitter * (2.0 * uniform.0[*used] - 1.0));
        *used += 1;
        self.moving.at.copy(&self.candidate, lane);
        self.other.at.copy(&self.candidate, lane);
        copy(&mut self.other.momentum, &self.moving.momentum, lane);
        copy(&mut self.sum, &self.moving.momentum, lane);
        copy(&mut self.half_sum, &self.zero, lane);
        self.factor.0[lane] = if backwards { -factor } else { factor };
        let initial = 0.5 * square - self.log_density.0[lane];
        self.lanes[lane] = Lane {
            growing: true,
            initial,
            reference: initial,
            energy: initial,
            weight: 1.0,
            factor,
            ..Lane::default()
        };
    }

    /// Takes in the state that a lane has arrived at. `choice` is uniform, and so are the leading bits of `whole`, the last of which is a coin.
    pub(super) fn grow(
        &mut self,
        nuts: &Nuts,
        lane: usize,
        arrived: (f64, f64),
        choice: f64,
        whole: f64,
    ) -> Option<TreeTransition> {
        let (log_density, energy) = arrived;
        let tree = &mut self.lanes[lane];
        tree.leapfrog_steps += 1;
        let error = energy - tree.initial;
        if error.is_nan() || error > DIVERGENCE {
            return Some(self.end(lane, true));
        }
        let exponent = tree.reference - energy;
        let weight = if exponent > LARGEST_EXPONENT {
            let smaller = (-exponent).exp();
            tree.weight *= smaller;
            tree.half_weight *= smaller;
            tree.reference = energy;
            1.0
        } else {
            exponent.exp()
        };
        tree.acceptance += if tree.reference == tree.initial { weight.min(1.0) } else { (-error).exp().min(1.0) };
        tree.half_weight += weight;
        if tree.leaves == 0 || choice * tree.half_weight < weight {
            tree.half_energy = energy;
            tree.half_log_density = log_density;
            self.half_candidate.copy(&self.moving.at, lane);
        }
        if self.closes_a_turn(lane) {
            return Some(self.end(lane, false));
        }
        let tree = &mut self.lanes[lane];
        tree.leaves += 1;
        if tree.leaves < 1 << tree.depth {
            return None;
        }
        self.join(lane, whole);
        if self.lanes[lane].depth == nuts.max_depth
            || turns(&self.other.momentum, &self.moving.momentum, &self.sum, &self.zero, lane)
        {
            return Some(self.end(lane, false));
        }
        if coin(whole) != (self.factor.0[lane] < 0.0) {
            self.factor.0[lane] = -self.factor.0[lane];
            swap(&mut self.moving.at.position, &mut self.other.at.position, lane);
            swap(&mut self.moving.at.force, &mut self.other.at.force, lane);
            swap(&mut self.moving.momentum, &mut self.other.momentum, lane);
        }
        None
    }

    /// Joins the new half, which is complete, to the trajectory. `whole` is uniform.
    fn join(&mut self, lane: usize, whole: f64) {
        let tree = &mut self.lanes[lane];
        if whole * tree.weight < tree.half_weight {
            tree.energy = tree.half_energy;
            tree.moved = true;
            self.log_density.0[lane] = tree.half_log_density;
            self.candidate.copy(&self.half_candidate, lane);
        }
        tree.weight += tree.half_weight;
        tree.depth += 1;
        tree.leaves = 0;
        tree.half_weight = 0.0;
        for (sum, half) in self.sum.iter_mut().zip(&mut self.half_sum) {
            sum.0[lane] += half.0[lane];
            half.0[lane] = 0.0;
        }
    }

    /// Opens a piece with the state just reached, or closes the pieces that end with it; whether one of them turns.
    fn closes_a_turn(&mut self, lane: usize) -> bool {
        let Lane { depth, leaves, .. } = self.lanes[lane];
        let d = self.zero.len();
        let top = (leaves >> 1).count_ones() as usize;
        if depth > 0 && leaves % 2 == 0 {
            let place = top * d..(top + 1) * d;
            copy(&mut self.opened[place.clone()], &self.moving.momentum, lane);
            let sums = self.half_sum.iter().zip(&self.moving.momentum);
            for (before, (sum, momentum)) in self.opened_before[place].iter_mut().zip(sums) {
                before.0[lane] = sum.0[lane] - momentum.0[lane];
            }
        }
        let closed = leaves.trailing_ones() as usize;
        (top + 1 - closed..=top).rev().take(closed).any(|place| {
            let place = place * d..(place + 1) * d;
            let (first, before) = (&self.opened[place.clone()], &self.opened_before[place]);
            turns(first, &self.moving.momentum, &self.half_sum, before, lane)
        })
    }

    fn end(&mut self, lane: usize, divergent: bool) -> TreeTransition {
        self.factor.0[lane] = 0.0;
        if divergent {
            // A lane may stand still for a while, but not where a number is not finite.
            self.moving.at.copy(&self.candidate, lane);
            copy(&mut self.moving.momentum, &self.zero, lane);
        }
        let tree = &mut self.lanes[lane];
        tree.growing = false;
        TreeTransition {
            acceptance: tree.acceptance / tree.leapfrog_steps as f64,
            depth: tree.depth,
            leapfrog_steps: tree.leapfrog_steps,
            divergent,
            moved: tree.moved,
            energy: tree.energy,
            factor: tree.factor,
        }
    }
}

/// The last bit of a uniform number of 32 bits.
pub(super) fn coin(uniform: f64) -> bool {
    (uniform * 4_294_967_296.0) as u64 % 2 == 1
}
