//! Every statistical check by name, for `cargo xtask verify`: the claim it stands for and how it is run.

use crate::annealing_laws::{collapse_on_the_depth_flip, marginals_under_crossover, noise_of_layers};
use crate::camera_point::CameraPoint;
use crate::depth_flip::Arm;
use crate::evidence::{error_slope, stored_table, unbiased};
use crate::faulty_kernels::{curvature_of_state, rejections, reversal};
use crate::finding::Finding;
use crate::growth::{Growth, two_modes};
use crate::linear_series::Series;
use crate::mixture_filter::against_ideal;
use crate::outcome::{Outcome, in_two_stages, outcome};
use crate::partitioned_laws::{Importance, agreement, particles_needed, represents_the_same};
use crate::posteriordb::{self, Sampler, Starts, judged};
use crate::size::Size;
use crate::static_posteriors::{camera_point_chains, gaussian_volume_law, tempered_depth_flip, volume_law};
use crate::{
    calibrated_samplers, filter_calibration, frozen_tuning, joint_distribution, resampling_laws, sampler_invariance,
    walls,
};
use sinew_invariance::Report;

/// What a check gives.
#[derive(Clone, Copy, Debug)]
pub enum Run {
    /// Reports, whose statistics have run in stages.
    Reports(fn(u64, Size) -> Vec<Report>),
    /// Findings, by the rule of two stages.
    Findings(fn(u64, Size) -> Vec<Finding>),
    /// Outcomes as they are.
    Outcomes(fn(u64, Size) -> Vec<Outcome>),
}

/// A check of one claim.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Name, for `--only`.
    pub name: &'static str,
    /// The claim in plain words.
    pub claim: &'static str,
    /// How it is run.
    pub run: Run,
}

impl Check {
    /// Runs it with a seed; nothing comes back where its data are missing.
    #[must_use]
    pub fn outcomes(&self, seed: u64, size: Size) -> Vec<Outcome> {
        match self.run {
            Run::Reports(run) => run(seed, size).into_iter().map(Outcome::from).collect(),
            Run::Findings(run) => in_two_stages(seed, |seed| run(seed, size)),
            Run::Outcomes(run) => run(seed, size),
        }
    }
}

/// A finding that holds where a planted fault is seen.
fn seen(name: &str, statistic: f64, is_seen: bool) -> Finding {
    Finding::between(
        format!("{name} is seen"),
        f64::from(u8::from(is_seen)),
        [1.0, 1.0],
        format!("statistic {statistic:.2}"),
    )
}

/// Kernels with faults fail, and the same without keep their targets: a check that has lost its power shows here.
#[must_use]
pub fn faults(seed: u64, size: Size) -> Vec<Outcome> {
    let [right, wrong] = curvature_of_state(seed, size);
    let [kept, lost] = reversal();
    let worst = wrong.worst().map_or(f64::NAN, |s| s.value);
    let mut all = vec![Outcome::from(right)];
    let curvature = seen("curvature that depends on the state", worst, !wrong.holds());
    let reversed = Finding::at_most("reversal", kept, 1e-12, "distance from the start");
    let not_reversed = seen("curvature that depends on the state, by reversal", lost, lost > 1e-3);
    all.extend([curvature, reversed, not_reversed].iter().map(|finding| outcome(finding, 0.0, 1)));
    let dropped = |seed| {
        let [right, wrong, part] = rejections(size.pick(250, 1000), size.pick(200, 400), seed);
        vec![right, seen("rejected states that are not counted", wrong.statistic, !wrong.holds()), part]
    };
    all.extend(in_two_stages(seed, dropped));
    all
}

fn evidence(seed: u64, size: Size) -> Vec<Finding> {
    let Some(series) = Series::stored("lgssm_d2.json") else { return vec![] };
    let mut findings = unbiased(&series, 250, size.pick(80, 400), seed);
    findings.extend(stored_table(&series, size.pick(20, 200), seed));
    findings.push(error_slope(&series, size.pick(3, 4) as u32, size.pick(12, 40), seed));
    findings
}

