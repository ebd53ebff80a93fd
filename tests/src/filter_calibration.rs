//! J3: errors of filters in units of what they themselves claim, eᵀ P⁻¹ e with the filter's own covariance P, on simulated linear-Gaussian series. Their mean is the dimension of the state.

use crate::finding::{Finding, mean_and_error};
use crate::linear_series::{Series, Sight, dot};
use crate::size::Size;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::{self, HmcFilter};

/// Mean of eᵀ P⁻¹ e over the frames of one series.
fn normalised_error(series: &Series, tracker: &mut impl Tracker<Sight>, stage: &Stage) -> f64 {
    let d = series.dim;
    let mut sum = 0.0;
    for (frame, truth) in series.truth.iter().enumerate() {
        tracker.step(&series.sight(frame), stage.round(frame)).expect("a posterior");
        let moments = tracker.posterior().moments(Isa::best());
        let lower = cholesky("covariance of the filter", &moments.covariance, d).expect("positive definite").lower;
        let error: Vec<f64> = truth.iter().zip(&moments.mean).map(|(x, m)| x - m).collect();
        sum += inverse_lower(&lower, d).chunks(d).map(|row| dot(row, &error).powi(2)).sum::<f64>();
    }
    sum / series.truth.len() as f64
}

/// Both filters in two dimensions, the particle filter with many particles, and `hmc` with the Gaussian prior in ten as well.
///
/// # Panics
/// When a filter fails on a frame, which would be a defect.
#[must_use]
pub fn normalised_errors(seed: u64, size: Size) -> Vec<Finding> {
    let (runs, frames) = (size.pick(60, 200), size.pick(15, 50));
    let finding = |name: &str, dim: usize, run: &dyn Fn(&Series, &Stage) -> f64| {
        let values: Vec<f64> = (0..runs)
            .map(|r| {
                let [data, filter] = Stage::new(seed, name).round(r).split(["data", "filter"]);
                run(&Series::simulated(dim, frames, &data), &filter) / dim as f64
            })
            .collect();
        let [mean, error] = mean_and_error(&values);
        let detail = format!(
            "mean over {runs} series of {frames} frames {mean:.4} ± {error:.4} of the dimension {dim}, seed {seed}"
        );
        Finding::score(format!("normalised error of {name}, d = {dim}"), (mean - 1.0) / error, 4.5, detail)
    };
    let particles = |count: usize| {
        move |series: &Series, stage: &Stage| {
            let config = bootstrap::Config { particles: count, ..bootstrap::Config::default() };
            let mut filter = Bootstrap::new(config, series.model(), series.m0.clone()).expect("valid");
            normalised_error(series, &mut filter, stage)
        }
    };
    let chains = |series: &Series, stage: &Stage| {
        let config = hmc_filter::Config {
            chains: 16,
            updates: 80,
            burn_in: 20,
            step_size: 0.5,
            leapfrog_steps: 8,
            jitter: 0.2,
            ..hmc_filter::Config::default()
        };
        let mut filter = HmcFilter::new(config, series.model(), series.m0.clone(), Isa::best()).expect("valid");
        normalised_error(series, &mut filter, stage)
    };
    vec![
        finding("the bootstrap filter", 2, &particles(size.pick(2000, 8000))),
        finding("hmc", 2, &chains),
        finding("hmc", 10, &chains),
    ]
}
