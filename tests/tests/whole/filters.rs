//! Trackers and the backward pass against exact filters (E4b, E5, the smoother, and the bootstrap filter's evidence).

use sinew::core::diagnostics::effective_sample_size;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::Stage;
use sinew::dynamics::smoother::Smoother;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::{Config, HmcFilter};
use sinew::tracking::{Inferred, StepInfo, Tracker};
use sinew_tests::linear_series::{Series, deviations};

fn hmc(series: &Series, config: Config) -> HmcFilter<sinew::dynamics::linear_gaussian::LinearGaussian> {
    HmcFilter::new(config, series.model(), series.m0.clone(), Isa::best()).expect("valid")
}

/// 16 chains with 29 kept draws each. The start is one of 16 prior draws, so the burn-in is that of a real frame and not the paper's 6.
fn short_chains() -> Config {
    Config {
        chains: 16,
        updates: 48,
        burn_in: 20,
        step_size: 0.5,
        leapfrog_steps: 12,
        jitter: 0.2,
        curvature_draws: 16,
        ..Config::default()
    }
}

/// The HMC filter in one frame, with a Gaussian prior (E5). 4 means and 10 covariances at |z| < 4.5: false alarm 1e-4.
#[test]
fn one_frame_of_the_hmc_filter_has_the_exact_posterior() {
    let series = Series::simulated(4, 1, &Stage::new(5, "E5 data"));
    let exact = series.kalman().remove(0).filtered;
    let mut filter = hmc(&series, Config { updates: 3000, ..short_chains() });
    let info = filter.step(&series.sight(0), Stage::new(5, "E5")).expect("posterior");
    assert!(info.r_hat.is_some_and(|r| r < 1.01) && info.divergences == 0, "{info:?}");
    let posterior = filter.posterior();
    let mut states = vec![vec![0.0; 4]; posterior.count()];
    states.iter_mut().enumerate().for_each(|(i, s)| posterior.state(i, s));
    let check = |name: String, exact: f64, value: &dyn Fn(&[f64]) -> f64| {
        let chains: Vec<Vec<f64>> =
            (0..16).map(|i| states[i..].iter().step_by(16).map(|s| value(s)).collect()).collect();
        let n = states.len() as f64;
        let mean = chains.iter().flatten().sum::<f64>() / n;
        let variance = chains.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
        let z = (mean - exact) / (variance / effective_sample_size(&chains)).sqrt();
        assert!(z.abs() < 4.5, "{name}: {mean} against {exact}, z = {z}, bound 4.5, seed 5");
    };
    for i in 0..4 {
        check(format!("mean {i}"), exact.mean[i], &|s| s[i]);
        for j in 0..=i {
            check(format!("covariance {i}, {j}"), exact.covariance[i * 4 + j], &|s| {
                (s[i] - exact.mean[i]) * (s[j] - exact.mean[j])
            });
        }
    }
}

/// E4b, first half: 40 runs on each stored series; means and variances (the exact one and the squared error of the mean) of five frames. 120 statistics at |z| < 4.5.
#[test]
fn the_hmc_filter_with_a_gaussian_prior_agrees_with_kalman() {
    for name in ["lgssm_d2.json", "lgssm_d10.json"] {
        let Some(series) = Series::stored(name) else { return };
        let exact = series.kalman();
        let (runs, frames) = (40, [0, 9, 24, 39, 49]);
        let mut errors = vec![vec![]; frames.len() * series.dim * 2];
        for run in 0..runs {
            let mut filter = hmc(&series, short_chains());
            let mut slot = 0;
            for (frame, exact) in exact.iter().map(|frame| &frame.filtered).enumerate() {
                let stage = Stage::new(run, "E4b").at_frame(frame as u32);
                let info = filter.step(&series.sight(frame), stage).expect("posterior");
                if !frames.contains(&frame) {
                    continue;
                }
                let got = filter.posterior().moments(Isa::best());
                for (j, sd) in deviations(exact).iter().enumerate() {
                    let error = (info.mean[j] - exact.mean[j]) / sd;
                    errors[slot].push(error);
                    // The variance holds the error of the mean, which few draws leave.
                    errors[slot + 1].push(got.covariance[j * (series.dim + 1)] / (sd * sd) - 1.0 - error * error);
                    slot += 2;
                }
            }
        }
        let n = runs as f64;
        for (k, errors) in errors.iter().enumerate() {
            let mean = errors.iter().sum::<f64>() / n;
            let variance = errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / (n - 1.0);
            let z = mean / (variance / n).sqrt();
            let what = if k % 2 == 0 { "mean" } else { "variance" };
            let (frame, coordinate) = (frames[k / 2 / series.dim], k / 2 % series.dim);
            assert!(
                z.abs() < 4.5,
                "{name}, frame {frame}, coordinate {coordinate}: relative error of the {what} {mean}, z = {z}, bound 4.5"
            );
        }
    }
}

