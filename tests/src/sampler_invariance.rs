//! Whether the samplers keep their targets, and reach them (acceptance H4, energy H5, invariance H6).
//!
//! The checks `exact-start`, `step-size sweep`, `divergent stays` and `long-run`.
//!
//! Every kernel stands on every target with exact draws; steps are such that between a third and all trajectories are accepted.

use crate::camera_draws::Seen;
use crate::camera_point::CameraPoint;
use crate::kernels::{self, eight};
use crate::size::Size;
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::lanes::{Isa, LANES};
use sinew::core::random::Stage;
use sinew::samplers::gaussian_mixture::GaussianMixture as Proposal;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::integrator::PhasePoint;
use sinew::samplers::jumps::Jumps;
use sinew::samplers::metric::{Dense, Metric};
use sinew::samplers::nuts::Nuts;
use sinew_invariance::targets::{Banana, ExactTarget, GaussianTarget, HalfLine, MixtureTarget, Truncated};
use sinew_invariance::{
    ExactRank, ExactStart, Integrator, LongRun, Report, TestFunctions, energy_order, exact_rank, exact_start, long_run,
    reversibility, two_sample, volume,
};

/// A target with the step and the number of steps of its trajectories.
struct Case {
    name: &'static str,
    target: Box<dyn Exact>,
    step: f64,
    leapfrogs: usize,
}

/// An exact target that can stand in a list.
trait Exact: ExactTarget {
    fn boxed(&self) -> Box<dyn Exact>;
}

impl<T: ExactTarget + Clone + 'static> Exact for T {
    fn boxed(&self) -> Box<dyn Exact> {
        Box::new(self.clone())
    }
}

fn two_modes() -> MixtureTarget {
    let modes = vec![GaussianTarget::standard(2), GaussianTarget::new(vec![2.5, 0.0], vec![vec![0.7], vec![0.3, 0.6]])];
    MixtureTarget::new(vec![0.4, 0.6], modes)
}

fn cases() -> Vec<Case> {
    let case = |name, target: &dyn Exact, step, leapfrogs| Case { name, target: target.boxed(), step, leapfrogs };
    let tails =
        MixtureTarget::new(vec![0.5, 0.5], vec![GaussianTarget::scaled(&[1.0]), GaussianTarget::scaled(&[5.0])]);
    vec![
        case("Gaussian, 1 dimension", &GaussianTarget::standard(1), 1.2, 3),
        case("Gaussian, 5 dimensions, correlation 0.8", &GaussianTarget::equicorrelated(5, 0.8), 0.5, 6),
        case("Gaussian, 28 dimensions, correlation 0.5", &GaussianTarget::equicorrelated(28, 0.5), 0.6, 5),
        case("two scales of one mean", &tails, 1.0, 4),
        case("two modes", &two_modes(), 0.6, 5),
        case("banana", &Banana { sd: 1.2, bend: 0.6 }, 0.4, 6),
        case("half-lines", &HalfLine { rate: vec![1.0, 3.0] }, 0.3, 4),
        case(
            "cliff to −∞",
            &Truncated { whole: GaussianTarget::standard(3), edge: 0.5, beyond: f64::NEG_INFINITY },
            0.5,
            4,
        ),
        case("region of NaN", &Truncated { whole: GaussianTarget::standard(3), edge: 0.5, beyond: f64::NAN }, 0.5, 4),
    ]
}

/// Moments and the log density, over eight chains.
fn functions(target: &dyn Exact) -> TestFunctions<'static> {
    let own = target.boxed();
    TestFunctions::moments(target.dim()).with("log density", move |x| own.log_density(x)).together(LANES)
}

/// Unit metric.
pub(crate) fn plain(dim: usize, step: f64, leapfrogs: usize, jitter: f64) -> Hmc {
    Hmc::new(step, &vec![1.0; dim], leapfrogs, jitter, Isa::best()).expect("valid settings")
}

/// A report under another name.
fn named(name: String, report: Report) -> Report {
    Report { measured: format!("{name}; {}", report.measured), ..report }
}

