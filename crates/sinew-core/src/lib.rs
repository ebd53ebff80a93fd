//! Log densities, motion models, decoders and random streams, of one state or of eight at once.
//!
#![doc = include_str!("../README.md")]

pub mod beside;
mod chacha;
pub mod combinations;
pub mod combinators;
mod compile_here;
pub mod decode;
pub mod density;
pub mod diagnostics;
pub mod elementary;
mod error;
pub mod estimators;
mod forwarded;
mod groups;
pub mod hierarchy;
pub mod injection;
pub mod kernel;
pub mod lanes;
pub mod lbfgs;
pub mod part;
pub mod random;
pub mod side_by_side;
mod streams;
mod through;
pub mod toy;
pub mod transition;
pub mod within;

pub use error::Error;
