//! The variance that resampling adds, scheme by scheme.
//!
//! - **One resampling**: 200 states from N(0, 1) in d coordinates are weighted by a likelihood of standard deviation ½ and resampled; the variance of the mean of what is left about the weighted mean, given the states. Of one
//!   coordinate and sorted, and of four as they come.
//! - **A filter**: a bootstrap filter of 200 particles on a linear-Gaussian series of four coordinates and 30 frames; the mean squared error of its means about the exact ones.
//!
//! Errors are standard errors over independent weighted sets, or runs, and the schemes share the sets and the runs' random numbers.

use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::Stage;
use sinew::samplers::resample::Scheme;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew_tests::finding::ratio_of_means;
use sinew_tests::linear_series::Series;

/// Schemes from the least expected variance to the largest.
pub(super) const SCHEMES: [Scheme; 4] = [Scheme::Systematic, Scheme::Stratified, Scheme::Residual, Scheme::Multinomial];

/// What is measured.
pub(super) const CASES: [&str; 3] =
    ["one resampling, d = 1, sorted", "one resampling, d = 4", "filter, d = 4, 30 frames"];

const PARTICLES: usize = 200;

/// Variances of one resampling, one row a weighted set, one column a scheme.
fn once(dim: usize, sorted: bool, sets: usize, replicates: usize, stage: &Stage) -> Vec<[f64; 4]> {
    let set = |index: usize| {
        let [draw, choose] = stage.round(index).split(["draw", "choose"]);
        let mut blocks = vec![Block::ZERO; dim * PARTICLES / 8];
        draw.whole().fill_normal(Isa::baseline(), &mut blocks);
        let flat: Vec<f64> = blocks.iter().flat_map(|block| block.0).collect();
        let mut states: Vec<&[f64]> = flat.chunks(dim).collect();
        if sorted {
            states.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
        let weight = |x: &&[f64]| x.iter().map(|x| -0.5 * ((x - 0.7) / 0.5).powi(2)).sum::<f64>().exp();
        let weights: Vec<f64> = states.iter().map(weight).collect();
        let total: f64 = weights.iter().sum();
        let mean = |j: usize| states.iter().zip(&weights).map(|(x, w)| w * x[j]).sum::<f64>() / total;
        let exact: Vec<f64> = (0..dim).map(mean).collect();
        SCHEMES.map(|scheme| {
            let mut rng = choose.block(0);
            let one = |rng: &mut _| {
                let ancestors = scheme.ancestors(&weights, PARTICLES, rng);
                let error = |j: usize| {
                    let sum: f64 = ancestors.iter().map(|&a| states[a][j]).sum();
                    (sum / PARTICLES as f64 - exact[j]).powi(2)
                };
                (0..dim).map(error).sum::<f64>() / dim as f64
            };
            (0..replicates).map(|_| one(&mut rng)).sum::<f64>() / replicates as f64
        })
    };
    (0..sets).map(set).collect()
}

/// Mean squared errors of a filter, one row a run, one column a scheme.
fn filtered(runs: usize, stage: &Stage) -> Outcome<Vec<[f64; 4]>> {
    let [data, filter] = stage.round(0).split(["data", "filter"]);
    let series = Series::simulated(4, 30, &data);
    let exact: Vec<Vec<f64>> = series.kalman().into_iter().map(|frame| frame.filtered.mean).collect();
    let mut rows = vec![];
    for run in 0..runs {
        let mut row = [0.0; 4];
        for (error, scheme) in row.iter_mut().zip(SCHEMES) {
            let config = bootstrap::Config { particles: PARTICLES, scheme, ..bootstrap::Config::default() };
            let mut tracker = Bootstrap::new(config, series.model(), series.m0.clone())?;
            for (frame, exact) in exact.iter().enumerate() {
                let info = tracker.step(&series.sight(frame), filter.round(run).at_frame(frame as u32))?;
                let squares = info.mean.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
                *error += squares / (4 * 30) as f64;
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Runs one of [`CASES`] and returns its rows.
pub(super) fn cell(case: usize, repeats: usize, stage: &Stage) -> Outcome<Value> {
    let rows = match case {
        0 => once(1, true, repeats, 100, stage),
        1 => once(4, false, repeats, 100, stage),
        _ => filtered(repeats, stage)?,
    };
    Ok(json!(rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>()))
}

/// Mean of each scheme over that of multinomial resampling, and its standard error from the paired rows (delta method).
pub(super) fn over_multinomial(rows: &[Vec<f64>]) -> [[f64; 2]; 4] {
    std::array::from_fn(|scheme| ratio_of_means(rows, scheme, 3))
}
