#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! | module | what |
//! |---|---|
//! | [`joint_angles`] | the angles of a body by a convention, in a state |
//! | [`circle`] | means and differences of angles, which know no cut |
//! | [`columns`] | which angles a body has under which names: OpenSim's or the ISB's |
//! | [`decomposition`] | three angles of a rotation |
//! | [`pelvis`] | angles of the pelvis, by OpenSim and by Baker |
//! | [`marginals`] | mean, quantiles and rates of change over draws of states |
//! | [`fixed_lag`] | draws of an earlier frame that belong to draws of the present one |
//! | [`visibility`] | which angles the keypoints of a frame show |
//! | [`angle_draws`] | draws of the rotations of a body over the frames of a run |
//! | [`standing`] | the zero of angles in the draws of a standing trial, and what speaks against the trial |
//! | [`zero`] | what a standing trial takes off angles |

pub mod angle_draws;
pub mod circle;
pub mod columns;
pub mod decomposition;
pub mod fixed_lag;
pub mod joint_angles;
pub mod marginals;
pub mod pelvis;
pub mod standing;
pub mod trajectory_change;
pub mod visibility;
pub mod zero;

mod link_angles;
mod observed;

pub use angle_draws::AngleDraws;
pub use columns::Convention;
pub use joint_angles::JointAngles;
pub use link_angles::{CoordinateSource, JointTurn, LinkAngles};
pub use marginals::{AngleMarginal, AngleMarginals};
pub use zero::AngleZero;
