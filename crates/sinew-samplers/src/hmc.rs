//! Hybrid (Hamiltonian) Monte Carlo over a block of eight chains in lockstep.
//!
//! With the potential E(s) = −log p(s), component steps ε_j = η / √h_j (Choo & Fleet 2001, eq. 17) and unit-variance momenta (Duane et al. 1987; Neal 2011), one update is
//!
//! 1. p ~ N(0, I), H₀ = E(s) + p·p / 2;
//! 2. L leapfrog steps: p_j −= ε_j / 2 ∂E/∂s_j; s_j += ε_j p_j; p_j −= ε_j / 2 ∂E/∂s_j (eqs. 13–15), adjacent half steps fused;
//! 3. accept with probability min(1, exp(H₀ − H₁)) (eq. 16), else keep the old state, which counts again as a draw.
//!
//! This equals a mass matrix diag(η² / ε_j²) with the unit step η. The curvature h must not depend on the state. With `jitter` a > 0 the steps of one trajectory are multiplied by a number uniform in
//! (1 − a, 1 + a), one for each chain; it does not depend on the state either, so the target stays invariant.
//!
//! A trajectory that meets a log density or gradient that is not finite, or ends with H₁ − H₀ > 1000, is rejected and counted as divergent. State, log density and gradient of the current states are cached
//! in [`Chains`], so that an update costs L gradients; it allocates nothing.

pub(crate) mod kernel;
mod sample;

pub use kernel::{Chains, DIVERGENCE, Hmc, Update, Workspace, update};
pub use sample::{Settings, sample};