fn volume_laws(seed: u64, _: Size) -> Vec<Finding> {
    [volume_law(1000, 4000, seed), gaussian_volume_law(1_000_000, seed)].concat()
}

fn camera_point(seed: u64, size: Size) -> Vec<Finding> {
    let point = CameraPoint::stored();
    point.map_or_else(Vec::new, |point| camera_point_chains(&point, size.pick(2000, 20_000), seed))
}

fn tempered_evidence(seed: u64, size: Size) -> Vec<Finding> {
    Arm::stored().map_or_else(Vec::new, |arm| tempered_depth_flip(&arm, 2000, size.pick(3, 40), seed))
}

fn growth_model(seed: u64, size: Size) -> Vec<Finding> {
    let (chains, runs) = (size.pick(250, 1000), size.pick(3, 10));
    Growth::stored().map_or_else(Vec::new, |growth| two_modes(&growth, 5000, chains, runs, seed))
}

fn partitioned(seed: u64, size: Size) -> Vec<Finding> {
    let mut findings = particles_needed(seed, size);
    for importance in [Importance::Product, Importance::Right, Importance::Wrong, Importance::Whole] {
        for (coupled, frames) in [(true, 1), (true, 4), (false, 4)] {
            findings.extend(agreement(coupled, importance, frames, size, seed));
        }
    }
    findings
}

fn annealing(seed: u64, size: Size) -> Vec<Finding> {
    let mut findings = noise_of_layers(seed);
    findings.extend(marginals_under_crossover(seed, size));
    if let Some(arm) = Arm::stored() {
        findings.extend(collapse_on_the_depth_flip(&arm, size.pick(10, 40), seed));
    }
    findings
}

/// The mixture filter beside ideal draws: file, chains, the stored error of ideal draws, runs.
fn mixture_filter(seed: u64, size: Size) -> Vec<Finding> {
    let reduced = [("lgssm_d2.json", 250, 0.125, 5), ("lgssm_d10.json", 250, 0.27, 2)];
    let full = [
        ("lgssm_d2.json", 250, 0.125, 20),
        ("lgssm_d2.json", 1000, 0.063, 6),
        ("lgssm_d10.json", 250, 0.27, 20),
        ("lgssm_d10.json", 1000, 0.154, 6),
    ];
    let cases = if size == Size::Reduced { &reduced[..] } else { &full[..] };
    let run = |&(file, chains, stored, runs): &(&str, usize, f64, usize)| {
        Series::stored(file).map_or_else(Vec::new, |series| against_ideal(&series, file, chains, stored, runs, seed))
    };
    cases.iter().flat_map(run).collect()
}

fn stored_posteriors(seed: u64, size: Size) -> Vec<Finding> {
    let all = posteriordb::all();
    let updates = |sampler| if sampler == Sampler::Hmc { size.pick(1600, 4000) } else { size.pick(500, 2000) };
    let samplers = [Sampler::Hmc, Sampler::Nuts];
    let cases =
        samplers.into_iter().flat_map(|sampler| [Starts::Uniform, Starts::Normal].map(|starts| (sampler, starts)));
    cases
        .flat_map(|(sampler, starts)| all.iter().flat_map(move |p| judged(p, sampler, starts, updates(sampler), seed)))
        .collect()
}

use Run::{Findings, Outcomes, Reports};

/// Checks by name, how each is run, and what it stands for.
macro_rules! checks {
    ($($name:literal $run:expr, $claim:literal)*) => { &[$(Check { name: $name, claim: $claim, run: $run }),*] };
}

