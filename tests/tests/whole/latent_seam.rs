//! Trackers of a latent state through a decoder that bends: a sheet of two dimensions in four. Invariance, convergence, resumption, threads; and through the identity nothing changes.

use sinew::core::combinators::{Sum, Through};
use sinew::core::decode::{Decode, Identity};
use sinew::core::density::{Lanes, LogDensity};
use sinew::core::diagnostics::effective_sample_size;
use sinew::core::kernel::MarkovKernel;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::toy::{Quadratic, Sheet};
use sinew::dynamics::first_order::FirstOrder;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::samplers::annealed_search::{self, Last};
use sinew::samplers::chains::ChainStat;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::metric::Geometry;
use sinew::samplers::one_chain::OneChain;
use sinew::samplers::resample::multinomial;
use sinew::tracking::annealed::{self, Annealed};
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::decoded::Decoded;
use sinew::tracking::hmc_filter::{self, HmcFilter};
use sinew::tracking::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_invariance::{ExactStart, RankCalibration, TestFunctions, calibration, exact_start};
use sinew_tests::quadrature::Axis;

type Seen = Lanes<Quadratic>;

/// Where tracking begins, in the latent space.
const START: [f64; 2] = [0.2, -0.1];
const STEP_SD: f64 = 0.4;
const FIRST_SD: f64 = 0.8;
const NOISE_SD: f64 = 0.3;

fn sheet() -> Lanes<Sheet> {
    Lanes { leaf: Sheet { radius: 1.2, twist: 0.5 }, isa: Isa::best() }
}

fn pose(x: &[f64]) -> Vec<f64> {
    let mut pose = vec![0.0; 4];
    sheet().decode(x, &mut pose);
    pose
}

fn walk(between: Between) -> RandomWalk {
    let walk = RandomWalk::new(&[STEP_SD; 2], 1.0, between, Isa::best()).expect("valid");
    walk.with_initial_sd(vec![FIRST_SD; 2]).expect("valid")
}

/// The observation of a point.
fn observed(z: Vec<f64>) -> Seen {
    let precision = vec![NOISE_SD.powi(-2); z.len()];
    Lanes { leaf: Quadratic { centre: z, precision }, isa: Isa::best() }
}

/// A pose that wanders over the sheet, not quite seen on it.
fn seen(frame: u32) -> Seen {
    let t = 0.4 * f64::from(frame);
    let mut z = pose(&[0.9 * t.sin() + 0.3, 0.7 * t.cos()]);
    z.iter_mut().zip([0.1, -0.2, 0.15, 0.05]).for_each(|(z, error)| *z += error);
    observed(z)
}

fn bootstrap(particles: usize) -> bootstrap::Config {
    bootstrap::Config { particles, ..bootstrap::Config::default() }
}

fn annealed(layers: annealed_search::Config) -> annealed::Config {
    annealed::Config { particles: 203, layers }
}

fn chains(geometry: Geometry) -> hmc_filter::Config {
    hmc_filter::Config {
        chains: 16,
        updates: 24,
        burn_in: 8,
        step_size: 0.5,
        leapfrog_steps: 5,
        jitter: 0.2,
        geometry,
        ..hmc_filter::Config::default()
    }
}

trait Steps: Tracker<Seen> + Resume {}
impl<T: Tracker<Seen> + Resume> Steps for T {}

/// Every tracker on the sheet, with a motion that follows the latent estimates.
fn on_the_sheet() -> Vec<(&'static str, Box<dyn Steps>)> {
    let start = pose(&START);
    let motion = |between| FirstOrder::new(walk(between), 0.5).expect("finite");
    let filter = Decoded::new(sheet(), &start, |start| Bootstrap::new(bootstrap(203), motion(Between::Mixture), start));
    let search = Decoded::new(sheet(), &start, |start| {
        let layers = annealed_search::Config { layers: 4, adaptive: true, crossover: 0.5, ..Default::default() };
        Annealed::new(annealed(layers), motion(Between::Mixture), vec![STEP_SD; 2], start, Isa::best())
    });
    let hmc = |geometry, between| {
        Decoded::new(sheet(), &start, |start| HmcFilter::new(chains(geometry), motion(between), start, Isa::best()))
    };
    vec![
        ("bootstrap", Box::new(filter.expect("valid"))),
        ("annealed", Box::new(search.expect("valid"))),
        ("hmc", Box::new(hmc(Geometry::Diagonal, Between::Mixture).expect("valid"))),
        ("dense hmc", Box::new(hmc(Geometry::Dense, Between::Gaussian).expect("valid"))),
    ]
}

