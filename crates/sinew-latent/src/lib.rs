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
pub mod inference;
pub mod inverse;
pub mod latent_density;
pub mod lbfgs;
pub mod mapping;
pub mod model;
pub mod motion;
mod objective;
pub mod outputs;
pub mod principal;
mod process;
pub mod sequence;
pub mod sequence_density;
pub mod space;
pub mod training;

pub use error::Error;
