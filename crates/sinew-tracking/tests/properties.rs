//! Laws of trackers for random settings.

mod common;

use common::Sight;
use proptest::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::Isa;
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_dynamics::level_walk::LevelWalk;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::annealed_search::{self, Last, Scaling};
use sinew_samplers::grid::GridAxis;
use sinew_samplers::levels::Selection;
use sinew_samplers::metric::Geometry;
use sinew_samplers::resample::{Scheme, Truncation};
use sinew_tracking::annealed::{self, Annealed};
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::coarse_to_fine::{self, CoarseToFine, Judging};
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::hppf::{self, Hppf};
use sinew_tracking::partitioned::{self, Partitioned};
use sinew_tracking::{StepInfo, Tracker};

fn observation(dim: usize, frame: u32, product: bool) -> Sight {
    Sight::new(vec![0.1 * f64::from(frame); dim], vec![30.0; dim], product)
}

/// Each coordinate a part under the one before it.
fn tree(dim: usize) -> PartTree {
    let parts = (0..dim).map(|j| Part::new(vec![j], dim).expect("valid")).collect();
    let parents = (0..dim).map(|j| j.checked_sub(1)).collect();
    PartTree::new(Partition::new(parts, dim).expect("covers"), parents).expect("parents first")
}

fn walk(dim: usize) -> RandomWalk {
    RandomWalk::new(&vec![1.0; dim], 0.04, Between::Mixture, Isa::best()).expect("valid")
}

const SCHEMES: [Scheme; 4] = [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic];