fn stage(frame: u32) -> Stage {
    Stage::new(5, "latent seam").at_frame(frame)
}

/// All that a step leaves.
type Left = (StepInfo, Vec<Block>, Vec<f64>, Vec<ChainStat>);

fn step<O>(tracker: &mut (impl Tracker<O> + ?Sized), observed: &O, frame: u32) -> Left {
    let info = tracker.step(observed, stage(frame)).expect("a posterior");
    assert_eq!(info.mean, tracker.estimate());
    let posterior = tracker.posterior();
    (info, posterior.states.to_vec(), posterior.weights.to_vec(), posterior.chain_stats.to_vec())
}

#[test]
fn estimates_and_draws_are_poses() {
    for (name, mut tracker) in on_the_sheet() {
        assert!(tracker.estimate().iter().zip(pose(&START)).all(|(a, b)| (a - b).abs() < 1e-12), "{name}");
        assert_eq!((tracker.posterior().count(), tracker.posterior().dim), (0, 4), "{name}");
        for frame in 0..4 {
            let (info, ..) = step(&mut *tracker, &seen(frame), frame);
            let posterior = tracker.posterior();
            assert_eq!((info.mean.clone(), posterior.dim), (posterior.mean(), 4), "{name}");
            let mut draw = vec![0.0; 4];
            for index in 0..posterior.count() {
                posterior.state(index, &mut draw);
                let back = pose(&sheet().encode(&draw).expect("on the sheet"));
                assert!(draw.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-9), "{name}, frame {frame}: {draw:?}");
            }
        }
    }
}