fn starts(seed: u64, size: Size, steps: usize) -> ExactStart {
    ExactStart { starts: size.pick(600, 12_500), steps, seed, ..ExactStart::default() }
}

fn on_every_target(
    seed: u64,
    size: Size,
    sampler: &str,
    mut check: impl FnMut(&Case, &ExactStart) -> Report,
) -> Vec<Report> {
    let mut reports = vec![];
    for case in cases() {
        for steps in [1, 5] {
            reports.push(named(format!("{sampler}, {}", case.name), check(&case, &starts(seed, size, steps))));
        }
    }
    reports
}

/// Hamiltonian Monte Carlo from exact starts, diagonal unit metric.
#[must_use]
pub fn hmc_exact_starts(seed: u64, size: Size) -> Vec<Report> {
    on_every_target(seed, size, "hmc", |case, config| {
        let target = &Borrowed(&*case.target);
        let kernel = kernels::hmc(target, plain(target.dim(), case.step, case.leapfrogs, 0.2));
        exact_start(config, eight(&*case.target), kernel, &functions(&*case.target))
    })
}

/// With a dense metric; and on the posterior of a point before two cameras, where the data are at hand.
///
/// # Panics
/// Never: the metric is positive definite.
#[must_use]
pub fn dense_and_camera_exact_starts(seed: u64, size: Size) -> Vec<Report> {
    let target = GaussianTarget::equicorrelated(5, 0.8);
    let matrix: Vec<f64> = (0..25).map(|k| if k % 6 == 0 { 4.0 } else { -0.7 }).collect();
    let dense = Metric::Dense(Dense::new(&matrix, 5).expect("positive definite"));
    let hmc = Hmc::with_metric(0.9, &dense, 4, 0.2, Isa::best()).expect("valid settings");
    let mut reports = vec![];
    for steps in [1, 5] {
        let config = starts(seed, size, steps);
        let kernel = kernels::hmc(&target, hmc.clone());
        let report = exact_start(&config, eight(&target), kernel, &functions(&target));
        reports.push(named("hmc, dense metric".into(), report));
        if let Some(point) = CameraPoint::stored() {
            let seen = Seen::new(&point);
            let curvature: Vec<f64> = (0..3).map(|j| 1.0 / point.moments.covariance[4 * j]).collect();
            let hmc = Hmc::new(0.9, &curvature, 4, 0.2, Isa::best()).expect("valid settings");
            let (mode, scale) = (point.mode.clone(), curvature.clone());
            let mut about = TestFunctions::none();
            for j in 0..3 {
                let (m, s) = (mode[j], scale[j].sqrt());
                about = about
                    .with(format!("x{j}"), move |x| (x[j] - m) * s)
                    .with(format!("x{j}²"), move |x| ((x[j] - m) * s).powi(2));
            }
            let report = exact_start(&config, eight(&seen), kernels::hmc(&seen, hmc), &about.together(LANES));
            reports.push(named("hmc, camera point".into(), report));
        }
    }
    reports
}

/// The no-U-turn sampler from exact starts.
///
/// # Panics
/// Never: its settings are valid.
#[must_use]
pub fn nuts_exact_starts(seed: u64, size: Size) -> Vec<Report> {
    on_every_target(seed, size, "no-U-turn", |case, config| {
        let target = &Borrowed(&*case.target);
        let unit = Metric::Diagonal(vec![1.0; target.dim()]);
        let nuts = Nuts::with_metric(case.step, &unit, 6, 0.1, Isa::best()).expect("valid settings");
        exact_start(config, eight(&*case.target), kernels::nuts(target, nuts), &functions(&*case.target))
    })
}

/// Jumps from exact starts: proposals from two Gaussians fitted to other draws.
///
/// # Panics
/// Never: the fit has enough draws.
#[must_use]
pub fn jump_exact_starts(seed: u64, size: Size) -> Vec<Report> {
    on_every_target(seed, size, "jumps", |case, config| {
        let target = &Borrowed(&*case.target);
        let mut rng = Stage::new(seed, "draws for a proposal").whole();
        let states: Vec<_> =
            (0..100).flat_map(|_| kernels::to_block(&eight(&*case.target)(&mut rng), target.dim())).collect();
        let proposal = Proposal::fit(Isa::best(), &states, target.dim(), 2, 800.0).expect("800 draws");
        let kernel = kernels::jumps(target, Jumps { proposal, count: 2 });
        exact_start(config, eight(&*case.target), kernel, &functions(&*case.target))
    })
}

