//! Geweke's joint-distribution test (J1) of Hamiltonian Monte Carlo, with steps from the prior alone.

use crate::planted_hmc::{Bug, Steps, update as planted};
use crate::simulators::{Linear3, PRIOR_SD, PartOfBody};
use crate::size::Size;
use sinew::core::kernel::MarkovKernel;
use sinew::core::lanes::Isa;
use sinew::core::random::BlockRng;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::one_chain::OneChain;
use sinew_invariance::draws::normals;
use sinew_invariance::{Geweke, Report, TestFunctions, geweke};

fn config(seed: u64, size: Size) -> Geweke {
    Geweke { chains: size.pick(200, 6000), cycles: 50, seed, ..Geweke::default() }
}

/// The sampler on the arm of CF28; `believed` is what it takes for the errors' size, over the true one.
///
/// # Panics
/// Never: its settings are valid.
#[must_use]
pub fn arm(seed: u64, size: Size, believed: f64) -> Report {
    let body = PartOfBody::arm(0.02);
    let believes = body.believing(believed);
    let curvature = vec![1.0 / (PRIOR_SD * PRIOR_SD); body.dim()];
    let hmc = Hmc::new(0.35, &curvature, 5, 0.2, Isa::best()).expect("valid settings");
    let kernel = |theta: &[f64], y: &[f64], rng: &mut BlockRng| {
        let mut state = theta.to_vec();
        OneChain::new(believes.posterior(y), hmc.clone()).step(&mut state, rng);
        state
    };
    let (prior, simulate) =
        (|rng: &mut BlockRng| body.prior(rng), |x: &[f64], rng: &mut BlockRng| body.simulate(x, rng));
    geweke(&config(seed, size), prior, simulate, kernel, &body.functions())
}

/// A linear-Gaussian problem in three dimensions with a planted bug or none, and a belief about the errors' size.
#[must_use]
pub fn linear(seed: u64, size: Size, bug: Bug, believed: f64) -> Report {
    let steps = Steps { size: if bug == Bug::NoAcceptStep { 0.5 } else { 0.3 }, count: 4, bug };
    let kernel = |theta: &[f64], y: &[f64], rng: &mut BlockRng| {
        planted(|x, g| Linear3.log_posterior(y, believed, x, g), steps, theta, rng)
    };
    let functions = TestFunctions::moments(3)
        .with("log posterior", |x| Linear3.log_posterior(&x[3..], 1.0, &x[..3], &mut [0.0; 3]));
    let simulate = |x: &[f64], rng: &mut BlockRng| Linear3.simulate(x, rng);
    geweke(&config(seed, size), |rng: &mut BlockRng| normals(3, rng), simulate, kernel, &functions)
}

/// The arm and the linear problem, both right.
#[must_use]
pub fn right(seed: u64, size: Size) -> Vec<Report> {
    vec![arm(seed, size, 1.0), linear(seed, size, Bug::None, 1.0)]
}
