//! Leapfrog and hybrid Monte Carlo on the benchmark problem and on targets in closed form.
//!
//! Hamiltonian Monte Carlo: reversibility (H1), volume (H2), energy error (H3, H5), acceptance (H4), step sizes of components (H8), moments of a long run (H9); on the 28-dimensional benchmark problem and, where the specification names that body, on a posterior of CF28.

use sinew::body::standard::{cf28, h32};
use sinew::body::{KinematicTree, Plan, Proportions, point_positions};
use sinew::core::combinators::{OnPart, Sum};
use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::diagnostics::{effective_sample_size, split_r_hat};
use sinew::core::lanes::{Block, Isa, LANES, triangle};
use sinew::core::part::Part;
use sinew::core::random::Stage;
use sinew::core::toy::Quadratic;
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::mixture::Mixture;
use sinew::dynamics::prior::Prior;
use sinew::observe::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View};
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::integrator::{End, PhasePoint};
use sinew::samplers::laplace::laplace;
use sinew::samplers::metric::{Dense, Metric};
use sinew::samplers::starts::laplace_starts;
use sinew_markers::{MarkerLikelihood, MarkerModel};
use sinew_tests::problem28;
use std::sync::Arc;

const UNIT: Block = Block::splat(1.0);

fn noise(dim: usize, stage: Stage) -> Vec<Block> {
    let mut out = vec![Block::ZERO; dim];
    stage.whole().fill_normal(Isa::best(), &mut out);
    out
}

fn gradient_at<T: GradLogDensity>(target: &T, x: &[Block]) -> (Block, Vec<Block>) {
    let mut gradient = vec![Block::ZERO; x.len()];
    let value = target.log_density_grad_block(x, &mut gradient, &mut vec![Block::ZERO; target.workspace()]);
    (value, gradient)
}

fn trajectory<T: GradLogDensity>(target: &T, hmc: &Hmc, x: &mut [Block], p: &mut [Block]) -> End {
    let mut gradient = gradient_at(target, x).1;
    let point = PhasePoint { position: x, momentum: p, gradient: &mut gradient };
    hmc.trajectory(target, &UNIT, point, &mut vec![Block::ZERO; target.workspace()])
}

/// Gauss–Newton curvature at a pose plus the prior's precision.
fn curvature_at(likelihood: &impl GaussNewton, pose: &[f64], prior_sd: &[f64]) -> Vec<f64> {
    let x: Vec<Block> = pose.iter().map(|&x| Block::splat(x)).collect();
    let mut diagonal = vec![Block::ZERO; x.len()];
    likelihood.gauss_newton_diagonal_block(&x, &mut diagonal, &mut vec![Block::ZERO; likelihood.workspace()]);
    diagonal.iter().zip(prior_sd).map(|(h, sd)| h.0[0] + 1.0 / (sd * sd)).collect()
}

fn curvature28(problem: &problem28::Problem) -> Vec<f64> {
    curvature_at(&problem.likelihood(Isa::best()), &problem.true_pose, &problem.prior_sd)
}

/// A posterior of CF28: its markers in one view with errors of 0.003, and a mixture of ten poses as prior.
struct Cf28 {
    target: Sum<Lanes<MarkerLikelihood>, Lanes<Mixture>>,
    pose: Vec<f64>,
    curvature: Vec<f64>,
}

