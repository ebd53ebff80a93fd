//! Hybrid Monte Carlo per leapfrog step and state, normal deviates per state, resampling per particle.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::density::{GradLogDensity, Lanes};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew_samplers::resample::Scheme;
use std::hint::black_box;

const DIM: usize = 28;
const LEAPFROG_STEPS: usize = 20;

fn sets() -> Vec<Isa> {
    let mut sets = vec![Isa::best()];
    sets.extend(Isa::by_name("avx2").filter(|isa| *isa != Isa::best()));
    sets
}

fn hmc(c: &mut Criterion) {
    for isa in sets() {
        let leaf = Quadratic { centre: vec![0.0; DIM], precision: vec![1.0; DIM] };
        let target = Lanes { leaf, isa };
        let hmc = Hmc::new(0.3, &[1.0; DIM], LEAPFROG_STEPS, 0.2, isa).expect("valid");
        let mut chains = Chains::new(&target, vec![Block::splat(0.1); DIM]).expect("finite");
        let mut ws = Workspace::new(&target);
        let mut rng = Stage::new(1, "bench").whole();
        let mut group = c.benchmark_group(format!("hmc/{}", isa.name()));
        group.throughput(Throughput::Elements((LANES * LEAPFROG_STEPS) as u64));
        group.bench_function("leapfrog step and state, 28-d quadratic", |b| {
            b.iter(|| black_box(update(&target, &hmc, &mut chains, &mut ws, &mut rng)));
        });
        group.throughput(Throughput::Elements(LANES as u64));
        let (mut grad, x) = (vec![Block::ZERO; DIM], vec![Block::splat(0.1); DIM]);
        group.bench_function("gradient of the quadratic alone, per state", |b| {
            b.iter(|| black_box(target.log_density_grad_block(black_box(&x), &mut grad, &mut [])));
        });
        let mut noise = vec![Block::ZERO; DIM];
        group.bench_function("28 normal deviates, per state", |b| {
            b.iter(|| rng.fill_normal(isa, black_box(&mut noise)));
        });
        group.finish();
    }
}

fn resampling(c: &mut Criterion) {
    for n in [1_000, 1_000_000] {
        let weights: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.37).sin().powi(8)).collect();
        let mut group = c.benchmark_group(format!("resample/{n}"));
        group.throughput(Throughput::Elements(n as u64)).sample_size(10);
        let mut rng = Stage::new(1, "bench").whole();
        for scheme in [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic] {
            group.bench_function(format!("{scheme:?}"), |b| {
                b.iter(|| black_box(scheme.ancestors(&weights, n as usize, &mut rng)));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, hmc, resampling);
criterion_main!(benches);
