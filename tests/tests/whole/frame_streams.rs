//! Random numbers of a run belong to their frame.
//!
//! What is thinned and what is smoothed draws its own in each.

use sinew::config::settings::Settings;
use sinew::methods::{BootstrapMethod, HmcMethod};
use sinew::setup::Setup;
use sinew::track::{self, Pipeline, Spool};
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{bootstrap, hmc_filter};
use sinew_results::estimate::FrameEstimate;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation;
use sinew_tests::simulated_source::source;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc;

const FRAMES: u64 = 15;

fn recording() -> SyntheticRecording {
    SyntheticRecording::new(&Script { duration_s: FRAMES as f64 / 30.0, ..Script::default() }, 3).unwrap()
}

fn prepared(settings: &Settings) -> (SyntheticRecording, Setup, Pipeline) {
    let recording = recording();
    let setup = evaluation::set_up(&mut source(&recording), 0..FRAMES, settings, |_| ()).unwrap();
    let tree = setup.tree();
    let pipeline = Pipeline::new(&setup, &tree, &recording.cameras, &recording.layout, settings.clone()).unwrap();
    (recording, setup, pipeline)
}

/// Of draws with equal weights a systematic choice takes every n-th, from a start that differs from frame to frame.
#[test]
fn each_frame_is_thinned_from_another_start() {
    let hmc = HmcMethod(hmc_filter::Config { chains: 8, updates: 8, burn_in: 1, ..HmcMethod::default().0 });
    let settings = Settings { method: Arc::new(hmc), draws: 2, ..Settings::default() };
    let (recording, _, mut pipeline) = prepared(&settings);
    let mut starts = BTreeSet::new();
    pipeline
        .track(&mut source(&recording), 0..FRAMES, |estimate: FrameEstimate, posterior: &Posterior<'_>| {
            let mut state = vec![0.0; posterior.dim];
            let kept = &estimate.draws.states[..posterior.dim];
            let index = (0..posterior.weights.len()).find(|&index| {
                posterior.state(index, &mut state);
                state == kept
            });
            starts.insert(index.expect("a draw of the posterior"));
            Ok(())
        })
        .unwrap();
    // 15 of 32 starts: fewer than five different ones in one of a thousand million runs.
    assert!(starts.len() >= 5, "{starts:?}");
}

/// Trajectories have the correlations between successive frames that the backward pass says, and none across a frame in which tracking began again.
#[test]
fn smoothed_trajectories_have_the_correlations_of_the_model() {
    const COUNT: u64 = 9;
    const RESTART: u64 = 5;
    let bootstrap = BootstrapMethod(bootstrap::Config { particles: 64, ..bootstrap::Config::default() });
    let settings = Settings { method: Arc::new(bootstrap), draws: track::TRAJECTORIES, ..Settings::default() };
    let (_, setup, pipeline) = prepared(&settings);
    let tree = setup.tree();
    let walk = track::walk(&setup, &tree, &settings).unwrap();
    let variances: Vec<f64> = walk.sd().iter().map(|sd| sd * sd).collect();
    let d = variances.len();
    let folder = std::env::temp_dir().join(format!("sinew-frame-streams-{}", std::process::id()));
    let mut spool = Spool::temporary(&folder, [d, 0, 0, 0]).unwrap();
    // Filtered variances come from a step of motion.
    let covariance: Vec<f64> = (0..d * d).map(|k| if k / d == k % d { variances[k % d] } else { 0.0 }).collect();
    for number in 0..COUNT {
        let mut filtered = sinew::core::transition::Moments { mean: vec![0.0; d], covariance: covariance.clone() };
        filtered.mean[0] = number as f64;
        let estimate = FrameEstimate { number, restarted: number == RESTART, filtered, ..FrameEstimate::default() };
        spool.append(&estimate).unwrap();
    }
    let mut frames = vec![];
    let keep = |estimate: FrameEstimate| {
        frames.push((estimate.mean_state, estimate.draws.states));
        Ok(ControlFlow::Continue(()))
    };
    track::smooth(&mut spool, &pipeline, &tree, || Ok(()), keep).unwrap();
    // With G = 1/2 the smoothed variance in units of the filtered one is 1 + (next - 2) / 4, and the covariance with the next frame next / 2.
    let mut variance = vec![1.0; COUNT as usize];
    for frame in (0..COUNT as usize - 1).rev().filter(|&frame| frame + 1 != RESTART as usize) {
        variance[frame] = 1.0 + (variance[frame + 1] - 2.0) / 4.0;
    }
    // Coordinates but the first, whose mean moves, of all trajectories.
    let series = |frame: usize| {
        let (mean, states) = &frames[frame];
        let one = |(k, x): (usize, &f64)| ((x - mean[k % d]) / variances[k % d].sqrt(), k % d);
        states.iter().enumerate().map(one).filter(|(_, j)| *j > 0).map(|(x, _)| x).collect::<Vec<f64>>()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64;
    // Six standard errors of a mean of products of standard normals.
    let bound = 6.0 * (2.0 / series(0).len() as f64).sqrt();
    for frame in 0..COUNT as usize {
        let now = series(frame);
        let found = product(&now, &now);
        assert!((found - variance[frame]).abs() < bound, "frame {frame}: variance {found}, not {}", variance[frame]);
        if frame + 1 < COUNT as usize {
            let expected = if frame + 1 == RESTART as usize { 0.0 } else { 0.5 * variance[frame + 1] };
            let found = product(&now, &series(frame + 1));
            assert!((found - expected).abs() < bound, "frames {frame} and the next: {found}, not {expected}");
        }
    }
    // The frame before a restart keeps its filtered mean; those before it are drawn towards their next one.
    assert_eq!(frames[RESTART as usize - 1].0[0], (RESTART - 1) as f64);
    assert!(frames[RESTART as usize - 2].0[0] > (RESTART - 2) as f64);
}