fn cf28_posterior() -> Cf28 {
    let tree = cf28(&Proportions::default());
    let plan = Arc::new(Plan::with_all_points(&tree));
    let isa = Isa::best();
    let wave = |j: usize| 0.2 * (1.7 * j as f64).sin();
    let pose: Vec<f64> = (0..28).map(|j| wave(j) + if j == 2 { 1.0 } else { 0.0 }).collect();
    let model = MarkerModel { plan: Arc::clone(&plan), centre: [0.0, -4.8, 1.0], sigma: 0.003, isa };
    let mut points = vec![0.0; 3 * plan.points()];
    point_positions(&plan, isa, &pose, &mut points);
    let frame: Vec<Option<[f64; 2]>> = points
        .chunks(3)
        .zip(0..)
        .map(|(p, k)| {
            let depth = p[1] - model.centre[1];
            let error = |i: usize| 0.003 * (1.3 * (k + i) as f64).sin();
            Some([(p[0] - model.centre[0]) / depth + error(0), (p[2] - model.centre[2]) / depth + error(7)])
        })
        .collect();
    let prior_sd = vec![0.1; 28];
    let centre = |i: usize| (0..28).map(|j| pose[j] + 0.05 * ((i + 3 * j) as f64).sin()).collect();
    let prior = Mixture::new((0..10).map(centre).collect(), &prior_sd).expect("valid mixture");
    let likelihood = model.bind(&frame);
    let curvature = curvature_at(&likelihood, &pose, &prior_sd);
    Cf28 { target: Sum(likelihood, Lanes { leaf: prior, isa }), pose, curvature }
}

/// States of the posterior's bulk: `blocks` blocks after a short run from the true pose.
fn bulk28(problem: &problem28::Problem, blocks: usize) -> Vec<Block> {
    let hmc = Hmc::new(0.3, &curvature28(problem), 20, 0.2, Isa::best()).expect("valid");
    let starts: Vec<Block> = (0..blocks).flat_map(|_| problem.true_pose.iter().map(|&x| Block::splat(x))).collect();
    let schedule = Schedule { updates: 40, burn_in: 40 };
    let stage = Stage::new(1, "bulk");
    draw_trajectories(&problem.target(Isa::best()), &hmc, &starts, blocks * LANES, schedule, &stage)
        .expect("finite start")
        .last
}

/// Reversibility (H1), on CF28 and on the benchmark.
#[test]
fn reversed_momenta_lead_back() {
    let body = cf28_posterior();
    let start: Vec<Block> = body.pose.iter().map(|&x| Block::splat(x)).collect();
    reversed(&body.target, &Hmc::new(0.2, &body.curvature, 80, 0.0, Isa::best()).expect("valid"), &start);
    let problem = problem28::load();
    let (target, start) = (problem.target(Isa::best()), bulk28(&problem, 1));
    for metric in [Metric::Diagonal(curvature28(&problem)), dense28(&problem)] {
        reversed(&target, &Hmc::with_metric(0.2, &metric, 80, 0.0, Isa::best()).expect("valid"), &start);
    }
}

/// The whole Gauss–Newton matrix at the true pose plus the prior's precision.
fn dense28(problem: &problem28::Problem) -> Metric {
    let likelihood = problem.likelihood(Isa::best());
    let x: Vec<Block> = problem.true_pose.iter().map(|&x| Block::splat(x)).collect();
    let mut matrix = vec![Block::ZERO; triangle(28, 0)];
    likelihood.gauss_newton_block(&x, &mut matrix, &mut vec![Block::ZERO; likelihood.workspace()]);
    let entry = |i: usize, j: usize| {
        let prior = if i == j { problem.prior_sd[i].powi(-2) } else { 0.0 };
        matrix[triangle(i.max(j), i.min(j))].0[0] + prior
    };
    let whole: Vec<f64> = (0..28 * 28).map(|e| entry(e / 28, e % 28)).collect();
    Metric::Dense(Dense::new(&whole, 28).expect("positive definite"))
}

fn reversed(target: &impl GradLogDensity, hmc: &Hmc, start: &[Block]) {
    let momenta = noise(28, Stage::new(1, "H1"));
    let (mut x, mut p) = (start.to_vec(), momenta.clone());
    trajectory(target, hmc, &mut x, &mut p);
    assert!((x[20].0[3] - start[20].0[3]).abs() > 1e-3, "the trajectory moves");
    p.iter_mut().flat_map(|b| &mut b.0).for_each(|p| *p = -*p);
    trajectory(target, hmc, &mut x, &mut p);
    for j in 0..28 {
        for lane in 0..LANES {
            let (dx, dp) = (x[j].0[lane] - start[j].0[lane], p[j].0[lane] + momenta[j].0[lane]);
            assert!(dx.abs() < 1e-10 && dp.abs() < 1e-10, "coordinate {j}, lane {lane}: {dx}, {dp}, bound 1e-10");
        }
    }
}