fn steps(tracker: &mut impl Tracker<Sight>, dim: usize, seed: u64) -> Result<StepInfo, TestCaseError> {
    let mut last = StepInfo::default();
    for frame in 0..3 {
        let stage = Stage::new(seed, "property").at_frame(frame);
        last = tracker
            .step(&observation(dim, frame, seed.is_multiple_of(2)), stage)
            .map_err(|e| TestCaseError::fail(e.to_string()))?;
        let posterior = tracker.posterior();
        prop_assert_eq!(posterior.states.len(), posterior.count().div_ceil(8) * dim);
        prop_assert!((posterior.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        prop_assert!(last.mean.iter().all(|m| m.is_finite()));
        let mean = posterior.mean();
        let is_filter = last.log_evidence.is_some() || !last.exponents.is_empty();
        prop_assert!(!is_filter || mean.iter().zip(&last.mean).all(|(a, b)| (a - b).abs() < 1e-12));
        prop_assert_eq!(&last.mean[..], tracker.estimate());
        // Of chains whose draws alternate, n draws are worth n log₁₀ n at most.
        let count = posterior.count() as f64;
        prop_assert!(last.ess >= 0.0 && last.ess <= count * count.log10().max(1.0) * (1.0 + 1e-9));
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
        scheme in prop::sample::select(&SCHEMES[..]),
    ) {
        let config = bootstrap::Config { particles, scheme, resample_below: below };
        let info = steps(&mut Bootstrap::new(config, walk(dim), vec![0.0; dim]).expect("valid"), dim, seed)?;
        prop_assert_eq!(info.likelihood_evaluations, particles);
    }

    #[test]
    fn annealed_steps_for_every_size(
        dim in 1..6usize, particles in 1..100usize, layers in 1..7usize, survival in 0.05..0.95f64, adaptive: bool,
        crossover in prop_oneof![Just(0.0), 0.0..=1.0f64], seed: u64,
        scaling in prop::sample::select(vec![Scaling::Variance, Scaling::StandardDeviation]),
        last in prop_oneof![Just(Last::Solve), (0.0..3.0f64).prop_map(Last::Fixed)],
        scheme in prop::sample::select(&SCHEMES[..]),
    ) {
        let layers = annealed_search::Config { layers, survival, scaling, last, scheme, adaptive, crossover };
        let config = annealed::Config { particles, layers };
        let tracker = Annealed::new(config, walk(dim), vec![0.2; dim], vec![0.0; dim], Isa::best());
        let mut tracker = tracker.expect("valid");
        let info = steps(&mut tracker, dim, seed)?;
        prop_assert_eq!(info.likelihood_evaluations, particles * layers.layers);
        prop_assert_eq!((info.exponents.len(), info.survivors.len()), (layers.layers, layers.layers));
        prop_assert!(info.exponents.iter().all(|beta| *beta >= 0.0 && beta.is_finite()));
        prop_assert!(info.survivors.iter().all(|d| *d >= 1.0 - 1e-9 && *d <= particles as f64 * (1.0 + 1e-9)));
        let (best, value) = tracker.best();
        prop_assert_eq!(value, observation(dim, 2, true).log_density(&best));
    }

    #[test]
    fn partitioned_steps_for_every_size(
        dim in 1..6usize, particles in 1..100usize, seed: u64, scheme in prop::sample::select(&SCHEMES[..]),
    ) {
        let config = partitioned::Config { particles, scheme };
        let mut tracker = Partitioned::new(config, walk(dim), tree(dim), vec![0.0; dim]).expect("valid");
        let info = steps(&mut tracker, dim, seed)?;
        let product = seed.is_multiple_of(2);
        let counts = if product { (0, dim * particles) } else { (particles, (dim - 1) * particles) };
        prop_assert_eq!((info.likelihood_evaluations, info.part_evaluations), counts);
        prop_assert_eq!(info.survivors.len(), dim);
        prop_assert!(info.survivors.iter().all(|d| *d >= 1.0 - 1e-9 && *d <= particles as f64 * (1.0 + 1e-9)));
        prop_assert_eq!(info.survivors.iter().copied().fold(f64::INFINITY, f64::min), info.ess);
    }

    #[test]
    fn coarse_to_fine_steps_for_every_size(
        dim in 1..6usize, coarse in 1..60usize, fine in 1..60usize, drift in -1.0..1.0f64, snapped: bool,
        judging in prop::sample::select(vec![Judging::Decoupled, Judging::Chained, Judging::Whole]),
        width in 0.01..3.0f64, wraps: bool, seed: u64,
    ) {
        let axes = vec![GridAxis::new(-1.0, 1.5, width, wraps).expect("valid"); dim];
        let config = coarse_to_fine::Config { coarse, fine, drift, snapped, judging };
        let mut tracker = CoarseToFine::new(config, axes, tree(dim), vec![0.0; dim], Isa::best()).expect("valid");
        let info = steps(&mut tracker, dim, seed)?;
        let whole = if judging == Judging::Whole { fine * dim } else { 0 };
        prop_assert!((2..=coarse + 1).contains(&(info.likelihood_evaluations - whole)));
        prop_assert_eq!(info.part_evaluations, fine * dim - whole);
        let seen = observation(dim, 2, true);
        for judged in [tracker.coarse(), tracker.fine()] {
            prop_assert_eq!(judged.log_likelihood, seen.log_density(&judged.state));
        }
        prop_assert_eq!(&tracker.fine().state, &info.mean);
    }

    #[test]
    fn hppf_steps_for_every_size(
        dim in 1..6usize, particles in 1..60usize, surviving in 0.01..1.0f64, seed: u64,
        truncation in prop::sample::select(&[Truncation::KeepOnceRefill, Truncation::TruncateThenSystematic][..]),
    ) {
        let config = hppf::Config { particles, selection: Selection { truncation, surviving }, width: 3.0 };
        let motion = LevelWalk::new(tree(dim), vec![0.2; dim], vec![0.2; dim], Isa::best()).expect("valid");
        let mut tracker = Hppf::new(config, motion, &tree(dim), vec![0.0; dim]).expect("valid");
        let info = steps(&mut tracker, dim, seed)?;
        let judged = dim * (dim + 1) / 2;
        prop_assert_eq!((info.likelihood_evaluations, info.part_evaluations), (particles, judged * particles));
        prop_assert_eq!(info.survivors.len(), 2 * dim);
        let found = tracker.found().expect("a frame");
        prop_assert!(found.similar.contains(&found.mode) && found.similar.iter().all(|i| *i < particles));
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
        let mut filter = HmcFilter::new(config, walk, vec![0.0; dim], Isa::best()).expect("valid");
        let info = steps(&mut filter, dim, seed)?;
        prop_assert_eq!(info.gradient_evaluations, chains * (1 + updates * 3) + 8);
        prop_assert_eq!(info.trajectories, chains * updates);
    }
}
