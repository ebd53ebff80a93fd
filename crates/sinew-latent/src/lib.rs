//! Gaussian process latent variable models.
pub mod back_constraint;
mod columns;
pub mod covariance;
mod dynamics;
mod error;
pub mod gpdm;
pub mod gplvm;
mod gram;
pub mod hgplvm;
pub mod lbfgs;
pub mod model;
mod objective;
pub mod outputs;
pub mod principal;
mod process;
pub mod training;

pub use error::Error;