fn log_det(mut m: Vec<Vec<f64>>) -> f64 {
    let n = m.len();
    let mut log = 0.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| m[a][k].abs().total_cmp(&m[b][k].abs())).expect("rows left");
        m.swap(k, pivot);
        log += m[k][k].abs().ln();
        let pivot_row = m[k].clone();
        for row in &mut m[k + 1..] {
            let factor = row[k] / pivot_row[k];
            row.iter_mut().zip(&pivot_row).skip(k).for_each(|(a, b)| *a -= factor * b);
        }
    }
    log
}

/// Volume preservation (H2), on parts of CF28 and of the benchmark.
#[test]
fn a_leapfrog_step_preserves_volume() {
    let body = cf28_posterior();
    volume_is_preserved(&body.target, &body.curvature, &body.pose);
    let problem = problem28::load();
    volume_is_preserved(&problem.target(Isa::best()), &curvature28(&problem), &problem.true_pose);
}

fn volume_is_preserved(target: &impl GradLogDensity, h: &[f64], fixed: &[f64]) {
    for indices in [vec![0, 5, 9, 20], vec![3, 4, 11, 12, 25, 27], vec![6, 7, 8]] {
        let d = indices.len();
        let scales: Vec<f64> = indices.iter().map(|&j| 1.0 / h[j].sqrt()).collect();
        let part = Part::new(indices.clone(), 28).expect("valid");
        let target = OnPart { target, part, fixed: fixed.to_vec() };
        let own: Vec<f64> = indices.iter().map(|&j| h[j]).collect();
        let hmc = Hmc::new(0.5, &own, 1, 0.0, Isa::best()).expect("valid");
        let step = |k: usize, by: f64| {
            let mut x: Vec<Block> = indices.iter().map(|&j| Block::splat(fixed[j])).collect();
            let mut p: Vec<Block> = (0..d).map(|j| Block::splat(0.3 * j as f64 - 0.5)).collect();
            // In units of the curvature, so that the differences are of one size.
            if k < d {
                x[k].0[0] += by * scales[k]
            } else {
                p[k - d].0[0] += by
            }
            trajectory(&target, &hmc, &mut x, &mut p);
            let scaled = x.iter().zip(&scales).map(|(x, s)| x.0[0] / s);
            scaled.chain(p.iter().map(|p| p.0[0])).collect::<Vec<f64>>()
        };
        let size = 1e-4;
        // Richardson: the error of the differences is of fourth order.
        let column = |k: usize| -> Vec<f64> {
            let central =
                |h: f64| -> Vec<f64> { step(k, h).iter().zip(step(k, -h)).map(|(a, b)| (a - b) / (2.0 * h)).collect() };
            central(size).iter().zip(central(2.0 * size)).map(|(a, b)| (4.0 * a - b) / 3.0).collect()
        };
        let jacobian: Vec<Vec<f64>> = (0..2 * d).map(column).collect();
        let log = log_det(jacobian);
        assert!(log.abs() < 1e-7, "coordinates {indices:?}: log |det| = {log}, bound 1e-7");
    }
}

/// Order of the energy error (H3).
#[test]
fn the_energy_error_falls_with_the_square_of_the_step() {
    let problem = problem28::load();
    let target = problem.target(Isa::best());
    let h = curvature28(&problem);
    let blocks = 13;
    let starts = bulk28(&problem, blocks);
    let mut points = vec![];
    for halvings in 0..4 {
        let eta = 0.2 / f64::from(1 << halvings);
        let hmc = Hmc::new(eta, &h, 5 << halvings, 0.0, Isa::best()).expect("valid");
        let mut total = 0.0;
        for block in 0..blocks {
            let mut x = starts[block * 28..][..28].to_vec();
            let mut p = noise(28, Stage::new(3, "H3").round(block));
            let before = gradient_at(&target, &x).0;
            let kinetic: Vec<f64> = (0..LANES).map(|l| p.iter().map(|p| 0.5 * p.0[l] * p.0[l]).sum()).collect();
            let end = trajectory(&target, &hmc, &mut x, &mut p);
            for (lane, kinetic) in kinetic.iter().enumerate() {
                let change = end.kinetic.0[lane] - end.log_density.0[lane] - kinetic + before.0[lane];
                total += change.abs() / (blocks * LANES) as f64;
            }
        }
        points.push((eta.ln(), total.ln()));
    }
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x) * (p.0 - x));
    assert!((1.8..=2.2).contains(&slope), "slope {slope}, bounds 1.8 and 2.2; {points:?}");
}

