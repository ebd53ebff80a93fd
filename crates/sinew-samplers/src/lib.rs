//! Samplers on plain targets: particles, Hamiltonian Monte Carlo, tempering, importance sampling, and searches.
//!
//! Particles come with log weights, resampling and moments, chains with tuning and a warm-up. The searches ([`annealed_search`], the choice of [`parts`]) claim no posterior.
//!
//! Nothing here knows of frames, bodies or cameras: a target is a [`sinew_core::density::LogDensity`], with a gradient where one is needed. A verb is a free function on
//! [`particles::Particles`]; a Markov kernel is usable alone. Diagnostics of chains are re-exported from [`sinew_core::diagnostics`].
//!
//! ```
//! use sinew_core::density::Lanes;
//! use sinew_core::kernel::MarkovKernel;
//! use sinew_core::lanes::Isa;
//! use sinew_core::random::Stage;
//! use sinew_core::toy::Quadratic;
//! use sinew_samplers::hmc::Hmc;
//! use sinew_samplers::one_chain::OneChain;
//!
//! let isa = Isa::best();
//! let target = Lanes { leaf: Quadratic { centre: vec![1.0, -2.0], precision: vec![1.0, 25.0] }, isa };
//! let mut kernel = OneChain::new(target, Hmc::new(0.8, &[1.0, 25.0], 4, 0.2, isa)?);
//! let mut rng = Stage::new(1, "example").whole();
//! let mut state = [1.0, -2.0];
//! let mut sum = 0.0;
//! for _ in 0..2000 {
//!     kernel.step(&mut state, &mut rng);
//!     sum += state[1];
//! }
//! assert!((sum / 2000.0 + 2.0).abs() < 0.03);
//! # Ok::<(), sinew_samplers::Error>(())
//! ```
pub mod annealed_search;
pub mod ascent;
pub mod chains;
pub mod crossover;
pub mod curvature;
pub mod decoded;
pub mod descent;
pub mod diffusion;
pub mod dual_averaging;
mod error;
pub mod few_draws;
pub mod gaussian_mixture;
pub mod grid;
pub mod guided;
pub mod hmc;
pub mod importance;
pub mod integrator;
pub mod jumps;
pub mod laplace;
pub mod learned;
pub mod levels;
pub mod likelihood_weighting;
pub mod metric;
pub mod mode_mean;
pub mod moments;
pub mod nuts;
pub mod one_chain;
pub mod origins;
pub mod particles;
pub mod parts;
pub mod population;
pub mod quantised;
pub mod resample;
pub mod starts;
pub mod temperature;
pub mod tempered_smc;
mod triangular;
pub mod tuning;
pub mod warm_up;
pub mod weighted_resampling;
pub mod weights;

pub use error::Error;
pub use sinew_core::diagnostics;
