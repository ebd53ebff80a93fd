//! Recorded human motion as named points over time, and as states of a body that follows them.
//!
//! | module | what |
//! |---|---|
//! | [`mod@convert`] | motion files into each other |
//! | [`learn`] | a model of motion or poses from motion files |
//! | [`recorded`] | the joints of a motion file, by the names that are in use |
//! | [`cmu`] | the joints of recordings of the CMU database |
//! | [`follow`] | one of four bodies by name, and its states along a motion |
//! | [`retarget`] | a body in a person's size, and its states along a motion |
//! | [`median_lengths`](mod@median_lengths) | the lengths of a person's segments, for the bodies of silhouettes |
//! | [`damped_fit`] | states of such a body along a motion, each near the one before |
//! | [`gltf`] | a moving skeleton as glTF, with a mesh of its bones |
//! | [`hppf24_scale`] | HPPF24 with one scale for all parts |
//!
//! ```
//! use sinew_body::hppf24;
//! use sinew_motion::damped_fit::{MotionFollowing, states};
//! use sinew_body::points::points_of_states;
//!
//! let body = hppf24::tree(1.0);
//! let mut standing = vec![0.0; body.dof()];
//! standing[2] = 0.9;
//! let motion = points_of_states(&body, &[standing]);
//! let found = states(&body, &motion, &MotionFollowing::default())?;
//! assert!((found[0][2] - 0.9).abs() < 0.01);
//! # Ok::<(), sinew_motion::FollowError>(())
//! ```

pub mod cmu;
pub mod convert;
pub mod damped_fit;
mod error;
pub mod follow;
mod follow_error;
pub mod gltf;
pub mod hppf24_scale;
pub mod learn;
pub mod median_lengths;
pub mod recorded;
pub mod retarget;

pub use error::Error;
pub use follow_error::FollowError;
