#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! | module | what |
//! |---|---|
//! | [`gplvm`], [`gpdm`], [`hgplvm`] | models to be learned: plain, with dynamics between rows, a tree of spaces |
//! | [`training`] | learning, step by step, stopped and resumed to the same bits; L-BFGS of [`sinew_core::lbfgs`] |
//! | [`mapping`], [`space`] | from a latent to its row: mean, variance, Jacobians, on blocks of eight; decoders for trackers |
//! | [`inverse`], [`inference`] | from a row, or from some of its columns, to its latent: one, or the whole posterior |
//! | [`motion`] | the next latent: its density, draws |
//! | [`file`](mod@file) | files |
//!
//! Limits: a step of learning takes time as the cube of the rows, and memory as their square (all of them are used: no inducing points); some hundred rows learn in seconds, [`check::MAX_ROWS`] are the most that a file may have. The objective
//! has many optima: what is found depends on the start, leading principal components. A model knows what it was learned from, and is sure of itself beyond: its variance grows where there are no latents, but poses of another kind may be
//! mapped into the midst of them.
//!
//! Sources: Lawrence, *Probabilistic non-linear principal component analysis with Gaussian process latent variable models* (2005); Lawrence & Quiñonero-Candela, *Local distance preservation in the GP-LVM through back constraints* (2006);
//! Urtasun, Fleet & Fua, *3D people tracking with Gaussian process dynamical models* (2006); Lawrence & Moore, *Hierarchical Gaussian process latent variable models* (2007); Wang, Fleet & Hertzmann, *Gaussian process dynamical models for
//! human motion* (2008).
pub mod back_constraint;
pub mod check;
mod columns;
pub mod covariance;
mod dynamics;
mod error;
pub mod file;
pub mod gpdm;
pub mod gplvm;
mod gram;
pub mod hgplvm;
pub mod inference;
pub mod inverse;
pub mod latent_density;
pub mod mapping;
pub mod model;
pub mod motion;
mod objective;
pub mod outputs;
pub mod principal;
mod process;
mod ranges;
pub mod sequence;
pub mod sequence_density;
pub mod space;
pub mod training;
pub mod tree;

pub use error::Error;
