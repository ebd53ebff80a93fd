//! EM for Gaussian mixtures: rising likelihood, recovery, agreement with scikit-learn, threads.

use serde_json::Value;
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_dynamics::Error;
use sinew_dynamics::mixture_em::{Component, Config, LearnedMixture, run, start};

/// Points of three separated Gaussians in three dimensions with the standard deviations 1, 2, 0.5, in turn.
const CENTRES: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [15.0, -10.0, 5.0], [-12.0, 20.0, -8.0]];
const SD: [f64; 3] = [1.0, 2.0, 0.5];

fn separated(count: usize) -> Vec<f64> {
    let mut noise = vec![Block::ZERO; (count * 3).div_ceil(8)];
    Stage::new(3, "separated").whole().fill_normal(Isa::baseline(), &mut noise);
    let noise = noise.iter().flat_map(|block| block.0).take(count * 3);
    noise.enumerate().map(|(i, z)| CENTRES[i / 3 % 3][i % 3] + SD[i / 3 % 3] * z).collect()
}

fn learned(rows: &[f64], dim: usize, config: &Config, seed: u64) -> LearnedMixture {
    let start = start(rows, dim, config, Stage::new(seed, "em")).expect("valid");
    run(rows, dim, start, config, &mut |_| {}).expect("valid")
}

/// Expectation–maximisation finds separated Gaussians (M1): the three means, each within 5 standard errors in each coordinate.
#[test]
fn separated_gaussians_are_recovered() {
    let count = 3000;
    let rows = separated(count);
    let found = learned(&rows, 3, &Config { components: 3, ..Config::default() }, 4);
    assert!(found.converged);
    let each = count as f64 / 3.0;
    for (group, centre) in CENTRES.iter().enumerate() {
        let k = found.nearest[group];
        let component = &found.components[k];
        assert!((group..count).step_by(3).all(|n| found.nearest[n] == k));
        assert!((component.weight - 1.0 / 3.0).abs() < 1e-6);
        for (mean, centre) in component.mean.iter().zip(centre) {
            let z = (mean - centre) / (SD[group] / each.sqrt());
            assert!(z.abs() < 5.0, "group {group}: z = {z}, bound 5, seed 3");
        }
        for (k, entry) in component.covariance.iter().enumerate() {
            let exact = if k % 4 == 0 { SD[group].powi(2) } else { 0.0 };
            let z = (entry - exact) / (SD[group].powi(2) * (f64::from(1 + u8::from(k % 4 == 0)) / each).sqrt());
            assert!(z.abs() < 5.0, "group {group}: covariance {entry} for {exact}, z = {z}");
        }
    }
}

/// Expectation–maximisation climbs (M1): the log likelihood never falls by more than 1e-9 of itself, but where a component was seeded again or removed the iteration before. Few points for many components, so that these do happen.
#[test]
fn the_log_likelihood_never_falls_but_after_a_new_seed() {
    for (ridge, components, count) in [(0.0, 3, 600), (0.0, 12, 600), (1e-6, 12, 600), (1e-6, 40, 300)] {
        let config = Config { components, ridge, tolerance: 0.0, ..Config::default() };
        let found = learned(&separated(count), 3, &config, 5);
        let mut rises = 0;
        for pair in found.iterations.windows(2) {
            if pair[0].reseeded + pair[0].removed == 0 {
                let [before, after] = [pair[0].log_likelihood, pair[1].log_likelihood];
                assert!(after >= before - 1e-9 * before.abs(), "{components}, {ridge}: {before} falls to {after}");
                rises += 1;
            }
        }
        assert!(rises > 5, "{components}, {ridge}: {rises} iterations compared");
        let seeds: usize = found.iterations.iter().map(|iteration| iteration.reseeded).sum();
        assert!(components != 40 || seeds > 0, "no component starved among 40 for {count} points");
    }
}

