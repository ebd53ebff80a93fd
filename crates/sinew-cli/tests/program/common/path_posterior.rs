//! The exact posterior of a path of states that walk at random and are seen by linear observations with Gaussian errors: one Gaussian of all states, by one inverse. No filter and no smoother is run.

/// Numbers of a state.
pub const DIM: usize = 4;

/// A linear observation of the state in a frame.
#[derive(Clone, Debug)]
pub struct Row {
    pub frame: usize,
    /// What it is of: rows of different frames with the same number are of the same camera, point and axis.
    pub of: usize,
    pub by_state: [f64; DIM],
    /// Observed less what a state of zeros would show.
    pub value: f64,
    pub variance: f64,
}

/// N(mean, diagonal of squares) of the first state, and standard deviations of a step.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    pub start: [f64; DIM],
    pub start_sd: [f64; DIM],
    pub step_sd: [f64; DIM],
}

/// Moments of all states, frame after frame.
pub struct PathPosterior {
    pub mean: Vec<f64>,
    pub covariance: Vec<Vec<f64>>,
    /// By how much each row's value moves each number of the mean.
    pub gain: Vec<Vec<f64>>,
    pub log_evidence: f64,
}

/// Inverse of a positive definite matrix and the logarithm of its determinant, by elimination.
pub fn inverse(matrix: &[Vec<f64>]) -> (Vec<Vec<f64>>, f64) {
    let n = matrix.len();
    let unit = |i: usize| (0..n).map(move |j| f64::from(u8::from(i == j)));
    let mut rows: Vec<Vec<f64>> =
        matrix.iter().enumerate().map(|(i, row)| row.iter().copied().chain(unit(i)).collect()).collect();
    let mut log_determinant = 0.0;
    for i in 0..n {
        let pivot = rows[i][i];
        assert!(pivot > 0.0, "not positive definite");
        log_determinant += pivot.ln();
        rows[i].iter_mut().for_each(|x| *x /= pivot);
        let own = rows[i].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = row[i];
            if factor != 0.0 {
                row.iter_mut().zip(&own).for_each(|(x, by)| *x -= factor * by);
            }
        }
    }
    (rows.into_iter().map(|row| row[n..].to_vec()).collect(), log_determinant)
}

impl PathPosterior {
    /// The states of the frames up to `last`, given the rows of these frames.
    pub fn new(walk: &Walk, all: &[Row], last: usize) -> Self {
        let rows: Vec<&Row> = all.iter().filter(|row| row.frame <= last).collect();
        let n = DIM * (last + 1);
        let mut precision = vec![vec![0.0; n]; n];
        let mut pull = vec![0.0; n];
        let mut squares = 0.0;
        let mut log_scale = 0.0;
        for k in 0..n {
            let sd = if k < DIM { walk.start_sd[k] } else { walk.step_sd[k % DIM] };
            let weight = sd.powi(-2);
            log_scale += 2.0 * sd.ln();
            precision[k][k] += weight;
            if k < DIM {
                pull[k] += weight * walk.start[k];
                squares += weight * walk.start[k].powi(2);
            } else {
                precision[k - DIM][k - DIM] += weight;
                precision[k][k - DIM] -= weight;
                precision[k - DIM][k] -= weight;
            }
        }
        for row in &rows {
            let first = DIM * row.frame;
            for i in 0..DIM {
                pull[first + i] += row.by_state[i] * row.value / row.variance;
                for j in 0..DIM {
                    precision[first + i][first + j] += row.by_state[i] * row.by_state[j] / row.variance;
                }
            }
            squares += row.value.powi(2) / row.variance;
            log_scale += (std::f64::consts::TAU * row.variance).ln();
        }
        let (covariance, log_determinant) = inverse(&precision);
        let times = |row: &Vec<f64>| row.iter().zip(&pull).map(|(c, p)| c * p).sum::<f64>();
        let mean: Vec<f64> = covariance.iter().map(times).collect();
        let gained: f64 = mean.iter().zip(&pull).map(|(m, p)| m * p).sum();
        let gain_of = |number: &Vec<f64>, row: &&Row| {
            (0..DIM).map(|i| number[DIM * row.frame + i] * row.by_state[i]).sum::<f64>() / row.variance
        };
        let gain = covariance.iter().map(|number| rows.iter().map(|row| gain_of(number, row)).collect()).collect();
        Self { mean, covariance, gain, log_evidence: -0.5 * (log_scale + log_determinant + squares - gained) }
    }
}
