//! Two samples: fresh draws against draws that the kernel has moved (Gandy & Scott 2020, algorithm 1).
//!
//! For every test function h the distribution functions of h(x), x ~ π, and of h(x′), x′ = k steps from another draw, are compared by Kolmogorov and Smirnov's distance. It sees changes of shape that leave means and
//! medians alone; where those change, [`crate::exact_start`] needs fewer draws, since its pairs cancel noise.

use crate::detectable::Wrong;
use crate::exact_start::Moved;
use crate::p_values::two_samples;
use crate::sequential::{About, Measured, run};
use crate::{ExactStart, Report, TestFunctions};
use sinew_core::random::{BlockRng, Stage};

const SHOWS: &str = "the kernel changes the shape of its target: a mode lost or visited too often, tails cut, an edge that holds too much or too little";

/// Tests `transition` against exact draws of its target. Both samples have `config.starts` draws.
///
/// # Panics
/// Without two starts, a step and a test function.
pub fn two_sample(
    config: &ExactStart,
    mut draw: impl FnMut(&mut BlockRng) -> Vec<f64>,
    mut transition: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
) -> Report {
    let stages = Stage::new(config.seed, "two samples");
    let steps = config.steps;
    assert!(config.starts > 1 && steps > 0, "at least two starts and one step");
    functions.assert_some();
    let measured = |draws| format!("{draws} draws from the target beside {draws} that were moved by {steps} step(s)");
    let about = About { test: "two samples", would_show: SHOWS, seed: config.seed, measured: &measured };
    let mut share = Moved::default();
    let mut report = run(&config.control, &about, config.starts, |starts, stage| {
        let mut rng = stages.round(stage).whole();
        let mut columns = vec![(Vec::with_capacity(starts), Vec::with_capacity(starts)); functions.names().len()];
        for _ in 0..starts {
            let fresh = functions.at(&draw(&mut rng));
            let start = draw(&mut rng);
            let mut moved = start.clone();
            for _ in 0..steps {
                moved = transition(&moved, &mut rng);
            }
            share.add(moved != start);
            for ((column, fresh), moved) in columns.iter_mut().zip(fresh).zip(functions.at(&moved)) {
                column.0.push(fresh);
                column.1.push(moved);
            }
        }
        let found = functions.names().iter().zip(&mut columns).map(|(name, (fresh, moved))| {
            let (value, p) = two_samples(fresh, moved);
            let one_sigma = Some((name.clone(), (Wrong::Distribution, (2.0 / starts as f64).sqrt())));
            Measured { name: format!("distance of {name}"), value, p, one_sigma }
        });
        found.collect()
    });
    report.statistics.push(share.statistic(config.least_moved));
    report
}
