//! Motion priors: how a state moves between frames, and what that makes of one frame's posterior.
//!
//! [`random_walk::RandomWalk`] is the model of Choo & Fleet (2001); its prior between frames is their mixture over the last states of the chains, or one Gaussian of all draws. [`first_order::FirstOrder`] moves it on by a part of the estimate's last change. [`linear_gaussian::LinearGaussian`]
//! is the model on which filters can be checked exactly, by the one of [`kalman`]. [`smoother`] runs back over the moments that a filter left.
//!
//! ```
//! use sinew_core::density::GradLogDensity;
//! use sinew_core::lanes::Isa;
//! use sinew_core::transition::Predict;
//! use sinew_dynamics::random_walk::{Between, RandomWalk};
//!
//! // 28 coordinates at 30 frames a second: 15 mm and 0.15 rad per frame.
//! let walk = RandomWalk::choo_fleet(28, 1.0 / 30.0, Between::Mixture, Isa::best())?;
//! let prior = walk.initial(&[0.0; 28])?;
//! let mut gradient = [0.0; 28];
//! prior.log_density_grad(&[0.015; 28], &mut gradient);
//! assert!((gradient[0] * 0.015 + 1.0).abs() < 1e-12);
//! # Ok::<(), sinew_dynamics::Error>(())
//! ```
pub mod axes;
pub mod backward_pass;
mod error;
pub mod factor;
pub mod first_order;
pub mod gaussian;
pub mod joint_limits;
pub mod joint_ranges;
pub mod kalman;
pub mod lasting;
pub mod lasting_draws;
pub mod lasting_scales;
pub mod level_walk;
pub mod linear_gaussian;
pub mod linear_motion;
pub mod linearised_filter;
pub mod mixture;
pub mod mixture_em;
pub mod model_file;
pub mod motion_prior;
pub mod pca;
pub mod persistent_errors;
pub mod primitives;
pub mod prior;
pub mod random_walk;
pub mod shared_numbers;
pub mod smoother;

pub use error::Error;

/// The programs of the page are compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
