//! How often central intervals of a weighted set hold the truth, over frames whose exact posterior is known.
//!
//! For each coordinate and frame the truth's place u = Σ W_i 1(s_i < truth) among the weighted draws is taken; the central interval of level p holds it where |u − ½| < p / 2.

use sinew::tracking::posterior::Posterior;
use sinew_tests::evaluation::weighted_places::{is_inside, spreads, weighted_places};
use sinew_tests::finding::mean_and_error;

/// Nominal levels.
pub(super) const LEVELS: [f64; 4] = [0.5, 0.8, 0.9, 0.95];

/// Columns of a row: a share inside for each level, the set's standard deviation over the exact one, and the squared distance of its mean from the exact mean in exact standard deviations.
pub(super) const COLUMNS: usize = LEVELS.len() + 2;

/// Sums over coordinates and frames.
#[derive(Default)]
pub(super) struct Tally {
    sums: [f64; COLUMNS],
    count: usize,
}

impl Tally {
    /// Adds a frame with its exact means and standard deviations.
    pub(super) fn add(&mut self, posterior: &Posterior<'_>, truth: &[f64], exact_mean: &[f64], exact_sd: &[f64]) {
        let mean = posterior.mean();
        let (below, spread) = (weighted_places(posterior, truth), spreads(posterior, &mean));
        for j in 0..truth.len() {
            for (sum, level) in self.sums.iter_mut().zip(LEVELS) {
                *sum += f64::from(u8::from(is_inside(below[j], level)));
            }
            self.sums[LEVELS.len()] += spread[j] / exact_sd[j];
            self.sums[LEVELS.len() + 1] += ((mean[j] - exact_mean[j]) / exact_sd[j]).powi(2);
        }
        self.count += truth.len();
    }

    /// Means over coordinates and frames.
    pub(super) fn row(&self) -> [f64; COLUMNS] {
        self.sums.map(|sum| sum / self.count as f64)
    }
}

/// Means and standard errors of the columns of rows; the last is the root of the mean square.
pub(super) fn summary(rows: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let column = |k: usize| {
        let [mean, error] = mean_and_error(&rows.iter().map(|row| row[k]).collect::<Vec<_>>());
        if k + 1 == COLUMNS { [mean.sqrt(), 0.5 * error / mean.sqrt()] } else { [mean, error] }
    };
    (0..COLUMNS).map(column).collect()
}
