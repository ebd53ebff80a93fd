//! Adaptive tempered sequential Monte Carlo with Hamiltonian moves (Del Moral, Doucet & Jasra 2006).
//!
//! The effective number chooses the temperatures, as in Jasra et al. (2011).
//!
//! From prior(s) to prior(s) L(s) through prior(s) L(s)^β:
//!
//! 1. s_i ~ prior, i = 1 … N; β = 0, log Z = 0
//! 2. while β < 1:
//!    - β' ≤ 1, the largest at which the weights w_i = exp((β' − β) log L(s_i)) keep the effective number α times that of the states with a finite value ([`crate::temperature`])
//!    - log Z ← log Z + log Σ w_i / N; S ← resampled by w (systematic); β ← β'
//!    - each s_i ← K updates of Hamiltonian Monte Carlo on prior(s) L(s)^β
//!
//! exp(log Z) estimates the evidence, without bias apart from the choice of the temperatures. All N K states of the last temperature are kept: each of them is a draw after a move that leaves the target unchanged
//! (what waste-free sequential Monte Carlo does at every temperature; Dau & Chopin 2022).
//!
//! The metric of an update at β is (1 − β) P + β G, with the prior's precision P and a posterior metric G that was made before: it depends on no state, so every move keeps its target. It is positive definite
//! for every β, and equals P + β J if G = P + J.

pub(crate) mod algorithm;
mod sample;

pub use algorithm::{Config, MOST_TEMPERATURES, Sample, Temperature, temper};
pub use sample::{NormalPrior, PriorDensity, Settings, sample};