/// A boxed target as a target.
struct Borrowed<'a>(&'a dyn Exact);

impl LogDensity for Borrowed<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.0.log_density(x)
    }
}

impl GradLogDensity for Borrowed<'_> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.0.log_density_grad(x, grad)
    }
}

/// Steps from which nearly all to few trajectories are accepted, short and long ones, with and without jitter, on a Gaussian of 28 dimensions.
#[must_use]
pub fn step_size_sweep(seed: u64, size: Size) -> Vec<Report> {
    let target = GaussianTarget::equicorrelated(28, 0.5);
    let mut reports = vec![];
    for step in [0.05, 0.5, 0.9, 1.15] {
        for leapfrogs in [1, size.pick(20, 200)] {
            for jitter in [0.0, 0.3] {
                let config = ExactStart { starts: size.pick(200, 3000), steps: 1, seed, ..ExactStart::default() };
                let kernel = kernels::hmc(&target, plain(28, step, leapfrogs, jitter));
                let report = exact_start(&config, eight(&target), kernel, &functions(&target));
                reports.push(named(format!("hmc, step {step}, {leapfrogs} leapfrog step(s), jitter {jitter}"), report));
            }
        }
    }
    reports
}

/// Shapes, where means and medians might agree by accident.
#[must_use]
pub fn shapes(seed: u64, size: Size) -> Vec<Report> {
    let config = ExactStart { starts: size.pick(4000, 100_000), steps: 3, seed, ..ExactStart::default() };
    let one_of_eight = |target: &dyn Exact| {
        let own = target.boxed();
        TestFunctions::none().with("x0", |x| x[0]).with("log density", move |x| own.log_density(&x[..own.dim()]))
    };
    let check = |name: &str, target: &dyn Exact, step, leapfrogs| {
        let borrowed = Borrowed(target);
        let kernel = kernels::hmc(&borrowed, plain(target.dim(), step, leapfrogs, 0.2));
        named(format!("hmc, {name}"), two_sample(&config, eight(target), kernel, &one_of_eight(target)))
    };
    vec![
        check("two modes", &two_modes(), 0.6, 5),
        check("banana", &Banana { sd: 1.2, bend: 0.6 }, 0.4, 6),
        check("Gaussian, 5 dimensions, correlation 0.8", &GaussianTarget::equicorrelated(5, 0.8), 0.5, 6),
    ]
}

/// Detailed balance of Hamiltonian updates: ranks within paths.
#[must_use]
pub fn ranks_in_paths(seed: u64, size: Size) -> Vec<Report> {
    let config = ExactRank { paths: size.pick(1000, 60_000), steps: 4, seed, ..ExactRank::default() };
    let check = |name: &str, target: &dyn Exact, step, leapfrogs| {
        let borrowed = Borrowed(target);
        let kernel = || kernels::hmc(&borrowed, plain(target.dim(), step, leapfrogs, 0.2));
        named(format!("hmc, {name}"), exact_rank(&config, eight(target), kernel(), kernel(), &functions(target)))
    };
    vec![check("banana", &Banana { sd: 1.2, bend: 0.6 }, 0.4, 6), check("two modes", &two_modes(), 0.6, 5)]
}

