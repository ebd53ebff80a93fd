//! Samplers of populations on a linear-Gaussian frame, where posterior and evidence have closed forms.
//!
//! PriorDensity N(m, diag s²) in three dimensions, one observation y = a·x + N(0, σ²), two prior standard deviations from what is expected and 25 times as sharp. Statistical tests
//! compare means over independent runs by |z| < 4.5, a false alarm in 10⁵ each.

use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::FramePrior;
use sinew_samplers::annealed_search::{self, Last, Scaling, search};
use sinew_samplers::importance::{Tails, importance};
use sinew_samplers::laplace::{Laplace, laplace};
use sinew_samplers::metric::{Dense, Metric};
use sinew_samplers::population::Population;
use sinew_samplers::resample::Scheme;
use sinew_samplers::starts::{importance_starts, laplace_starts};
use sinew_samplers::tempered_smc::{self, temper};
use sinew_samplers::{Error, curvature::curvature};
use std::f64::consts::TAU;

const A: [f64; 3] = [1.0, -2.0, 0.5];
const Y: f64 = 4.0;
const SIGMA: f64 = 0.08;
const MEAN: [f64; 3] = [0.3, 0.0, -0.2];
const SD: [f64; 3] = [1.0, 0.7, 1.5];
const PRECISION: [f64; 3] = [1.0, 1.0 / (0.7 * 0.7), 1.0 / (1.5 * 1.5)];

fn dot(x: &[f64]) -> f64 {
    A.iter().zip(x).map(|(a, x)| a * x).sum()
}

/// log N(y; a·x, σ²).
struct Observed;
impl LogDensity for Observed {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -0.5 * ((Y - dot(x)) / SIGMA).powi(2) - 0.5 * (TAU * SIGMA * SIGMA).ln()
    }
}
impl GradLogDensity for Observed {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.iter_mut().zip(A).for_each(|(g, a)| *g = a * (Y - dot(x)) / (SIGMA * SIGMA));
        self.log_density(x)
    }
}
impl GaussNewton for Observed {
    fn gauss_newton_diagonal_block(&self, _x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        diagonal.iter_mut().zip(A).for_each(|(d, a)| *d = Block::splat(a * a / (SIGMA * SIGMA)));
    }
    fn gauss_newton_block(&self, _x: &[Block], matrix: &mut [Block], _ws: &mut [Block]) {
        let entries = (0..3).flat_map(|i| (0..=i).map(move |j| A[i] * A[j] / (SIGMA * SIGMA)));
        matrix.iter_mut().zip(entries).for_each(|(m, entry)| *m = Block::splat(entry));
    }
}

/// N(m, diag s²).
struct Before;
impl LogDensity for Before {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        (0..3).map(|j| -0.5 * ((x[j] - MEAN[j]) / SD[j]).powi(2) - 0.5 * (TAU * SD[j] * SD[j]).ln()).sum()
    }
}
impl GradLogDensity for Before {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        (0..3).for_each(|j| grad[j] = (MEAN[j] - x[j]) * PRECISION[j]);
        self.log_density(x)
    }
}
impl FramePrior for Before {
    fn sample_block(&self, _block: usize, out: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::baseline(), out);
        for (j, x) in out.iter_mut().enumerate() {
            x.0.iter_mut().for_each(|x| *x = MEAN[j] + SD[j] * *x);
        }
    }
    fn precision_diagonal(&self) -> &[f64] {
        &PRECISION
    }
}

/// Variance of y, gain of each coordinate.
fn gain() -> (f64, [f64; 3]) {
    let variance = SIGMA * SIGMA + (0..3).map(|j| (A[j] * SD[j]).powi(2)).sum::<f64>();
    (variance, [0, 1, 2].map(|j| SD[j] * SD[j] * A[j] / variance))
}

fn exact_mean() -> [f64; 3] {
    let (_, gain) = gain();
    [0, 1, 2].map(|j| MEAN[j] + gain[j] * (Y - dot(&MEAN)))
}

fn exact_variance(j: usize) -> f64 {
    let (variance, gain) = gain();
    SD[j] * SD[j] - gain[j] * gain[j] * variance
}

