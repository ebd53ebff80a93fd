//! Long runs: does a kernel reach its target, and how much are its draws worth.
//!
//! Invariance alone is cheap: the kernel that never moves has it. [`long_run`] starts anywhere, leaves out a burn-in and compares means of test functions with their exact values, with errors from the effective number
//! of draws. [`mixing`] reports autocorrelation times and R̂ of the same runs, for targets without exact values.

use crate::TestFunctions;
use crate::detectable::{Estimate, one_sigma};
use crate::p_values::{normal_p, share_p};
use crate::report::{Bound, Report, Statistic};
use crate::sequential::{About, Control, Measured, run};
use sinew_core::diagnostics::{effective_sample_size, rank_r_hat, split_r_hat};
use sinew_core::random::{BlockRng, Stage};

/// Sizes of the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongRun {
    /// Steps left out at the beginning.
    pub burn_in: usize,
    /// Steps kept in each chain, of the first stage.
    pub draws: usize,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for LongRun {
    fn default() -> Self {
        Self { burn_in: 500, draws: 5000, seed: 1, control: Control::default() }
    }
}

/// Series of each test function: one a chain.
fn series(
    config: &LongRun,
    draws: usize,
    stage: &Stage,
    starts: &[Vec<f64>],
    transition: &mut impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
) -> Vec<Vec<Vec<f64>>> {
    assert!(draws > 0 && !starts.is_empty(), "at least one chain and one draw");
    functions.assert_some();
    let mut all = vec![vec![Vec::with_capacity(draws); starts.len()]; functions.names().len()];
    for (chain, start) in starts.iter().enumerate() {
        let mut rng = stage.block(chain as u32);
        let mut state = start.clone();
        for step in 0..config.burn_in + draws {
            state = transition(&state, &mut rng);
            if step >= config.burn_in {
                all.iter_mut().zip(functions.at(&state)).for_each(|(series, value)| series[chain].push(value));
            }
        }
    }
    all
}

/// Fewer effective draws than this cannot be judged, and fail: run longer, or mend the kernel.
const LEAST_EFFECTIVE: f64 = 100.0;

/// Compares long-run means of the test functions with `expected`, their exact values under the target, in the same order.
///
/// A function whose values are 0 and 1 is judged by the binomial law of its effective draws, so that rare events raise no false alarms. The errors rest on Geyer's estimate of the autocorrelation time: give the chains hundreds of times that length, or the rate of false alarms is larger than stated. Fewer than a hundred effective draws fail: they prove nothing.
///
/// # Panics
/// When `expected` has another length than the test functions, and without a chain, a draw and a test function.
pub fn long_run(
    config: &LongRun,
    starts: &[Vec<f64>],
    mut transition: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
    expected: &[f64],
) -> Report {
    assert_eq!(expected.len(), functions.names().len(), "one expected value for each test function");
    let stages = Stage::new(config.seed, "long run");
    let measured = |draws| format!("means over {} chains of {draws} steps after {}", starts.len(), config.burn_in);
    let about = About {
        test: "long run",
        would_show: "the kernel does not reach its target, or keeps another: parts of the state or modes that are never visited, a small bias that adds up",
        seed: config.seed,
        measured: &measured,
    };
    let mut worth = vec![];
    let mut report = run(&config.control, &about, config.draws, |draws, stage| {
        worth.clear();
        let all = series(config, draws, &stages.round(stage), starts, &mut transition, functions);
        let effective: Vec<f64> = all.iter().map(|chains| effective_sample_size(chains)).collect();
        let estimates: Vec<Estimate> = all.iter().zip(&effective).map(|(chains, &n)| estimate(chains, n)).collect();
        let sizes = one_sigma(functions, &estimates);
        worth.extend(functions.names().iter().zip(effective.iter()).map(|(name, &value)| Statistic {
            name: format!("effective draws of {name}"),
            value,
            bound: Bound::Range { least: LEAST_EFFECTIVE, most: f64::INFINITY },
        }));
        let found = functions.names().iter().zip(&all).zip(expected).zip(estimates.iter().zip(effective).zip(sizes));
        let found = found.map(|(((name, chains), &expected), ((of, effective), size))| {
            // Chains that never move have no error; the number of effective draws fails then.
            let z = if of.variance > 0.0 { (of.mean - expected) / of.error } else { 0.0 };
            let indicator = of.variance > 0.0 && chains.iter().flatten().all(|&x| x == 0.0 || x == 1.0);
            let p = if indicator { share_p(of.mean, effective, expected) } else { normal_p(z) };
            Measured { name: format!("mean of {name}"), value: z, p, one_sigma: size.map(|size| (name.clone(), size)) }
        });
        found.collect()
    });
    report.statistics.extend(worth);
    report
}

fn estimate(chains: &[Vec<f64>], effective: f64) -> Estimate {
    let n = chains.iter().map(Vec::len).sum::<usize>() as f64;
    let mean = chains.iter().flatten().sum::<f64>() / n;
    let variance = chains.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
    Estimate { mean, variance, error: (variance / effective.max(1.0)).sqrt() }
}

/// Autocorrelation time and R̂ of a set of runs.
///
/// The report holds when split R̂ and rank-normalised R̂ of every test function are at most `r_hat`, 1.01 for instance, and every autocorrelation time is at most `time` steps. The bounds are yours: no rate of false alarms belongs to them.
///
/// # Panics
/// Without a chain, a draw and a test function.
pub fn mixing(
    config: &LongRun,
    starts: &[Vec<f64>],
    mut transition: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
    r_hat: f64,
    time: f64,
) -> Report {
    let stage = Stage::new(config.seed, "mixing");
    let all = series(config, config.draws, &stage, starts, &mut transition, functions);
    let at_most = |name: String, value: f64, most: f64| Statistic {
        name,
        value,
        bound: Bound::Range { least: f64::NEG_INFINITY, most },
    };
    let found = functions.names().iter().zip(all).flat_map(|(name, chains)| {
        let time_found = (config.draws * starts.len()) as f64 / effective_sample_size(&chains);
        [
            at_most(format!("split R̂ of {name}"), split_r_hat(&chains), r_hat),
            at_most(format!("rank-normalised R̂ of {name}"), rank_r_hat(&chains), r_hat),
            at_most(format!("autocorrelation time of {name}"), time_found, time),
        ]
    });
    Report {
        seed: Some(config.seed),
        ..Report::exact(
            "mixing",
            format!("{} chains of {} steps after {}", starts.len(), config.draws, config.burn_in),
            "chains that do not agree or hardly move: too small a step, a mode that is not left, a coordinate that is never updated",
            found.collect(),
        )
    }
}
