//! Numbers that must be finite or positive.

use crate::Error;

pub(crate) fn finite(name: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(Error::OutOfRange { name, index, value: values[index], expected: "must be finite" }),
        None => Ok(()),
    }
}

pub(crate) fn positive(name: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|x| !(x.is_finite() && *x > 0.0)) {
        Some(index) => {
            Err(Error::OutOfRange { name, index, value: values[index], expected: "must be positive and finite" })
        }
        None => Ok(()),
    }
}