fn exact_log_evidence() -> f64 {
    let (variance, _) = gain();
    -0.5 * (Y - dot(&MEAN)).powi(2) / variance - 0.5 * (TAU * variance).ln()
}

/// Asserts that independent estimates agree with a value.
fn check_mean(what: &str, estimates: &[f64], exact: f64) {
    let n = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / n;
    let variance = estimates.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let z = (mean - exact) / (variance / n).sqrt();
    assert!(z.abs() < 4.5, "{what}: {mean} against {exact}, z = {z}");
}

fn mode() -> Laplace {
    laplace(&Observed, &Before, 64, Isa::best(), Stage::new(1, "laplace")).expect("positive definite")
}

fn metrics() -> [Metric; 2] {
    let diagonal = curvature(&Observed, &Before, 64, Stage::new(1, "curvature"));
    [Metric::Diagonal(diagonal), Metric::Dense(mode().metric)]
}

#[test]
fn tempered_smc_has_exact_moments_and_evidence() {
    for (metric, config) in metrics().iter().zip([
        tempered_smc::Config { particles: 101, leapfrog_steps: 12, ..tempered_smc::Config::default() },
        tempered_smc::Config { particles: 101, ..tempered_smc::Config::default() },
    ]) {
        let runs: Vec<_> = (0..200)
            .map(|r| temper(&Observed, &Before, metric, &config, Isa::best(), Stage::new(r, "smc")).expect("runs"))
            .collect();
        let relative: Vec<f64> = runs.iter().map(|r| (r.log_evidence - exact_log_evidence()).exp()).collect();
        check_mean("evidence", &relative, 1.0);
        let means: Vec<Vec<f64>> = runs.iter().map(|r| r.mean()).collect();
        for (j, exact) in exact_mean().into_iter().enumerate() {
            check_mean("mean", &means.iter().map(|m| m[j]).collect::<Vec<_>>(), exact);
            let square = |run: &tempered_smc::Sample| {
                let all = run.draws.iter().flat_map(|p| (0..p.count()).map(|i| (p.state(i)[j] - exact).powi(2)));
                all.sum::<f64>() / (run.draws.len() * 101) as f64
            };
            check_mean("variance", &runs.iter().map(square).collect::<Vec<_>>(), exact_variance(j));
        }
    }
}

#[test]
fn temperatures_rise_to_one_and_cost_is_counted() {
    let [_, dense] = metrics();
    let config = tempered_smc::Config { particles: 64, updates: 2, leapfrog_steps: 3, ..Default::default() };
    let run = temper(&Observed, &Before, &dense, &config, Isa::best(), Stage::new(1, "rise")).expect("runs");
    let betas: Vec<f64> = run.temperatures.iter().map(|t| t.beta).collect();
    assert!(betas.len() > 3 && betas[0] > 0.0 && betas.is_sorted_by(|a, b| a < b), "{betas:?}");
    assert_eq!(betas.last(), Some(&1.0));
    assert!(run.temperatures.iter().all(|t| t.effective >= 31.9 && (0.5..=1.0).contains(&t.acceptance)));
    assert_eq!((run.likelihoods, run.gradients), (64 * betas.len(), 64 * (1 + 2 * 3) * betas.len()));
    assert_eq!((run.draws.len(), run.draws[0].count(), run.divergences), (2, 64, 0));
}

