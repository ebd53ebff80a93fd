//! Does Hamiltonian Monte Carlo keep its target? Starts from exact draws (H6), kernels with planted faults that must be seen (H7, H10), long runs, a sweep of step sizes, walls of −∞ and NaN, frozen tuning.

use crate::camera_point::CameraPoint;
use crate::finding::{Finding, mean_and_error};
use crate::two_samples::kolmogorov_smirnov;
use sinew::core::density::{GradLogDensity, Lanes, LogDensity};
use sinew::core::diagnostics::effective_sample_size;
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::mixture::Mixture;
use sinew::samplers::chains::{Schedule, draw};
use sinew::samplers::hmc::{Chains, DIVERGENCE, Hmc, Workspace, leapfrog, update};
use sinew::samplers::metric::{Dense, Metric};
use sinew::samplers::nuts::{self, Nuts};
use sinew::samplers::tuning::{self, Trial};
use std::f64::consts::TAU;

/// A target with exact draws.
pub trait Exact: GradLogDensity {
    /// Eight independent draws.
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng);
}

/// Independent draws in blocks.
#[must_use]
pub fn exact_draws(target: &impl Exact, blocks: usize, stage: &Stage) -> Vec<Block> {
    let d = target.dim();
    let mut out = vec![Block::ZERO; blocks * d];
    for (block, states) in out.chunks_exact_mut(d).enumerate() {
        target.draw_block(states, &mut stage.block(block as u32));
    }
    out
}

impl Exact for Lanes<Gaussian> {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        self.leaf.sample_block(self.isa, out, rng);
    }
}

impl Exact for Lanes<Mixture> {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        let mut which = [Block::ZERO];
        rng.fill_uniform(&mut which);
        rng.fill_normal(self.isa, out);
        let means = self.leaf.means();
        for (j, (x, sd)) in out.iter_mut().zip(self.leaf.sd()).enumerate() {
            for (x, u) in x.0.iter_mut().zip(which[0].0) {
                *x = means[(u * means.len() as f64) as usize][j] + sd * *x;
            }
        }
    }
}

/// A Gaussian whose covariance is Σ + 1 1ᵀ / 2 with variances Σ from 1 to `widest`.
#[must_use]
pub fn correlated(dim: usize, widest: f64) -> Lanes<Gaussian> {
    let variance = |j: usize| widest.powf(j as f64 / (dim.max(2) - 1) as f64);
    let entry = |i: usize, j: usize| 0.5 + if i == j { variance(i) } else { 0.0 };
    let covariance: Vec<f64> = (0..dim * dim).map(|e| entry(e / dim, e % dim)).collect();
    let leaf = Gaussian::new(vec![0.0; dim], &covariance).expect("positive definite");
    Lanes { leaf, isa: Isa::best() }
}

/// Two Gaussians in the plane, four of their deviations apart.
#[must_use]
pub fn two_modes() -> Lanes<Mixture> {
    let leaf = Mixture::new(vec![vec![-1.4, 0.0], vec![1.4, 0.5]], &[0.7, 1.0]).expect("valid");
    Lanes { leaf, isa: Isa::best() }
}

/// Student's t with four degrees: far out its curvature is a fraction of that in the middle. Drawn as z √(2 / e) with e the sum of two exponential deviates.
pub struct HeavyTails;

impl LogDensity for HeavyTails {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -2.5 * (x[0] * x[0] / 4.0).ln_1p()
    }
}

impl GradLogDensity for HeavyTails {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = -5.0 * x[0] / (4.0 + x[0] * x[0]);
        self.log_density(x)
    }
}

impl Exact for HeavyTails {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        let mut u = [Block::ZERO; 2];
        rng.fill_uniform(&mut u);
        rng.fill_normal(Isa::best(), out);
        for lane in 0..LANES {
            let chi_square = -2.0 * (u[0].0[lane] * u[1].0[lane]).ln();
            out[0].0[lane] *= (4.0 / chi_square).sqrt();
        }
    }
}

