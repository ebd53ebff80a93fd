//! Articulated bodies.
mod error;
pub mod tree;
pub use error::Error;
pub use tree::{Axis, Joint, KinematicTree, Link, Point};
