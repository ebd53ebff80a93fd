//! The benchmark of missing limbs: a leg or the body of subject 35 to fill in.
//!
//! (Taylor, Hinton & Roweis 2007; Lawrence 2007, "Learning for larger datasets with the Gaussian process latent variable model", section 4.1.)
//!
//! A row describes two consecutive frames of a sequence: 50 angles of the later one in radians, then nine numbers on the root, whose horizontal position and heading enter as changes alone. The last sequence of the test set
//! is judged from its row [`FIRST_JUDGED`] on, where some columns are taken away and filled in from the others.

use std::error::Error;
use std::fs;
use std::ops::Range;
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

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

/// Rows of a benchmark, with the mean and the standard deviation (n − 1) of their columns.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// What is learned from, a row a pair of frames, by sequence.
    pub training: Vec<Vec<Vec<f64>>>,
    /// The test sequence.
    pub test: Vec<Vec<f64>>,
    /// Means of the training rows.
    pub mean: Vec<f64>,
    /// Standard deviations of the training rows.
    pub sd: Vec<f64>,
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
        let taylor = scales[SCALES_BEFORE..].iter().map(|row| row[0]).collect();
        let rows: Vec<&Vec<f64>> = training.iter().flatten().collect();
        let (count, dim) = (rows.len() as f64, test[0].len());
        let mean: Vec<f64> = (0..dim).map(|j| rows.iter().map(|row| row[j]).sum::<f64>() / count).collect();
        let variance = |j: usize| rows.iter().map(|row| (row[j] - mean[j]).powi(2)).sum::<f64>() / (count - 1.0);
        let sd = (0..dim).map(|j| variance(j).sqrt()).collect();
        Ok(Self { training, test, mean, sd, taylor })
    }

    /// A row in standard deviations from the mean.
    #[must_use]
    pub fn scaled(&self, row: &[f64]) -> Vec<f64> {
        row.iter().zip(&self.mean).zip(&self.sd).map(|((x, mean), sd)| (x - mean) / sd).collect()
    }

    /// Errors of rows that were filled in, one for each judged row of the test sequence, in its own units.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn judged(&self, filled: &[Vec<f64>], missing: Range<usize>) -> Filled {
        let truth = &self.test[FIRST_JUDGED..];
        assert_eq!(filled.len(), truth.len(), "rows that were filled in");
        let (mut cumulative, mut squares) = (0.0, 0.0);
        for (found, truth) in filled.iter().zip(truth) {
            for j in missing.clone() {
                let error = (found[j] - truth[j]).to_degrees();
                squares += error * error;
                cumulative += (error * self.taylor[j]).powi(2);
            }
        }
        let columns = missing.len() as f64;
        Filled { cumulative: cumulative / columns, rms_deg: (squares / (columns * truth.len() as f64)).sqrt() }
    }

    /// The judged rows, each filled in from the training row nearest to it in the other columns: raw, or in standard deviations.
    #[must_use]
    pub fn nearest_neighbours(&self, missing: &Range<usize>, is_scaled: bool) -> Vec<Vec<f64>> {
        let weights: Vec<f64> = match is_scaled {
            true => self.sd.iter().map(|sd| sd.powi(-2)).collect(),
            false => vec![1.0; self.sd.len()],
        };
        let distance = |a: &[f64], b: &[f64]| {
            let terms = a.iter().zip(b).zip(&weights).enumerate().filter(|(j, _)| !missing.contains(j));
            terms.map(|(_, ((a, b), weight))| weight * (a - b).powi(2)).sum::<f64>()
        };
        let nearest = |row: &Vec<f64>| {
            let near = |a: &&Vec<f64>, b: &&Vec<f64>| distance(a, row).total_cmp(&distance(b, row));
            self.training.iter().flatten().min_by(near).cloned().unwrap_or_default()
        };
        self.test[FIRST_JUDGED..].iter().map(nearest).collect()
    }
}