/// x² e^{−x} on the positive half-line, −∞ elsewhere: skewed, with mean and variance 3.
pub struct Skewed;

impl LogDensity for Skewed {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x[0] > 0.0 { 2.0 * x[0].ln() - x[0] } else { f64::NEG_INFINITY }
    }
}

impl GradLogDensity for Skewed {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = 2.0 / x[0] - 1.0;
        self.log_density(x)
    }
}

impl Exact for Skewed {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        let mut u = [Block::ZERO; 3];
        rng.fill_uniform(&mut u);
        out[0] = Block(std::array::from_fn(|lane| -(0..3).map(|k| u[k].0[lane].ln()).sum::<f64>()));
    }
}

/// A standard normal between a region of NaN below −2 and a cliff to −∞ above 1.
pub struct Walled;

impl LogDensity for Walled {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0])
    }
}

impl GradLogDensity for Walled {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let legal = -2.0 <= x[0] && x[0] <= 1.0;
        grad[0] = if legal { -x[0] } else { f64::NAN };
        match x[0] {
            x if x > 1.0 => f64::NEG_INFINITY,
            x if x < -2.0 => f64::NAN,
            x => -0.5 * x * x,
        }
    }
}

impl Exact for Walled {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        for lane in 0..LANES {
            let mut one = [Block::ZERO];
            loop {
                rng.fill_normal(Isa::baseline(), &mut one);
                if let Some(x) = one[0].0.iter().find(|x| (-2.0..=1.0).contains(*x)) {
                    out[0].0[lane] = *x;
                    break;
                }
            }
        }
    }
}

/// The posterior of the camera point, drawn by rejection from a Gaussian that is 1.3 times as wide.
pub struct Seen<'a> {
    point: &'a CameraPoint,
    envelope: Lanes<Gaussian>,
    /// Largest logarithm of target over envelope, on a grid of ±8 deviations, and a little more.
    bound: f64,
}

impl<'a> Seen<'a> {
    /// Finds the bound of the rejection.
    ///
    /// # Panics
    /// Where the stored covariance is not one.
    #[must_use]
    pub fn new(point: &'a CameraPoint) -> Self {
        let wide: Vec<f64> = point.moments.covariance.iter().map(|c| 1.69 * c).collect();
        let leaf = Gaussian::new(point.mode.clone(), &wide).expect("positive definite");
        let envelope = Lanes { leaf, isa: Isa::best() };
        let target = point.target();
        let mut bound = f64::NEG_INFINITY;
        for index in 0..33_usize.pow(3) {
            let x: Vec<f64> = (0..3)
                .map(|j| {
                    let step = (index / 33_usize.pow(j as u32) % 33) as f64 / 2.0 - 8.0;
                    point.mode[j] + step * point.moments.covariance[4 * j].sqrt()
                })
                .collect();
            bound = bound.max(target.log_density(&x) - envelope.log_density(&x));
        }
        Self { point, envelope, bound: bound + 0.05 }
    }
}

impl LogDensity for Seen<'_> {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.point.target().log_density(x)
    }
}

impl GradLogDensity for Seen<'_> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.point.target().log_density_grad(x, grad)
    }
}

impl Exact for Seen<'_> {
    fn draw_block(&self, out: &mut [Block], rng: &mut BlockRng) {
        let (mut proposed, mut u) = (vec![Block::ZERO; 3], [Block::ZERO]);
        let mut filled = 0;
        while filled < LANES {
            self.envelope.leaf.sample_block(Isa::best(), &mut proposed, rng);
            rng.fill_uniform(&mut u);
            for lane in 0..LANES {
                let x: Vec<f64> = proposed.iter().map(|b| b.0[lane]).collect();
                let ratio = self.log_density(&x) - self.envelope.log_density(&x) - self.bound;
                assert!(ratio <= 0.0, "the envelope covers the target");
                if filled < LANES && u[0].0[lane].ln() < ratio {
                    out.iter_mut().zip(&x).for_each(|(b, x)| b.0[filled] = *x);
                    filled += 1;
                }
            }
        }
    }
}

