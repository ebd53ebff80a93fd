//! The diagnostics of the frames so far, in a file of the program's own, `diagnostics.partial`.
//!
//! The summary at the end needs quantiles over all frames, and memory shall not grow with them.
//!
//! A row of numbers a frame ([`crate::results::estimate::diagnostics`]), little-endian.

use super::partial::{PartialFile, Place};
use crate::Error;
use crate::results::estimate::{FrameEstimate, diagnostics};
use std::io::{self, Read as _, Write as _};

/// Name of the file, but for `.partial`: it never gets another.
pub(crate) const NAME: &str = "diagnostics";

pub(crate) struct Journal {
    pub(crate) file: PartialFile,
    cameras: usize,
}

impl Journal {
    pub(crate) fn open(place: &Place<'_>, cameras: usize) -> Result<Self, Error> {
        Ok(Self { file: place.file(NAME, |_| Ok(()))?, cameras })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let row = diagnostics::numbers(estimate, self.cameras);
        self.file.write(|out| row.iter().try_for_each(|number| out.write_all(&number.to_le_bytes())))
    }

    /// Gives the frames so far to `each`, with nothing in them but their diagnostics.
    pub(crate) fn read_back(&mut self, fps: f64, mut each: impl FnMut(&FrameEstimate)) -> Result<(), Error> {
        let mut stream = self.file.read_back()?;
        let mut bytes = vec![0; 8 * diagnostics::count(self.cameras)];
        loop {
            match stream.read_exact(&mut bytes) {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
                Err(error) => return Err(Error::io("read", NAME)(error)),
            }
            let row: Vec<f64> = bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
            if let Some(frame) = diagnostics::estimate(&row, fps) {
                each(&frame);
            }
        }
    }
}
