//! Log density and gradient of the priors between frames, per state, for one state and for a block.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::density::{GradLogDensity, Lanes};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_dynamics::gaussian::Gaussian;
use sinew_dynamics::mixture::Mixture;
use std::hint::black_box;

const DIM: usize = 28;

fn both(c: &mut Criterion, name: &str, isa: Isa, density: &impl GradLogDensity) {
    let mut group = c.benchmark_group(format!("{name}/{}", isa.name()));
    let (state, mut grad) = (vec![0.1; DIM], vec![0.0; DIM]);
    group.throughput(Throughput::Elements(1));
    group.bench_function("one state", |b| {
        b.iter(|| black_box(density.log_density_grad(black_box(&state), &mut grad)));
    });
    let (x, mut grads) = (vec![Block::splat(0.1); DIM], vec![Block::ZERO; DIM]);
    let mut ws = vec![Block::ZERO; density.workspace()];
    group.throughput(Throughput::Elements(LANES as u64));
    group.bench_function("block, per state", |b| {
        b.iter(|| black_box(density.log_density_grad_block(black_box(&x), &mut grads, &mut ws)));
    });
    group.finish();
}

fn priors(c: &mut Criterion) {
    let mut sets = vec![Isa::best()];
    sets.extend(Isa::by_name("avx2").filter(|isa| *isa != Isa::best()));
    for isa in sets {
        for count in [10, 16] {
            let means = (0..count).map(|i| (0..DIM).map(|j| f64::from(i) * 0.01 + j as f64 * 0.001).collect());
            let leaf = Mixture::new(means.collect(), &[0.15; DIM]).expect("valid");
            both(c, &format!("mixture of {count}, 28-d"), isa, &Lanes { leaf, isa });
        }
        let covariance: Vec<f64> =
            (0..DIM * DIM).map(|k| (-0.2 * ((k / DIM) as f64 - (k % DIM) as f64).abs()).exp()).collect();
        let leaf = Gaussian::new(vec![0.0; DIM], &covariance).expect("valid");
        both(c, "gaussian, 28-d", isa, &Lanes { leaf, isa });
    }
}

criterion_group!(benches, priors);
criterion_main!(benches);
