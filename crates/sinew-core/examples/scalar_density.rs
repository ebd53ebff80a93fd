//! A log density of one state at a time: what must be written, and what comes with it.
//!
//! `cargo run -p sinew-core --example scalar_density`

use sinew_core::combinators::{Sum, Tempered};
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, LANES};

/// log p = −½ (x − m)², a normal density without its constant.
struct Normal(f64);

impl LogDensity for Normal {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -0.5 * (x[0] - self.0).powi(2)
    }
}

impl GradLogDensity for Normal {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = self.0 - x[0];
        self.log_density(x)
    }
}

fn main() {
    // Densities are made of densities: half a likelihood at 3 times a prior at 0.
    let posterior = Sum(Normal(0.0), Tempered { target: Normal(3.0), beta: 0.5 });
    let mut grad = [0.0];
    println!("at 1: {}, gradient {}", posterior.log_density_grad(&[1.0], &mut grad), grad[0]);

    // A block is one coordinate of eight states; the density runs on it state after state.
    let x = [Block(std::array::from_fn(|lane| 0.5 * lane as f64))];
    let mut scratch = vec![Block::ZERO; posterior.workspace()];
    let values = posterior.log_density_block(&x, &mut scratch);
    for lane in 0..LANES {
        println!("at {}: {:.3}", x[0].0[lane], values.0[lane]);
    }
}
