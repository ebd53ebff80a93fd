//! Rows of data centred, and scaled where that is wanted, and back.

use crate::Error;
use crate::columns::count_rows;
use serde::{Deserialize, Serialize};

/// What was taken from each column, and by what it was divided then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standard {
    /// Means of the columns.
    pub mean: Vec<f64>,
    /// Divisors of the columns, positive.
    pub scale: Vec<f64>,
}

/// What is done to columns before a model is learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preparation {
    /// Means are taken off.
    Centred,
    /// Means are taken off, and columns divided by their standard deviation (by 1 where that is below 10⁻⁴).
    Standardised,
}

impl Standard {
    /// Means and divisors of rows of length `cols`, one after the other.
    ///
    /// # Errors
    /// [`Error::Shape`] and [`Error::OutOfRange`] where there are no whole finite rows.
    pub fn new(rows: &[f64], cols: usize, preparation: Preparation) -> Result<Self, Error> {
        let count = count_rows("data", rows, cols)? as f64;
        let mut mean = vec![0.0; cols];
        for row in rows.chunks_exact(cols) {
            mean.iter_mut().zip(row).for_each(|(m, x)| *m += x / count);
        }
        let mut scale = vec![1.0; cols];
        if preparation == Preparation::Standardised {
            for (j, scale) in scale.iter_mut().enumerate() {
                let square: f64 = rows.chunks_exact(cols).map(|row| (row[j] - mean[j]).powi(2)).sum();
                let deviation = (square / count).sqrt();
                *scale = if deviation < 1e-4 { 1.0 } else { deviation };
            }
        }
        Ok(Self { mean, scale })
    }

    /// Rows as the model sees them.
    #[must_use]
    pub fn apply(&self, rows: &[f64]) -> Vec<f64> {
        let cols = self.mean.len();
        rows.iter().enumerate().map(|(k, x)| (x - self.mean[k % cols]) / self.scale[k % cols]).collect()
    }

    /// One number of a column, from the model's units back to the data's.
    #[must_use]
    pub fn restore(&self, column: usize, value: f64) -> f64 {
        value * self.scale[column] + self.mean[column]
    }
}
