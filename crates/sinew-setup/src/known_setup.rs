//! A set-up of an earlier run, read once for all runs that begin with it.
//!
//! Its draws make half a megabyte of text, which takes as long to read as a few frames to track.

use super::setup_error::SetupError;
use super::stored::Setup;

/// A set-up with its text.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownSetup {
    /// The set-up.
    pub setup: Setup,
    /// What [`Setup::to_toml`] says of it.
    pub toml: String,
}

impl KnownSetup {
    /// A set-up that is known.
    ///
    /// # Errors
    /// As [`Setup::to_toml`].
    pub fn new(setup: Setup) -> Result<Self, SetupError> {
        let toml = setup.to_toml()?;
        Ok(Self { setup, toml })
    }
}
