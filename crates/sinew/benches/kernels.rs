//! Costs per state of the kernels, scalar and block, for the best instruction set and for AVX2.
//!
//! One iteration is one state (or one particle, or one chain and leapfrog step), so criterion prints what a state costs.

use criterion::{Bencher, Criterion, criterion_group, criterion_main};
use sinew::body::{Plan, Proportions, point_positions_block, standard};
use sinew::core::combinators::Sum;
use sinew::core::density::{GradLogDensity, Lanes};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::dynamics::mixture::Mixture;
use sinew::observe::{MarkerModel, ObservationModel};
use sinew::problem28;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Times `call`, which treats `states` states, so that one iteration is one state.
fn per_state(b: &mut Bencher<'_>, states: usize, mut call: impl FnMut()) {
    b.iter_custom(|iterations| {
        let calls = iterations.div_ceil(states as u64);
        let start = Instant::now();
        for _ in 0..calls {
            call();
        }
        let scale = iterations as f64 / (calls * states as u64) as f64;
        Duration::from_secs_f64(start.elapsed().as_secs_f64() * scale)
    });
}

/// The instruction sets that are reported: the best one, and AVX2 where that is not the best.
fn sets() -> Vec<Isa> {
    let mut sets = vec![Isa::best()];
    sets.extend(Isa::by_name("avx2").filter(|&isa| isa != Isa::best()));
    sets
}

fn density_rows(c: &mut Criterion, name: &str, target: &dyn GradLogDensity, isa: Isa, pose: &[f64]) {
    let block: Vec<Block> = pose.iter().map(|&x| Block(std::array::from_fn(|lane| x + 0.001 * lane as f64))).collect();
    let mut grad = vec![Block::ZERO; pose.len()];
    let mut ws = vec![Block::ZERO; target.workspace()];
    let mut group = c.benchmark_group(format!("{name}/{}", isa.name()));
    group.bench_function("value", |b| {
        per_state(b, LANES, || {
            black_box(target.log_density_block(black_box(&block), &mut ws));
        });
    });
    group.bench_function("value+gradient", |b| {
        per_state(b, LANES, || {
            black_box(target.log_density_grad_block(black_box(&block), &mut grad, &mut ws));
        });
    });
    let mut g = vec![0.0; pose.len()];
    group.bench_function("value+gradient, one state", |b| {
        b.iter(|| black_box(target.log_density_grad(black_box(pose), &mut g)));
    });
    group.finish();
}

fn kinematics(c: &mut Criterion) {
    for (name, tree) in [
        ("forward kinematics CF28", standard::cf28(&Proportions::default())),
        ("forward kinematics H32", standard::h32(&Proportions::default())),
    ] {
        let plan = Plan::with_all_points(&tree);
        for isa in sets() {
            let q = vec![Block::splat(0.1); plan.dof()];
            let mut out = vec![Block::ZERO; 3 * plan.points()];
            let mut ws = vec![Block::ZERO; plan.workspace()];
            c.bench_function(&format!("{name}/{}", isa.name()), |b| {
                per_state(b, LANES, || point_positions_block(&plan, isa, black_box(&q), &mut out, &mut ws));
            });
        }
    }
}

fn posteriors(c: &mut Criterion) {
    let problem = problem28::load();
    for isa in sets() {
        density_rows(c, "problem28 posterior", &problem.target(isa), isa, &problem.true_pose);
        density_rows(c, "problem28 likelihood", &problem.likelihood(isa), isa, &problem.true_pose);
        density_rows(c, "problem28 mixture prior", &problem.prior(isa), isa, &problem.true_pose);
    }
    let plan = Arc::new(Plan::with_all_points(&standard::cf28(&Proportions::default())));
    let frame: Vec<_> = (0..17).map(|k| Some([0.003 * f64::from(k) - 0.02, 0.01 * f64::from(k) - 0.1])).collect();
    for isa in sets() {
        let model = MarkerModel { plan: Arc::clone(&plan), centre: [0.0, -4.8, 1.0], sigma: 0.003, isa };
        let centres = (0..10).map(|i| vec![0.01 * f64::from(i); 28]).collect();
        let leaf = Mixture::new(centres, &problem.prior_sd).expect("valid mixture");
        density_rows(c, "CF28 posterior", &Sum(model.bind(&frame), Lanes { leaf, isa }), isa, &[0.05; 28]);
    }
}

criterion_group!(benches, kinematics, posteriors);
criterion_main!(benches);