#[test]
fn a_start_must_have_a_sampled_state() {
    let at = |pose: &[f64]| {
        let made = Decoded::new(sheet(), pose, |start| Bootstrap::new(bootstrap(10), walk(Between::Mixture), start));
        made.map(|tracker| tracker.tracker().particles().state(0))
    };
    assert!(at(&pose(&START)).expect("on the sheet").iter().zip(START).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(matches!(at(&[0.0, 1.2, 0.0, 0.0]), Err(Error::NotEncoded)));
    assert!(matches!(at(&START), Err(Error::Dimension { name: "start", found: 2, expected: 4 })));
    let (_, mut tracker) = on_the_sheet().remove(0);
    let refused = tracker.step(&observed(vec![0.0; 3]), stage(0));
    assert!(matches!(refused, Err(Error::Dimension { name: "observation", found: 3, expected: 4 })));
}

/// Each tracker as it is and behind the identity, ten frames: everything that it says and keeps.
#[test]
fn through_the_identity_nothing_changes() {
    fn check<K>(name: &str, make: impl Fn() -> K)
    where
        K: Tracker<Seen> + Resume + for<'a> Tracker<Through<&'a Seen, &'a Identity>>,
    {
        let mut plain = make();
        let start = [START[0], START[1], 0.1, -0.3];
        let mut behind = Decoded::new(Identity(4), &start, |_| Ok::<K, Error>(make())).expect("valid");
        for frame in 0..10 {
            assert_eq!(
                step::<Seen>(&mut behind, &seen(frame), frame),
                step::<Seen>(&mut plain, &seen(frame), frame),
                "{name}"
            );
            assert_eq!(behind.posterior(), plain.posterior(), "{name}");
            assert_eq!(behind.save()[4..], plain.save(), "{name}");
        }
    }
    let start = || vec![START[0], START[1], 0.1, -0.3];
    let motion = |between| RandomWalk::new(&[STEP_SD; 4], 1.0, between, Isa::best()).expect("valid");
    check("bootstrap", || Bootstrap::new(bootstrap(203), motion(Between::Mixture), start()).expect("valid"));
    check("annealed", || {
        let config = annealed(annealed_search::Config::default());
        Annealed::new(config, motion(Between::Mixture), vec![STEP_SD; 4], start(), Isa::best()).expect("valid")
    });
    for (geometry, between) in [(Geometry::Diagonal, Between::Mixture), (Geometry::Dense, Between::Gaussian)] {
        check("hmc", || HmcFilter::new(chains(geometry), motion(between), start(), Isa::best()).expect("valid"));
    }
}

#[test]
fn one_layer_of_annealing_is_the_bootstrap_filter() {
    let start = pose(&START);
    let mut filter =
        Decoded::new(sheet(), &start, |start| Bootstrap::new(bootstrap(203), walk(Between::Mixture), start))
            .expect("valid");
    let mut one = Decoded::new(sheet(), &start, |start| {
        let layers = annealed_search::Config { layers: 1, last: Last::Fixed(1.0), ..Default::default() };
        Annealed::new(annealed(layers), walk(Between::Mixture), vec![STEP_SD; 2], start, Isa::best())
    })
    .expect("valid");
    for frame in 0..10 {
        let (info, states, weights, _) = step::<Seen>(&mut filter, &seen(frame), frame);
        let (one, its_states, its_weights, _) = step::<Seen>(&mut one, &seen(frame), frame);
        assert_eq!((its_states, its_weights), (states, weights));
        assert_eq!(StepInfo { exponents: vec![], survivors: vec![], ..one }, info);
    }
}

#[test]
fn a_stopped_tracker_continues_to_the_same_bits() {
    const FRAMES: u32 = 8;
    for (i, (name, mut whole)) in on_the_sheet().into_iter().enumerate() {
        let all: Vec<Left> = (0..FRAMES).map(|frame| step(&mut *whole, &seen(frame), frame)).collect();
        let (_, mut tracker) = on_the_sheet().remove(i);
        for frame in 0..FRAMES {
            let saved = tracker.save();
            assert_eq!(saved[..4], *tracker.estimate(), "{name}");
            let (_, mut new) = on_the_sheet().remove(i);
            for wrong in [&saved[..3], &saved[1..], &[&saved[..], &[0.0]].concat()] {
                assert!(matches!(new.restore(wrong), Err(Error::Dimension { name: "saved state", .. })), "{name}");
            }
            new.restore(&saved).expect("the same settings");
            assert_eq!((new.save(), new.estimate()), (saved, tracker.estimate()), "{name}");
            assert_eq!(new.posterior().count(), 0, "{name}: no draws before the next step");
            assert_eq!(step(&mut *new, &seen(frame), frame), all[frame as usize], "{name}, frame {frame}");
            tracker = new;
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| -> Vec<Left> {
            let follow = |(_, mut tracker): (_, Box<dyn Steps>)| -> Vec<Left> {
                (0..6).map(|frame| step(&mut *tracker, &seen(frame), frame)).collect()
            };
            on_the_sheet().into_iter().flat_map(follow).collect()
        })
    };
    let one = with(1);
    assert!(one == with(2) && one == with(8));
}

/// The exact filter on a grid over the latent space.
struct Exact {
    /// log Z of all frames so far, of likelihoods without their constants.
    log_evidence: f64,
    mean: Vec<f64>,
    variance: Vec<f64>,
}

fn exact(frames: u32) -> Vec<Exact> {
    let axis = Axis::new(&[-3.6, 3.6], 10);
    let n = axis.nodes.len();
    let normal = |x: f64, sd: f64| (-0.5 * (x / sd).powi(2)).exp() / (sd * std::f64::consts::TAU.sqrt());
    let step = |to: usize, from: usize| normal(axis.nodes[to] - axis.nodes[from], STEP_SD) * axis.weights[from];
    let start = |j: usize, i: usize| normal(axis.nodes[i] - START[j], FIRST_SD);
    let kernel: Vec<f64> = (0..n * n).map(|e| step(e / n, e % n)).collect();
    let mut density: Vec<f64> = (0..n * n).map(|e| start(0, e / n) * start(1, e % n)).collect();
    let (mut out, mut log_evidence) = (vec![], 0.0);
    for frame in 0..frames {
        if frame > 0 {
            let dot = |row: &[f64], at: &dyn Fn(usize) -> f64| -> f64 {
                row.iter().enumerate().map(|(k, a)| a * at(k)).sum()
            };
            let rows: Vec<f64> =
                (0..n * n).map(|e| dot(&kernel[e / n * n..][..n], &|k| density[k * n + e % n])).collect();
            density = (0..n * n).map(|e| dot(&kernel[e % n * n..][..n], &|k| rows[e / n * n + k])).collect();
        }
        let poses: Vec<Vec<f64>> = (0..n * n).map(|e| pose(&[axis.nodes[e / n], axis.nodes[e % n]])).collect();
        density.iter_mut().zip(&poses).for_each(|(p, y)| *p *= seen(frame).log_density(y).exp());
        let mass = |e: usize| axis.weights[e / n] * axis.weights[e % n] * density[e];
        let total: f64 = (0..n * n).map(mass).sum();
        log_evidence += total.ln();
        density.iter_mut().for_each(|p| *p /= total);
        let mass = |e: usize| axis.weights[e / n] * axis.weights[e % n] * density[e];
        let expected = |f: &dyn Fn(&[f64]) -> f64| poses.iter().enumerate().map(|(e, y)| mass(e) * f(y)).sum::<f64>();
        let mean: Vec<f64> = (0..4).map(|k| expected(&|y| y[k])).collect();
        let variance = (0..4).map(|k| expected(&|y| (y[k] - mean[k]).powi(2))).collect();
        out.push(Exact { log_evidence, mean, variance });
    }
    out
}

/// Mean of numbers over its standard error.
fn score(numbers: &[f64]) -> f64 {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean / (variance / n).sqrt()
}

/// Means, variances and the evidence of three frames over 300 runs: 25 statistics at |z| < 4.5, false alarm 2e-4.
#[test]
fn the_bootstrap_filter_agrees_with_quadrature() {
    const RUNS: u64 = 300;
    let exact = exact(3);
    let mut errors = vec![vec![]; 3 * 8 + 1];
    for run in 0..RUNS {
        let made = Decoded::new(sheet(), &pose(&START), |start| {
            Bootstrap::new(bootstrap(4000), walk(Between::Mixture), start)
        });
        let (mut tracker, mut log_evidence) = (made.expect("valid"), 0.0);
        for (frame, exact) in (0..).zip(&exact) {
            let stage = Stage::new(run, "quadrature").at_frame(frame);
            log_evidence += tracker.step(&seen(frame), stage).expect("weights").log_evidence.expect("a filter");
            let found = tracker.posterior().moments(Isa::best());
            for k in 0..4 {
                let slot = 8 * frame as usize + 2 * k;
                errors[slot].push(found.mean[k] - exact.mean[k]);
                errors[slot + 1].push(found.covariance[5 * k] - exact.variance[k]);
            }
        }
        errors[24].push((log_evidence - exact[2].log_evidence).exp() - 1.0);
    }
    for (slot, errors) in errors.iter().enumerate() {
        let z = score(errors);
        assert!(z.abs() < 4.5, "statistic {slot}: z = {z}, bound 4.5, seeds 0 to 299");
    }
}

/// Means and variances of the first frame, from long chains: 2 × 8 statistics at |z| < 4.5, false alarm 1e-4.
#[test]
fn hmc_agrees_with_quadrature() {
    let exact = exact(1).remove(0);
    for geometry in [Geometry::Diagonal, Geometry::Dense] {
        let config = hmc_filter::Config { updates: 3000, ..chains(geometry) };
        let made = Decoded::new(sheet(), &pose(&START), |start| {
            HmcFilter::new(config, walk(Between::Gaussian), start, Isa::best())
        });
        let mut tracker = made.expect("valid");
        let info = tracker.step(&seen(0), Stage::new(3, "quadrature")).expect("a posterior");
        assert!(info.r_hat.is_some_and(|r| r < 1.01) && info.divergences == 0, "{info:?}");
        let posterior = tracker.posterior();
        let mut draws = vec![vec![0.0; 4]; posterior.count()];
        draws.iter_mut().enumerate().for_each(|(i, draw)| posterior.state(i, draw));
        for k in 0..4 {
            let check = |name: &str, exact: f64, value: &dyn Fn(f64) -> f64| {
                let chains: Vec<Vec<f64>> =
                    (0..16).map(|i| draws[i..].iter().step_by(16).map(|y| value(y[k])).collect()).collect();
                let n = draws.len() as f64;
                let mean = chains.iter().flatten().sum::<f64>() / n;
                let variance = chains.iter().flatten().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
                let z = (mean - exact) / (variance / effective_sample_size(&chains)).sqrt();
                assert!(z.abs() < 4.5, "{geometry:?}, {name} {k}: {mean} against {exact}, z = {z}, bound 4.5, seed 3");
            };
            check("mean", exact.mean[k], &|y| y);
            check("variance", exact.variance[k], &|y| (y - exact.mean[k]).powi(2));
        }
    }
}

fn normal(rng: &mut BlockRng, dim: usize) -> Vec<f64> {
    let mut out = vec![Block::ZERO; dim];
    rng.fill_normal(Isa::best(), &mut out);
    out.iter().map(|block| block.0[0]).collect()
}

/// A latent state of the first frame.
fn first_state(rng: &mut BlockRng) -> Vec<f64> {
    START.iter().zip(normal(rng, 2)).map(|(x, z)| x + FIRST_SD * z).collect()
}

/// Both latent coordinates, and what they decode to.
fn pose_functions() -> TestFunctions<'static> {
    let decoded = |k: usize| move |x: &[f64]| pose(&x[..2])[k];
    TestFunctions::moments(2).with("pose 0", decoded(0)).with("pose 1", decoded(1)).with("pose 3", decoded(3))
}

