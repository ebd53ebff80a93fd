//! The vocabulary of `sinew`: states in lanes, log densities, transitions, parts, decoders and random streams.
//!
//! This crate knows nothing of bodies, images or particles. A state is a flat slice of `f64`; eight states form a block that one instruction stream evaluates
//! together (see [`lanes`]). Densities are written once and run on one state or on a block, on the best instruction set that the processor has:
//!
//! ```
//! use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
//! use sinew_core::lanes::{Block, Isa};
//! use sinew_core::toy::Quadratic;
//!
//! let target = Lanes { leaf: Quadratic { centre: vec![1.0, 2.0], precision: vec![1.0, 4.0] }, isa: Isa::best() };
//! assert_eq!(target.log_density(&[2.0, 2.0]), -0.5);
//! let mut gradient = [Block::ZERO; 2];
//! target.log_density_grad_block(&[Block::splat(2.0), Block::splat(3.0)], &mut gradient, &mut []);
//! assert_eq!(gradient[1].0[0], -4.0);
//! ```
pub mod beside;
pub mod combinations;
pub mod combinators;
mod compile_here;
pub mod decode;
pub mod density;
pub mod diagnostics;
pub mod elementary;
mod error;
mod forwarded;
pub mod hierarchy;
pub mod injection;
pub mod kernel;
pub mod lanes;
pub mod part;
pub mod random;
pub mod side_by_side;
mod through;
pub mod toy;
pub mod transition;
pub mod within;

pub use error::Error;
