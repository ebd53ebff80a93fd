//! A density of eight exponentials, per state with gradient: with `inlined!`, and with functions that are never inlined, whose operations on lanes are compiled for the baseline.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_core::density::{GradLogDensity, LaneDensity, Lanes};
use sinew_core::elementary::exp;
use sinew_core::inlined;
use sinew_core::lanes::{Block, Isa, LANES, Real};
use std::hint::black_box;

const DIM: usize = 8;

macro_rules! never_inlined {
    ($($function:item)*) => {
        $(#[inline(never)] $function)*
    };
}

macro_rules! exponentials {
    ($name:ident, $wrap:ident) => {
        struct $name;
        impl LaneDensity for $name {
            $wrap! {
                fn dim(&self) -> usize {
                    DIM
                }
                fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
                    let mut sum = V::splat(0.0);
                    for j in 0..DIM {
                        let e = exp(V::load(&x[j]));
                        if GRAD {
                            e.store(&mut grad[j]);
                        }
                        sum = sum + e;
                    }
                    sum
                }
            }
        }
    };
}

exponentials!(Inlined, inlined);
exponentials!(NotInlined, never_inlined);

fn inlining(c: &mut Criterion) {
    let isa = Isa::best();
    let (x, mut grad) = ([Block::splat(0.3); DIM], [Block::ZERO; DIM]);
    let mut group = c.benchmark_group(format!("inlining/{}", isa.name()));
    group.throughput(Throughput::Elements(LANES as u64));
    let inlined = Lanes { leaf: Inlined, isa };
    group.bench_function("inlined", |b| {
        b.iter(|| black_box(inlined.log_density_grad_block(black_box(&x), &mut grad, &mut [])));
    });
    let not = Lanes { leaf: NotInlined, isa };
    group.bench_function("not inlined", |b| {
        b.iter(|| black_box(not.log_density_grad_block(black_box(&x), &mut grad, &mut [])));
    });
    group.finish();
}

criterion_group!(benches, inlining);
criterion_main!(benches);
