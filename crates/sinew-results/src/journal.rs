//! The diagnostics of the frames so far, in a file of the program's own, `diagnostics.partial`.
//!
//! The summary at the end needs quantiles over all frames, and memory shall not grow with them.
//!
//! A row of numbers a frame ([`crate::estimate::diagnostics`], then the standard deviations of the points), little-endian.

use super::partial::{FilePlace, PartialFile};
use crate::Error;
use crate::estimate::{FrameEstimate, PointMarginal, diagnostics};
use std::io::{self, Read as _, Write as _};

/// Name of the file, but for `.partial`: it never gets another.
pub(crate) const NAME: &str = "diagnostics";

pub(crate) struct Journal {
    pub(crate) file: PartialFile,
    cameras: usize,
    points: usize,
}

impl Journal {
    pub(crate) fn open(place: &FilePlace<'_>, cameras: usize, points: usize) -> Result<Self, Error> {
        Ok(Self { file: place.file(NAME, |_| Ok(()))?, cameras, points })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let mut row = diagnostics::numbers(estimate, self.cameras);
        row.extend(estimate.points.iter().flat_map(|point| point.sd));
        self.file.write(|out| row.iter().try_for_each(|number| out.write_all(&number.to_le_bytes())))
    }

    /// Gives the frames so far to `each`, with nothing in them but their diagnostics and the standard deviations of their points.
    pub(crate) fn read_back(&mut self, fps: f64, mut each: impl FnMut(&FrameEstimate)) -> Result<(), Error> {
        let mut stream = self.file.read_back()?;
        let scalars = diagnostics::count(self.cameras);
        let mut bytes = vec![0; 8 * (scalars + 3 * self.points)];
        loop {
            match stream.read_exact(&mut bytes) {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
                Err(error) => return Err(Error::io("read", NAME)(error)),
            }
            let row: Vec<f64> = bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
            let (row, sd) = row.split_at(scalars);
            if let Some(frame) = diagnostics::estimate(row, fps) {
                let point = |sd: &[f64; 3]| PointMarginal { sd: *sd, ..PointMarginal::default() };
                each(&FrameEstimate { points: sd.as_chunks().0.iter().map(point).collect(), ..frame });
            }
        }
    }
}
