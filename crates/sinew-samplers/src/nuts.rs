//! No-U-turn sampler over a block of eight chains, none of which waits for another.
//!
//! A transition (Hoffman & Gelman 2014; in its multinomial form Betancourt 2017, appendix A) draws a momentum p ~ N(0, I), which with the state has the energy H₀ = −log p(x) + p·p / 2, and
//! grows a trajectory by doublings, forwards or backwards with probability ½ each:
//!
//! 1. The new half has as many states as all there were. One of them is its candidate, each with a probability proportional to its weight exp(H₀ − H).
//! 2. The half is thrown away and the transition ends where a state of it diverges (H − H₀ is not a number or above 1000), or where it or one of its own halves, quarters … turns.
//! 3. Else its candidate replaces that of the whole trajectory with probability min(1, weight of the new half / weight of the old).
//! 4. The transition ends with that candidate where the whole trajectory turns, or at the greatest depth.
//!
//! A piece with the momenta p₁ … p_n turns where ρ·p₁ ≤ 0 or ρ·p_n ≤ 0 with ρ = Σ p_i − (p₁ + p_n) / 2. This is Betancourt's generalised criterion in whitened momenta, with half of the two
//! ends taken off, as in NumPyro, since whole ends miss the turns of short trajectories.
//!
//! A half is built state by state, not by recursion (Phan, Pradhan & Jankowiak 2019, appendix A): state n of it, from 0, leaves its momentum and the sum before it at place popcount(n / 2) if n is even;
//! if n is odd it closes as many pieces as n ends in binary ones, whose first states are at the places from popcount(n / 2) downwards. So memory grows as the depth.
//!
//! All lanes call the gradient together but each grows its own tree, and where one is complete the next begins in the same lane. Stop lanes after equal numbers of transitions, as [`draw`] does: after equal numbers of gradients,
//! long transitions would be missing. Step and metric are fixed; jitter is drawn once a transition and independently of the state. Nothing is allocated per step.

mod draws;
mod trees;

pub use draws::{TreeRun, adapt, draw};
pub use trees::Trees;

use crate::Error;
use crate::integrator::{Leapfrog, Moving, check_jitter};
use crate::metric::Metric;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;
use trees::{End, States, coin};

/// Greatest depth by default, as in Stan.
pub const MAX_DEPTH: usize = 10;

/// Steps of the integrator; fixed while chains run.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuts {
    leapfrog: Leapfrog,
    max_depth: usize,
    jitter: f64,
}

impl Nuts {
    /// Steps η A for a metric. A trajectory has at most 2^`max_depth` states.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the step size and each curvature are positive and finite, 1 ≤ `max_depth` ≤ 30, and 0 ≤ jitter < 1.
    pub fn with_metric(
        step_size: f64,
        metric: &Metric,
        max_depth: usize,
        jitter: f64,
        isa: Isa,
    ) -> Result<Self, Error> {
        let leapfrog = Leapfrog::new(step_size, metric, isa)?;
        check_jitter(jitter)?;
        if !(1..=30).contains(&max_depth) {
            let (name, value) = ("greatest depth", max_depth as f64);
            return Err(Error::OutOfRange { name, value, expected: "must be from 1 to 30" });
        }
        Ok(Self { leapfrog, max_depth, jitter })
    }
}

/// A completed transition of one chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeTransition {
    /// Mean over the new states of min(1, exp(H₀ − H)).
    pub acceptance: f64,
    /// Doublings that were kept.
    pub depth: usize,
    /// Gradients it took.
    pub leapfrog_steps: usize,
    /// Whether it met a divergence.
    pub divergent: bool,
    /// Whether it ended in another state than it began.
    pub moved: bool,
    /// Hamiltonian of the resulting state.
    pub energy: f64,
    /// Factor of the step size (jitter).
    pub factor: f64,
}

/// One leapfrog step of every lane in `active`, and what transitions it completes. The others stand still, but not before their tree is complete.
pub fn step<T: GradLogDensity + ?Sized>(
    target: &T,
    nuts: &Nuts,
    trees: &mut Trees,
    active: &[bool; LANES],
    rng: &mut BlockRng,
) -> [Option<TreeTransition>; LANES] {
    let mut uniforms = [Block::ZERO; 2];
    rng.fill_uniform(&mut uniforms);
    let [choice, whole] = uniforms;
    for (lane, &is_active) in active.iter().enumerate() {
        if is_active && !trees.lanes[lane].growing {
            trees.begin(nuts, lane, coin(choice.0[lane]), rng);
        }
    }
    let Trees { moving, half_sum, gradient, workspace, factor, .. } = trees;
    let End { at: States { position, force }, momentum } = moving;
    let moving = Moving { position, momentum, force, sum: half_sum, gradient, workspace };
    let (log_density, kinetic) = nuts.leapfrog.step(target, factor, moving);
    let mut complete = [None; LANES];
    for (lane, complete) in complete.iter_mut().enumerate() {
        if trees.lanes[lane].growing {
            let arrived = (log_density.0[lane], kinetic.0[lane] - log_density.0[lane]);
            *complete = trees.grow(nuts, lane, arrived, choice.0[lane], whole.0[lane]);
        }
    }
    complete
}
