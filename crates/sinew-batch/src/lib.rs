//! Many trials: a plan, shards that run it, and one table over all.
//!
//! ```text
//! study/
//!     plan.json  tasks.jsonl     what is to be done: one line a trial, with a hash of inputs and settings
//!     ended/I-of-N.jsonl         what became of it: one line a trial, by shard
//!     setups/                    set-ups that trials of a subject share
//!     results/                   a result folder a trial, or one archive a shard
//!     summary.csv  groups.csv  report.html     what `gather` makes of all that
//! ```
//!
//! A task is done when its latest line has the same hash of inputs and settings as the plan, and says that there are results. So a shard that is run again runs only what is missing, and after the plan is made again only what has changed.

mod angle_draws;
mod error;
pub mod gather;
mod group_statistics;
mod keeping;
pub mod ledger;
mod memory_first;
mod packed;
mod page;
pub mod plan;
mod pooled_setup;
pub mod run;
mod scratch;
pub mod shard;
mod submit;
pub mod trial_table;
mod trials;

pub use error::{Error, ExitCode};
pub use packed::{unpack, unpacked};
pub use submit::write_submit_files;
