#![doc = include_str!("../README.md")]

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
