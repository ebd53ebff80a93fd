//! Every check of this library in full size, for a run that takes minutes and not seconds: the ordinary tests call the same functions in reduced size with fixed seeds.

use crate::camera_point::CameraPoint;
use crate::depth_flip::Arm;
use crate::evidence::{error_slope, stored_table, unbiased};
use crate::finding::Finding;
use crate::growth::{Growth, two_modes};
use crate::kept_targets::{curvature_of_state, exact_starts, long_run, rejections, sweep, tuned_acceptance, walls};
use crate::linear_series::Series;
use crate::mixture_filter::against_ideal;
use crate::posteriordb::{self, Sampler, judged};
use crate::resample_counts::all_counts;
use crate::static_posteriors::{camera_point_chains, gaussian_volume_law, tempered_depth_flip, volume_law};

/// A check: its name, what a failure would mean, and the check by seed. Without the data folder a check that needs it finds nothing.
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// The kind of fault that it sees.
    pub sees: &'static str,
    /// Runs it.
    pub run: fn(u64) -> Vec<Finding>,
}

/// Errors of ideal draws from the mixture target, as the data folder states them.
pub const IDEAL: [(&str, usize, f64); 4] = [
    ("lgssm_d2.json", 250, 0.125),
    ("lgssm_d2.json", 1000, 0.063),
    ("lgssm_d10.json", 250, 0.27),
    ("lgssm_d10.json", 1000, 0.154),
];

fn d2(check: impl Fn(&Series) -> Vec<Finding>) -> Vec<Finding> {
    Series::stored("lgssm_d2.json").map_or_else(Vec::new, |series| check(&series))
}

/// A finding that holds where a planted fault is seen: the largest |z| or the smallest p of its statistics is beyond the bounds.
#[must_use]
pub fn detected(name: &str, of_fault: &[Finding]) -> Finding {
    let seen: Vec<&str> = of_fault.iter().filter(|f| !f.holds()).map(|f| f.name.as_str()).collect();
    Finding::between(
        format!("{name}: statistics that see it"),
        seen.len() as f64,
        [1.0, f64::INFINITY],
        seen.join(", "),
    )
}

fn mixture_filter(seed: u64) -> Vec<Finding> {
    let run = |(file, chains, stored): (&str, usize, f64)| {
        let runs = if chains == 1000 { 6 } else { 20 };
        Series::stored(file).map_or_else(Vec::new, |series| against_ideal(&series, file, chains, stored, runs, seed))
    };
    IDEAL.into_iter().flat_map(run).collect()
}

fn faults(seed: u64) -> Vec<Finding> {
    let [right, wrong] = curvature_of_state(12_500, seed);
    let [kept, dropped, part] = rejections(1000, 400, seed);
    let mut findings = right;
    findings.push(detected("curvature that depends on the state", &wrong));
    findings.push(detected("rejected states not counted", &[dropped]));
    findings.extend([kept, part]);
    findings
}

fn posteriors(seed: u64) -> Vec<Finding> {
    let all = posteriordb::all();
    [Sampler::Hmc, Sampler::Nuts].iter().flat_map(|s| all.iter().flat_map(|p| judged(p, *s, 2000, seed))).collect()
}

/// All of them, cheapest first.
pub const CHECKS: [Check; 13] = [
    Check {
        name: "volume laws",
        sees: "wrong weights or effective numbers in one frame of particles",
        run: |seed| [volume_law(1000, 4000, seed), gaussian_volume_law(1_000_000, seed)].concat(),
    },
    Check {
        name: "frozen tuning",
        sees: "adaptation that goes on while draws are kept; a search that misses its acceptance",
        run: |seed| tuned_acceptance(2000, seed).into(),
    },
    Check {
        name: "walls of -inf and NaN",
        sees: "moves onto points without density; divergences that change what is between",
        run: |seed| walls(1250, 40, seed),
    },
    Check {
        name: "exact starts",
        sees: "an update that does not keep its target: a missing half step, a wrong sign of the energy, a test that is left out",
        run: |seed| exact_starts(CameraPoint::stored().as_ref(), 12_500, seed),
    },
    Check { name: "planted faults", sees: "checks that have lost their power", run: faults },
    Check {
        name: "resampling of hard weights",
        sees: "biased counts, lost or chosen zeros, wrong sums",
        run: |seed| all_counts(100_000, seed),
    },
    Check {
        name: "camera point",
        sees: "a wrong projection, gradient or constant",
        run: |seed| CameraPoint::stored().map_or_else(Vec::new, |point| camera_point_chains(&point, 20_000, seed)),
    },
    Check {
        name: "tempered evidence",
        sees: "wrong increments of the evidence, modes that starve",
        run: |seed| Arm::stored().map_or_else(Vec::new, |arm| tempered_depth_flip(&arm, 2000, 40, seed)),
    },
    Check {
        name: "evidence of particles",
        sees: "old weights kept after resampling, log N taken off twice, bias of a scheme or threshold, errors that do not fall with the root of N",
        run: |seed| {
            d2(|series| {
                let mut findings = unbiased(series, 250, 400, seed);
                findings.extend(stored_table(series, 200, seed));
                findings.push(error_slope(series, 4, 40, seed));
                findings
            })
        },
    },
    Check {
        name: "growth model",
        sees: "a mode that is lost, in particles and in chains with the mixture prior",
        run: |seed| Growth::stored().map_or_else(Vec::new, |growth| two_modes(&growth, 5000, 1000, 10, seed)),
    },
    Check {
        name: "long run and sweep",
        sees: "a bias of some parts in a thousand of a variance, at any step size",
        run: |seed| [vec![long_run(62_500, seed)], sweep(200, seed)].concat(),
    },
    Check { name: "posteriordb", sees: "bias on posteriors that others have sampled", run: posteriors },
    Check {
        name: "mixture filter",
        sees: "chains that do not reach their mixture target, wrong components",
        run: mixture_filter,
    },
];