/// Trajectories keep the posterior of a latent state: exact starts by rejection, since the likelihood without its constant is at most 1. False alarm 1e-6.
#[test]
fn hmc_keeps_a_posterior_through_a_decoder() {
    let (likelihood, isa) = (observed(vec![0.8, 0.5, 0.3, 0.2]), Isa::best());
    let prior = Lanes { leaf: Quadratic { centre: START.to_vec(), precision: vec![FIRST_SD.powi(-2); 2] }, isa };
    let through = Through { target: likelihood, decoder: sheet() };
    let mut kernel = OneChain::new(Sum(&through, &prior), Hmc::new(0.35, &[4.0; 2], 4, 0.2, isa).expect("valid"));
    let draw = |rng: &mut BlockRng| loop {
        let x = first_state(rng);
        let mut uniform = [Block::ZERO];
        rng.fill_uniform(&mut uniform);
        if uniform[0].0[0].ln() < through.log_density(&x) {
            break x;
        }
    };
    let transition = |x: &[f64], rng: &mut BlockRng| {
        let mut state = x.to_vec();
        kernel.step(&mut state, rng);
        state
    };
    let config = ExactStart { starts: 20_000, steps: 2, seed: 2, ..ExactStart::default() };
    exact_start(&config, draw, transition, &pose_functions()).assert_holds();
}

