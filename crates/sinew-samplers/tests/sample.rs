//! `sample` of every kernel: exact moments, the stored moments of eight schools, starts, threads, warm-up draws, and what a summary says of a run that failed.

use rayon::ThreadPoolBuilder;
use serde_json::Value;
use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use sinew_core::toy::Quadratic;
use sinew_samplers::diagnostics::{effective_sample_size, mcse_of_mean};
use sinew_samplers::summary::RunWarning;
use sinew_samplers::tempered_smc::NormalPrior;
use sinew_samplers::{Density, Error, Run, Starts, check_gradient, hmc, jumps, nuts, tempered_smc};
use std::path::PathBuf;

/// N(0, C) with C = L Lᵀ, correlated 0.9 and with deviations 1 and 10, and a third coordinate N(5, 0.01²).
struct Correlated;

impl Density for Correlated {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (u, v, w) = (x[0], x[1] / 10.0, (x[2] - 5.0) / 0.01);
        let (a, b) = ((u - 0.9 * v) / 0.19, (v - 0.9 * u) / 0.19);
        gradient.copy_from_slice(&[-a, -b / 10.0, -w / 0.01]);
        -0.5 * (u * a + v * b + w * w)
    }
    fn names(&self) -> Vec<String> {
        ["u", "v", "w"].map(String::from).into()
    }
}

/// The same three deviations without correlation, by lanes.
fn lanes() -> Lanes<Quadratic> {
    Lanes { leaf: Quadratic { centre: vec![0.0, 0.0, 5.0], precision: vec![1.0, 0.01, 1e4] }, isa: Isa::best() }
}

/// Mean and variance of one coordinate within 4.5 standard errors.
fn check_moments(what: &str, run: &Run, coordinate: usize, mean: f64, variance: f64) {
    let chains = run.series(coordinate);
    let squares: Vec<Vec<f64>> = chains.iter().map(|c| c.iter().map(|x| (x - mean).powi(2)).collect()).collect();
    for (name, series, exact) in [("mean", chains, mean), ("variance", squares, variance)] {
        let found = series.iter().flatten().sum::<f64>() / run.stats.len() as f64;
        let z = (found - exact) / mcse_of_mean(&series);
        assert!(z.abs() < 4.5, "{what}, coordinate {coordinate}: {name} {found} against {exact}, z = {z}");
    }
}

/// 18 statistics at |z| < 4.5: false alarm 1e-4.
#[test]
fn every_kernel_draws_a_gaussian() {
    let nuts = nuts::sample(&Correlated, nuts::Settings { seed: 1, ..Default::default() }).expect("samples");
    let hmc = hmc::sample(&Correlated, hmc::Settings { seed: 2, ..Default::default() }).expect("samples");
    let by_lanes =
        nuts::sample(&lanes(), nuts::Settings { seed: 3, chains: 10, ..Default::default() }).expect("samples");
    for (what, run) in [("nuts", &nuts), ("hmc", &hmc), ("nuts by lanes", &by_lanes)] {
        let summary = run.summary();
        assert!(summary.holds(), "{what}: {summary}");
        for (j, (mean, variance)) in [(0.0, 1.0), (0.0, 100.0), (5.0, 1e-4)].into_iter().enumerate() {
            check_moments(what, run, j, mean, variance);
        }
        let ess = effective_sample_size(&run.series(1));
        assert!(ess > 0.25 * run.stats.len() as f64, "{what}: {ess} of {}", run.stats.len());
    }
    assert_eq!((nuts.chains, nuts.draws(), by_lanes.chains), (4, 1000, 10));
    assert_eq!((nuts.names[2].as_str(), by_lanes.names[2].as_str()), ("w", "x[2]"));
    let products = nuts.map(["uv"], |x, out| out[0] = x[0] * x[1]);
    let z = (products.summary().rows[0].mean - 9.0) / products.summary().rows[0].mcse;
    assert!(z.abs() < 4.5, "covariance: z = {z}");
}

