//! Bytes of a C3D file, read within their bounds in the order of its processor.

use super::processor::Processor;
use crate::{Error, Place};

/// Bytes of a block.
pub(super) const BLOCK: usize = 512;

/// A file in memory.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) name: &'a str,
    pub(super) bytes: &'a [u8],
    pub(super) processor: Processor,
}

impl<'a> Source<'a> {
    /// `inside` names what would be cut off, with its article.
    pub(super) fn slice(&self, at: usize, length: usize, inside: &'static str) -> Result<&'a [u8], Error> {
        let slice = at.checked_add(length).and_then(|end| self.bytes.get(at..end));
        slice.ok_or_else(|| Error::Truncated {
            place: Place::file(self.name),
            inside,
            offset: self.bytes.len(),
            line: None,
        })
    }

    pub(super) fn byte(&self, at: usize, inside: &'static str) -> Result<u8, Error> {
        Ok(self.slice(at, 1, inside)?[0])
    }

    pub(super) fn word(&self, at: usize, inside: &'static str) -> Result<u16, Error> {
        let slice = self.slice(at, 2, inside)?;
        Ok(self.processor.word([slice[0], slice[1]]))
    }

    pub(super) fn real(&self, at: usize, inside: &'static str) -> Result<f64, Error> {
        let slice = self.slice(at, 4, inside)?;
        Ok(self.processor.real([slice[0], slice[1], slice[2], slice[3]]))
    }

    /// A value that cannot be; `field` is called as the format calls it.
    pub(super) fn bad(&self, field: &str, found: impl ToString, expected: &str) -> Error {
        Place::file(self.name).bad_value(field, found.to_string(), expected)
    }

    /// A place in the file, counted from byte 1.
    pub(super) fn place(&self, at: usize) -> Place {
        Place::file(self.name).within(format!("byte {}", at + 1))
    }
}