/// Nothing depends on the number of threads.
#[test]
fn populations_are_the_same_for_every_number_of_threads() {
    let [_, dense] = metrics();
    let config = tempered_smc::Config { particles: 43, ..Default::default() };
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(|| {
            let stage = || Stage::new(7, "threads");
            let isa = Isa::best();
            let smc = temper(&Observed, &Before, &dense, &config, isa, stage()).expect("runs");
            let target = Sum(&Observed, &Before);
            let weighted = importance(&target, &mode(), Tails::default(), 43, isa, &stage()).expect("runs");
            let start = Population::from_blocks(3, 43, |_, x| x.fill(Block::ZERO)).expect("not empty");
            let found = search(&Observed, &start, &SD, &annealed_search::Config::default(), isa, stage());
            (smc, weighted, found.expect("finds"))
        })
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn importance_sampling_has_exact_moments_and_evidence() {
    let (target, laplace) = (Sum(&Observed, &Before), mode());
    for tails in [Tails::Gaussian, Tails::default(), Tails::StudentT { degrees: 2 }] {
        let run = |r| importance(&target, &laplace, tails, 60, Isa::best(), &Stage::new(r, "weigh")).expect("runs");
        let runs: Vec<_> = (0..300).map(run).collect();
        let relative: Vec<f64> = runs.iter().map(|r| (r.log_evidence - exact_log_evidence()).exp()).collect();
        if tails == Tails::Gaussian {
            // The proposal is the posterior: every weight is the evidence.
            assert!(relative.iter().all(|e| (e - 1.0).abs() < 1e-9));
            assert!((runs[0].effective_sample_size() - 60.0).abs() < 1e-6);
        } else {
            check_mean("evidence", &relative, 1.0);
        }
        for (j, exact) in exact_mean().into_iter().enumerate() {
            let means: Vec<f64> = runs.iter().map(|r| r.mean()[j]).collect();
            check_mean("mean", &means, exact);
        }
    }
}

#[test]
fn a_proposal_that_misses_shows_in_the_effective_number() {
    let target = Sum(&Observed, &Before);
    let Laplace { mode, metric } = mode();
    let effective = |mode: &[f64], metric: &Dense, tails| {
        let laplace = Laplace { mode: mode.to_vec(), metric: metric.clone() };
        let weighted = importance(&target, &laplace, tails, 4000, Isa::best(), &Stage::new(1, "miss"));
        weighted.map(|w| w.effective_sample_size() / 4000.0)
    };
    assert!(effective(&mode, &metric, Tails::default()).expect("runs") > 0.7);
    let shifted = [mode[0] + 0.6, mode[1], mode[2]];
    assert!(effective(&shifted, &metric, Tails::default()).expect("runs") < 0.1);
    let prior = Dense::new(&[PRECISION[0], 0.0, 0.0, 0.0, PRECISION[1], 0.0, 0.0, 0.0, PRECISION[2]], 3);
    assert!(effective(&mode, &prior.expect("positive"), Tails::default()).expect("runs") < 0.1);
    let none = effective(&mode, &metric, Tails::StudentT { degrees: 0 });
    assert!(matches!(none, Err(Error::OutOfRange { name: "degrees of freedom", .. })));
}

#[test]
fn one_layer_of_the_search_is_a_step_of_a_particle_filter() {
    let centre = |_: usize, x: &mut [Block]| x.iter_mut().zip(MEAN).for_each(|(x, m)| *x = Block::splat(m));
    let start = Population::from_blocks(3, 20_000, centre).expect("not empty");
    let config = annealed_search::Config { layers: 1, last: Last::Fixed(1.0), ..Default::default() };
    let runs: Vec<_> = (0..40)
        .map(|r| search(&Observed, &start, &SD, &config, Isa::best(), Stage::new(r, "one layer")).expect("finds"))
        .collect();
    for (j, exact) in exact_mean().into_iter().enumerate() {
        check_mean("mean", &runs.iter().map(|r| r.mean[j]).collect::<Vec<_>>(), exact);
    }
    assert!(runs.iter().all(|r| r.exponents == [1.0] && r.population.count() == 20_000));
}

#[test]
fn the_search_closes_in_on_the_peak_layer_by_layer() {
    let start = Population::from_blocks(3, 200, |_, x| x.fill(Block::ZERO)).expect("not empty");
    let target = Sum(&Observed, &Before);
    let peak = target.log_density(&exact_mean());
    for scaling in [Scaling::Variance, Scaling::StandardDeviation] {
        let config = annealed_search::Config { scaling, scheme: Scheme::Systematic, ..Default::default() };
        let found = search(&target, &start, &SD, &config, Isa::best(), Stage::new(2, "peak")).expect("finds");
        assert!(found.exponents.len() == 10 && found.exponents[9] > 10.0 * found.exponents[0]);
        assert!(peak - found.best_log_density < 0.1, "{scaling:?}: {}", peak - found.best_log_density);
        assert_eq!(found.best_log_density, target.log_density(&found.best));
        assert!((0..3).all(|j| (found.mean[j] - exact_mean()[j]).abs() < exact_variance(j).sqrt()));
    }
}

#[test]
fn bad_settings_are_refused() {
    let [_, dense] = metrics();
    let smc = |config| temper(&Observed, &Before, &dense, &config, Isa::best(), Stage::new(1, "bad"));
    let good = tempered_smc::Config::default();
    assert!(matches!(smc(tempered_smc::Config { particles: 0, ..good }), Err(Error::Empty { .. })));
    assert!(smc(tempered_smc::Config { updates: 0, ..good }).is_err());
    assert!(smc(tempered_smc::Config { survival: 1.0, ..good }).is_err());
    assert!(smc(tempered_smc::Config { step_size: f64::NAN, ..good }).is_err());
    let start = Population::from_blocks(3, LANES, |_, x| x.fill(Block::ZERO)).expect("not empty");
    let found = |sd: &[f64], config| search(&Observed, &start, sd, &config, Isa::best(), Stage::new(1, "bad"));
    let good = annealed_search::Config::default();
    assert!(found(&SD, annealed_search::Config { layers: 0, ..good }).is_err());
    assert!(found(&SD, annealed_search::Config { survival: 0.0, ..good }).is_err());
    assert!(found(&SD[..2], good).is_err() && found(&[1.0, f64::NAN, 1.0], good).is_err());
}

#[test]
fn curvatures_match_observation_and_prior() {
    let expected = [0, 1, 2].map(|j| A[j] * A[j] / (SIGMA * SIGMA) + PRECISION[j]);
    let found = curvature(&Observed, &Before, 20, Stage::new(1, "curvature"));
    assert!(found.iter().zip(expected).all(|(f, e)| (f / e - 1.0).abs() < 1e-14), "{found:?} for {expected:?}");
    assert_eq!(curvature(&Observed, &Before, 0, Stage::new(1, "curvature")), PRECISION);
}

/// A curvature that is the square of the first coordinate where that is positive, and elsewhere no number in the second and negative in the third.
struct Patchy;
impl LogDensity for Patchy {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        0.0
    }
}
impl GradLogDensity for Patchy {
    fn log_density_grad(&self, _x: &[f64], _grad: &mut [f64]) -> f64 {
        0.0
    }
}
impl GaussNewton for Patchy {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        for lane in 0..LANES {
            let x = x[0].0[lane];
            diagonal[0].0[lane] = x * x;
            diagonal[1].0[lane] = if x > 0.0 { 2.0 } else { f64::NAN };
            diagonal[2].0[lane] = if x > 0.0 { 4.0 } else { -9.0 };
        }
    }
}

