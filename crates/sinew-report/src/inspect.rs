//! What files contain, in a few lines, and what is odd about them.
//!
//! | module | looks at |
//! |---|---|
//! | [`file_facts`] | one file or folder, by what it is ([`Subject`]) |
//! | [`model_picture`] | a motion model, as a picture |
//! | [`latent_picture()`] | a latent model, as a picture |
//! | [`action_picture`], [`picture_of_actions`] | an action trace, as a picture |
//! | [`fit`] | a calibration and keypoints together: do they belong to each other? |

mod acclaim;
mod action_picture;
mod actions;
mod body_file;
mod c3d_file;
mod calibration;
mod draws;
pub(crate) mod error;
mod facts;
mod file_facts;
pub mod fit;
mod image_files;
mod keypoints;
mod lasting_facts;
mod latent_model;
mod latent_picture;
pub(crate) mod latent_plane;
mod model_picture;
mod motion_file;
mod motion_model;
mod people;
mod recognise;
mod results;
mod settings_file;
mod setup_file;
pub(crate) mod stick_figure;
mod subject;
mod table_file;
mod toml_file;

pub use action_picture::action_picture;
pub use actions::picture_of_actions;
pub use error::InspectError;
pub use facts::{Facts, Odd};
pub use file_facts::file_facts;
pub use latent_picture::latent_picture;
pub use model_picture::model_picture;
pub use recognise::subjects;
pub use subject::Subject;