/// All checks.
pub const CHECKS: &[Check] = checks! {
    "hmc-exact-starts" Reports(sampler_invariance::hmc_exact_starts),
        "Hamiltonian Monte Carlo keeps its target, also at cliffs and where a density is NaN"
    "nuts-exact-starts" Reports(sampler_invariance::nuts_exact_starts),
        "the no-U-turn sampler keeps its target"
    "jumps-exact-starts" Reports(sampler_invariance::jump_exact_starts),
        "jumps keep their target"
    "step-size-sweep" Reports(sampler_invariance::step_size_sweep),
        "Hamiltonian Monte Carlo keeps its target at any step size, with and without jitter"
    "shapes" Reports(sampler_invariance::shapes),
        "Hamiltonian Monte Carlo keeps the shape of its target, modes included"
    "ranks-in-paths" Reports(sampler_invariance::ranks_in_paths),
        "Hamiltonian updates are in detailed balance"
    "long-runs" Reports(sampler_invariance::long_runs),
        "samplers reach their targets from afar"
    "integrator" Reports(sampler_invariance::integrator),
        "leapfrog is reversible, keeps volume and is of second order"
    "joint-distribution" Reports(joint_distribution::right),
        "posteriors of Hamiltonian Monte Carlo belong to the simulator (Geweke)"
    "calibration-hmc" Reports(|seed, size| vec![calibrated_samplers::hmc(seed, size).0]),
        "posterior draws of Hamiltonian Monte Carlo are calibrated on the lower body of CF28"
    "calibration-tempered" Reports(|seed, size| vec![calibrated_samplers::tempered(seed, size).0]),
        "posterior draws of tempered sequential Monte Carlo are calibrated on the arm"
    "calibration-particles" Reports(|seed, size| vec![calibrated_samplers::particle_filter(seed, size).0]),
        "posterior draws of the particle filter are calibrated on the arm"
    "resampling" Reports(resampling_laws::every_scheme),
        "every resampling scheme is unbiased and keeps the bounds of its counts, for weights of all kinds"
    "filter-calibration" Findings(filter_calibration::normalised_errors),
        "errors of both filters are as large as their own covariances say"
    "dense-and-camera" Reports(sampler_invariance::dense_and_camera_exact_starts),
        "Hamiltonian Monte Carlo keeps its target with a dense metric, and on a point before two cameras"
    "walls" Findings(|seed, size| walls::walls(size.pick(250, 1250), size.pick(20, 40), seed)),
        "no chain stands where there is no density; divergences are counted and change nothing between"
    "frozen-tuning" Findings(|seed, size| frozen_tuning::tuned_acceptance(size.pick(500, 2000), seed).into()),
        "a tuned step size accepts the requested share and does not change while draws are kept"
    "faults" Outcomes(faults),
        "kernels with planted faults are seen"
    "volume-laws" Findings(volume_laws),
        "one frame of particles has the variance and the effective number of the closed forms"
    "camera-point" Findings(camera_point),
        "chains have the moments of a point before two cameras, by quadrature"
    "tempered-evidence" Findings(tempered_evidence),
        "tempered Monte Carlo finds eight modes with their masses and the evidence"
    "evidence" Findings(evidence),
        "the evidence of particles is unbiased under every scheme and threshold; their errors are those stored and fall with the root of their number"
    "growth-model" Findings(growth_model),
        "both modes of the growth model are kept by particles and by chains with the mixture prior"
    "mixture-filter" Findings(mixture_filter),
        "hmc with the mixture prior is within 1.3 times the error of ideal draws"
    "posteriordb" Findings(stored_posteriors),
        "means and standard deviations of five posteriors that others have sampled, from scattered starts"
    "weighted-resampling" Findings(represents_the_same),
        "weighted resampling represents what it did, for any importance function and scheme"
    "partitioned" Findings(partitioned),
        "the partitioned filter is the joint filter with unbiased evidence, whatever its importance functions; it needs particles for one part at a time"
    "annealing" Findings(annealing),
        "layers of annealing diffuse as they say, crossover keeps marginals, and the annealed filter loses modes that a filter keeps"
};
