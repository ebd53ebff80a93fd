//! BVH: a skeleton and its joint angles over time (Biovision, 1990s).
//!
//! ```text
//! HIERARCHY
//! ROOT Hips
//! {
//!   OFFSET 0.0 0.0 0.0
//!   CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
//!   JOINT Knee
//!   {
//!     OFFSET 0.0 -0.43 0.0
//!     CHANNELS 3 Zrotation Yrotation Xrotation
//!     End Site
//!     {
//!       OFFSET 0.0 -0.42 0.0
//!     }
//!   }
//! }
//! MOTION
//! Frames:          2
//! Frame Time: 0.0333333
//! …
//! ```
//!
//! Angles are in degrees, lengths in the file's own unit, axes usually Y up. Rotations multiply in the order in which a
//! joint lists its channels, left to right; the origin of a joint is `p = p_parent + R_parent (OFFSET + positions)`, so
//! that position channels add to the offset. Both orders and any mixture are honoured per joint.
//!
//! Written are: Y up, (X, Y, Z) = (x, z, −y) of the world ([`bvh_from_world`]), metres, `Frame Time` with seven digits.
//! Blender's default import shows that as (X, −Z, Y), which is our world again; it takes the scene's rate only with
//! "Update Scene FPS". [`export`] makes a file from a kinematic tree.
//!
//! ```
//! use sinew_formats::bvh;
//! let text = "HIERARCHY\nROOT Hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Yrotation Xrotation\nEnd Site\n{\nOFFSET 1 0 0\n}\n}\n\
//!             MOTION\nFrames: 1\nFrame Time: .04\n90 0 0\n";
//! let file = bvh::read("walk.bvh", text)?;
//! let points = file.positions(0).unwrap();
//! assert_eq!(points[1].0, "Hip_End");
//! assert!((points[1].1[1] - 1.0).abs() < 1e-15);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

mod body;
pub mod export;
mod hierarchy;
mod reader;
mod writer;

pub use hierarchy::{Bvh, BvhJoint, Channel, bvh_from_world, forward_kinematics, local_transform, world_from_bvh};
pub use reader::read;
pub use writer::{write, write_frame, write_header};
