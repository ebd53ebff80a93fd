//! Motion files as values, and what can become of them.
//!
//! A file holds *points* (TRC, C3D, CSV), *coordinates* (MOT, CSV) or a *skeleton* (BVH, ASF/AMC; glTF is only written). A skeleton says where its points are, so it becomes points; nothing
//! becomes a skeleton or coordinates of OpenSim without inverse kinematics, which is tracking and not conversion:
//!
//! | from \ to | TRC, C3D | CSV | MOT | BVH | glTF |
//! |---|---|---|---|---|---|
//! | TRC, C3D | yes | points | no | no | no |
//! | CSV of points | yes | yes | no | no | no |
//! | MOT, CSV of coordinates | no | yes | yes | no | no |
//! | BVH | joints and tips | joints and tips | its channels | yes | yes |
//! | AMC with ASF | bone ends | bone ends | channels of its BVH | yes | yes |
//!
//! In between everything is in the world frame (Z up), metres and seconds; BVH files state no unit of length and are taken as metres.

mod acclaim;
mod bone_names;
pub mod c3d_points;
mod content;
pub(crate) mod error;
mod format;
mod joints;
mod read;
mod write;

pub use bone_names::{BoneNames, rename_bones};
pub use c3d_points::{ConvertedMotion, rewritten_c3d};
pub use content::{Content, Motion, rate_of};
pub use error::MotionError;
pub use format::Format;
pub use joints::{RecordedJoints, recorded_joints};
pub use read::read;
pub use write::write;