/// Acceptance of small steps, and the largest stable one (H4).
#[test]
fn acceptance_tends_to_one_and_the_harmonic_target_is_stable_below_two() {
    let isa = Isa::best();
    let target = Lanes { leaf: Quadratic { centre: vec![0.0; 3], precision: vec![1.0, 4.0, 0.1] }, isa };
    let curvature = [1.0, 4.0, 0.1];
    let starts = noise(3, Stage::new(4, "H4"));
    let farthest = |eta: f64| {
        let hmc = Hmc::new(eta, &curvature, 1000, 0.0, isa).expect("valid");
        let (mut x, mut p) = (starts.clone(), noise(3, Stage::new(5, "H4")));
        trajectory(&target, &hmc, &mut x, &mut p);
        x.iter().flat_map(|b| b.0).fold(0.0_f64, |a, b| a.max(b.abs()))
    };
    assert!(farthest(1.99) < 1e3, "{}", farthest(1.99));
    assert!(farthest(2.01) > 1e6, "{}", farthest(2.01));
    let mut last = 0.0;
    for eta in [1.5, 0.5, 0.1, 0.01] {
        let hmc = Hmc::new(eta, &curvature, 7, 0.0, isa).expect("valid");
        let schedule = Schedule { updates: 200, burn_in: 0 };
        let acceptance =
            draw_trajectories(&target, &hmc, &starts, 8, schedule, &Stage::new(6, "H4")).expect("finite").acceptance;
        assert!(acceptance > last, "{acceptance} at {eta}");
        last = acceptance;
    }
    assert!(last > 0.999_9, "{last}");
}

/// E[exp(−ΔH)] = 1 at stationarity (H5).
#[test]
fn the_mean_of_exp_minus_the_energy_error_is_one() {
    let (isa, d, blocks) = (Isa::best(), 10, 12_500);
    let precision: Vec<f64> = (0..d).map(|j| 1.0 + j as f64).collect();
    let target = Lanes { leaf: Quadratic { centre: vec![0.0; d], precision: precision.clone() }, isa };
    let hmc = Hmc::new(0.5, &[5.0; 10], 5, 0.0, isa).expect("valid");
    let stage = Stage::new(5, "H5");
    let (mut sum, mut square, mut acceptance) = (0.0, 0.0, 0.0);
    for block in 0..blocks {
        let mut numbers = vec![Block::ZERO; 2 * d];
        stage.block(block).fill_normal(isa, &mut numbers);
        let (x, p) = numbers.split_at_mut(d);
        for (x, precision) in x.iter_mut().zip(&precision) {
            x.0.iter_mut().for_each(|x| *x /= precision.sqrt());
        }
        let before = gradient_at(&target, x).0;
        let kinetic: Vec<f64> = (0..LANES).map(|l| p.iter().map(|p| 0.5 * p.0[l] * p.0[l]).sum()).collect();
        let end = trajectory(&target, &hmc, x, p);
        for (lane, kinetic) in kinetic.iter().enumerate() {
            let ratio = (kinetic - before.0[lane] - end.kinetic.0[lane] + end.log_density.0[lane]).exp();
            sum += ratio;
            square += ratio * ratio;
            acceptance += ratio.min(1.0);
        }
    }
    let n = f64::from(blocks) * LANES as f64;
    let mean = sum / n;
    let z = (mean - 1.0) / ((square / n - mean * mean) / n).sqrt();
    assert!(acceptance / n > 0.8 && acceptance / n < 0.99, "acceptance {}", acceptance / n);
    assert!(z.abs() < 4.0, "mean {mean}, z = {z}, bound 4, seed 5, false alarm 6e-5");
}

