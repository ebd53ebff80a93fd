//! Calibration of filters (J3): errors e of a filter's mean about the true state, eᵀ P⁻¹ e, on simulated linear-Gaussian series. With the exact covariance P their mean is the dimension of the state, and a little more for what the filter's
//! own draws add. With the filter's own P it is larger by a few per cent, since a covariance of few draws has too large an inverse: that number is shown, not judged.

use crate::finding::{Finding, mean_and_error};
use crate::linear_series::{Series, Sight, chains_on_series, dot};
use crate::size::Size;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::HmcFilter;

/// Mean of eᵀ P⁻¹ e over the frames of one series: with the exact covariance, and with the filter's own.
fn normalised_error(series: &Series, tracker: &mut impl Tracker<Sight>, stage: &Stage) -> [f64; 2] {
    let d = series.dim;
    let mut sums = [0.0; 2];
    for ((frame, truth), exact) in series.truth.iter().enumerate().zip(series.kalman()) {
        tracker.step(&series.sight(frame), stage.round(frame)).expect("a posterior");
        let moments = tracker.posterior().moments(Isa::best());
        let error: Vec<f64> = truth.iter().zip(&moments.mean).map(|(x, m)| x - m).collect();
        for (sum, covariance) in sums.iter_mut().zip([&exact.filtered.covariance, &moments.covariance]) {
            let lower = cholesky("covariance of a filter", covariance, d).expect("positive definite").lower;
            *sum += inverse_lower(&lower, d).chunks(d).map(|row| dot(row, &error).powi(2)).sum::<f64>();
        }
    }
    sums.map(|sum| sum / (series.truth.len() * d) as f64)
}

/// Both filters in two dimensions, the particle filter with many particles, and `hmc` with the Gaussian prior in ten as well.
///
/// # Panics
/// When a filter fails on a frame, which would be a defect.
#[must_use]
pub fn normalised_errors(seed: u64, size: Size) -> Vec<Finding> {
    let (runs, frames) = (size.pick(60, 200), size.pick(15, 50));
    let finding = |name: &str, dim: usize, run: &dyn Fn(&Series, &Stage) -> [f64; 2]| {
        let values: Vec<[f64; 2]> = (0..runs)
            .map(|r| {
                let [data, filter] = Stage::new(seed, name).round(r).split(["data", "filter"]);
                run(&Series::simulated(dim, frames, &data), &filter)
            })
            .collect();
        let [exact, own] = [0, 1].map(|k| mean_and_error(&values.iter().map(|v| v[k]).collect::<Vec<_>>()));
        let detail = format!(
            "over {runs} series of {frames} frames {:.4} ± {:.4} of the dimension {dim}; {:.4} ± {:.4} with the filter's own covariance; seed {seed}",
            exact[0], exact[1], own[0], own[1]
        );
        Finding::score(format!("normalised error of {name}, d = {dim}"), (exact[0] - 1.0) / exact[1], 4.0, detail)
    };
    let particles = |count: usize| {
        move |series: &Series, stage: &Stage| {
            let config = bootstrap::Config { particles: count, ..bootstrap::Config::default() };
            let mut filter = Bootstrap::new(config, series.model(), series.m0.clone()).expect("valid");
            normalised_error(series, &mut filter, stage)
        }
    };
    let chains = |series: &Series, stage: &Stage| {
        let mut filter =
            HmcFilter::new(chains_on_series(), series.model(), series.m0.clone(), Isa::best()).expect("valid");
        normalised_error(series, &mut filter, stage)
    };
    vec![
        finding("the bootstrap filter", 2, &particles(size.pick(2000, 8000))),
        finding("hmc", 2, &chains),
        finding("hmc", 10, &chains),
    ]
}