/// Whatever starves is seeded again ten times at most and then removed, down to what the points can carry.
#[test]
fn starving_components_are_seeded_again_and_then_removed() {
    let rows = separated(30);
    let found = learned(&rows, 3, &Config { components: 20, ..Config::default() }, 6);
    let sum = |count: fn(&sinew_dynamics::mixture_em::Iteration) -> usize| found.iterations.iter().map(count).sum();
    let (reseeded, removed): (usize, usize) = (sum(|i| i.reseeded), sum(|i| i.removed));
    assert!(reseeded <= 200 && removed > 0, "{reseeded} seeded again, {removed} removed");
    assert_eq!(found.components.len() + removed, 20);
    assert!((1..=7).contains(&found.components.len()), "30 points carry seven components of four at most");
    assert!((found.components.iter().map(|c| c.weight).sum::<f64>() - 1.0).abs() < 1e-12);
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        entry => vec![entry.as_f64().expect("a number")],
    }
}

fn near(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() < 1e-8 * e.abs().max(1.0), "{what}: {f} for {e}");
    }
}

/// `data/gaussian_mixture.py` made the numbers; the ridge is the same number for both.
#[test]
fn scikit_learn_finds_the_same_from_the_same_start() {
    let file: Value = serde_json::from_str(include_str!("data/gaussian_mixture.json")).expect("JSON");
    let each = |at: &Value, name: &str| -> Vec<Vec<f64>> {
        at[name].as_array().expect("a list").iter().map(numbers).collect()
    };
    let from = &file["start"];
    let parts = each(from, "weights").into_iter().zip(each(from, "means")).zip(each(from, "covariances"));
    let start = parts.map(|((w, mean), covariance)| Component { weight: w[0], mean, covariance }).collect();
    let iterations = file["iterations"].as_u64().expect("a number") as usize;
    let config = Config { components: 3, max_iterations: iterations, tolerance: 0.0, ..Config::default() };
    assert_eq!(file["ridge"].as_f64(), Some(config.ridge));
    let found = run(&numbers(&file["points"]), 3, start, &config, &mut |_| {}).expect("valid");
    assert_eq!(found.iterations.len(), iterations + 1);
    for (k, component) in found.components.iter().enumerate() {
        near("weight", &[component.weight], &each(&file, "weights")[k]);
        near("mean", &component.mean, &each(&file, "means")[k]);
        near("covariance", &component.covariance, &each(&file, "covariances")[k]);
    }
    let last = found.iterations.last().expect("iterations").log_likelihood;
    near("log likelihood", &[last], &numbers(&file["log_likelihood"]));
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let rows = separated(400);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| learned(&rows, 3, &Config { components: 10, ..Config::default() }, 7))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
    assert_ne!(one, learned(&rows, 3, &Config { components: 10, ..Config::default() }, 8));
}

#[test]
fn equal_points_give_no_more_components_than_there_are_places() {
    let rows: Vec<f64> = [1.0, 2.0, 5.0].into_iter().cycle().take(60).collect();
    let config = Config { components: 8, ..Config::default() };
    assert_eq!(start(&rows, 1, &config, Stage::new(1, "equal")).expect("valid").len(), 3);
}

#[test]
fn rows_and_starts_that_do_not_fit_are_refused() {
    let config = Config { components: 2, ..Config::default() };
    let from = |rows: &[f64], config: &Config| start(rows, 2, config, Stage::new(1, "bad"));
    assert!(matches!(from(&[1.0; 4], &config), Err(Error::Shape { found: 2, expected: 3, .. })));
    assert!(from(&[1.0; 9], &config).is_err() && from(&[f64::NAN; 8], &config).is_err());
    let rows = [1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 1.0];
    assert!(from(&rows, &Config { components: 0, ..config }).is_err());
    assert!(from(&rows, &Config { ridge: -1.0, ..config }).is_err());
    let component = || Component { weight: 1.0, mean: vec![0.0; 2], covariance: vec![1.0, 0.0, 0.0, 1.0] };
    let ends = |start| run(&rows, 2, start, &config, &mut |_| {});
    assert!(ends(vec![]).is_err() && ends(vec![Component { weight: 0.0, ..component() }]).is_err());
    assert!(ends(vec![Component { mean: vec![0.0], ..component() }]).is_err());
    assert!(ends(vec![Component { covariance: vec![1.0, 2.0, 2.0, 1.0], ..component() }]).is_err());
}
