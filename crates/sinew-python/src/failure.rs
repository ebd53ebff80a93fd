//! What goes wrong, as Python's exceptions.
//!
//! The classes stand in `sinew/_errors.py`; the program's exit code chooses one of them. The text has the lines that the program prints, with keyword arguments for flags: what, `caused by`, `help`.

use pyo3::prelude::*;
pub(crate) use sinew_words::exit_codes::{FAILED, INPUT, USAGE};
use std::error::Error;

/// An error on its way to Python.
#[derive(Debug)]
pub(crate) struct Failure {
    /// The code with which the program would end.
    pub code: u8,
    /// What went wrong.
    pub what: String,
    /// What caused it, outermost first.
    pub causes: Vec<String>,
    /// What to do.
    pub help: Option<String>,
}

impl Failure {
    /// A failure with a code, its causes and help.
    pub(crate) fn new(code: u8, error: &dyn Error, help: Option<String>) -> Self {
        let mut causes = vec![];
        let mut cause = error.source();
        while let Some(inner) = cause {
            causes.push(inner.to_string());
            cause = inner.source();
        }
        Self { code, what: error.to_string(), causes, help }
    }

    /// An argument that cannot be used.
    pub(crate) fn argument(what: impl Into<String>) -> Self {
        Self { code: INPUT, what: what.into(), causes: vec![], help: None }
    }

    /// A fault of ours.
    pub(crate) fn bug(what: impl Into<String>) -> Self {
        let help = "this is a bug; please report it with the lines above".to_owned();
        Self { code: FAILED, what: what.into(), causes: vec![], help: Some(help) }
    }

    fn exception(&self, py: Python<'_>) -> PyResult<PyErr> {
        let made = py.import("sinew._errors")?.getattr("error")?;
        Ok(PyErr::from_value(made.call1((self.code, &self.what, &self.causes, self.help.as_deref()))?))
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| failure.exception(py).unwrap_or_else(|error| error))
    }
}

/// Errors of values that a caller gave.
macro_rules! argument_errors {
    ($($error:ty),+) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new(INPUT, &error, None)
            }
        })+
    };
}

argument_errors!(sinew::body::Error, sinew::observe::Error, sinew::samplers::Error);

/// Errors that know the program's exit code and advice.
macro_rules! program_errors {
    ($($error:ty),+) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                let error = sinew_report::Error::from(error);
                Self::new(sinew_words::exit_code(&error), &error, sinew_words::help(&error))
            }
        })+
    };
}

program_errors!(
    sinew::Error,
    sinew_input::Error,
    sinew_setup::Error,
    sinew_results::Error,
    sinew_motion::Error,
    sinew_report::Error
);

impl From<sinew::formats::Error> for Failure {
    fn from(error: sinew::formats::Error) -> Self {
        sinew::Error::from(error).into()
    }
}
