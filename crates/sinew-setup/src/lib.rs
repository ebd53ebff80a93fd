//! The set-up pass: everything that tracking needs to know before the first frame.
//!
//! [`set_up`] reads the people of some frames once, in order, and returns a [`Setup`], one plain value that is saved as `setup.toml`:
//!
//! 1. the tracked person is found by agreement of the cameras and followed ([`sinew_observe::association`]); of the frames that show them, an evenly spaced part is kept;
//! 2. one constant offset and the scatter of the detections, camera by camera, before any pose is known ([`sinew_observe::cameras::offsets`]);
//! 3. points in space, from which the sizes of the subject and the poses of the frames follow ([`sinew_body::bundle`]);
//! 4. the model error: joints of the body are not keypoints of a detector ([`shape`]);
//! 5. the pose of the first frame.
//!
//! Then, from the frames again, the motion noise ([`measure_motion`]), the posterior of everything that is constant and known up to an error ([`measure_lasting`]), and what the subject looks like ([`measure_look`]).
//!
//! A body from a file keeps the sizes that it has there: offsets, noise and the subject's sizes are found with H32, then the file's body is fitted to the points in
//! space, and the model error is what remains for that body ([`own_body`]).
//!
//! With one camera there are no points in space: offsets stay 0, the body keeps its default sizes, and the pose is fitted to pixels, its depth by the size of
//! the body ([`one_camera`]). How far that size may be from the person's is part of every interval ([`Setup::size_sd`]).

pub mod bodies;
pub mod body_limits;
pub mod calibration_fit;
pub mod checks;
pub mod clocks;
mod collect;
mod colours;
mod error;
mod error_persistence;
pub mod exchanged_cameras;
mod first_second;
mod girth;
mod known_setup;
pub mod lasting_draws;
pub mod lasting_errors;
pub mod lasting_posterior;
pub mod lasting_prior;
pub mod lasting_sources;
pub mod level_points;
mod looked_frames;
mod measured_colours;
mod measured_girth;
mod measured_lasting;
mod measured_look;
pub mod measured_mistakes;
mod measured_motion;
pub mod mirrored_places;
mod mistake_prior;
mod model_error;
pub mod motion_noise;
pub mod oddities;
pub mod one_camera;
pub mod own_body;
pub mod pass;
mod pose_fit;
pub mod posed_body;
pub mod predictive;
pub mod refined_calibration;
mod scale;
mod scatter;
pub mod segment_lengths;
mod setup_error;
pub mod shape;
pub mod shared_cameras;
pub mod silhouette_overlap;
mod space_points;
pub mod speed;
mod stored;
pub mod uncertainty;
pub mod unknown_size;
mod up_axis;
pub mod upward;
mod warning;

pub use collect::{Collected, SetupRequest, alone, collect, limb_lengths};
pub use colours::{MeasuredColours, PartColours};
pub use error::Error;
pub use girth::MeasuredGirth;
pub use known_setup::KnownSetup;
pub use lasting_errors::MeasuredErrors;
pub use measured_lasting::{measure_lasting, measure_lasting_with};
pub use measured_look::measure_look;
pub use measured_motion::measure_motion;
pub use pass::{find_up, set_up, unmeasured};
pub use pose_fit::pose_of;
pub use setup_error::SetupError;
pub use stored::{Body, CameraSetup, FileBody, SCHEMA, Setup};
pub use warning::SetupWarning;