/// Steps of components (H8): component steps ε_j against the textbook form with mass η² / ε_j², unit-free step η.
#[test]
fn component_steps_equal_a_mass_matrix() {
    let isa = Isa::best();
    let leaf = Quadratic { centre: vec![0.5, -1.0, 2.0], precision: vec![3.0, 0.2, 10.0] };
    let (eta, h, steps) = (0.3, [2.0, 0.5, 7.0], 25);
    let hmc = Hmc::new(eta, &h, steps, 0.0, isa).expect("valid");
    let (x0, p0) = ([0.1, 0.4, 2.3], [0.7, -1.1, 0.2]);
    let (mut x, mut p) = (x0.map(Block::splat), p0.map(Block::splat));
    trajectory(&Lanes { leaf: leaf.clone(), isa }, &hmc, &mut x, &mut p);
    // ε = η / √h gives the mass h; the momentum of that mass is √h p.
    let (mut y, mut q) = (x0, [0, 1, 2].map(|j| h[j].sqrt() * p0[j]));
    for _ in 0..steps {
        let mut g = [0.0; 3];
        leaf.log_density_grad(&y, &mut g);
        (0..3).for_each(|j| q[j] += 0.5 * eta * g[j]);
        (0..3).for_each(|j| y[j] += eta * q[j] / h[j]);
        leaf.log_density_grad(&y, &mut g);
        (0..3).for_each(|j| q[j] += 0.5 * eta * g[j]);
    }
    for j in 0..3 {
        let (dx, dp) = (x[j].0[0] - y[j], p[j].0[0] - q[j] / h[j].sqrt());
        assert!(dx.abs() < 1e-12 && dp.abs() < 1e-12, "coordinate {j}: {dx}, {dp}, bound 1e-12");
    }
}

/// Moments of a long run on a Gaussian (H9), with both metrics. 130 statistics at |z| < 4.5: false alarm 1e-3.
#[test]
fn a_long_run_has_the_moments_of_a_badly_scaled_gaussian() {
    let d = 10;
    // Eigenvalues 1 … 100, turned by a Householder reflection.
    let v: Vec<f64> = (0..d).map(|j| 1.0 / (1.0 + j as f64)).collect();
    let norm: f64 = v.iter().map(|v| v * v).sum();
    let turn = |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / norm;
    let eigenvalue = |k: usize| 100.0_f64.powf(k as f64 / 9.0);
    let covariance: Vec<f64> =
        (0..d * d).map(|e| (0..d).map(|k| turn(e / d, k) * eigenvalue(k) * turn(e % d, k)).sum()).collect();
    let isa = Isa::best();
    let mean: Vec<f64> = (0..d).map(|j| j as f64 - 3.0).collect();
    let leaf = Gaussian::new(mean.clone(), &covariance).expect("valid");
    let diagonal = Metric::Diagonal(leaf.precision_diagonal().to_vec());
    // A metric that is not the exact precision, so that it must be the sampler which is right.
    let rough: Vec<f64> = (0..d * d).map(|e| leaf.precision()[e] * if e / d == e % d { 1.4 } else { 0.8 }).collect();
    let dense = Metric::Dense(Dense::new(&rough, d).expect("positive definite"));
    for (metric, steps) in [(diagonal, 15), (dense, 5)] {
        let hmc = Hmc::with_metric(0.7, &metric, steps, 0.2, isa).expect("valid");
        moments_of_long_run(&leaf, &covariance, &hmc);
    }
}