/// E4b, second half: 90 % intervals over 200 simulated series.
#[test]
fn intervals_of_the_hmc_filter_cover_what_they_say() {
    for (dim, frames) in [(2, 20), (10, 10)] {
        let (mut covered, mut total) = (0, 0);
        for run in 0..200 {
            let series = Series::simulated(dim, frames, &Stage::new(run, "coverage data"));
            let mut filter = hmc(&series, short_chains());
            for frame in 0..frames {
                let stage = Stage::new(run, "coverage").at_frame(frame as u32);
                filter.step(&series.sight(frame), stage).expect("posterior");
                let posterior = filter.posterior();
                for j in 0..dim {
                    let mut values: Vec<f64> =
                        (0..posterior.count()).map(|i| posterior.states[i / 8 * dim + j].0[i % 8]).collect();
                    values.sort_by(f64::total_cmp);
                    let at = |p: f64| values[(p * values.len() as f64) as usize];
                    total += 1;
                    covered += usize::from((at(0.05)..=at(0.95)).contains(&series.truth[frame][j]));
                }
            }
        }
        let coverage = covered as f64 / total as f64;
        assert!((0.88..=0.92).contains(&coverage), "d = {dim}: {coverage}, bounds 0.88 and 0.92, seeds 0 to 199");
    }
}

/// Trajectories drawn backwards have the smoothed moments. 20 × 2 statistics at |z| < 4.5.
#[test]
fn sampled_trajectories_have_the_smoothed_moments() {
    let (dim, frames, blocks) = (4, 5, 4000);
    let series = Series::simulated(dim, frames, &Stage::new(11, "trajectories data"));
    let filtered: Vec<_> = series.kalman().into_iter().map(|frame| frame.filtered).collect();
    let smoother = Smoother::new(dim, series.a.clone(), series.q.clone()).expect("square");
    let mut rng = Stage::new(11, "trajectories").whole();
    let isa = Isa::best();
    let mut states = vec![Block::ZERO; blocks * dim];
    let mut now = filtered[frames - 1].clone();
    smoother.sample_last(&now, &mut states, isa, &mut rng).expect("semi-definite");
    for frame in (0..frames).rev() {
        if frame + 1 < frames {
            now = smoother.step(&filtered[frame], &now).expect("positive definite");
            smoother.sample(&filtered[frame], &mut states, isa, &mut rng).expect("positive definite");
        }
        for j in 0..dim {
            let values: Vec<f64> = states[j..].iter().step_by(dim).flat_map(|b| b.0).collect();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
            let exact = now.covariance[j * (dim + 1)];
            let z = [(mean - now.mean[j]) / (exact / n).sqrt(), (variance / exact - 1.0) / (2.0 / n).sqrt()];
            assert!(z.iter().all(|z| z.abs() < 4.5), "frame {frame}, coordinate {j}: z = {z:?}, bound 4.5, seed 11");
        }
    }
}

fn bootstrap_run(series: &Series, particles: usize, seed: u64) -> Vec<StepInfo> {
    let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
    let mut filter = Bootstrap::new(config, series.model(), series.m0.clone()).expect("valid");
    (0..series.z.len())
        .map(|frame| {
            let stage = Stage::new(seed, "bootstrap").at_frame(frame as u32);
            filter.step(&series.sight(frame), stage).expect("weights")
        })
        .collect()
}

/// Twenty seeds of 4000 particles: each log Z within 0.75 (5 standard deviations), pooled error at most 0.06 (measured elsewhere: 0.035).
#[test]
fn the_bootstrap_filter_agrees_with_kalman() {
    let Some(series) = Series::stored("lgssm_d2.json") else { return };
    let exact = series.kalman();
    let log_z: f64 = exact.iter().map(|e| e.log_likelihood).sum();
    let (mut square, mut count) = (0.0, 0.0);
    for seed in 0..20 {
        let run = bootstrap_run(&series, 4000, seed);
        let error = run.iter().filter_map(|i| i.log_evidence).sum::<f64>() - log_z;
        assert!(error.abs() < 0.75, "seed {seed}: log Z off by {error}, bound 0.75");
        for (info, exact) in run.iter().zip(exact.iter().map(|frame| &frame.filtered)) {
            for (j, sd) in deviations(exact).iter().enumerate() {
                square += ((info.mean[j] - exact.mean[j]) / sd).powi(2);
                count += 1.0;
            }
        }
    }
    let error = f64::sqrt(square / count);
    assert!(error < 0.06, "{error} posterior standard deviations, bound 0.06");
}

/// 200 seeds of 250 particles: the mean of Ẑ / Z within 5 standard errors of 1.
#[test]
fn the_evidence_of_the_bootstrap_filter_is_unbiased() {
    let Some(series) = Series::stored("lgssm_d2.json") else { return };
    let log_z: f64 = series.kalman().iter().map(|e| e.log_likelihood).sum();
    let ratios: Vec<f64> = (0..200)
        .map(|seed| {
            (bootstrap_run(&series, 250, seed).iter().filter_map(|i| i.log_evidence).sum::<f64>() - log_z).exp()
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / 200.0;
    let variance = ratios.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>() / 199.0;
    let z = (mean - 1.0) / (variance / 200.0).sqrt();
    assert!(z.abs() < 5.0, "mean {mean}, z = {z}, bound 5");
}
