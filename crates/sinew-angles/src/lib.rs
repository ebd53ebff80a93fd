//! Angles of joints, as clinicians and OpenSim read them, with their posteriors.
//!
//! | module | what |
//! |---|---|
//! | [`joint_angles`] | the angles of a body by a convention, in a state |
//! | [`columns`] | which angles a body has under which names: OpenSim's or the ISB's |
//! | [`decomposition`] | three angles of a rotation |
//! | [`pelvis`] | angles of the pelvis, by OpenSim and by Baker |
//! | [`marginals`] | mean, quantiles and rates of change over draws of states |
//! | [`fixed_lag`] | draws of an earlier frame that belong to draws of the present one |
//! | [`visibility`] | which angles the keypoints of a frame show |
//! | [`angle_draws`] | draws of the rotations of a body over the frames of a run |
//! | [`standing`] | the zero of angles in the draws of a standing trial, and what speaks against the trial |
//! | [`zero`] | what a standing trial takes off angles |
//!
//! No file, no camera and no set-up is known here. docs/reference/angles.md has a drawing of each angle.
//!
//! ```
//! use sinew_angles::{Convention, JointAngles};
//! use sinew_body::{Proportions, standard};
//!
//! let body = standard::h32(&Proportions::default());
//! let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
//! let mut state = vec![0.0; body.dof()];
//! state[body.first_dof(body.link_index("r_shin").ok_or("no shin")?)] = -0.5;
//! let mut raw = vec![0.0; angles.raw_count()];
//! angles.raw(&state, None, &mut raw);
//! let knee = angles.names().iter().position(|name| name == "knee_angle_r").ok_or("no knee")?;
//! assert_eq!(angles.signed(knee, &raw), 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod angle_draws;
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
