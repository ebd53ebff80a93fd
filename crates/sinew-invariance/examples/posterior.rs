//! A posterior without exact draws: Geweke's test of its kernel, and the coverage of its intervals.
//!
//! `cargo run --release -p sinew-invariance --example posterior`

use sinew_core::random::BlockRng;
use sinew_invariance::draws::{normals, uniform};
use sinew_invariance::{Geweke, RankCalibration, TestFunctions, calibration, geweke};

/// θ ~ N(0, 1) and five observations of it with variance 1.
fn prior(rng: &mut BlockRng) -> Vec<f64> {
    normals(1, rng)
}

fn simulate(theta: &[f64], rng: &mut BlockRng) -> Vec<f64> {
    normals(5, rng).iter().map(|z| theta[0] + z).collect()
}

fn metropolis(theta: &[f64], y: &[f64], rng: &mut BlockRng) -> Vec<f64> {
    let log_density = |t: f64| -0.5 * (t * t + y.iter().map(|y| (y - t).powi(2)).sum::<f64>());
    let proposed = theta[0] + normals(1, rng)[0];
    if uniform(rng).ln() < log_density(proposed) - log_density(theta[0]) { vec![proposed] } else { theta.to_vec() }
}

fn main() {
    let functions = TestFunctions::moments(1);
    println!("{}\n", geweke(&Geweke::default(), prior, simulate, metropolis, &functions));

    let draws = |y: &[f64], count: usize, rng: &mut BlockRng| {
        let mut theta = vec![0.0];
        let mut kept = || {
            for _ in 0..20 {
                theta = metropolis(&theta, y, rng);
            }
            theta.clone()
        };
        (0..count).map(|_| kept()).collect()
    };
    let (report, _ranks) = calibration(&RankCalibration::default(), prior, simulate, draws, &functions);
    println!("{report}");
}
