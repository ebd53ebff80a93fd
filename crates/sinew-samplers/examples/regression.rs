//! A logistic regression of 200 outcomes on three covariates by every sampler, and the evidence for each covariate.

use sinew_samplers::core::random::Stage;
use sinew_samplers::tempered_smc::{self, NormalPrior};
use sinew_samplers::{Density, Error, check_gradient, hmc, jumps, nuts};

/// ln p(y | x, β) = Σ y_i η_i − ln(1 + exp η_i) with η_i = β_0 + Σ β_k x_ik.
struct Likelihood {
    covariates: Vec<[f64; 3]>,
    outcomes: Vec<bool>,
}

impl Likelihood {
    /// Covariates and outcomes by the coefficients −0.5, 1, −2 and 0.
    fn simulated() -> Self {
        use sinew_samplers::core::lanes::Block;
        let mut uniform = vec![Block::ZERO; 4 * 25];
        Stage::new(1, "regression").whole().fill_uniform(&mut uniform);
        let numbers: Vec<f64> = uniform.iter().flat_map(|block| block.0).collect();
        let covariates: Vec<[f64; 3]> =
            numbers.chunks(4).map(|u| [2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0, 2.0 * u[2] - 1.0]).collect();
        let probability = |x: &[f64; 3]| 1.0 / (1.0 + (0.5 - x[0] + 2.0 * x[1]).exp());
        let outcomes = covariates.iter().zip(numbers.chunks(4)).map(|(x, u)| u[3] < probability(x)).collect();
        Self { covariates, outcomes }
    }

    /// The same without the last covariates.
    fn without(&self, count: usize) -> Self {
        let kept = |x: &[f64; 3]| std::array::from_fn(|k| if k < 3 - count { x[k] } else { 0.0 });
        Self { covariates: self.covariates.iter().map(kept).collect(), outcomes: self.outcomes.clone() }
    }
}

impl Density for Likelihood {
    fn dim(&self) -> usize {
        4
    }
    fn log_density(&self, beta: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let mut value = 0.0;
        for (x, &outcome) in self.covariates.iter().zip(&self.outcomes) {
            let eta = beta[0] + x.iter().zip(&beta[1..]).map(|(x, b)| x * b).sum::<f64>();
            let y = f64::from(u8::from(outcome));
            value += y * eta - (eta.max(0.0) + (-eta.abs()).exp().ln_1p());
            let error = y - 1.0 / (1.0 + (-eta).exp());
            gradient[0] += error;
            gradient[1..].iter_mut().zip(x).for_each(|(g, x)| *g += error * x);
        }
        value
    }
}

/// Likelihood and prior N(0, 2.5²).
struct Posterior<'a>(&'a Likelihood, &'a NormalPrior);

impl Density for Posterior<'_> {
    fn dim(&self) -> usize {
        4
    }
    fn log_density(&self, beta: &[f64], gradient: &mut [f64]) -> f64 {
        let mut slope = [0.0; 4];
        let value = self.0.log_density(beta, gradient) + self.1.log_density(beta, &mut slope);
        gradient.iter_mut().zip(slope).for_each(|(g, s)| *g += s);
        value
    }
    fn names(&self) -> Vec<String> {
        ["intercept", "first", "second", "third"].map(String::from).into()
    }
}

fn main() -> Result<(), Error> {
    let (likelihood, prior) = (Likelihood::simulated(), NormalPrior { mean: vec![0.0; 4], sd: vec![2.5; 4] });
    let posterior = Posterior(&likelihood, &prior);
    for x in [[0.0; 4], [-0.5, 1.0, -2.0, 0.3]] {
        check_gradient(&posterior, &x)?;
    }
    println!("no-U-turn trees\n{}\n", nuts::sample(&posterior, nuts::Settings::default())?.summary());
    println!("trajectories of one length\n{}\n", hmc::sample(&posterior, hmc::Settings::default())?.summary());
    println!("with jumps\n{}\n", jumps::sample(&posterior, jumps::Settings::default())?.summary());
    for count in 0..3 {
        let run = tempered_smc::sample(&likelihood.without(count), &prior, tempered_smc::Settings::default())?;
        println!("tempering with {} covariates\n{}\n", 3 - count, run.summary());
    }
    Ok(())
}
