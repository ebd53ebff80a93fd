//! A Metropolis kernel and the same with an exponent that is 3 % wrong: what passes, what fails, and what a passing test would have seen.
//!
//! `cargo run --release -p sinew-invariance --example metropolis`

use sinew_core::density::LogDensity;
use sinew_core::random::BlockRng;
use sinew_invariance::draws::{normals, uniform};
use sinew_invariance::targets::{ExactTarget, GaussianTarget};
use sinew_invariance::{ExactStart, TestFunctions, exact_start};

fn main() {
    let target = GaussianTarget::equicorrelated(2, 0.5);
    let functions = || TestFunctions::moments(2).with("log density", |x| target.log_density(x));
    for (exponent, starts) in [(1.0, 100_000), (1.03, 100_000), (1.03, 1_000_000)] {
        let kernel = |x: &[f64], rng: &mut BlockRng| {
            let y: Vec<f64> = x.iter().zip(normals(2, rng)).map(|(x, z)| x + 1.5 * z).collect();
            let ratio = exponent * (target.log_density(&y) - target.log_density(x));
            if uniform(rng).ln() < ratio { y } else { x.to_vec() }
        };
        let config = ExactStart { starts, ..ExactStart::default() };
        println!("exponent {exponent}: {}\n", exact_start(&config, |rng| target.draw(rng), kernel, &functions()));
    }
}
