//! A density of 32 coordinates through a linear decoder of 8, per state with gradient.
//! Target alone, decoder alone, both as `Through`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::combinators::Through;
use sinew_core::decode::{Decode, Linear};
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::toy::Quadratic;
use std::hint::black_box;

const SOURCE: usize = 8;
const TARGET: usize = 32;

fn decoders(c: &mut Criterion) {
    let isa = Isa::best();
    let entries = (0..SOURCE * TARGET).map(|e| (e as f64).sin()).collect();
    let decoder = Lanes { leaf: Linear::new(entries, SOURCE).expect("rows"), isa };
    let target = Lanes { leaf: Quadratic { centre: vec![0.1; TARGET], precision: vec![4.0; TARGET] }, isa };
    let through = Through { target: &target, decoder: &decoder };
    let (x, y) = (vec![Block::splat(0.3); SOURCE], vec![Block::splat(0.3); TARGET]);
    let (mut grad, mut grad_out) = (x.clone(), y.clone());
    let mut ws = vec![Block::ZERO; through.workspace()];
    let mut group = c.benchmark_group(format!("decoders/{}", isa.name()));
    group.throughput(Throughput::Elements(LANES as u64));
    group.bench_function("target alone", |b| {
        b.iter(|| black_box(target.log_density_grad_block(black_box(&y), &mut grad_out, &mut ws)));
    });
    group.bench_function("decoder alone", |b| {
        b.iter(|| {
            decoder.decode_block(black_box(&x), &mut grad_out, &mut ws);
            decoder.pullback_block(black_box(&x), black_box(&y), &mut grad, &mut ws);
            black_box(&grad);
        });
    });
    group.bench_function("through", |b| {
        b.iter(|| black_box(through.log_density_grad_block(black_box(&x), &mut grad, &mut ws)));
    });
    group.finish();
}

criterion_group!(benches, decoders);
criterion_main!(benches);
