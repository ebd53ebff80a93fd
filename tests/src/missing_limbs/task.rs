//! A sequence that lacks some columns from a row on, and the sequences to learn from.

use std::error::Error;
use std::ops::Range;

pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Numbers of two consecutive frames.
pub type Row = Vec<f64>;

/// Number of columns of a row.
pub const COLUMNS: usize = 59;

/// A task.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// Sequences to learn from.
    pub training: Vec<&'a [Row]>,
    /// The sequence, whole.
    pub sequence: &'a [Row],
    /// First row that lacks columns.
    pub first: usize,
    /// The columns that it lacks.
    pub missing: Range<usize>,
}

/// Means and standard deviations (n − 1) of columns.
#[derive(Clone, Debug)]
pub struct Scales {
    /// Means.
    pub mean: Row,
    /// Standard deviations.
    pub sd: Row,
}

impl Task<'_> {
    /// The rows to be filled in, as they are.
    #[must_use]
    pub fn judged(&self) -> &[Row] {
        &self.sequence[self.first..]
    }

    /// Columns that are always there.
    #[must_use]
    pub fn observed(&self) -> Vec<usize> {
        (0..COLUMNS).filter(|j| !self.missing.contains(j)).collect()
    }

    /// Means and standard deviations of the training rows.
    #[must_use]
    pub fn scales(&self) -> Scales {
        let rows: Vec<&Row> = self.training.iter().copied().flatten().collect();
        let count = rows.len() as f64;
        let mean: Row = (0..COLUMNS).map(|j| rows.iter().map(|row| row[j]).sum::<f64>() / count).collect();
        let variance = |j: usize| rows.iter().map(|row| (row[j] - mean[j]).powi(2)).sum::<f64>() / (count - 1.0);
        Scales { sd: (0..COLUMNS).map(|j| variance(j).sqrt()).collect(), mean }
    }

    /// The judged rows with these columns in place of the missing ones.
    #[must_use]
    pub fn with(&self, columns: impl Fn(&Row) -> Row) -> Vec<Row> {
        let fill = |row: &Row| {
            let mut filled = row.clone();
            filled[self.missing.clone()].copy_from_slice(&columns(row));
            filled
        };
        self.judged().iter().map(fill).collect()
    }
}

impl Scales {
    /// A column of a row in standard deviations from the mean.
    #[must_use]
    pub fn apply(&self, row: &Row, column: usize) -> f64 {
        (row[column] - self.mean[column]) / self.sd[column]
    }

    /// Back to the column's unit.
    #[must_use]
    pub fn restore(&self, column: usize, value: f64) -> f64 {
        value * self.sd[column] + self.mean[column]
    }
}
