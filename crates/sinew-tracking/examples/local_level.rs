//! The smallest filter: a level that wanders, seen with noise.

use sinew_tracking::BlockRng;
use sinew_tracking::state_space::{Settings, StateSpace, filter};

struct LocalLevel;

impl StateSpace for LocalLevel {
    type Observation = f64;
    fn dim(&self) -> usize {
        1
    }
    fn draw_first(&self, level: &mut [f64], rng: &mut BlockRng) {
        level[0] = rng.normal();
    }
    fn draw_next(&self, _frame: usize, before: &[f64], level: &mut [f64], rng: &mut BlockRng) {
        level[0] = before[0] + 0.5 * rng.normal();
    }
    fn log_density(&self, _frame: usize, seen: &f64, level: &[f64]) -> f64 {
        -0.5 * (seen - level[0]).powi(2) - 0.5 * std::f64::consts::TAU.ln()
    }
}

fn main() -> Result<(), sinew_tracking::Error> {
    let seen = [0.2, -0.4, 1.1, 0.9, 2.0, 1.4];
    let found = filter(&LocalLevel, &seen, Settings { particles: 10_000, seed: 42, ..Settings::default() })?;
    for (seen, frame) in seen.iter().zip(&found.frames) {
        println!("seen {seen:5.2}, level {:5.2} ± {:.2}, {:.0} effective", frame.mean[0], frame.sd[0], frame.ess);
    }
    println!("log evidence {:.3}", found.log_evidence);
    Ok(())
}
