//! Settings that trackers refuse.

use sinew_core::lanes::Isa;
use sinew_core::part::{Part, PartTree, Partition};
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::annealed_search;
use sinew_samplers::grid::GridAxis;
use sinew_tracking::Error;
use sinew_tracking::annealed::{self, Annealed};
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::coarse_to_fine::{self, CoarseToFine};
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::partitioned::{self, Partitioned};
fn walk() -> RandomWalk {
    RandomWalk::new(&[1.0, 0.5], 0.04, Between::Mixture, Isa::best()).expect("valid")
}

fn tree() -> PartTree {
    let parts = [0, 1].map(|j| Part::new(vec![j], 2).expect("valid")).to_vec();
    PartTree::new(Partition::new(parts, 2).expect("covers"), vec![None, Some(0)]).expect("parents first")
}

#[test]
fn settings_are_checked() {
    let hmc = |config| HmcFilter::new(config, walk(), vec![0.0; 2], Isa::best()).map(|_| ());
    let default = hmc_filter::Config::default;
    assert!(hmc(default()).is_ok() && hmc(hmc_filter::Config::real_recordings()).is_ok());
    for bad in [
        hmc_filter::Config { chains: 0, ..default() },
        hmc_filter::Config { updates: 5, ..default() },
        hmc_filter::Config { updates: 0, burn_in: 0, ..default() },
        hmc_filter::Config { step_size: f64::NAN, ..default() },
        hmc_filter::Config { leapfrog_steps: 0, ..default() },
        hmc_filter::Config { jitter: 1.0, ..default() },
        hmc_filter::Config { patience: 0, ..default() },
    ] {
        assert!(hmc(bad.clone()).is_err(), "{bad:?}");
    }
    let start = HmcFilter::new(default(), walk(), vec![0.0; 3], Isa::best());
    assert!(matches!(start, Err(Error::Dimension { name: "start", found: 3, expected: 2 })));
    for config in [
        bootstrap::Config { particles: 0, ..Default::default() },
        bootstrap::Config { resample_below: 2.0, ..Default::default() },
        bootstrap::Config { resample_below: f64::NAN, ..Default::default() },
    ] {
        assert!(Bootstrap::new(config, walk(), vec![0.0; 2]).is_err());
    }
}

#[test]
fn settings_of_searches_and_of_the_partitioned_filter_are_checked() {
    let annealed = |layers, sd: &[f64], centre: &[f64]| {
        let config = annealed::Config { particles: 5, layers };
        Annealed::new(config, walk(), sd.to_vec(), centre.to_vec(), Isa::best()).map(|_| ())
    };
    let good = annealed_search::Config::default;
    assert!(annealed(good(), &[0.1; 2], &[0.0; 2]).is_ok());
    assert!(annealed(good(), &[0.1; 3], &[0.0; 2]).is_err() && annealed(good(), &[0.1; 2], &[0.0; 3]).is_err());
    assert!(
        annealed(good(), &[0.1, -1.0], &[0.0; 2]).is_err() && annealed(good(), &[0.1, f64::NAN], &[0.0; 2]).is_err()
    );
    for bad in [
        annealed_search::Config { layers: 0, ..good() },
        annealed_search::Config { survival: 1.0, ..good() },
        annealed_search::Config { survival: f64::NAN, ..good() },
        annealed_search::Config { crossover: 1.1, ..good() },
        annealed_search::Config { last: annealed_search::Last::Fixed(f64::INFINITY), ..good() },
        annealed_search::Config { last: annealed_search::Last::Fixed(-1.0), ..good() },
    ] {
        assert!(annealed(bad, &[0.1; 2], &[0.0; 2]).is_err(), "{bad:?}");
    }
    let small =
        PartTree::new(Partition::new(vec![Part::new(vec![0], 1).expect("valid")], 1).expect("covers"), vec![None]);
    let small = small.expect("one part");
    let partitioned = |particles, tree, centre: &[f64]| {
        let config = partitioned::Config { particles, ..partitioned::Config::default() };
        Partitioned::new(config, walk(), tree, centre.to_vec()).map(|_| ())
    };
    assert!(partitioned(1, tree(), &[0.0; 2]).is_ok() && partitioned(0, tree(), &[0.0; 2]).is_err());
    assert!(partitioned(1, small.clone(), &[0.0; 2]).is_err() && partitioned(1, tree(), &[0.0; 1]).is_err());
    let axes = vec![GridAxis::new(-2.0, 2.0, 0.15, false).expect("valid"); 2];
    let coarse_to_fine = |config, tree, centre: &[f64]| {
        CoarseToFine::new(config, axes.clone(), tree, centre.to_vec(), Isa::best()).map(|_| ())
    };
    let good = coarse_to_fine::Config::default;
    assert!(coarse_to_fine(good(), tree(), &[0.0; 2]).is_ok());
    assert!(coarse_to_fine(good(), small, &[0.0; 2]).is_err() && coarse_to_fine(good(), tree(), &[0.0; 3]).is_err());
    for bad in [
        coarse_to_fine::Config { coarse: 0, ..good() },
        coarse_to_fine::Config { fine: 0, ..good() },
        coarse_to_fine::Config { drift: f64::NAN, ..good() },
    ] {
        assert!(coarse_to_fine(bad.clone(), tree(), &[0.0; 2]).is_err(), "{bad:?}");
    }
}
