//! A comma-separated table being written.

use super::partial::{FilePlace, PartialFile};
use crate::Error;
use sinew_formats::tidy_csv::{Cell, write_header, write_row};

/// A table with a fixed header.
pub(crate) struct Table {
    pub(crate) file: PartialFile,
}

impl Table {
    pub(crate) fn open(place: &FilePlace<'_>, name: &str, columns: &[impl AsRef<str>]) -> Result<Self, Error> {
        Ok(Self { file: place.file(name, |out| write_header(out, columns))? })
    }

    pub(crate) fn append(&mut self, cells: &[Cell<'_>]) -> Result<(), Error> {
        self.file.write(|out| write_row(out, cells))
    }
}

/// A count.
pub(crate) fn integer(value: u64) -> Cell<'static> {
    Cell::Integer(i64::try_from(value).unwrap_or(i64::MAX))
}

/// A diagnostic, or nothing where a method does not have it; an infinite one (R-hat of chains that never moved) becomes NaN.
pub(crate) fn optional(value: Option<f64>) -> Cell<'static> {
    value.map_or(Cell::Empty, |value| Cell::Number(if value.is_finite() { value } else { f64::NAN }))
}