/// A way to move a block of chains once.
pub trait Move<T> {
    /// Moves them.
    fn once(&self, target: &T, chains: &mut Chains, rng: &mut BlockRng);
}

/// The project's update.
pub struct Product<'a>(pub &'a Hmc);

impl<T: GradLogDensity> Move<T> for Product<'_> {
    fn once(&self, target: &T, chains: &mut Chains, rng: &mut BlockRng) {
        update(target, self.0, chains, &mut Workspace::new(target), rng);
    }
}

/// The planted fault of H7: steps from the curvature at the chain's own state, as of [`HeavyTails`].
pub struct CurvatureOfState<'a>(pub &'a Hmc);

/// What the fault multiplies the steps with.
#[must_use]
pub fn faulty_factor(x: f64) -> f64 {
    (1.0 + x * x / 4.0).sqrt()
}

impl Move<HeavyTails> for CurvatureOfState<'_> {
    fn once(&self, target: &HeavyTails, chains: &mut Chains, rng: &mut BlockRng) {
        let (mut p, mut u) = ([Block::ZERO], [Block::ZERO]);
        rng.fill_normal(Isa::best(), &mut p);
        rng.fill_uniform(&mut u);
        let factor = Block(chains.position[0].0.map(faulty_factor));
        let (mut x, mut g) = (chains.position.clone(), chains.gradient.clone());
        let kinetic = p[0].0.map(|p| 0.5 * p * p);
        let end = leapfrog(target, self.0, &factor, &mut x, &mut p, &mut g, &mut []);
        for (lane, kinetic) in kinetic.into_iter().enumerate() {
            let error = end.kinetic.0[lane] - end.log_density.0[lane] - kinetic + chains.log_density.0[lane];
            if error < DIVERGENCE && u[0].0[lane] < (-error).exp() {
                chains.position[0].0[lane] = x[0].0[lane];
                chains.gradient[0].0[lane] = g[0].0[lane];
                chains.log_density.0[lane] = end.log_density.0[lane];
            }
        }
    }
}

/// H6: after one move from exact draws, means of x_j, x_j² and x_i x_j against the same states before (|z| < 4.5), and every coordinate against independent exact draws (Kolmogorov–Smirnov, p > 1e-4).
#[must_use]
pub fn exact_start<T: Exact>(name: &str, target: &T, by: &impl Move<T>, blocks: usize, seed: u64) -> Vec<Finding> {
    let d = target.dim();
    let [to_start, to_compare, to_move] = Stage::new(seed, "exact start").split(["start", "compare", "move"]);
    let starts = exact_draws(target, blocks, &to_start);
    let others = exact_draws(target, blocks, &to_compare);
    let mut ends = vec![];
    for (block, start) in starts.chunks_exact(d).enumerate() {
        let mut chains = Chains::new(target, start.to_vec()).expect("finite");
        by.once(target, &mut chains, &mut to_move.block(block as u32));
        ends.extend(chains.position);
    }
    let mut findings = vec![];
    let series = |of: &[Block], j: usize| -> Vec<f64> { of[j..].iter().step_by(d).flat_map(|b| b.0).collect() };
    let columns = |of: &[Block]| -> Vec<Vec<f64>> { (0..d).map(|j| series(of, j)).collect() };
    let (before, after, fresh) = (columns(&starts), columns(&ends), columns(&others));
    let mut paired = |what: String, change: Vec<f64>| {
        let [mean, error] = mean_and_error(&change);
        let detail = format!("change {mean:.2e}, {} starts, seed {seed}", change.len());
        findings.push(Finding::score(format!("{name}: {what}"), mean / error, 4.5, detail));
    };
    for i in 0..d {
        paired(format!("x{i}"), after[i].iter().zip(&before[i]).map(|(a, b)| a - b).collect());
        for j in 0..=i {
            let product = |of: &[Vec<f64>], k: usize| of[i][k] * of[j][k];
            let change = (0..before[i].len()).map(|k| product(&after, k) - product(&before, k)).collect();
            paired(format!("x{i} x{j}"), change);
        }
    }
    for i in 0..d {
        let p = kolmogorov_smirnov(&after[i], &fresh[i]);
        findings.push(Finding {
            name: format!("{name}: Kolmogorov-Smirnov p of x{i}"),
            statistic: p,
            bounds: [1e-4, 1.0],
            false_alarm: 1e-4,
            detail: format!("{} draws each, seed {seed}", after[i].len()),
        });
    }
    findings
}

