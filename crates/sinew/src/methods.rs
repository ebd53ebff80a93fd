//! The methods of tracking, one file a method.
//!
//! Enter: the settings of a method, a set-up, the motion prior, the parts of the body. Leaves: a tracker on the likelihood of a frame ([`FrameLikelihood`]).
//! Must not know: where frames come from, and what becomes of the posterior.
//!
//! A method is described by an [`About`] (name, help, what it needs and gives, its own settings) and made by a [`Method`]. The command line, its completion
//! and the tables of the documentation derive from [`METHODS`], and so do messages that a method's own setting is idle; other idle settings are listed by hand (`config/idle.rs`).

pub mod about;
pub mod annealed;
pub mod bootstrap;
pub mod coarse_to_fine;
pub mod gpapf;
pub mod guided;
pub mod h_apf;
pub mod hmc;
pub mod hppf;
pub mod latent_state;
pub mod list;
pub mod partitioned;
pub mod score;

pub use about::{About, Gives, LatentUse, Making, Method, StepSize, Steps};
pub use annealed::AnnealedMethod;
pub use bootstrap::BootstrapMethod;
pub use coarse_to_fine::CoarseToFineMethod;
pub use gpapf::GpapfMethod;
pub use guided::GuidedMethod;
pub use h_apf::HApfMethod;
pub use hmc::HmcMethod;
pub use hppf::HppfMethod;
pub use list::{METHODS, find};
pub use partitioned::PartitionedMethod;
pub use score::Score;
pub use sinew_observe::frame_likelihood::{BoundImages, BoundKeypoints, FrameLikelihood};
