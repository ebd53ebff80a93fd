//! One frame of each tracker in 28 dimensions on a quadratic observation.
//! Bootstrap per particle, hybrid Monte Carlo per chain and leapfrog step.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_tracking::{Tracker, bootstrap, hmc_filter};
use std::hint::black_box;

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

criterion_group!(benches, frames);
criterion_main!(benches);