/// H10: the mean of [`Skewed`] over all states, and over those only that a trajectory brought; and the part that was rejected. A kernel whose rejected states are dropped shows in the second.
#[must_use]
pub fn rejections(blocks: usize, updates: usize, seed: u64) -> [Finding; 3] {
    let hmc = Hmc::new(2.1, &[0.5], 1, 0.0, Isa::best()).expect("valid");
    let [to_start, to_move] = Stage::new(seed, "rejections").split(["start", "move"]);
    let starts = exact_draws(&Skewed, blocks, &to_start);
    let (mut all, mut dropped, mut rejected) = (vec![], vec![], 0);
    for (block, start) in starts.iter().enumerate() {
        let mut chains = Chains::new(&Skewed, vec![*start]).expect("finite");
        let mut ws = Workspace::new(&Skewed);
        let mut rng = to_move.block(block as u32);
        let (mut sums, mut taken) = ([0.0; LANES], [(0.0, 0.0); LANES]);
        for _ in 0..updates {
            let moved = update(&Skewed, &hmc, &mut chains, &mut ws, &mut rng);
            for lane in 0..LANES {
                let x = chains.position[0].0[lane];
                sums[lane] += x / updates as f64;
                if moved.accepted[lane] {
                    taken[lane].0 += x;
                    taken[lane].1 += 1.0;
                } else {
                    rejected += 1;
                }
            }
        }
        all.extend(sums);
        dropped.extend(taken.iter().filter(|t| t.1 > 0.0).map(|t| t.0 / t.1));
    }
    let part = rejected as f64 / (blocks * LANES * updates) as f64;
    let of = |what: &str, values: &[f64]| {
        let [mean, error] = mean_and_error(values);
        Finding::score(what, (mean - 3.0) / error, 4.5, format!("mean {mean:.4} ± {error:.4} for 3, seed {seed}"))
    };
    [
        of("mean of all states", &all),
        of("mean without rejected states", &dropped),
        Finding::between("part rejected", part, [0.4, 0.6], ""),
    ]
}

/// `long-run`: the variance of a 28-dimensional Gaussian, in units of the exact one and averaged over coordinates, over `updates` updates of 16 chains.
#[must_use]
pub fn long_run(updates: usize, seed: u64) -> Finding {
    let target = correlated(28, 30.0);
    let metric = Metric::Diagonal(target.leaf.precision_diagonal().to_vec());
    let hmc = Hmc::with_metric(0.35, &metric, 12, 0.2, Isa::best()).expect("valid");
    let starts = exact_draws(&target, 2, &Stage::new(seed, "long run start"));
    let schedule = Schedule { updates, burn_in: 1 };
    let draws = draw(&target, &hmc, &starts, 16, schedule, &Stage::new(seed, "long run")).expect("finite");
    let squares = pooled_squares(&draws, &target);
    let values: Vec<f64> = squares.iter().flatten().copied().collect();
    let [mean, _] = mean_and_error(&values);
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
    let error = (variance / effective_sample_size(&squares)).sqrt();
    let detail = format!(
        "{mean:.5} ± {error:.5} for 1, {} draws, acceptance {:.2}, seed {seed}",
        values.len(),
        draws.acceptance
    );
    Finding::score("long run: pooled variance", (mean - 1.0) / error, 4.0, detail)
}

