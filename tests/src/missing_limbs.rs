//! The benchmark of missing limbs: a leg or the body of subject 35 to fill in.
//!
//! (Taylor, Hinton & Roweis 2007; Lawrence 2007, "Learning for larger datasets with the Gaussian process latent variable model", section 4.1.)
//!
//! A row describes two consecutive frames of a sequence: 50 angles of the later one in radians, then nine numbers on the root, whose horizontal position and heading enter as changes alone. The last sequence of the test set
//! is judged from its row [`FIRST_JUDGED`] on, where some columns are taken away and filled in from the others.

use std::fs;
use std::ops::Range;
use std::path::Path;

pub mod latent;
pub mod mixture;
pub mod neighbours;
pub mod process;
pub mod task;

use task::{Outcome, Row, Task};

/// First row of the test sequence whose columns are missing.
pub const FIRST_JUDGED: usize = 62;
/// Columns of the leg.
pub const LEG: Range<usize> = 7..14;
/// Columns of the body.
pub const BODY: Range<usize> = 20..50;
/// Channels of a frame that are angles of joints.
const ANGLES: [Range<usize>; 5] = [6..38, 40..47, 48..50, 52..59, 60..62];
/// Columns before Taylor's scales that are no angles.
const SCALES_BEFORE: usize = 9;

/// Rows of a benchmark.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// What is learned from, a row a pair of frames, by sequence.
    pub training: Vec<Vec<Row>>,
    /// The test sequence.
    pub test: Vec<Row>,
    /// Taylor's scales of the angles, by column.
    taylor: Vec<f64>,
}

/// Errors of what was filled in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filled {
    /// Sum of the squared errors in Taylor's scales over the number of missing columns.
    pub cumulative: f64,
    /// Root mean square, degrees.
    pub rms_deg: f64,
}

fn numbers(path: &Path) -> Outcome<Vec<Vec<f64>>> {
    let text = fs::read_to_string(path)?;
    let row = |line: &str| line.split(',').map(|number| Ok(number.trim().parse()?)).collect();
    text.lines().skip(1).map(row).collect()
}

/// Frames by sequence, whose number stands in the first column.
fn sequences(path: &Path) -> Outcome<Vec<Vec<Vec<f64>>>> {
    let rows = numbers(path)?;
    let by_sequence = rows.chunk_by(|a, b| a[0] == b[0]);
    Ok(by_sequence.map(|rows| rows.iter().map(|row| row[1..].to_vec()).collect()).collect())
}

/// The row of two consecutive frames.
fn features(before: &[f64], after: &[f64]) -> Vec<f64> {
    let [now, then] = [after, before].map(|frame| move |channel: usize| frame[channel].to_radians());
    let mut row: Vec<f64> = ANGLES.into_iter().flatten().map(|channel| now(channel).sin().asin()).collect();
    row.extend([before[0] - after[0], before[2] - after[2], after[1]]);
    row.extend([now(3).sin(), now(5).sin(), then(4).sin() - now(4).sin()]);
    row.extend([now(3).cos(), now(5).cos(), then(4).cos() - now(4).cos()]);
    row
}

fn pairs(sequence: &[Vec<f64>]) -> Vec<Vec<f64>> {
    sequence.windows(2).map(|pair| features(&pair[0], &pair[1])).collect()
}

impl Benchmark {
    /// Reads `train.csv`, `test.csv` and `taylor_scale_bias.csv` of a folder.
    ///
    /// # Errors
    /// Files that are missing or hold anything else.
    pub fn read(folder: &Path) -> Outcome<Self> {
        let training: Vec<_> = sequences(&folder.join("train.csv"))?.iter().map(|sequence| pairs(sequence)).collect();
        let test = sequences(&folder.join("test.csv"))?;
        let test = pairs(test.last().ok_or("no test sequence")?);
        let scales = numbers(&folder.join("taylor_scale_bias.csv"))?;
        let taylor = scales.iter().skip(SCALES_BEFORE).map(|row| row[0]).collect();
        Ok(Self { training, test, taylor })
    }

    /// The task that was published: the last sequence, from its row [`FIRST_JUDGED`] on, after learning from all others.
    #[must_use]
    pub fn published(&self, missing: &Range<usize>) -> Task<'_> {
        let training = self.training.iter().map(Vec::as_slice).collect();
        Task { training, sequence: &self.test, first: FIRST_JUDGED, missing: missing.clone() }
    }

    /// The same for the later half of one training sequence, after learning from those that are not left out.
    #[must_use]
    pub fn left_out(&self, all: &[usize], one: usize, missing: &Range<usize>) -> Task<'_> {
        let kept = self.training.iter().enumerate().filter(|(i, _)| !all.contains(i));
        let (training, sequence) = (kept.map(|(_, rows)| rows.as_slice()).collect(), self.training[one].as_slice());
        Task { training, sequence, first: sequence.len() / 2, missing: missing.clone() }
    }

    /// Errors of rows that were filled in, one for each judged row, in their own units.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn judged(&self, task: &Task<'_>, filled: &[Row]) -> Filled {
        let truth = task.judged();
        assert_eq!(filled.len(), truth.len(), "rows that were filled in");
        let (mut cumulative, mut squares) = (0.0, 0.0);
        for (found, truth) in filled.iter().zip(truth) {
            for j in task.missing.clone() {
                let error = (found[j] - truth[j]).to_degrees();
                squares += error * error;
                cumulative += (error * self.taylor[j]).powi(2);
            }
        }
        let columns = task.missing.len() as f64;
        Filled { cumulative: cumulative / columns, rms_deg: (squares / (columns * truth.len() as f64)).sqrt() }
    }
}