/// 0.3 N(−8, 1) + 0.7 N(8, 1), twice: no trajectory crosses, and jumps know the weights.
struct Apart;

impl Density for Apart {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let [a, b] = [(0.3_f64, -8.0), (0.7, 8.0)].map(|(w, m)| w.ln() - 0.5 * (x[0] - m) * (x[0] - m));
        let sum = a.max(b) + (-(a - b).abs()).exp().ln_1p();
        gradient[0] = -(a - sum).exp() * (x[0] + 8.0) - (b - sum).exp() * (x[0] - 8.0);
        gradient[1] = -x[1];
        sum - 0.5 * x[1] * x[1]
    }
}

/// 4 statistics at |z| < 4.5. Without jumps the summary says that chains disagree.
#[test]
fn jumps_weigh_modes_that_trajectories_do_not_join() {
    let starts = || Starts::Uniform(10.0);
    let alone =
        nuts::sample(&Apart, nuts::Settings { seed: 4, starts: starts(), ..Default::default() }).expect("samples");
    let warnings = alone.summary().warnings;
    assert!(warnings.iter().any(|w| matches!(w, RunWarning::RHat { value, .. } if *value > 1.5)), "{warnings:?}");
    let run =
        jumps::sample(&Apart, jumps::Settings { seed: 5, starts: starts(), ..Default::default() }).expect("samples");
    assert!(run.summary().holds(), "{}", run.summary());
    check_moments("jumps", &run, 0, 3.2, 1.0 + 64.0 - 3.2 * 3.2);
    check_moments("jumps", &run, 1, 0.0, 1.0);
}

/// Eight schools of posteriordb: θ̃_1 … θ̃_8, μ, ln τ.
struct Schools {
    y: Vec<f64>,
    sigma: Vec<f64>,
}

impl Density for Schools {
    fn dim(&self) -> usize {
        10
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (mu, tau) = (x[8], x[9].exp());
        let mut value = -mu * mu / 50.0 - (tau * tau / 25.0).ln_1p() + x[9];
        (gradient[8], gradient[9]) = (-mu / 25.0, 1.0 - 2.0 * tau * tau / (25.0 + tau * tau));
        for j in 0..8 {
            let error = (self.y[j] - mu - tau * x[j]) / self.sigma[j];
            value -= 0.5 * (x[j] * x[j] + error * error);
            gradient[j] = tau * error / self.sigma[j] - x[j];
            gradient[8] += error / self.sigma[j];
            gradient[9] += tau * x[j] * error / self.sigma[j];
        }
        value
    }
}

/// The stored file; `None`, with a word, where it is absent.
fn stored(name: &str) -> Option<Value> {
    let folder = std::env::var_os("SINEW_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let Ok(text) = std::fs::read_to_string(folder.join(name)) else {
        assert!(std::env::var_os("SINEW_REQUIRE_DATA").is_none(), "{name} is missing in {}", folder.display());
        eprintln!("skipped: no {name} in {}", folder.display());
        return None;
    };
    Some(serde_json::from_str(&text).expect("JSON"))
}

