//! Every statistical check by name, for `cargo xtask verify`: the claim it stands for and how it is run.

use crate::outcome::{Outcome, in_two_stages};
use crate::size::Size;
use crate::{calibrated_samplers, filter_calibration, joint_distribution, resampling_laws, sampler_invariance};
use sinew_invariance::Report;

/// A check of one claim.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Name, for `--only`.
    pub name: &'static str,
    /// The claim in plain words.
    pub claim: &'static str,
    /// Runs it; nothing comes back where its data are missing.
    pub run: fn(u64, Size) -> Vec<Outcome>,
}

fn outcomes(reports: Vec<Report>) -> Vec<Outcome> {
    reports.into_iter().map(Outcome::from).collect()
}

/// All checks.
pub const CHECKS: &[Check] = &[
    Check {
        name: "hmc-exact-starts",
        claim: "Hamiltonian Monte Carlo keeps its target, also at cliffs and where a density is NaN",
        run: |seed, size| outcomes(sampler_invariance::hmc_exact_starts(seed, size)),
    },
    Check {
        name: "nuts-exact-starts",
        claim: "the no-U-turn sampler keeps its target",
        run: |seed, size| outcomes(sampler_invariance::nuts_exact_starts(seed, size)),
    },
    Check {
        name: "jumps-exact-starts",
        claim: "jumps keep their target",
        run: |seed, size| outcomes(sampler_invariance::jump_exact_starts(seed, size)),
    },
    Check {
        name: "step-size-sweep",
        claim: "Hamiltonian Monte Carlo keeps its target at any step size, with and without jitter",
        run: |seed, size| outcomes(sampler_invariance::step_size_sweep(seed, size)),
    },
    Check {
        name: "shapes",
        claim: "Hamiltonian Monte Carlo keeps the shape of its target, modes included",
        run: |seed, size| outcomes(sampler_invariance::shapes(seed, size)),
    },
    Check {
        name: "ranks-in-paths",
        claim: "Hamiltonian updates are in detailed balance",
        run: |seed, size| outcomes(sampler_invariance::ranks_in_paths(seed, size)),
    },
    Check {
        name: "long-runs",
        claim: "samplers reach their targets from afar",
        run: |seed, size| outcomes(sampler_invariance::long_runs(seed, size)),
    },
    Check {
        name: "integrator",
        claim: "leapfrog is reversible, keeps volume and is of second order",
        run: |seed, size| outcomes(sampler_invariance::integrator(seed, size)),
    },
    Check {
        name: "joint-distribution",
        claim: "posteriors of Hamiltonian Monte Carlo are those of the simulator (Geweke)",
        run: |seed, size| outcomes(joint_distribution::right(seed, size)),
    },
    Check {
        name: "calibration-hmc",
        claim: "posterior draws of Hamiltonian Monte Carlo are calibrated on the lower body of CF28",
        run: |seed, size| outcomes(vec![calibrated_samplers::hmc(seed, size).0]),
    },
    Check {
        name: "calibration-tempered",
        claim: "posterior draws of tempered sequential Monte Carlo are calibrated on the arm",
        run: |seed, size| outcomes(vec![calibrated_samplers::tempered(seed, size).0]),
    },
    Check {
        name: "calibration-particles",
        claim: "posterior draws of the particle filter are calibrated on the arm",
        run: |seed, size| outcomes(vec![calibrated_samplers::particle_filter(seed, size).0]),
    },
    Check {
        name: "resampling",
        claim: "every resampling scheme is unbiased and keeps the bounds of its counts, for weights of all kinds",
        run: |seed, size| outcomes(resampling_laws::every_scheme(seed, size)),
    },
    Check {
        name: "filter-calibration",
        claim: "errors of both filters are as large as their own covariances say",
        run: |seed, size| in_two_stages(seed, |seed| filter_calibration::normalised_errors(seed, size)),
    },
];
