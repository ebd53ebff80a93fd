//! Densities of posteriordb against stored points, and both samplers judged by the stored moments.

use sinew::core::density::{GradLogDensity, LogDensity};
use sinew_tests::finding::demand;
use sinew_tests::posteriordb::{Sampler, Starts, all, judged};
use sinew_tests::stored::{number, numbers};

/// Values and gradients at the stored points to 1e-6, relative to the largest entry; gradients against central differences too.
#[test]
fn densities_and_gradients_are_those_stored() {
    for posterior in all() {
        let points = posterior.stored["checkpoints"].as_array().expect("array");
        assert_eq!(points.len(), 3);
        for point in points {
            let (u, stored) = (numbers(&point["u"]), numbers(&point["grad"]));
            let mut grad = vec![0.0; u.len()];
            let value = posterior.log_density_grad(&u, &mut grad);
            let lp = number(&point["lp"]);
            assert!((value - lp).abs() < 1e-6 * lp.abs().max(1.0), "{}: {value} against {lp}", posterior.name);
            let scale = stored.iter().fold(1.0_f64, |a, g| a.max(g.abs()));
            for (j, (found, stored)) in grad.iter().zip(&stored).enumerate() {
                assert!((found - stored).abs() < 1e-6 * scale, "{}: {found} against {stored}", posterior.name);
                let at = |h: f64| {
                    let mut u = u.clone();
                    u[j] += h;
                    posterior.log_density(&u)
                };
                // Fourth order: the regression is a thousand times as stiff in β as the others.
                let central = |h: f64| (at(h) - at(-h)) / (2.0 * h);
                let numeric = (4.0 * central(1e-4) - central(2e-4)) / 3.0;
                assert!((found - numeric).abs() < 1e-5 * scale, "{}: {found} against {numeric}", posterior.name);
            }
        }
    }
}

/// Judges the posteriors whose names hold one of `names`.
fn judge(names: &[&str], sampler: Sampler, starts: Starts, updates: usize, seed: u64) {
    for posterior in all().iter().filter(|posterior| names.iter().any(|name| posterior.name.contains(name))) {
        demand(&judged(posterior, sampler, starts, updates, seed));
    }
}

/// The posteriors that take seconds; the Gaussian process with counts takes a minute by itself.
const QUICK: [&str; 4] = ["eight_schools", "sblrc", "gp_regr", "arma"];

/// 46 statistics at |z| < 4: false alarm 3e-3, with one fixed seed.
#[test]
fn hamiltonian_chains_have_the_stored_moments() {
    judge(&QUICK, Sampler::Hmc, Starts::Uniform, 1600, 1);
}

/// The same.
#[test]
fn no_u_turn_trees_have_the_stored_moments() {
    judge(&QUICK, Sampler::Nuts, Starts::Uniform, 500, 1);
}

/// A few chains start where ARMA's residuals grow without bound, and no step size for all chains accepts half of the trajectories. Three seeds.
#[test]
fn starts_far_in_the_tails_do_not_stop_the_others() {
    for seed in [1, 2, 3] {
        judge(&["arma"], Sampler::Hmc, Starts::Normal, 1600, seed);
        judge(&["arma"], Sampler::Nuts, Starts::Normal, 500, seed);
    }
}

/// 26 statistics. Half a chain of 800 updates is worth 120 draws, so that split R-hat is 1.004 ± 0.001; of 500 it is 76 and 1.007 ± 0.002, whose largest of 26 may be above 1.01.
#[test]
fn a_gaussian_process_with_counts_mixes_from_scattered_starts() {
    judge(&["gp_pois_regr-gp_pois_regr"], Sampler::Nuts, Starts::Uniform, 800, 1);
}