/// Ranks of true poses among the draws of a first frame are uniform (simulation-based calibration). False alarm 1e-6 a tracker.
#[test]
fn posteriors_of_poses_are_calibrated() {
    type Make = fn() -> Box<dyn Steps>;
    let filter: Make = || {
        let made = |start| Bootstrap::new(bootstrap(2000), walk(Between::Mixture), start);
        Box::new(Decoded::new(sheet(), &pose(&START), made).expect("valid"))
    };
    let hmc: Make = || {
        let config = hmc_filter::Config { updates: 60, burn_in: 20, ..chains(Geometry::Dense) };
        let made = |start| HmcFilter::new(config, walk(Between::Gaussian), start, Isa::best());
        Box::new(Decoded::new(sheet(), &pose(&START), made).expect("valid"))
    };
    for make in [filter, hmc] {
        let simulate =
            |y: &[f64], rng: &mut BlockRng| y.iter().zip(normal(rng, 4)).map(|(y, z)| y + NOISE_SD * z).collect();
        let mut run = 0;
        let posterior = |z: &[f64], n: usize, rng: &mut BlockRng| -> Vec<Vec<f64>> {
            run += 1;
            let mut tracker = make();
            tracker.step(&observed(z.to_vec()), Stage::new(run, "calibration of poses")).expect("a posterior");
            let posterior = tracker.posterior();
            let state = |&index: &usize| {
                let mut draw = vec![0.0; 4];
                posterior.state(index, &mut draw);
                draw
            };
            multinomial(posterior.weights, n, rng).iter().map(state).collect()
        };
        let functions = TestFunctions::moments(4);
        let config = RankCalibration { data_sets: 1000, draws: 19, bins: 10, seed: 4, ..RankCalibration::default() };
        let (report, _) = calibration(&config, |rng| pose(&first_state(rng)), simulate, posterior, &functions);
        report.assert_holds();
    }
}
