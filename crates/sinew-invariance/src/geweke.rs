//! Geweke's joint-distribution test ("Getting it right", 2004), for a posterior kernel whose target has no exact draws.
//!
//! Parameters θ and data y have two simulators of the same joint law:
//!
//! - marginal–conditional: θ ~ p(θ), y ~ p(y | θ), independent each time;
//! - successive–conditional: y ~ p(y | θ), θ ← K_y(θ), over and over, with the posterior kernel K_y under test.
//!
//! Means of test functions of (θ, y) must agree. Here each successive chain starts from a draw of its own from the prior, so that it has the joint law from its first state on, and there are many of them: their means are
//! independent, and no autocorrelation has to be estimated. A small error of the kernel is carried from cycle to cycle and adds up along a chain, which gives the test its power.

use crate::detectable::{Estimate, one_sigma};
use crate::p_values::normal_p;
use crate::sequential::{About, Control, Measured, run};
use crate::{Report, TestFunctions};
use sinew_core::random::{BlockRng, Stage};

/// Sizes of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geweke {
    /// Successive–conditional chains of the first stage; there are as many times `cycles` independent draws beside them.
    pub chains: usize,
    /// Cycles of data and kernel in each chain.
    pub cycles: usize,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for Geweke {
    fn default() -> Self {
        Self { chains: 400, cycles: 50, seed: 1, control: Control::default() }
    }
}

const SHOWS: &str = "the kernel's posterior is not that of the simulator: a likelihood, prior or noise level that differs between them, a wrong acceptance rule, a forgotten half step. \
     A wrong gradient under a right acceptance rule passes";

/// Tests `kernel(θ, y, rng)` against `prior(rng)` and `simulate(θ, rng)`. Test functions see θ followed by y.
///
/// # Panics
/// Without two chains, a cycle and a test function.
pub fn geweke(
    config: &Geweke,
    mut prior: impl FnMut(&mut BlockRng) -> Vec<f64>,
    mut simulate: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    mut kernel: impl FnMut(&[f64], &[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
) -> Report {
    let stages = Stage::new(config.seed, "joint distribution");
    let cycles = config.cycles;
    assert!(config.chains > 1 && cycles > 0, "at least two chains and one cycle");
    functions.assert_some();
    let measured = |chains| {
        format!(
            "{chains} chains of {cycles} cycles of new data and a kernel step, beside {} independent draws",
            chains * cycles
        )
    };
    let about = About { test: "joint distribution", would_show: SHOWS, seed: config.seed, measured: &measured };
    run(&config.control, &about, config.chains, |chains, stage| {
        let mut rng = stages.round(stage).whole();
        let count = functions.names().len();
        let (mut independent, mut successive) = (vec![Mean::default(); count], vec![Mean::default(); count]);
        for _ in 0..chains {
            for _ in 0..cycles {
                let theta = prior(&mut rng);
                let joint = [&*theta, &simulate(&theta, &mut rng)].concat();
                independent.iter_mut().zip(functions.at(&joint)).for_each(|(mean, value)| mean.add(value));
            }
            let mut theta = prior(&mut rng);
            let mut own = vec![Mean::default(); count];
            for _ in 0..cycles {
                let data = simulate(&theta, &mut rng);
                theta = kernel(&theta, &data, &mut rng);
                let joint = [&*theta, &*data].concat();
                own.iter_mut().zip(functions.at(&joint)).for_each(|(mean, value)| mean.add(value));
            }
            successive.iter_mut().zip(own).for_each(|(mean, own)| mean.add(own.mean));
        }
        let estimate = |(a, b): (&Mean, &Mean)| Estimate {
            mean: a.mean,
            variance: a.squared_error() * a.count,
            error: (a.squared_error() + b.squared_error()).sqrt(),
        };
        let sizes = one_sigma(functions, &independent.iter().zip(&successive).map(estimate).collect::<Vec<_>>());
        let found = functions.names().iter().zip(independent.iter().zip(&successive)).zip(sizes);
        let found = found.map(|((name, (a, b)), size)| {
            let difference = b.mean - a.mean;
            // Constants may differ by rounding.
            let is_rounding = difference.abs() <= 1e-12 * a.mean.abs().max(b.mean.abs());
            let z = if is_rounding { 0.0 } else { difference / (a.squared_error() + b.squared_error()).sqrt() };
            let one_sigma = size.map(|size| (name.clone(), size));
            Measured { name: format!("mean of {name}"), value: z, p: normal_p(z), one_sigma }
        });
        found.collect()
    })
}

/// Mean and its squared standard error, by Welford's recursion.
#[derive(Clone, Default)]
struct Mean {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let off = value - self.mean;
        self.mean += off / self.count;
        self.squares += off * (value - self.mean);
    }

    fn squared_error(&self) -> f64 {
        self.squares / (self.count - 1.0) / self.count
    }
}
