//! Objective of a GPLVM beside what faer needs for its parts, and maps of blocks of latents.
//!
//! 50 columns, 3 coordinates of a latent.
//!
//! Arithmetic of an objective, in fused multiply-adds: N³/6 each for the Cholesky factor, its inverse L⁻¹ and their product L⁻ᵀ L⁻¹, N² D for K⁻¹ Y and N² D / 2 for A Aᵀ. Arithmetic of a block of maps, in multiplications of eight lanes: N (q + 16) for the radial
//! basis functions (15 for an exponential), N D for the mean, N (q + 1) + N D q for the Jacobian; N² / 2 for a variance.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::triangular::BlockStructure;
use faer::linalg::matmul::{matmul, triangular};
use faer::{Accum, Mat, Par, Spec};
use sinew_core::decode::LaneDecode;
use sinew_core::density::{Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::lbfgs::Objective;
use sinew_latent::gplvm::{Config, model};
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::model::LatentModel;
use sinew_latent::space::Space;
use sinew_latent::training::Landscape;
use std::hint::black_box;

const COLUMNS: usize = 50;
const DIM: usize = 3;

fn made_up(count: usize) -> LatentModel {
    let entry = |n: usize, d: usize| (0.1 * n as f64 * (1.0 + 0.03 * d as f64)).sin() + (0.37 * (n * d) as f64).cos();
    let data: Vec<f64> = (0..count * COLUMNS).map(|k| entry(k / COLUMNS, k % COLUMNS)).collect();
    model(&data, COLUMNS, &Config { dim: DIM, ..Config::default() }).expect("valid")
}

/// Factor, inverse and products with Y as faer makes them.
fn faer_parts(gram: &Mat<f64>, rows: &Mat<f64>, par: Par) -> f64 {
    let count = gram.nrows();
    let mut factor = gram.clone();
    let scratch = llt::factor::cholesky_in_place_scratch::<f64>(count, par, Spec::default());
    let mut memory = MemBuffer::new(scratch.or(llt::inverse::inverse_scratch::<f64>(count, par)));
    let stack = MemStack::new(&mut memory);
    llt::factor::cholesky_in_place(factor.as_mut(), Default::default(), par, stack, Spec::default()).expect("definite");
    let mut inverse = Mat::zeros(count, count);
    llt::inverse::inverse(inverse.as_mut(), factor.as_ref(), par, stack);
    let mut weights = rows.clone();
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(factor.as_ref(), weights.as_mut(), par);
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(factor.transpose(), weights.as_mut(), par);
    let (full, lower) = (BlockStructure::Rectangular, BlockStructure::TriangularLower);
    triangular::matmul(
        inverse.as_mut(),
        lower,
        Accum::Add,
        weights.as_ref(),
        full,
        weights.transpose(),
        full,
        -1.0,
        par,
    );
    matmul(
        factor.as_mut().subcols_mut(0, 1),
        Accum::Replace,
        inverse.as_ref(),
        weights.as_ref().subcols(0, 1),
        1.0,
        par,
    );
    factor[(0, 0)]
}

fn objectives(c: &mut Criterion) {
    let mut group = c.benchmark_group(format!("gplvm objective/{}", Isa::best().name()));
    group.sample_size(20);
    for count in [200, 400, 1000] {
        let model = made_up(count);
        let latents = &model.nodes[0].latents;
        let covariance = model.nodes[0].covariance;
        let white = |i: usize, j: usize| if i == j { covariance.white } else { 0.0 };
        let row = |n: usize| &latents[n * DIM..][..DIM];
        let gram = Mat::from_fn(count, count, |i, j| covariance.between(row(i), row(j)) + white(i, j));
        let rows = Mat::from_fn(count, COLUMNS, |i, j| model.data[i * COLUMNS + j]);
        group.bench_function(BenchmarkId::new("faer's parts, one thread", count), |b| {
            b.iter(|| black_box(faer_parts(black_box(&gram), &rows, Par::Seq)));
        });
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let (mut landscape, unknowns) = Landscape::new(model.clone(), Isa::best()).expect("valid");
            let mut gradient = vec![0.0; unknowns.len()];
            group.bench_function(BenchmarkId::new(format!("with gradient, threads {threads}"), count), |b| {
                let routine = || black_box(landscape.evaluate(black_box(&unknowns), &mut gradient));
                pool.install(|| b.iter(routine));
            });
        }
    }
    group.finish();
}

struct MeanAndJacobian<'a> {
    space: &'a Space,
    x: &'a [Block],
    mean: &'a mut [Block],
    jacobian: &'a mut [Block],
    ws: &'a mut [Block],
}

impl Kernel<Block> for MeanAndJacobian<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        self.space.decode::<V>(self.x, self.mean, self.ws);
        self.space.jacobian::<V>(self.x, self.jacobian, self.ws);
    }
}

fn maps(c: &mut Criterion) {
    let isa = Isa::best();
    let mut group = c.benchmark_group(format!("latent map/{}", isa.name()));
    group.throughput(Throughput::Elements(LANES as u64));
    for count in [200, 400] {
        let model = made_up(count);
        let space = Space::new(&model, 0).expect("valid");
        let x = vec![Block::splat(0.3); DIM];
        let (mut mean, mut jacobian) = (vec![Block::ZERO; COLUMNS], vec![Block::ZERO; COLUMNS * DIM]);
        let mut ws = vec![Block::ZERO; space.mapping.workspace()];
        group.bench_function(BenchmarkId::new("mean", count), |b| {
            b.iter(|| space.mapping.mean_block(black_box(&x), isa, black_box(&mut mean), &mut ws));
        });
        group.bench_function(BenchmarkId::new("mean and Jacobian", count), |b| {
            b.iter(|| {
                let (x, mean, jacobian, ws) = (black_box(&x[..]), &mut mean[..], &mut jacobian[..], &mut ws[..]);
                dispatch(isa, MeanAndJacobian { space: &space, x, mean, jacobian, ws });
                black_box(&jacobian);
            });
        });
        group.bench_function(BenchmarkId::new("variance", count), |b| {
            b.iter(|| black_box(space.mapping.variance_block(black_box(&x), isa, &mut ws)));
        });
        let prior = LatentPrior::of(&model, 0);
        let density = Lanes { leaf: LatentDensity::prior_of(space.mapping.clone(), prior), isa };
        let mut ws = vec![Block::ZERO; LogDensity::workspace(&density)];
        group.bench_function(BenchmarkId::new("log density of latents", count), |b| {
            b.iter(|| black_box(density.log_density_block(black_box(&x), &mut ws)));
        });
    }
    group.finish();
}

criterion_group!(benches, objectives, maps);
criterion_main!(benches);
