//! Articulated bodies: kinematic trees, forward kinematics over lanes, gradients by a backward sweep, the bodies of the papers.
//!
//! Nothing here knows of probability, cameras or files.
//!
//! ```
//! use sinew_body::{Plan, Proportions, point_positions, standard::h32};
//! use sinew_core::lanes::Isa;
//!
//! let body = h32(&Proportions::default());
//! let plan = Plan::with_all_points(&body);
//! let mut q = vec![0.0; body.dof()];
//! q[2] = 1.02; // the waist stands 1.02 m above the ground
//! let mut points = vec![0.0; 3 * plan.points()];
//! point_positions(&plan, Isa::best(), &q, &mut points);
//! let head = body.point_index("Head").unwrap();
//! assert!((points[3 * head + 2] - 1.75).abs() < 1e-12);
//! ```
pub mod bones;
pub mod bundle;
mod error;
pub mod fit;
pub mod flesh;
mod foot;
pub mod frustum;
pub mod half_turns;
pub mod hapf31;
pub mod hppf24;
pub mod initial;
pub mod kinematics;
pub mod leg_turns;
pub mod motion_ranges;
#[cfg(test)]
mod placed;
pub mod point_derivatives;
pub mod points;
pub mod rotation;
mod sizes;
pub mod standard;
pub mod standard_flesh;
pub mod subject;
mod ten_cones;
pub mod tree;

pub use error::Error;
pub use kinematics::{
    Plan, point_jacobian, point_jacobian_each, point_positions, point_positions_block, point_positions_each,
    point_positions_into,
};
pub use sinew_core::lanes::Isa;
pub use standard::Proportions;
pub use tree::{Axis, Joint, KinematicTree, Link, Point};
