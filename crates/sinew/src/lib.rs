//! Tracks a moving human body from calibrated cameras and returns a posterior over 3D poses for every frame.
//!
//! The stations of a run, each a module whose page says what enters, what leaves and what it must not know:
//!
//! | module | what |
//! |---|---|
//! | [`input`] | keypoints, masks and images of a recording, one frame at a time |
//! | [`setup`] | sizes of the person, offsets of the cameras, noise: one value |
//! | [`methods`] | one file a method: what it needs and gives, its settings, how it is made |
//! | [`track`] | the loop: observe, step, record; a whole run and its checkpoint |
//! | [`run`] | whole runs: from settings to result folders, of one person or several, stopped and continued, live |
//! | [`predict`] | what a camera that a run did not use should see |
//! | [`results`] | estimates, the files of a run, and the same files read again |
//!
//! Beside them: [`config`] (settings with their origin), [`bodies`] (bodies by name or file) and [`files`]. Input, set-up and results are crates of their own. The layers below are re-exported
//! as modules; each can be used alone.
//!
//! A simulated walker is seen by four cameras, and the set-up pass finds the length of the thighs from the keypoints alone:
//!
//! ```
//! use sinew::input::in_memory::InMemory;
//! use sinew::input::source::FrameSource;
//! use sinew::setup::{self, SetupRequest};
//! use sinew_simulate::recording::{Script, SyntheticRecording};
//!
//! let walk = SyntheticRecording::new(&Script { duration_s: 1.5, ..Script::default() }, 1)?;
//! let mut source = InMemory { cameras: walk.cameras, layout: walk.layout, keypoints: walk.keypoints };
//! let frames: Vec<_> = source.frames().map(|number| Ok::<_, sinew::Error>((number, source.people(number)?))).collect();
//!
//! let (found, _) = setup::set_up(&source.cameras, &source.layout, &SetupRequest::default(), frames)?;
//! let knee = found.tree().link_index("r_shin").ok_or("no knee")?;
//! let thigh_m = -found.tree().links()[knee].offset[2];
//! assert!((thigh_m - 0.43).abs() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use sinew_angles as angles;
pub use sinew_body as body;
pub use sinew_core as core;
pub use sinew_dynamics as dynamics;
pub use sinew_formats as formats;
pub use sinew_latent as latent;
pub use sinew_observe as observe;
pub use sinew_samplers as samplers;
pub use sinew_tracking as tracking;

pub mod config;
mod error;
pub mod methods;
pub mod predict;
pub mod run;
pub mod track;

pub use error::{Error, with_causes};
pub use sinew_input as input;
pub use sinew_input::{FileError, Problems, files};
pub use sinew_results as results;
pub use sinew_setup as setup;
pub use sinew_setup::bodies;
