//! Learning of models from motion files, resumable to the same bytes.
//!
//! | module | what |
//! |---|---|
//! | [`primitives`] | a motion model of action primitives |
//! | [`latent`] | a latent model: GPLVM, GPDM or HGPLVM |
//! | [`motion_files`], [`sequences`] | motion files as a body's states at the rate of a model: for both |
//! | [`features`], [`limbs`] | which coordinates are learned together |
//! | [`selection`], [`reconstruction`] | which rows a latent model is learned from; how well it keeps poses |

pub(crate) mod error;
pub mod features;
pub mod latent;
pub mod limbs;
pub mod motion_files;
pub mod primitives;
pub mod reconstruction;
pub mod selection;
pub mod sequences;
mod unfinished;

pub use error::LearnError;
