//! Costs per state of the kernels, scalar and block, for the best instruction set and for AVX2.
//!
//! One iteration is one state (or one particle, or one chain and leapfrog step), so criterion prints what a state costs.

use criterion::{Bencher, Criterion, Throughput, criterion_group, criterion_main};
use sinew::body::{Plan, Proportions, point_positions_block, standard};
use sinew::config::settings::Settings;
use sinew::core::combinators::Sum;
use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::core::transition::diagonal_matrix;
use sinew::dynamics::mixture::Mixture;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::input::source::FrameSource;
use sinew::observe::ObservationModel;
use sinew::samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew::samplers::metric::{Dense, Metric};
use sinew::samplers::resample::Scheme;
use sinew::track::{Pipeline, Scene};
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{Tracker, bootstrap};
use sinew_markers::MarkerModel;
use sinew_results::estimate::FrameEstimate;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation;
use sinew_tests::problem28;
use sinew_tests::simulated_source::source;
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
        density_rows(c, "problem28 likelihood by views", &problem.likelihood_by_views(isa), isa, &problem.true_pose);
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

/// Rows of the samplers on problem28: one iteration is one chain and leapfrog step, one state of normal deviates, one particle and frame.
fn samplers(c: &mut Criterion) {
    const LEAPFROG_STEPS: usize = 20;
    let problem = problem28::load();
    for isa in sets() {
        let target = problem.target(isa);
        let mut group = c.benchmark_group(format!("problem28 sampling/{}", isa.name()));
        let curvature = curvature_of(&problem, isa);
        let whole = diagonal_matrix(&curvature);
        let metrics = [
            ("hmc leapfrog step, diagonal metric", Metric::Diagonal(curvature)),
            ("hmc leapfrog step, dense metric", Metric::Dense(Dense::new(&whole, 28).expect("positive definite"))),
        ];
        for (name, metric) in metrics {
            let hmc = Hmc::with_metric(0.3, &metric, LEAPFROG_STEPS, 0.2, isa).expect("valid steps");
            let start: Vec<Block> = problem.true_pose.iter().map(|&x| Block::splat(x)).collect();
            let mut chains = Chains::new(&target, start).expect("finite start");
            let mut ws = Workspace::new(&target);
            let mut rng = Stage::new(1, "bench").whole();
            group.bench_function(name, |b| {
                per_state(b, LANES * LEAPFROG_STEPS, || {
                    black_box(update(&target, &hmc, &mut chains, &mut ws, &mut rng));
                });
            });
        }
        let mut rng = Stage::new(1, "bench").whole();
        let mut noise = vec![Block::ZERO; 28];
        group.bench_function("28 normal deviates", |b| {
            per_state(b, LANES, || rng.fill_normal(isa, black_box(&mut noise)));
        });
        let likelihood = problem.likelihood(isa);
        let walk = RandomWalk::choo_fleet(28, 1.0 / 30.0, Between::Mixture, isa).expect("valid walk");
        for (name, scheme) in [("multinomial", Scheme::Multinomial), ("systematic", Scheme::Systematic)] {
            let config = bootstrap::Config { particles: 8192, scheme, ..bootstrap::Config::default() };
            let mut tracker =
                bootstrap::Bootstrap::new(config, walk.clone(), problem.true_pose.clone()).expect("valid filter");
            let mut frame = 0;
            group.bench_function(format!("bootstrap particle-frame, {name}"), |b| {
                per_state(b, 8192, || {
                    frame += 1;
                    black_box(tracker.step(&likelihood, Stage::new(1, "bench").at_frame(frame)).expect("weights"));
                });
            });
        }
        group.finish();
    }
}

/// Gauss–Newton diagonal at the true pose plus the prior's precision.
fn curvature_of(problem: &problem28::Problem, isa: Isa) -> Vec<f64> {
    let likelihood = problem.likelihood(isa);
    let x: Vec<Block> = problem.true_pose.iter().map(|&x| Block::splat(x)).collect();
    let mut diagonal = vec![Block::ZERO; 28];
    likelihood.gauss_newton_diagonal_block(&x, &mut diagonal, &mut vec![Block::ZERO; likelihood.workspace()]);
    diagonal.iter().zip(&problem.prior_sd).map(|(h, sd)| h.0[0] + 1.0 / (sd * sd)).collect()
}

fn resampling(c: &mut Criterion) {
    let mut group = c.benchmark_group("resampling, per particle");
    for n in [1_000_usize, 1_000_000] {
        let weights: Vec<f64> = (0..n).map(|i| 2.0 * (i + 1) as f64 / (n * (n + 1)) as f64).collect();
        let mut rng = Stage::new(1, "bench").whole();
        for (name, scheme) in [("multinomial", Scheme::Multinomial), ("systematic", Scheme::Systematic)] {
            group.bench_function(format!("{name} {n}"), |b| {
                per_state(b, n, || {
                    black_box(scheme.ancestors(&weights, n, &mut rng));
                });
            });
        }
    }
    group.finish();
}

/// The demo's recording with default settings, after its set-up: its likelihood, one iteration a state, and its tracking, one iteration a frame.
fn tracking(c: &mut Criterion) {
    let mut recording = source(&SyntheticRecording::new(&Script::default(), 1).expect("valid script"));
    let cameras = recording.cameras.clone();
    let layout = recording.layout.clone();
    let settings = Settings::default();
    let frames = recording.frames();
    let setup = evaluation::set_up(&mut recording, frames.clone(), &settings, |_| ()).expect("set-up");
    let tree = setup.tree();
    for isa in sets() {
        let settings = Settings { isa, ..settings.clone() };
        let mut scene = Scene::new(&setup, &tree, &cameras, &layout, &settings).expect("scene");
        let pose = setup.start_pose.clone();
        let (likelihood, _) = scene.observe(&recording.people(0).expect("people"), &[], &pose);
        density_rows(c, "H32 keypoint likelihood, 4 cameras", &likelihood, isa, &pose);
        let mut group = c.benchmark_group(format!("track the demo, per frame/{}", isa.name()));
        group.sample_size(10).measurement_time(Duration::from_secs(8)).throughput(Throughput::Elements(1));
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            group.bench_function(format!("{threads} threads"), |b| {
                pool.install(|| {
                    per_state(b, frames.end as usize, || {
                        let mut pipeline =
                            Pipeline::new(&setup, &tree, &cameras, &layout, settings.clone()).expect("pipeline");
                        pipeline
                            .track(&mut recording, frames.clone(), |estimate: FrameEstimate, _: &Posterior<'_>| {
                                black_box(estimate);
                                Ok(())
                            })
                            .expect("tracked");
                    });
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, kinematics, posteriors, samplers, resampling, tracking);
criterion_main!(benches);
