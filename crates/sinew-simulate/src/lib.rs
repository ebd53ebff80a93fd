//! Simulated people, cameras and detectors with known truth.
//!
//! A person who stands and walks, virtual cameras around them, and a detector that errs as real ones do.
//!
//! | module | what |
//! |---|---|
//! | [`gait`] | normative joint-angle curves of walking as Fourier series |
//! | [`walker`] | the whole body's state over time, feet on the ground |
//! | [`room`] | the way of a long walk, which turns before the walls |
//! | [`ring`] | cameras on a circle around a motion |
//! | [`draws`] | random numbers that are the same on every processor |
//! | [`crowd`] | several people, before a detector that takes one for another |
//! | [`crowd_absence`] | people who come late, leave and come back |
//! | [`detector`] | projections with offset, jitter, missing keypoints and gross outliers |
//! | [`evaluation_body`] | a clothed body of capsules and ellipsoids on the points of a motion |
//! | [`render`] | its silhouettes and pictures |
//! | [`segmentation_noise`] | silhouettes as a segmentation gives them |
//! | [`footage`] | cameras, person, masks and pictures of a motion |
//! | [`recording`] | all of it together, and as the files that other programs read |
//!
//! Everything follows from a seed, and nothing depends on the processor or the number of threads: the same seed gives the same bytes.
//!
//! ```
//! use sinew_simulate::recording::{SyntheticRecording, Script};
//! let recording = SyntheticRecording::new(&Script { duration_s: 0.5, ..Script::default() }, 7)?;
//! assert_eq!((recording.cameras.len(), recording.truth.frames.len()), (4, 15));
//! assert_eq!(recording.keypoints[0][0].len(), recording.layout.points.len());
//! # Ok::<(), sinew_observe::Error>(())
//! ```

pub mod adult;
pub mod calibration_error;
mod cast;
pub mod crowd;
pub mod crowd_absence;
pub mod detector;
pub mod draws;
mod error;
pub mod evaluation_body;
pub mod footage;
pub mod gait;
pub mod recording;
pub mod render;
pub mod ring;
pub mod room;
pub mod segmentation_noise;
mod space;
pub mod walker;

pub use error::Error;
