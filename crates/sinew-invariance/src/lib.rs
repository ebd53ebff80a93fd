//! Does a Markov kernel keep its target, does it reach it, do its intervals cover what they say.
//!
#![doc = include_str!("../README.md")]

pub mod calibration;
mod chains;
mod detectable;
pub mod draws;
mod exact_rank;
mod exact_start;
mod geweke;
mod gradient;
pub mod guide;
mod integrator;
mod p_values;
#[cfg(feature = "svg")]
pub mod plot;
mod report;
mod resampling;
mod sequential;
#[cfg(feature = "proptest")]
pub mod strategies;
pub mod targets;
mod test_functions;
mod two_sample;

pub use calibration::{RankCalibration, Ranks, calibration};
pub use chains::{LongRun, long_run, mixing};
pub use detectable::{Detectable, Wrong};
pub use exact_rank::{ExactRank, exact_rank};
pub use exact_start::{ExactStart, exact_start};
pub use geweke::{Geweke, geweke};
pub use gradient::{Differences, gradient};
pub use integrator::{Integrator, PhaseSpaceMap, Start, energy_order, reversibility, volume};
pub use report::{Bound, Report, Statistic};
pub use resampling::{CountLaw, Resampling, resampling};
pub use sequential::Control;
pub use test_functions::TestFunctions;
pub use two_sample::two_sample;