/// Mean over coordinates of x_j² / C_jj for each draw, chain by chain.
fn pooled_squares(draws: &sinew::samplers::chains::Draws, target: &Lanes<Gaussian>) -> Vec<Vec<f64>> {
    let d = target.dim();
    let covariance = inverse_diagonal(target);
    let series: Vec<Vec<Vec<f64>>> = (0..d).map(|j| draws.series(j)).collect();
    (0..draws.chains)
        .map(|chain| {
            (0..series[0][chain].len())
                .map(|k| (0..d).map(|j| series[j][chain][k].powi(2) / covariance[j]).sum::<f64>() / d as f64)
                .collect()
        })
        .collect()
}

/// Variances of a [`correlated`] Gaussian.
fn inverse_diagonal(target: &Lanes<Gaussian>) -> Vec<f64> {
    let d = target.dim();
    let lower =
        sinew::dynamics::factor::cholesky("precision", target.leaf.precision(), d).expect("positive definite").lower;
    let inverse = sinew::dynamics::factor::inverse_lower(&lower, d);
    (0..d).map(|j| (0..d).map(|k| inverse[k * d + j].powi(2)).sum()).collect()
}

/// `step-size sweep`: the same variance for acceptances from 0.2 to 0.99, trajectories of 1 and 200 steps, with jitter and without; errors from independent chains that start at exact draws.
#[must_use]
pub fn sweep(blocks: usize, seed: u64) -> Vec<Finding> {
    let target = correlated(28, 8.0);
    let metric = Metric::Diagonal(target.leaf.precision_diagonal().to_vec());
    let mut findings = vec![];
    let (mut lowest, mut highest) = (1.0_f64, 0.0_f64);
    for (eta, steps, updates) in [
        (1.35, 1, 40),
        (0.8, 1, 40),
        (0.5, 1, 40),
        (0.2, 1, 40),
        (1.05, 200, 6),
        (0.75, 200, 6),
        (0.4, 200, 6),
        (0.15, 200, 6),
    ] {
        for jitter in [0.0, 0.2] {
            let stage = Stage::new(seed, &format!("sweep {eta} {steps} {jitter}"));
            let [to_start, to_move] = stage.split(["start", "move"]);
            let starts = exact_draws(&target, blocks, &to_start);
            let hmc = Hmc::with_metric(eta, &metric, steps, jitter, Isa::best()).expect("valid");
            let schedule = Schedule { updates, burn_in: 1 };
            let draws = draw(&target, &hmc, &starts, blocks * LANES, schedule, &to_move).expect("finite");
            let of_chains: Vec<f64> = pooled_squares(&draws, &target)
                .iter()
                .map(|chain| chain.iter().sum::<f64>() / chain.len() as f64)
                .collect();
            let [mean, error] = mean_and_error(&of_chains);
            (lowest, highest) = (lowest.min(draws.acceptance), highest.max(draws.acceptance));
            let name = format!("variance at step {eta}, {steps} steps, jitter {jitter}");
            let detail = format!("{mean:.4} ± {error:.4} for 1, acceptance {:.2}, seed {seed}", draws.acceptance);
            findings.push(Finding::score(name, (mean - 1.0) / error, 4.5, detail));
        }
    }
    findings.push(Finding::between("sweep: lowest acceptance", lowest, [0.05, 0.3], ""));
    findings.push(Finding::between("sweep: highest acceptance", highest, [0.98, 1.0], ""));
    findings
}

