//! One frame of each tracker in 28 dimensions on a quadratic observation.
//! Bootstrap per particle, hybrid Monte Carlo per chain and leapfrog step. The filter of a model of one dimension (`filter_speed` in the examples counts its instructions).

#[path = "../examples/walk/mod.rs"]
mod walk;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_tracking::state_space::{Settings, StateSpace, filter};
use sinew_tracking::{Tracker, bootstrap, hmc_filter};
use std::hint::black_box;
use walk::Walk;

const DIM: usize = 28;

fn frames(c: &mut Criterion) {
    let isa = Isa::best();
    let observed = Lanes { leaf: Quadratic { centre: vec![0.0; DIM], precision: vec![100.0; DIM] }, isa };
    let walk = |between| RandomWalk::choo_fleet(DIM, 1.0 / 30.0, between, isa).expect("valid");
    let mut frame = 0;
    let mut stage = move || {
        frame += 1;
        Stage::new(1, "bench").at_frame(frame)
    };
    let mut group = c.benchmark_group(format!("trackers/{}", isa.name()));
    group.sample_size(20);
    for particles in [1_000, 100_000] {
        let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
        let mut tracker = bootstrap::Bootstrap::new(config, walk(Between::Mixture), vec![0.0; DIM]).expect("valid");
        group.throughput(Throughput::Elements(particles as u64));
        group.bench_function(format!("bootstrap, {particles} particles, per particle"), |b| {
            b.iter(|| black_box(tracker.step(&observed, stage()).expect("weights")));
        });
    }
    for between in [Between::Mixture, Between::Gaussian] {
        let config = hmc_filter::Config::real_recordings();
        let steps = config.chains * config.updates * config.leapfrog_steps;
        let mut tracker = hmc_filter::HmcFilter::new(config, walk(between), vec![0.0; DIM], isa).expect("valid");
        group.throughput(Throughput::Elements(steps as u64));
        group.bench_function(format!("hmc, {between:?}, per chain and leapfrog step"), |b| {
            b.iter(|| black_box(tracker.step(&observed, stage()).expect("start")));
        });
    }
    group.finish();
}

/// A hundred frames, resampled systematically in each.
fn one_dimension(c: &mut Criterion) {
    let isa = Isa::best();
    let series: Vec<f64> = (0..100).map(|t| 5.0 * (0.1 * f64::from(t)).sin()).collect();
    let settings = |particles| Settings { particles, resample_below: 1.0, ..Settings::default() };
    let mut group = c.benchmark_group(format!("filter of one dimension/{}", isa.name()));
    for particles in [1_000, 10_000] {
        group.throughput(Throughput::Elements((particles * series.len()) as u64));
        let mut row = |name: &str, run: &dyn Fn() -> f64| {
            group.bench_function(format!("{particles} particles, {name}, per particle and frame"), |b| b.iter(run));
        };
        row("one state", &|| evidence(&Walk::<false>(isa), &series, settings(particles)));
        row("eight states", &|| evidence(&Walk::<true>(isa), &series, settings(particles)));
    }
    group.finish();
}

fn evidence<M: StateSpace<Observation = f64>>(model: &M, series: &[f64], settings: Settings) -> f64 {
    black_box(filter(model, series, settings).expect("weights").log_evidence)
}

criterion_group!(benches, frames, one_dimension);
criterion_main!(benches);
