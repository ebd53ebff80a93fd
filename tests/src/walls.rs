//! `divergent stays`: chains between a region of NaN and a cliff to −∞.

use crate::finding::{Finding, mean_and_error};
use crate::kernels::{eight, to_block};
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::lanes::{Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::metric::Metric;
use sinew::samplers::nuts::{self, Nuts};
use sinew_invariance::draws::normals;
use sinew_invariance::targets::ExactTarget;
use std::f64::consts::TAU;

/// A standard normal between a region of NaN below −2 and a cliff to −∞ above 1.
#[derive(Clone, Copy)]
pub struct Walled;

impl LogDensity for Walled {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0])
    }
}

impl GradLogDensity for Walled {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let legal = -2.0 <= x[0] && x[0] <= 1.0;
        grad[0] = if legal { -x[0] } else { f64::NAN };
        match x[0] {
            x if x > 1.0 => f64::NEG_INFINITY,
            x if x < -2.0 => f64::NAN,
            x => -0.5 * x * x,
        }
    }
}

impl ExactTarget for Walled {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        loop {
            let x = normals(1, rng);
            if (-2.0..=1.0).contains(&x[0]) {
                return x;
            }
        }
    }
}

/// `divergent stays`: chains from exact draws of [`Walled`] never stand outside, divergences are counted, and mean and variance inside are the truncated normal's; for both samplers.
#[must_use]
pub fn walls(blocks: usize, updates: usize, seed: u64) -> Vec<Finding> {
    let isa = Isa::best();
    let density = |x: f64| (-0.5 * x * x).exp() / TAU.sqrt();
    // Φ(1) − Φ(−2).
    let mass = 0.841_344_746_068_542_9 - 0.022_750_131_948_179_2;
    let exact_mean = (density(-2.0) - density(1.0)) / mass;
    let exact_square = 1.0 + (-2.0 * density(-2.0) - density(1.0)) / mass;
    let [to_start, to_move, to_grow] = Stage::new(seed, "walls").split(["start", "move", "grow"]);
    let starts: Vec<_> =
        (0..blocks).flat_map(|b| to_block(&eight(&Walled)(&mut to_start.block(b as u32)), 1)).collect();
    let metric = Metric::Diagonal(vec![1.0]);
    let schedule = Schedule { updates, burn_in: 1 };
    let hmc = Hmc::with_metric(0.5, &metric, 3, 0.2, isa).expect("valid");
    let nuts = Nuts::with_metric(0.5, &metric, 10, 0.2, isa).expect("valid");
    let moved = draw_trajectories(&Walled, &hmc, &starts, blocks * LANES, schedule, &to_move).expect("finite");
    let grown = nuts::draw_trees(&Walled, &nuts, &starts, blocks * LANES, schedule, &to_grow).expect("finite").draws;
    let mut findings = vec![];
    for (name, draws) in [("hmc", moved), ("nuts", grown)] {
        let series = draws.series(0);
        let outside = series.iter().flatten().filter(|x| !(-2.0..=1.0).contains(*x)).count();
        findings.push(Finding::at_most(format!("{name}: states beyond the walls"), outside as f64, 0.0, ""));
        let bad = draws.stats.iter().filter(|s| !(s.log_density.is_finite() && s.energy.is_finite())).count();
        findings.push(Finding::at_most(format!("{name}: numbers that are none"), bad as f64, 0.0, ""));
        let counted = draws.stats.iter().filter(|s| s.divergent).count() as f64;
        let part = counted / draws.stats.len() as f64;
        findings.push(Finding::between(format!("{name}: divergent part"), part, [0.05, 0.95], "counted, not hidden"));
        for (what, exact, power) in [("mean", exact_mean, 1), ("mean square", exact_square, 2)] {
            let chain_means: Vec<f64> =
                series.iter().map(|c| c.iter().map(|x| x.powi(power)).sum::<f64>() / c.len() as f64).collect();
            let [mean, error] = mean_and_error(&chain_means);
            let detail = format!("{mean:.4} ± {error:.4} for {exact:.4}, seed {seed}");
            findings.push(Finding::score(
                format!("{name}: {what} between the walls"),
                (mean - exact) / error,
                4.5,
                detail,
            ));
        }
    }
    findings
}