/// `divergent stays`: chains from exact draws of [`Walled`] never stand outside, divergences are counted, and mean and variance inside are those of the truncated normal; for both samplers.
#[must_use]
pub fn walls(blocks: usize, updates: usize, seed: u64) -> Vec<Finding> {
    let isa = Isa::best();
    let density = |x: f64| (-0.5 * x * x).exp() / TAU.sqrt();
    // Φ(1) − Φ(−2).
    let mass = 0.841_344_746_068_542_9 - 0.022_750_131_948_179_2;
    let exact_mean = (density(-2.0) - density(1.0)) / mass;
    let exact_square = 1.0 + (-2.0 * density(-2.0) - density(1.0)) / mass;
    let [to_start, to_move, to_grow] = Stage::new(seed, "walls").split(["start", "move", "grow"]);
    let starts = exact_draws(&Walled, blocks, &to_start);
    let metric = Metric::Diagonal(vec![1.0]);
    let schedule = Schedule { updates, burn_in: 1 };
    let hmc = Hmc::with_metric(0.5, &metric, 3, 0.2, isa).expect("valid");
    let nuts = Nuts::with_metric(0.5, &metric, 10, 0.2, isa).expect("valid");
    let moved = draw(&Walled, &hmc, &starts, blocks * LANES, schedule, &to_move).expect("finite");
    let grown = nuts::draw(&Walled, &nuts, &starts, blocks * LANES, schedule, &to_grow).expect("finite").draws;
    let mut findings = vec![];
    for (name, draws) in [("hmc", moved), ("nuts", grown)] {
        let series = draws.series(0);
        let outside = series.iter().flatten().filter(|x| !(-2.0..=1.0).contains(*x)).count();
        findings.push(Finding::at_most(format!("{name}: states beyond the walls"), outside as f64, 0.0, ""));
        let bad = draws.stats.iter().filter(|s| !(s.log_density.is_finite() && s.energy.is_finite())).count();
        findings.push(Finding::at_most(format!("{name}: numbers that are none"), bad as f64, 0.0, ""));
        let counted = draws.stats.iter().filter(|s| s.divergent).count() as f64;
        let part = counted / draws.stats.len() as f64;
        findings.push(Finding::between(format!("{name}: divergent part"), part, [0.05, 0.95], "counted, not hidden"));
        for (what, exact, power) in [("mean", exact_mean, 1), ("mean square", exact_square, 2)] {
            let of_chains: Vec<f64> =
                series.iter().map(|c| c.iter().map(|x| x.powi(power)).sum::<f64>() / c.len() as f64).collect();
            let [mean, error] = mean_and_error(&of_chains);
            let detail = format!("{mean:.4} ± {error:.4} for {exact:.4}, seed {seed}");
            findings.push(Finding::score(
                format!("{name}: {what} between the walls"),
                (mean - exact) / error,
                4.5,
                detail,
            ));
        }
    }
    findings
}

/// `target acceptance` and `adaptation-frozen`: on 28 dimensions a step size is tuned to accept 0.8; then it accepts 0.8 ± 0.03, and the kept draws are bit for bit those of updates with that one step size and metric.
#[must_use]
pub fn tuned_acceptance(updates: usize, seed: u64) -> [Finding; 2] {
    let isa = Isa::best();
    let target = correlated(28, 8.0);
    let metric = Metric::Diagonal(target.leaf.precision_diagonal().to_vec());
    let [to_start, to_tune, to_move] = Stage::new(seed, "tuned").split(["start", "tune", "move"]);
    let states = exact_draws(&target, 2, &to_start);
    let config = tuning::Config { acceptance: 0.8, tolerance: 0.01, trajectories: 4000, ..tuning::Config::default() };
    let mut trial = Trial { target: &target, metric: &metric, states, isa };
    let tuned = tuning::step_size(&mut trial, 10, &config, &to_tune).expect("tunable");
    let hmc = Hmc::with_metric(tuned.step_size, &metric, 10, 0.0, isa).expect("valid");
    let schedule = Schedule { updates, burn_in: 0 };
    let draws = draw(&target, &hmc, &trial.states, 16, schedule, &to_move).expect("finite");
    let frozen = hmc.clone();
    let mut different = 0;
    let series: Vec<Vec<Vec<f64>>> = (0..28).map(|j| draws.series(j)).collect();
    let kept = |coordinate: usize, chain: usize, k: usize| series[coordinate][chain][k];
    for (block, start) in trial.states.chunks_exact(28).enumerate() {
        let mut chains = Chains::new(&target, start.to_vec()).expect("finite");
        let (mut ws, mut rng) = (Workspace::new(&target), to_move.block(block as u32));
        for k in 1..=updates {
            update(&target, &frozen, &mut chains, &mut ws, &mut rng);
            for (j, x) in chains.position.iter().enumerate() {
                for lane in 0..LANES {
                    different += usize::from(x.0[lane].to_bits() != kept(j, block * LANES + lane, k).to_bits());
                }
            }
        }
    }
    different += draws.stats.iter().filter(|s| s.step_factor.to_bits() != 1.0_f64.to_bits()).count();
    let detail = format!("step size {:.3}, {} draws, seed {seed}", tuned.step_size, draws.stats.len());
    [
        Finding::between("realised acceptance", draws.acceptance, [0.77, 0.83], detail),
        Finding::at_most("kept numbers that another step size or metric made", different as f64, 0.0, "bit for bit"),
    ]
}

