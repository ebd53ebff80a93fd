//! Gaussian process latent variable models.
mod columns;
mod covariance;
mod dynamics;
mod error;
mod gram;
pub mod lbfgs;
mod outputs;
mod principal;
mod process;

pub use covariance::Covariance;
pub use error::Error;
pub use outputs::{Preparation, Standard};
pub use principal::principal_scores;
