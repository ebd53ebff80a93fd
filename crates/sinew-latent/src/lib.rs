//! Gaussian process latent variable models: spaces of few coordinates from which tables of many columns come.
//!
//! A row of the table has a latent, a point of the space; all columns are Gaussian processes on it with one covariance. Latents and the covariance's parameters are learned together. It is about any table: bodies and images are unknown here.
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
//! ```
//! use sinew_core::lanes::Isa;
//! use sinew_latent::gplvm;
//! use sinew_latent::mapping::Mapping;
//! use sinew_latent::training::{Config, Training};
//!
//! // Thirty rows of four columns that depend on one number.
//! let rows: Vec<f64> = (0..30).flat_map(|n| [0.0, 0.7, 1.4, 2.1].map(|lag| (0.2 * f64::from(n) + lag).sin())).collect();
//! let start = gplvm::model(&rows, 4, &gplvm::Config { dim: 2, ..gplvm::Config::default() })?;
//! let mut training = Training::new(start, Config { steps: 100, ..Config::default() }, Isa::best())?;
//! training.run(|progress| progress.steps < 50);
//! let model = training.into_model();
//! let row = Mapping::new(&model, 0)?.mean_at(model.nodes[0].latent(7));
//! assert!(row.iter().zip(model.row(7)).all(|(found, known)| (found - known).abs() < 0.1));
//! # Ok::<(), sinew_latent::Error>(())
//! ```
//!
//! Two examples: `walking_map` learns a map of walking and draws it, `missing_columns` fills in columns of new rows.
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