fn moments_of_long_run(leaf: &Gaussian, covariance: &[f64], hmc: &Hmc) {
    let (isa, mean, leaf) = (Isa::best(), leaf.mean().to_vec(), leaf.clone());
    let d = mean.len();
    let mut starts = vec![Block::ZERO; 2 * d];
    let mut rng = Stage::new(9, "H9 start").whole();
    starts.chunks_exact_mut(d).for_each(|block| leaf.sample_block(isa, block, &mut rng));
    let schedule = Schedule { updates: 4000, burn_in: 0 };
    let draws = draw_trajectories(&Lanes { leaf, isa }, hmc, &starts, 16, schedule, &Stage::new(9, "H9"))
        .expect("finite start");
    assert!(draws.acceptance > 0.6 && draws.divergences == 0, "acceptance {}", draws.acceptance);
    let series: Vec<Vec<Vec<f64>>> = (0..d).map(|j| draws.series(j)).collect();
    let check = |name: String, values: Vec<Vec<f64>>, exact: f64| {
        let n = values.iter().map(Vec::len).sum::<usize>() as f64;
        let mean = values.iter().flatten().sum::<f64>() / n;
        let variance = values.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
        let z = (mean - exact) / (variance / effective_sample_size(&values)).sqrt();
        assert!(z.abs() < 4.5, "{name}: {mean} against {exact}, z = {z}, bound 4.5, seed 9");
        assert!(split_r_hat(&values) < 1.01, "{name}");
    };
    for i in 0..d {
        check(format!("mean {i}"), series[i].clone(), mean[i]);
        for j in 0..=i {
            let product = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| (a - mean[i]) * (b - mean[j])).collect()
            };
            let values = series[i].iter().zip(&series[j]).map(product).collect();
            check(format!("covariance {i}, {j}"), values, covariance[i * d + j]);
        }
    }
}

/// 56 statistics at |z| < 4.5: false alarm 4e-4.
#[test]
fn the_benchmark_posterior_has_the_means_of_the_long_run() {
    let problem = problem28::load();
    for (metric, eta, steps) in [(Metric::Diagonal(curvature28(&problem)), 0.3, 25), (dense28(&problem), 0.4, 6)] {
        long_run_means(&problem, &Hmc::with_metric(eta, &metric, steps, 0.2, Isa::best()).expect("valid"));
    }
}

/// In a linear-Gaussian model the Laplace approximation is the posterior, and its evidence is exact whatever is drawn.
#[test]
fn laplace_starts_of_a_gaussian_posterior_know_its_evidence() {
    let isa = Isa::best();
    let d = 4;
    let covariance: Vec<f64> = (0..d * d).map(|e| if e / d == e % d { 2.0 } else { 0.7 }).collect();
    let prior = Prior::Gaussian(Lanes { leaf: Gaussian::new(vec![0.5; d], &covariance).expect("valid"), isa });
    let seen = Quadratic { centre: vec![1.0, -1.0, 0.3, 2.0], precision: vec![4.0, 1.0, 9.0, 0.5] };
    let observed = Lanes { leaf: seen.clone(), isa };
    let found = laplace(&observed, &prior, 8, isa, Stage::new(1, "laplace")).expect("positive definite");
    let target = Sum(&observed, &prior);
    let (states, log_evidence) = laplace_starts(&target, &found, 16, isa, Stage::new(2, "starts")).expect("weights");
    assert!(states.iter().all(|b| b.0.iter().all(|x| x.is_finite())));
    // ∫ N(x; m, C) exp(−½ (x − c)ᵀ W (x − c)) dx = N(c; m, C + W⁻¹) · √|2π W⁻¹|
    let mut sum = covariance.clone();
    (0..d).for_each(|j| sum[j * (d + 1)] += 1.0 / seen.precision[j]);
    let marginal = Lanes { leaf: Gaussian::new(vec![0.5; d], &sum).expect("valid"), isa };
    let width: f64 = seen.precision.iter().map(|w| 0.5 * (std::f64::consts::TAU / w).ln()).sum();
    let exact = marginal.log_density(&seen.centre) + width;
    assert!((log_evidence - exact).abs() < 1e-10, "{log_evidence} against {exact}");
}