/// 20 statistics a kernel within 4 √(mcse² + mcse²) of the reference: false alarm 3e-3, with one fixed seed.
#[test]
fn eight_schools_have_the_stored_moments() {
    let Some(file) = stored("posteriordb/eight_schools-eight_schools_noncentered.json") else { return };
    let numbers = |v: &Value| v.as_array().expect("array").iter().map(|x| x.as_f64().expect("number")).collect();
    let schools = Schools { y: numbers(&file["data"]["y"]), sigma: numbers(&file["data"]["sigma"]) };
    for point in file["checkpoints"].as_array().expect("array") {
        let (u, mut gradient): (Vec<f64>, _) = (numbers(&point["u"]), vec![0.0; 10]);
        assert!((schools.log_density(&u, &mut gradient) - point["lp"].as_f64().expect("number")).abs() < 1e-6);
        check_gradient(&schools, &u).expect("the gradient of the density");
    }
    let names = (1..=8).map(|j| format!("theta[{j}]")).chain(["mu".into(), "tau".into()]);
    let names: Vec<String> = names.collect();
    let trees = nuts::Settings { draws: 2000, seed: 42, acceptance: 0.95, ..Default::default() };
    let lengths = hmc::Settings { draws: 4000, seed: 42, acceptance: 0.95, ..Default::default() };
    let runs = [("nuts", nuts::sample(&schools, trees)), ("hmc", hmc::sample(&schools, lengths))];
    for (what, run) in runs {
        let run = run.expect("samples").map(names.clone(), |u, theta| {
            let (mu, tau) = (u[8], u[9].exp());
            (0..8).for_each(|j| theta[j] = mu + tau * u[j]);
            (theta[8], theta[9]) = (mu, tau);
        });
        let summary = run.summary();
        assert!(summary.divergences <= 5 && summary.rows.iter().all(|row| row.r_hat < 1.01), "{what}: {summary}");
        for (j, row) in summary.rows.iter().enumerate() {
            let reference = |key: &str| file["reference"][&row.name][key].as_f64().expect("number");
            let squares: Vec<Vec<f64>> =
                run.series(j).iter().map(|c| c.iter().map(|x| (x - row.mean).powi(2)).collect()).collect();
            let sd_error = mcse_of_mean(&squares) / (2.0 * row.sd);
            for (name, found, error, exact, mcse) in [
                ("mean", row.mean, row.mcse, reference("mean"), reference("mcse_mean")),
                ("sd", row.sd, sd_error, reference("sd"), reference("mcse_sd")),
            ] {
                let z = (found - exact) / error.hypot(mcse);
                assert!(z.abs() < 4.0, "{what}, {name} of {}: {found} against {exact}, z = {z}", row.name);
            }
        }
    }
}

#[test]
fn draws_depend_on_the_seed_and_on_no_thread() {
    let on = |threads: usize, seed: u64| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let settings = nuts::Settings { seed, draws: 40, warm_up: 200, keep_warm_up: true, ..Default::default() };
            let trees = nuts::sample(&Correlated, settings.clone()).expect("samples");
            let lanes = nuts::sample(&lanes(), nuts::Settings { chains: 17, ..settings }).expect("samples");
            let settings = hmc::Settings { seed, draws: 40, warm_up: 200, ..Default::default() };
            let lengths = hmc::sample(&Correlated, settings).expect("samples");
            let settings = jumps::Settings { seed, draws: 40, warm_up: 200, fitting: 50, ..Default::default() };
            [trees, lanes, lengths, jumps::sample(&Correlated, settings).expect("samples")]
        })
    };
    let alone = on(1, 7);
    assert_eq!(format!("{alone:?}"), format!("{:?}", on(3, 7)));
    let other = on(1, 8);
    assert!(alone.iter().zip(&other).all(|(a, b)| a.states != b.states));
    let warm_up = alone[0].warm_up.as_ref().expect("kept");
    assert_eq!((warm_up.draws(), warm_up.chains, warm_up.dim()), (200, 4, 3));
    assert!(warm_up.series(0).concat().iter().any(|x| x.abs() > 0.0) && alone[2].warm_up.is_none());
}

/// Keeping the warm-up's draws changes no later draw.
#[test]
fn a_warm_up_is_the_same_whether_it_is_kept() {
    let run = |keep_warm_up| {
        let settings = nuts::Settings { seed: 9, draws: 30, warm_up: 200, keep_warm_up, ..Default::default() };
        nuts::sample(&Correlated, settings).expect("samples").states
    };
    assert_eq!(run(true), run(false));
}

/// N(0, I) in strips: no gradient says where they end, and every trajectory runs into a wall.
struct Strips;