#[test]
fn averages_of_curvatures_are_over_what_is_finite_and_positive() {
    let draws = 64;
    let mut blocks = vec![[Block::ZERO; 3]; draws / LANES];
    for (i, block) in blocks.iter_mut().enumerate() {
        Before.sample_block(i, block, &mut Stage::new(3, "patchy").block(i as u32));
    }
    let first: Vec<f64> = blocks.iter().flat_map(|block| block[0].0).collect();
    let share = first.iter().filter(|x| **x > 0.0).count() as f64 / draws as f64;
    assert!(share > 0.2 && share < 0.9);
    let square = first.iter().map(|x| x * x).sum::<f64>() / draws as f64;
    let found = curvature(&Patchy, &Before, draws, Stage::new(3, "patchy"));
    let expected = [square + PRECISION[0], 2.0 + PRECISION[1], 4.0 * share + PRECISION[2]];
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12), "{found:?} for {expected:?}");
}

/// One coordinate of `count` starts, idle lanes left out.
fn coordinates(states: &[Block], count: usize, j: usize) -> Vec<f64> {
    states.chunks_exact(3).flat_map(|block| block[j].0).take(count).collect()
}

/// The Laplace approximation of a Gaussian is the Gaussian: all weights are the evidence, and starts are draws of the posterior.
#[test]
fn starts_from_an_exact_laplace_approximation_are_exact() {
    let target = Sum(&Observed, &Before);
    let start = |seed: u64, count: usize| {
        laplace_starts(&target, &mode(), count, Isa::best(), Stage::new(seed, "starts")).unwrap()
    };
    let (states, log_mean) = start(1, 13);
    assert!((log_mean - exact_log_evidence()).abs() < 1e-9, "{log_mean} for {}", exact_log_evidence());
    // Two blocks of eight; the three idle lanes repeat the first starts.
    assert_eq!(states.len(), 2 * 3);
    for j in 0..3 {
        let all = coordinates(&states, 16, j);
        assert_eq!(all[13..], all[..3]);
        let means: Vec<f64> =
            (0..400).map(|seed| coordinates(&start(seed, 16).0, 16, j).iter().sum::<f64>() / 16.0).collect();
        check_mean("mean of starts", &means, exact_mean()[j]);
        let squares: Vec<f64> = (400..800)
            .map(|seed| {
                let starts = coordinates(&start(seed, 16).0, 16, j);
                starts.iter().map(|x| (x - exact_mean()[j]).powi(2)).sum::<f64>() / 16.0
            })
            .collect();
        check_mean("variance of starts", &squares, exact_variance(j));
    }
    assert!(matches!(
        laplace_starts(&target, &mode(), 0, Isa::best(), Stage::new(1, "starts")),
        Err(Error::Empty { count: 0, dim: 3 })
    ));
}

