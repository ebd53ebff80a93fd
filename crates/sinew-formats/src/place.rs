//! Where in a file something was found.
//!
//! Shown as `file:line (within)`, for example `Calib.toml:5 (cam_01)`; parts that are not known are left out.
//!
//! ```
//! use sinew_formats::Place;
//! assert_eq!(Place::file("Calib.toml").at_line(5).within("cam_01").to_string(), "Calib.toml:5 (cam_01)");
//! assert_eq!(Place::file("markers.trc").to_string(), "markers.trc");
//! ```

use crate::Error;
use std::fmt;

/// File, line and part of a file, for messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Name to show, as the caller gave it.
    pub file: Box<str>,
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// Camera, frame, joint or table.
    pub within: Option<Box<str>>,
}

impl Place {
    /// The file as a whole.
    #[must_use]
    pub fn file(name: &str) -> Self {
        Self { file: name.into(), line: None, within: None }
    }

    /// The same with a line, counted from 1.
    #[must_use]
    pub fn at_line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    /// The same with a camera, frame, joint or table.
    #[must_use]
    pub fn within(mut self, within: impl Into<String>) -> Self {
        self.within = Some(within.into().into_boxed_str());
        self
    }

    /// The error that something else stands here.
    pub(crate) fn syntax(self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::Syntax { place: self, found: found.into(), expected: expected.into() }
    }

    /// The error that a field has a value that it must not have.
    pub(crate) fn bad_value(
        self,
        field: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::BadValue { place: self, field: field.into(), found: found.into(), expected: expected.into() }
    }

    /// The error that a field is missing.
    pub(crate) fn lacks(self, field: impl Into<String>) -> Error {
        Error::MissingField { place: self, field: field.into() }
    }

    /// The error that a name is there twice.
    pub(crate) fn twice(self, what: &'static str, name: impl Into<String>) -> Error {
        Error::DuplicateName { place: self, what, name: name.into() }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(within) = &self.within {
            write!(f, " ({within})")?;
        }
        Ok(())
    }
}