impl Density for Strips {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.copy_from_slice(&[-x[0], -x[1]]);
        if (40.0 * x[0]).sin() > 0.0 { -0.5 * (x[0] * x[0] + x[1] * x[1]) } else { f64::NEG_INFINITY }
    }
}

#[test]
fn a_run_that_fails_says_so() {
    let starts = Starts::Given(vec![vec![0.04, 0.0]; 4]);
    let settings = nuts::Settings { seed: 1, draws: 200, warm_up: 200, starts, ..Default::default() };
    let summary = nuts::sample(&Strips, settings).expect("samples").summary();
    assert!(summary.divergences > 600 && !summary.holds(), "{summary}");
    assert!(summary.to_string().contains("of 800 trajectories diverged"), "{summary}");
}

#[test]
fn targets_that_cannot_be_sampled_are_refused() {
    let with = |settings: nuts::Settings| nuts::sample(&Correlated, settings).expect_err("refused");
    let good = || nuts::Settings { draws: 10, warm_up: 200, ..Default::default() };
    assert_eq!(with(nuts::Settings { chains: 0, ..good() }), Error::Empty { count: 0, dim: 3 });
    for (settings, what) in [
        (nuts::Settings { draws: 0, ..good() }, "number of draws"),
        (nuts::Settings { warm_up: 169, ..good() }, "number of warm-up transitions"),
        (nuts::Settings { acceptance: f64::NAN, ..good() }, "acceptance"),
        (nuts::Settings { max_depth: 0, ..good() }, "greatest depth"),
    ] {
        assert!(matches!(with(settings), Error::OutOfRange { name, .. } if name == what), "{what}");
    }
    let given = |starts: Vec<Vec<f64>>| with(nuts::Settings { starts: Starts::Given(starts), ..good() });
    assert!(matches!(given(vec![vec![0.0; 3]; 3]), Error::Length { found: 3, expected: 4, .. }));
    assert!(matches!(given(vec![vec![0.0; 2]; 4]), Error::Length { found: 2, expected: 3, .. }));
    assert!(matches!(given(vec![vec![f64::NAN; 3]; 4]), Error::BadStart { .. }));
}

/// ln L of the observation 1 ± 0.5 of the first coordinate.
struct Observed;

impl Density for Observed {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let error = (1.0 - x[0]) / 0.5;
        gradient.copy_from_slice(&[error / 0.5, 0.0]);
        -0.5 * error * error
    }
}

/// x | 1 is N(0.8, 0.2), y stays N(0, 1), and the evidence is N(1; 0, 1.25) √(2π) 0.5. 5 statistics at |z| < 4.5, and populations that agree.
#[test]
fn tempering_has_the_moments_and_the_evidence() {
    let prior = NormalPrior { mean: vec![0.0; 2], sd: vec![1.0; 2] };
    let settings = || tempered_smc::Settings { populations: 16, seed: 3, ..Default::default() };
    let run = tempered_smc::sample(&Observed, &prior, settings()).expect("samples");
    assert_eq!((run.chains, run.draws(), run.log_evidence.len()), (16, 1024, 16));
    check_moments("tempering", &run, 0, 0.8, 0.2);
    check_moments("tempering", &run, 1, 0.0, 1.0);
    let summary = run.summary();
    assert!(summary.rows.iter().all(|row| row.r_hat < 1.01) && summary.divergences == 0, "{summary}");
    let exact = -0.4 - 0.5 * 5.0_f64.ln();
    let (found, sd) = summary.log_evidence.expect("evidence");
    assert!((found - exact).abs() < 4.5 * sd / 4.0 && sd < 0.2, "{found} ± {sd} for {exact}");
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let alone = pool.install(|| tempered_smc::sample(&Observed, &prior, settings()).expect("samples"));
    assert_eq!(alone.states, run.states);
    let none = tempered_smc::sample(&Observed, &NormalPrior { mean: vec![0.0], sd: vec![1.0] }, settings());
    assert!(matches!(none, Err(Error::Length { found: 2, expected: 1, .. })));
}