/// From afar to known moments: a Gaussian of 28 dimensions and a banana.
///
/// # Panics
/// Never: its settings are valid.
#[must_use]
pub fn long_runs(seed: u64, size: Size) -> Vec<Report> {
    let config = LongRun { burn_in: 100, draws: size.pick(1500, 62_500), seed, ..LongRun::default() };
    let gaussian = GaussianTarget::equicorrelated(28, 0.5);
    let pooled = || {
        TestFunctions::none()
            .with("mean of all", |x| x.iter().sum::<f64>() / 28.0)
            .with("square of all", |x| x.iter().map(|x| x * x).sum::<f64>() / 28.0)
            .with("neighbours", |x| x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 27.0)
            .together(LANES)
    };
    let far = [[3.0; 28 * LANES].to_vec(), [-3.0; 28 * LANES].to_vec()];
    let moments = [0.0, 1.0, 0.5];
    let unit = Metric::Diagonal(vec![1.0; 28]);
    let trees = Nuts::with_metric(0.5, &unit, 6, 0.1, Isa::best()).expect("valid settings");
    let banana = Banana { sd: 1.2, bend: 0.6 };
    let bent = TestFunctions::none()
        .with("x0²", |x| x[0] * x[0])
        .with("x1", |x| x[1])
        .with("x1²", |x| x[1] * x[1])
        .together(LANES);
    let (v, b) = (1.2_f64.powi(2), 0.6_f64);
    let bent_moments = [v, 0.0, 1.0 + 2.0 * b * b * v * v];
    let beside = [[1.0; 2 * LANES].to_vec(), [-1.0; 2 * LANES].to_vec()];
    let hmc_run = long_run(&config, &far, kernels::hmc(&gaussian, plain(28, 0.6, 5, 0.2)), &pooled(), &moments);
    let nuts_run = long_run(&config, &far, kernels::nuts(&gaussian, trees), &pooled(), &moments);
    let banana_run = long_run(&config, &beside, kernels::hmc(&banana, plain(2, 0.4, 6, 0.2)), &bent, &bent_moments);
    vec![
        named("hmc, Gaussian, 28 dimensions".into(), hmc_run),
        named("no-U-turn, Gaussian, 28 dimensions".into(), nuts_run),
        named("hmc, banana".into(), banana_run),
    ]
}

/// The leapfrog steps of the samplers: reversible, volume-preserving, of second order (H1–H3).
#[must_use]
pub fn integrator(seed: u64, size: Size) -> Vec<Report> {
    let mut reports = vec![];
    for (name, target) in [
        ("two modes", Box::new(two_modes()) as Box<dyn Exact>),
        ("banana", Box::new(Banana { sd: 1.2, bend: 0.6 })),
        ("Gaussian, 5 dimensions, correlation 0.8", Box::new(GaussianTarget::equicorrelated(5, 0.8))),
    ] {
        let mut rng = Stage::new(seed, "starts of trajectories").whole();
        let starts: Vec<(Vec<f64>, Vec<f64>)> = (0..size.pick(100, 1000))
            .map(|_| (target.draw(&mut rng), sinew_invariance::draws::normals(target.dim(), &mut rng)))
            .collect();
        let borrowed = Borrowed(&*target);
        let map = |q: &[f64], p: &[f64], h: f64, steps: usize| trajectory(&borrowed, q, p, h, steps);
        let energy = |q: &[f64], p: &[f64]| 0.5 * p.iter().map(|p| p * p).sum::<f64>() - borrowed.log_density(q);
        let of = Integrator { map: &map, energy: &energy };
        reports.push(named(name.into(), reversibility(&of, &starts, 0.1, 40, 1e-10)));
        reports.push(named(name.into(), volume(&of, &starts[..20], 0.1, 5, 1e-7)));
        reports.push(named(name.into(), energy_order(&of, &starts, 0.8, 0.1, [1.8, 2.2])));
    }
    reports
}

/// A trajectory of the sampler's own integrator, in one lane.
fn trajectory(target: &Borrowed<'_>, q: &[f64], p: &[f64], h: f64, steps: usize) -> (Vec<f64>, Vec<f64>) {
    use sinew::core::lanes::Block;
    let d = q.len();
    let (mut q, mut p) = (kernels::to_block(&q.repeat(LANES), d), kernels::to_block(&p.repeat(LANES), d));
    let mut gradient = vec![Block::ZERO; d];
    target.log_density_grad_block(&q, &mut gradient, &mut []);
    let point = PhasePoint { position: &mut q, momentum: &mut p, gradient: &mut gradient };
    plain(d, h, steps, 0.0).trajectory(target, &Block::splat(1.0), point, &mut []);
    (kernels::from_block(&q)[..d].to_vec(), kernels::from_block(&p)[..d].to_vec())
}
