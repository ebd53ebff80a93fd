//! nuts-rs with the gradient of one state.
//!
//! Four chains of its default warm-up and 4000 draws, one after the other.

use crate::measure::{Clock, Run};
use crate::problem::Problem;
use nuts_rs::rand::SeedableRng;
use nuts_rs::rand::rngs::StdRng;
use nuts_rs::{
    Chain, CpuLogpFunc, CpuMath, CpuMathError, DiagNutsSettings, HasDims, LogpError, LowRankNutsSettings, Settings,
};
use sinew::core::density::GradLogDensity;
use std::collections::HashMap;
use std::error::Error;
use std::fmt;

const CHAINS: usize = 4;
const DRAWS: usize = 4000;

/// The log density is not finite; counts as a divergence.
#[derive(Debug)]
struct NotFinite;

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the log density is not finite")
    }
}

impl Error for NotFinite {}

impl LogpError for NotFinite {
    fn is_recoverable(&self) -> bool {
        true
    }
}

struct Posterior<'a>(&'a Problem);

impl HasDims for Posterior<'_> {
    fn dim_sizes(&self) -> HashMap<String, u64> {
        HashMap::from([("unconstrained_parameter".to_string(), 28)])
    }
}

impl CpuLogpFunc for Posterior<'_> {
    type LogpError = NotFinite;
    type FlowParameters = ();
    type ExpandedVector = Vec<f64>;

    fn dim(&self) -> usize {
        28
    }

    fn logp(&mut self, position: &[f64], gradient: &mut [f64]) -> Result<f64, NotFinite> {
        let value = self.0.target().log_density_grad(position, gradient);
        if value.is_finite() { Ok(value) } else { Err(NotFinite) }
    }

    fn expand_vector<R: nuts_rs::rand::Rng + ?Sized>(
        &mut self,
        _rng: &mut R,
        position: &[f64],
    ) -> Result<Vec<f64>, CpuMathError> {
        Ok(position.to_vec())
    }
}

fn run(problem: &Problem, settings: &impl Settings, tune: u64, seed: u64) -> Result<Run, Box<dyn Error>> {
    let mut run = Run {
        series: vec![Vec::new(); 28],
        seconds: [0.0; 2],
        gradients: [0; 2],
        acceptance: None,
        length: 0.0,
        depth: Some(0.0),
        divergences: 0,
    };
    for index in 0..CHAINS as u64 {
        let mut rng = StdRng::seed_from_u64(seed * 100 + index);
        let mut chain = settings.new_chain(index, CpuMath::new(Posterior(problem)), &mut rng)?;
        let start = Clock::start();
        chain.set_position(&problem.middle)?;
        for _ in 0..tune {
            run.gradients[0] += chain.draw()?.1.num_gradients as usize;
        }
        run.seconds[0] += start.seconds();
        let mut draws = Vec::with_capacity(DRAWS);
        let start = Clock::start();
        for _ in 0..DRAWS {
            let (draw, progress) = chain.draw()?;
            run.gradients[1] += progress.num_gradients as usize;
            run.divergences += usize::from(progress.diverging);
            let count = (CHAINS * DRAWS) as f64;
            run.length += progress.num_steps as f64 / count;
            run.depth = run.depth.map(|depth| depth + (progress.num_steps as f64 + 1.0).log2().floor() / count);
            draws.push(draw);
        }
        run.seconds[1] += start.seconds();
        for (j, series) in run.series.iter_mut().enumerate() {
            series.push(draws.iter().map(|draw| draw[j]).collect());
        }
    }
    Ok(run)
}

/// Its metric of low rank beside a diagonal.
pub fn low_rank(problem: &Problem, seed: u64) -> Result<Run, Box<dyn Error>> {
    let settings = LowRankNutsSettings { num_draws: DRAWS as u64, ..LowRankNutsSettings::default() };
    run(problem, &settings, settings.num_tune, seed)
}

/// Its diagonal metric.
pub fn diagonal(problem: &Problem, seed: u64) -> Result<Run, Box<dyn Error>> {
    let settings = DiagNutsSettings { num_draws: DRAWS as u64, ..DiagNutsSettings::default() };
    run(problem, &settings, settings.num_tune, seed)
}