/// H6 on its three targets with the project's update: a Gaussian in five dimensions with both metrics, two modes in the plane, the posterior of the camera point.
#[must_use]
pub fn exact_starts(point: Option<&CameraPoint>, blocks: usize, seed: u64) -> Vec<Finding> {
    let isa = Isa::best();
    let gaussian = correlated(5, 4.0);
    let diagonal = Metric::Diagonal(gaussian.leaf.precision_diagonal().to_vec());
    let dense = Metric::Dense(Dense::new(gaussian.leaf.precision(), 5).expect("positive definite"));
    let mut findings = vec![];
    for (name, metric) in [("gaussian, diagonal", diagonal), ("gaussian, dense", dense)] {
        let hmc = Hmc::with_metric(0.9, &metric, 4, 0.2, isa).expect("valid");
        findings.extend(exact_start(name, &gaussian, &Product(&hmc), blocks, seed));
    }
    let hmc = Hmc::new(0.9, &[1.0, 1.0], 4, 0.2, isa).expect("valid");
    findings.extend(exact_start("two modes", &two_modes(), &Product(&hmc), blocks, seed));
    if let Some(point) = point {
        let curvature: Vec<f64> = (0..3).map(|j| 1.0 / point.moments.covariance[4 * j]).collect();
        let hmc = Hmc::new(0.9, &curvature, 4, 0.2, isa).expect("valid");
        findings.extend(exact_start("camera point", &Seen::new(point), &Product(&hmc), blocks, seed));
    }
    findings
}

/// H7: on heavy tails the project's update keeps the target; the same update with steps from the curvature at the chain's state does not. Returns the findings of both.
#[must_use]
pub fn curvature_of_state(blocks: usize, seed: u64) -> [Vec<Finding>; 2] {
    let hmc = Hmc::new(0.8, &[1.0], 3, 0.0, Isa::best()).expect("valid");
    [
        exact_start("heavy tails", &HeavyTails, &Product(&hmc), blocks, seed),
        exact_start("heavy tails, curvature of the state", &HeavyTails, &CurvatureOfState(&hmc), blocks, seed),
    ]
}

/// H7 by reversal: where the trajectory of [`CurvatureOfState`] comes out when it starts from its end with the momentum turned; the distance from its start, for both kernels.
#[must_use]
pub fn reversal() -> [f64; 2] {
    let hmc = Hmc::new(0.8, &[1.0], 3, 0.0, Isa::best()).expect("valid");
    let distance = |factor: &dyn Fn(f64) -> f64| {
        let (mut x, mut p) = ([Block::splat(1.5)], [Block::splat(0.7)]);
        for _ in 0..2 {
            let mut g = [Block::ZERO];
            HeavyTails.log_density_grad_block(&x, &mut g, &mut []);
            let factor = Block(x[0].0.map(factor));
            leapfrog(&HeavyTails, &hmc, &factor, &mut x, &mut p, &mut g, &mut []);
            p[0].0.iter_mut().for_each(|p| *p = -*p);
        }
        (x[0].0[0] - 1.5).abs()
    };
    [distance(&|_| 1.0), distance(&faulty_factor)]
}
