//! The same density written once for eight states, and whether its code is compiled for the processor.
//!
//! Run it on your own density: where the best instruction set is slower than `baseline`, a function that computes with `Real` is not within `inlined!`.
//!
//! `cargo run --release -p sinew-core --example lane_density`

use sinew_core::density::{GradLogDensity, LaneDensity, Lanes, LogDensity};
use sinew_core::elementary::exp;
use sinew_core::inlined;
use sinew_core::lanes::{Block, Isa, LANES, Real};
use std::hint::black_box;
use std::time::Instant;

/// Counts c_j ~ Poisson(exp(x_j)) under x ~ N(0, 1): log p = Σ c_j x_j − exp(x_j) − ½ x_j².
struct Counts(Vec<f64>);

impl LaneDensity for Counts {
    inlined! {
        fn dim(&self) -> usize {
            self.0.len()
        }
        fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
            let mut sum = V::splat(0.0);
            for (j, &count) in self.0.iter().enumerate() {
                let x = V::load(&x[j]);
                let (rate, less) = (exp(x), V::splat(count) - x);
                if GRAD {
                    (less - rate).store(&mut grad[j]);
                }
                sum = sum + x.fma(x.fma(V::splat(-0.5), V::splat(count)), -rate);
            }
            sum
        }
    }
}

fn main() {
    let counts = || Counts(vec![0.0, 3.0, 1.0, 7.0, 2.0, 2.0, 0.0, 5.0]);
    let x = [Block::splat(0.3); 8];
    let mut grad = [Block::ZERO; 8];
    for isa in Isa::available() {
        let density = Lanes { leaf: counts(), isa };
        let (start, blocks) = (Instant::now(), 100_000);
        for _ in 0..blocks {
            black_box(density.log_density_grad_block(black_box(&x), &mut grad, &mut []));
        }
        let ns = start.elapsed().as_secs_f64() * 1e9 / f64::from(blocks) / LANES as f64;
        println!("{:>8}: {ns:.1} ns a state, log density {:.6}", isa.name(), density.log_density(&[0.3; 8]));
    }
}
