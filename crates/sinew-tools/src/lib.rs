//! What surrounds the tracking of a recording: it reads files, recordings and results, never a run.
//!
//! | module | what |
//! |---|---|
//! | [`mod@gait`] | events, strides and cycles of a person who walks, from a result |
//! | [`action_trace`] | which actions a run by action primitives saw |
//! | [`inspect`] | what a file or folder holds, and whether calibration and keypoints fit |
//! | [`learn`] | a motion model from motion files |
//! | [`motion`] | motion files into each other |
//! | [`segment`] | masks from images of fixed cameras |
//! | [`overlay`] | pictures of results over the images |
//! | [`refined`] | a calibration as the set-up of a run refined it |
//! | [`report`] | one HTML page that shows a result |
//! | [`result_table`] | which table of a result folder a CSV file is |
//! | [`mod@tracked`] | the poses of a result, read back |
//! | [`sync`] | how late cameras are against each other |
//! | [`shape_fit`] | thicknesses of a body from masks and a result |

pub mod action_trace;
mod error;
pub mod gait;
pub mod inspect;
pub mod learn;
pub mod motion;
pub mod overlay;
pub mod predict;
pub mod refined;
pub mod report;
pub mod result_table;
pub mod segment;
pub mod shape_fit;
pub mod svg;
pub mod sync;
pub mod tracked;
pub mod validate;

pub use error::Error;