/// Starts weighed by the likelihood: the mean weight estimates the evidence without bias, whatever its scatter, and the starts themselves tend to the posterior.
#[test]
fn starts_from_the_prior_have_the_evidence_and_in_the_limit_the_posterior() {
    let start =
        |seed: u64, count: usize| importance_starts(&Observed, &Before, count, Stage::new(seed, "starts")).unwrap();
    let relative: Vec<f64> = (0..2000).map(|seed| (start(seed, 12).1 - exact_log_evidence()).exp()).collect();
    check_mean("evidence", &relative, 1.0);
    let (states, _) = start(1, 12);
    assert_eq!(states.len(), 2 * 3);
    for j in 0..3 {
        let all = coordinates(&states, 16, j);
        assert_eq!(all[12..], all[..4]);
        // Of 20 000 proposals some 250 count: bias and scatter are below a fifth of the posterior's width.
        let mean = coordinates(&start(7, 20_000).0, 20_000, j).iter().sum::<f64>() / 20_000.0;
        let width = exact_variance(j).sqrt();
        assert!((mean - exact_mean()[j]).abs() < 0.4 * width, "{mean} for {}", exact_mean()[j]);
    }
    assert!(matches!(
        importance_starts(&Observed, &Before, 0, Stage::new(1, "starts")),
        Err(Error::Empty { count: 0, dim: 3 })
    ));
}

/// A density without a peak: nothing is selected, and every layer's diffusion remains.
struct Flat;
impl LogDensity for Flat {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        0.0
    }
}

#[test]
fn the_diffusion_shrinks_by_variance_or_by_deviation() {
    let start = Population::from_blocks(1, 20_000, |_, x| x.fill(Block::ZERO)).expect("not empty");
    for (scaling, expected) in
        [(Scaling::Variance, 1.0 + 0.5 + 0.25), (Scaling::StandardDeviation, 1.0 + 0.25 + 0.0625)]
    {
        let config = annealed_search::Config { layers: 3, scaling, scheme: Scheme::Systematic, ..Default::default() };
        let found = search(&Flat, &start, &[3.0], &config, Isa::best(), Stage::new(1, "flat")).expect("finds");
        let variance = found.population.states().iter().flat_map(|x| x.0).map(|x| x * x).sum::<f64>() / 20_000.0 / 9.0;
        // The mean of 20 000 squares scatters by a hundredth of it.
        assert!((variance / expected - 1.0).abs() < 0.05, "{scaling:?}: {variance} for {expected}");
    }
    let start = Population::from_blocks(3, 200, |_, x| x.fill(Block::ZERO)).expect("not empty");
    let config = annealed_search::Config { layers: 3, last: Last::Fixed(0.7), ..Default::default() };
    let found = search(&Observed, &start, &SD, &config, Isa::best(), Stage::new(1, "fixed")).expect("finds");
    assert!(found.exponents[2] == 0.7 && found.exponents[..2].iter().all(|beta| *beta < 0.5), "{:?}", found.exponents);
}
