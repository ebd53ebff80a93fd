//! Time stamps of a motion file must rise: going back is an error, standing still a warning.

use crate::{Error, Place, Warning};

/// Watches the time column of a file, row by row.
#[derive(Default)]
pub(crate) struct RowTime {
    last: Option<f64>,
    rows: usize,
    still: u64,
    first_still: u64,
}

impl RowTime {
    pub(crate) fn check(&mut self, name: &str, time_s: f64) -> Result<(), Error> {
        self.rows += 1;
        if let Some(before) = self.last {
            if time_s < before {
                return Err(Error::TimeBackwards { place: Place::file(name), row: self.rows, before, after: time_s });
            }
            if time_s == before {
                self.still += 1;
                if self.still == 1 {
                    self.first_still = self.rows as u64;
                }
            }
        }
        self.last = Some(time_s);
        Ok(())
    }

    pub(crate) fn warning(&self, name: &str) -> Option<Warning> {
        let (rows, first) = (self.still, self.first_still);
        (rows > 0).then(|| Warning::TimeStandsStill { place: Place::file(name), rows, first })
    }
}
