//! Gradients of problem28 in single and in double precision: nanoseconds a state, the least of many, and the largest relative difference of the gradients.
use sinew::core::density::{GradLogDensity, LaneDensity, Lanes};
use sinew::core::lanes::{Block, Isa};
use sinew::problem28;
use std::hint::black_box;
use std::time::Instant;

fn least(mut call: impl FnMut()) -> f64 {
    let mut best = f64::MAX;
    for _ in 0..1000 {
        let start = Instant::now();
        (0..300).for_each(|_| call());
        best = best.min(start.elapsed().as_secs_f64() / 2400.0 * 1e9);
    }
    best
}

fn report<T: LaneDensity>(name: &str, target: &Lanes<T>, pose: &[f64]) {
    let x: Vec<Block> = pose.iter().map(|&x| Block(std::array::from_fn(|l| x + 0.001 * l as f64))).collect();
    let (mut a, mut b) = (vec![Block::ZERO; 28], vec![Block::ZERO; 28]);
    let mut ws = vec![Block::ZERO; sinew::core::density::LogDensity::workspace(target)];
    let double = least(|| {
        black_box(target.log_density_grad_block(black_box(&x), &mut a, &mut ws));
    });
    let single = least(|| {
        black_box(target.single(black_box(&x), &mut b, &mut ws));
    });
    let largest = a.iter().flat_map(|g| g.0).fold(0.0_f64, |m, g| m.max(g.abs()));
    let apart =
        a.iter().zip(&b).flat_map(|(a, b)| (0..8).map(move |l| (a.0[l] - b.0[l]).abs())).fold(0.0_f64, f64::max);
    println!(
        "{name}: double {double:.1} ns, single {single:.1} ns, largest difference {:.1e} of the largest entry",
        apart / largest
    );
}

fn main() {
    let problem = problem28::load();
    let isa = Isa::best();
    for _ in 0..3 {
        report("likelihood", &problem.likelihood(isa), &problem.true_pose);
        report("mixture", &problem.prior(isa), &problem.true_pose);
    }
}