fn long_run_means(problem: &problem28::Problem, hmc: &Hmc) {
    let reference = problem28::long_run();
    let schedule = Schedule { updates: 1500, burn_in: 100 };
    let starts = bulk28(problem, 2);
    let target = problem.target(Isa::best());
    let draws =
        draw_trajectories(&target, hmc, &starts, 16, schedule, &Stage::new(28, "long run")).expect("finite start");
    for j in 0..28 {
        let series = draws.series(j);
        let n = draws.stats.len() as f64;
        let mean = series.iter().flatten().sum::<f64>() / n;
        let error = reference.sd[j] / effective_sample_size(&series).sqrt();
        let z = (mean - reference.mean[j]) / error.hypot(reference.mcse[j]);
        assert!(z.abs() < 4.5, "coordinate {j}: {mean} against {}, z = {z}, bound 4.5, seed 28", reference.mean[j]);
    }
}

/// A leg that moves by half a radian leaves its keypoints a hundred noises behind, where a robust density is flat: only the broadened one leads there.
#[test]
fn the_mode_of_a_fast_limb_is_found() {
    let tree = h32(&Proportions::default());
    let plan = Arc::new(Plan::with_all_points(&tree));
    let isa = Isa::best();
    let mut before = vec![0.0; tree.dof()];
    before[2] = 1.0;
    let knees: Vec<usize> = (0..tree.dof()).filter(|&j| moves_only(&tree, &plan, j, "RAnkle", "RKnee")).collect();
    assert!(!knees.is_empty());
    let mut after = before.clone();
    for &j in &knees {
        after[j] -= 0.5;
    }
    let positions = |q: &[f64]| {
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(&plan, isa, q, &mut out);
        out
    };
    let (seen, predicted) = (positions(&after), positions(&before));
    let views: Vec<View> = [[3.0, 3.0, 1.5], [-3.0, 3.0, 1.0], [-3.0, -3.0, 1.5], [3.0, -3.0, 2.0]]
        .map(|centre| View {
            camera: Camera::look_at("c", [1000.0, 1000.0], 900.0, centre, [0.0, 0.0, 1.0]).expect("not straight down"),
            bias_px: vec![],
            sigma_px: 1.5,
            usual_confidence: 1.0,
        })
        .to_vec();
    let detect = |view: &View| {
        let pixel = |p: &[f64]| view.camera.project([p[0], p[1], p[2]]).pixel();
        seen.chunks(3).map(|p| Some(Detection::new(pixel(p)?, 1.0))).collect::<Vec<_>>()
    };
    let detections: Vec<_> = views.iter().map(detect).collect();
    let noise = Noise::OutlierFloor { outlier: 0.02 };
    let model = KeypointModel {
        plan: Arc::clone(&plan),
        views,
        noise,
        model_error_m: 0.003,
        least_confidence: 0.0,
        mistakes: Mistakes::default(),
        isa,
    };
    let observed = model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &predicted });
    let covariance: Vec<f64> = (0..32 * 32).map(|e| if e / 32 == e % 32 { 0.25 * 0.25 } else { 0.0 }).collect();
    let prior = Prior::Gaussian(Lanes { leaf: Gaussian::new(before, &covariance).expect("valid"), isa });
    let mode = laplace(&observed, &prior, 64, isa, Stage::new(1, "fast")).expect("positive definite").mode;
    let found = positions(&mode);
    let ankle = tree.point_index("RAnkle").expect("has an ankle");
    let distance: f64 = (0..3).map(|a| (found[3 * ankle + a] - seen[3 * ankle + a]).powi(2)).sum::<f64>().sqrt();
    assert!(distance < 0.01, "{distance} m");
}

/// Whether a degree of freedom moves one point and leaves the other.
fn moves_only(tree: &KinematicTree, plan: &Plan, j: usize, moved: &str, left: &str) -> bool {
    let at = |q: &[f64], name: &str| {
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(plan, Isa::best(), q, &mut out);
        let k = tree.point_index(name).expect("known point");
        [out[3 * k], out[3 * k + 1], out[3 * k + 2]]
    };
    let zero = vec![0.0; tree.dof()];
    let mut turned = zero.clone();
    turned[j] = 0.3;
    at(&turned, left) == at(&zero, left) && at(&turned, moved) != at(&zero, moved)
}
