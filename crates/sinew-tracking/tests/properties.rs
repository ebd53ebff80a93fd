//! Laws of trackers for random settings.

use proptest::prelude::*;
use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::metric::Geometry;
use sinew_samplers::resample::Scheme;
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::{StepInfo, Tracker};

type Observed = Lanes<Quadratic>;

fn observation(dim: usize, frame: u32) -> Observed {
    let leaf = Quadratic { centre: vec![0.1 * f64::from(frame); dim], precision: vec![30.0; dim] };
    Lanes { leaf, isa: Isa::best() }
}

fn steps(mut tracker: impl Tracker<Observed>, dim: usize, seed: u64) -> Result<StepInfo, TestCaseError> {
    let mut last = StepInfo::default();
    for frame in 0..3 {
        let stage = Stage::new(seed, "property").at_frame(frame);
        last = tracker.step(&observation(dim, frame), stage).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let posterior = tracker.posterior();
        prop_assert_eq!(posterior.states.len(), posterior.count().div_ceil(8) * dim);
        prop_assert!((posterior.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        prop_assert!(last.mean.iter().all(|m| m.is_finite()));
        let mean = posterior.mean();
        prop_assert!(mean.iter().zip(&last.mean).all(|(a, b)| (a - b).abs() < 1e-12));
        prop_assert!(last.ess >= 0.0 && last.ess <= posterior.count() as f64 * (1.0 + 1e-9));
        let thinned = posterior.equal_weight(5, &mut Stage::new(seed, "thin").whole());
        prop_assert!(thinned.len() == 5 && thinned.iter().all(|&i| i < posterior.count()));
        let moments = posterior.moments(Isa::best());
        prop_assert!((0..dim).all(|j| moments.covariance[j * (dim + 1)] >= 0.0));
    }
    Ok(last)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn bootstrap_steps_for_every_size(
        dim in 1..6usize, particles in 1..100usize, below in 0.0..=1.0f64, seed: u64,
        scheme in prop::sample::select(vec![Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic]),
    ) {
        let walk = RandomWalk::new(&vec![1.0; dim], 0.04, Between::Mixture, Isa::best()).expect("valid");
        let config = bootstrap::Config { particles, scheme, resample_below: below };
        let info = steps(Bootstrap::new(config, walk, vec![0.0; dim]).expect("valid"), dim, seed)?;
        prop_assert_eq!(info.likelihood_evaluations, particles);
    }

    #[test]
    fn hmc_steps_for_every_size(
        dim in 1..6usize, chains in 1..20usize, burn_in in 0..4usize, more in 1..6usize, jitter in 0.0..0.5f64, seed: u64,
        between in prop::sample::select(vec![Between::Mixture, Between::Gaussian]),
        geometry in prop::sample::select(vec![Geometry::Diagonal, Geometry::Dense]),
    ) {
        let walk = RandomWalk::new(&vec![1.0; dim], 0.04, between, Isa::best()).expect("valid");
        let updates = burn_in + more;
        let config = hmc_filter::Config {
            chains,
            updates,
            burn_in,
            step_size: 0.5,
            leapfrog_steps: 3,
            jitter,
            curvature_draws: 8,
            patience: 1,
            geometry,
        };
        let filter = HmcFilter::new(config, walk, vec![0.0; dim], Isa::best()).expect("valid");
        let info = steps(filter, dim, seed)?;
        prop_assert_eq!(info.gradient_evaluations, chains * (1 + updates * 3) + 8);
        prop_assert_eq!(info.trajectories, chains * updates);
    }
}
