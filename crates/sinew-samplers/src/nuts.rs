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
//! All lanes call the gradient together but each grows its own tree, and where one is complete the next begins in the same lane. Stop lanes after equal numbers of transitions, as [`draw_trees`] does: after equal numbers of gradients,
//! long transitions would be missing. Step and metric are fixed; jitter is drawn once a transition and independently of the state. Nothing is allocated per step.

mod draws;
mod sample;
mod step;
mod transition;
mod trees;

pub use draws::{TreeRun, adapt, draw_trees};
pub use sample::{Settings, sample};
pub use step::step;
pub use transition::{MAX_DEPTH, Nuts, TreeTransition};
pub use trees::Trees;
