//! Trackers, one file per algorithm, and the one time loop around them.
//!
//! A [`Tracker`] turns the observation of a frame, a log density on the state, into draws of the posterior. It knows neither bodies nor images, so every tracker runs on a two-dimensional Gaussian:
//!
//! ```
//! use sinew_core::density::Lanes;
//! use sinew_core::lanes::Isa;
//! use sinew_core::random::Stage;
//! use sinew_core::toy::Quadratic;
//! use sinew_dynamics::random_walk::{Between, RandomWalk};
//! use sinew_tracking::bootstrap::{Bootstrap, Config};
//! use sinew_tracking::posterior::Posterior;
//! use sinew_tracking::{Error, Harness, StepInfo, run};
//!
//! /// A point that moves to the right, seen in every frame.
//! struct Moving {
//!     isa: Isa,
//!     last: Option<StepInfo>,
//! }
//!
//! impl Harness<Lanes<Quadratic>> for Moving {
//!     type Bound = Lanes<Quadratic>;
//!     type Noted = StepInfo;
//!     type Error = Error;
//!     fn observe(&mut self, frame: u32, _estimate: &[f64]) -> Result<Self::Bound, Error> {
//!         let leaf = Quadratic { centre: vec![0.1 * f64::from(frame), 0.0], precision: vec![100.0; 2] };
//!         Ok(Lanes { leaf, isa: self.isa })
//!     }
//!     fn note(&mut self, _: u32, info: StepInfo) -> Result<StepInfo, Error> {
//!         Ok(info)
//!     }
//!     fn record(&mut self, info: StepInfo, _: Posterior<'_>) -> Result<(), Error> {
//!         self.last = Some(info);
//!         Ok(())
//!     }
//! }
//!
//! let isa = Isa::best();
//! let walk = RandomWalk::new(&[1.0, 1.0], 0.01, Between::Mixture, isa)?;
//! let mut tracker = Bootstrap::new(Config { particles: 1000, ..Config::default() }, walk, vec![0.0, 0.0])?;
//! let mut moving = Moving { isa, last: None };
//! run(&mut tracker, 0..20, |frame| Stage::new(1, "example").at_frame(frame), &mut moving)?;
//! assert!((moving.last.expect("20 frames").mean[0] - 1.9).abs() < 0.2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Trackers are made over any motion model; one that follows the estimates ([`sinew_core::transition::MotionModel`]) is served and resumed like one that does not. Each of them becomes a tracker of a latent state behind [`decoded::Decoded`].
pub mod annealed;
pub mod bootstrap;
pub mod coarse_to_fine;
pub mod decoded;
mod error;
pub mod gpapf;
pub mod guided;
pub mod h_apf;
mod handed;
pub mod hmc_filter;
pub mod hppf;
mod latent_spaces;
pub mod moved;
mod particle_state;
pub mod partitioned;
pub mod posterior;
pub mod restrained;
mod resume;
mod run;
pub mod series;
pub mod state_space;
mod tracker;
pub mod with_prior;

pub use error::Error;
pub use resume::Resume;
pub use run::{Harness, run};
pub use tracker::{Inferred, StepInfo, Tracker};

pub use sinew_core::random::{BlockRng, Stage};
pub use sinew_samplers::resample::Scheme;

/// The programs of the page are compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
