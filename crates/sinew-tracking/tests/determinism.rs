//! Same bits for every number of threads, in one run or two halves; trackers in boxes; frames without observation.

mod common;

use common::Sight;
use sinew_core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_dynamics::level_walk::LevelWalk;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::annealed_search;
use sinew_samplers::grid::GridAxis;
use sinew_samplers::importance::Tails;
use sinew_samplers::levels::Selection;
use sinew_samplers::resample::Truncation;
use sinew_samplers::tuning;
use sinew_tracking::annealed::{self, Annealed};
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::coarse_to_fine::{self, CoarseToFine, Judging};
use sinew_tracking::guided::{self, Guided};
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::hppf::{self, Hppf};
use sinew_tracking::partitioned::{self, Partitioned};
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Error, Harness, Inferred, Resume, StepInfo, Tracker, run};

/// An observation that serves every tracker.
trait Seen: GaussNewton + PartLogDensity {}
impl<T: GaussNewton + PartLogDensity> Seen for T {}

/// A tracker whose state can be put down.
trait Both: Tracker<dyn Seen> + Resume {}
impl<T: Tracker<dyn Seen> + Resume> Both for T {}

type Boxed = Box<dyn Both>;
type Record = Vec<(StepInfo, Vec<Block>, Vec<f64>)>;

/// No observation: a density of 0 everywhere.
struct Nothing;
impl LogDensity for Nothing {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        0.0
    }
}
impl GradLogDensity for Nothing {
    fn log_density_grad(&self, _x: &[f64], grad: &mut [f64]) -> f64 {
        grad.fill(0.0);
        0.0
    }
}
impl GaussNewton for Nothing {
    fn gauss_newton_diagonal_block(&self, _x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        diagonal.fill(Block::ZERO);
    }
}

impl PartLogDensity for Nothing {
    fn parts(&self) -> usize {
        2
    }
    fn is_product(&self) -> bool {
        true
    }
    fn log_density_parts_block(&self, _parts: &[usize], _x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        out.fill(Block::ZERO);
    }
}

/// An observation that no state explains.
struct Impossible;
impl LogDensity for Impossible {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        f64::NEG_INFINITY
    }
}
impl PartLogDensity for Impossible {
    fn parts(&self) -> usize {
        2
    }
    fn log_density_parts_block(&self, _parts: &[usize], _x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        out.fill(Block::splat(f64::NEG_INFINITY));
    }
}

fn walk(between: Between) -> RandomWalk {
    RandomWalk::new(&[1.0, 0.5], 0.04, between, Isa::best()).expect("valid")
}

fn filter(between: Between) -> HmcFilter<RandomWalk> {
    let config = hmc_filter::Config {
        chains: 20,
        updates: 12,
        leapfrog_steps: 5,
        step_size: 0.6,
        jitter: 0.2,
        ..hmc_filter::Config::default()
    };
    HmcFilter::new(config, walk(between), vec![0.0, 1.0], Isa::best()).expect("valid")
}

fn guided(tails: Tails) -> Guided<RandomWalk> {
    let config = guided::Config { particles: 1003, tails, ..guided::Config::default() };
    Guided::new(config, walk(Between::Gaussian), vec![0.0, 1.0], Isa::best()).expect("valid")
}

fn tree() -> PartTree {
    let parts = [0, 1].map(|j| Part::new(vec![j], 2).expect("valid")).to_vec();
    PartTree::new(Partition::new(parts, 2).expect("covers"), vec![None, Some(0)]).expect("parents first")
}

fn annealed(layers: annealed_search::Config) -> Annealed<RandomWalk> {
    let config = annealed::Config { particles: 203, layers };
    Annealed::new(config, walk(Between::Mixture), vec![0.2, 0.1], vec![0.0, 1.0], Isa::best()).expect("valid")
}

fn partitioned(particles: usize) -> Partitioned<RandomWalk> {
    let config = partitioned::Config { particles, ..partitioned::Config::default() };
    Partitioned::new(config, walk(Between::Mixture), tree(), vec![0.0, 1.0]).expect("valid")
}

fn coarse_to_fine(config: coarse_to_fine::Config) -> CoarseToFine {
    let axes = vec![GridAxis::new(-2.0, 2.0, 0.15, false).expect("valid"); 2];
    CoarseToFine::new(config, axes, tree(), vec![0.0, 1.0], Isa::best()).expect("valid")
}

fn hppf(truncation: Truncation) -> Hppf<LevelWalk> {
    let selection = Selection { truncation, surviving: 0.8 };
    let config = hppf::Config { particles: 203, selection, ..hppf::Config::default() };
    let motion = LevelWalk::new(tree(), vec![0.2, 0.1], vec![0.2, 0.1], Isa::best()).expect("valid");
    Hppf::new(config, motion, &tree(), vec![0.0, 1.0]).expect("valid")
}

/// Trackers that claim a posterior, and how many: they come first.
const FILTERS: usize = 6;

fn trackers() -> Vec<Boxed> {
    let config = bootstrap::Config { particles: 1003, ..bootstrap::Config::default() };
    let adaptive = bootstrap::Config { resample_below: 0.5, ..config.clone() };
    let bootstrap = |config| Bootstrap::new(config, walk(Between::Mixture), vec![0.0, 1.0]).expect("valid");
    vec![
        Box::new(bootstrap(config)),
        Box::new(bootstrap(adaptive)),
        Box::new(filter(Between::Mixture)),
        Box::new(filter(Between::Gaussian)),
        Box::new(guided(Tails::Gaussian)),
        Box::new(partitioned(1003)),
        Box::new(annealed(annealed_search::Config::default())),
        Box::new(annealed(annealed_search::Config { adaptive: true, crossover: 0.5, layers: 4, ..Default::default() })),
        Box::new(coarse_to_fine(coarse_to_fine::Config::default())),
        Box::new(coarse_to_fine(coarse_to_fine::Config {
            snapped: false,
            judging: Judging::Whole,
            coarse: 51,
            fine: 43,
            drift: 0.5,
        })),
        Box::new(hppf(Truncation::KeepOnceRefill)),
        Box::new(hppf(Truncation::TruncateThenSystematic)),
    ]
}

/// A target that circles; every seventh frame is not seen.
fn observation(frame: u32) -> Box<dyn Seen> {
    if frame % 7 == 6 {
        return Box::new(Nothing);
    }
    let angle = f64::from(frame) * 0.1;
    Box::new(Sight::new(vec![angle.sin(), angle.cos()], vec![50.0, 200.0], true))
}

/// Shows the circling target and keeps all that comes out.
struct Circling<'a>(&'a mut Record);

impl Harness<dyn Seen> for Circling<'_> {
    type Bound = Box<dyn Seen>;
    type Noted = StepInfo;
    type Error = Error;
    fn observe(&mut self, frame: u32, _estimate: &[f64]) -> Result<Self::Bound, Error> {
        Ok(observation(frame))
    }
    fn note(&mut self, _: u32, info: StepInfo) -> Result<StepInfo, Error> {
        assert!(!info.restarted);
        Ok(info)
    }
    fn record(&mut self, info: StepInfo, posterior: Posterior<'_>) -> Result<(), Error> {
        self.0.push((info, posterior.states.to_vec(), posterior.weights.to_vec()));
        Ok(())
    }
}

fn follow(tracker: &mut Boxed, frames: std::ops::Range<u32>, record: &mut Record) {
    let stage = |frame| Stage::new(42, "determinism").at_frame(frame);
    run(tracker.as_mut(), frames, stage, &mut Circling(record)).expect("every frame has a posterior");
}

#[test]
fn threads_do_not_change_a_bit() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut record = Record::new();
            trackers().iter_mut().for_each(|tracker| follow(tracker, 0..15, &mut record));
            record
        })
    };
    let one = with_threads(1);
    assert!(one == with_threads(2) && one == with_threads(8) && one == with_threads(1));
}

/// 200 frames at once, in four parts, one by one, and in parts by ever new trackers that take the state of the one before up: in parts of 7, which end where nothing was seen, and of 5, which do not.
#[test]
fn parts_are_one_run() {
    const FRAMES: u32 = 200;
    for (i, mut whole) in trackers().into_iter().enumerate() {
        let mut one = Record::new();
        follow(&mut whole, 0..FRAMES, &mut one);
        for (length, is_new) in [(50, false), (1, false), (7, true), (5, true)] {
            let (mut tracker, mut parts) = (trackers().remove(i), Record::new());
            for first in (0..FRAMES).step_by(length as usize) {
                if is_new {
                    let saved = tracker.save();
                    tracker = trackers().remove(i);
                    tracker.restore(&saved).expect("the same settings");
                    assert!(tracker.save().iter().map(|x| x.to_bits()).eq(saved.iter().map(|x| x.to_bits())));
                }
                follow(&mut tracker, first..FRAMES.min(first + length), &mut parts);
            }
            assert!(one == parts, "tracker {i} in parts of {length}");
        }
    }
}

#[test]
fn numbers_of_another_tracker_are_refused() {
    for mut tracker in trackers() {
        let mut record = Record::new();
        follow(&mut tracker, 0..3, &mut record);
        let saved = tracker.save();
        for wrong in [&saved[1..], &[&saved[..], &[0.0]].concat(), &[]] {
            assert!(matches!(tracker.restore(wrong), Err(Error::Dimension { name: "saved state", .. })));
            assert_eq!(tracker.save().len(), saved.len());
        }
    }
}

#[test]
fn every_tracker_follows_and_reports() {
    for (i, mut tracker) in trackers().into_iter().enumerate() {
        let mut record = Record::new();
        follow(&mut tracker, 0..40, &mut record);
        let (info, states, _) = &record[39];
        let posterior_is_one = info.ess == 1.0 && states.len() == 2;
        let angle = 3.9_f64;
        assert!((info.mean[0] - angle.sin()).abs() < 0.2 && (info.mean[1] - angle.cos()).abs() < 0.2, "{info:?}");
        assert_eq!(tracker.estimate(), info.mean);
        assert!(
            (info.ess > 1.0 || posterior_is_one) && info.log_evidence.is_some_and(f64::is_finite) == (i < FILTERS),
            "{info:?}"
        );
        assert!(info.r_hat.is_none_or(|r| r < 1.2) && info.divergences == 0, "{info:?}");
        // A frame without observation says nothing of the evidence.
        assert!(record[34].0.log_evidence.is_some_and(|l| l.abs() < 1e-9) == (i < FILTERS));
    }
}

#[test]
fn a_refused_frame_leaves_a_tracker_of_particles_where_it_stood() {
    let stage = |frame| Stage::new(1, "refused").at_frame(frame);
    fn check<T: Tracker<Impossible> + Tracker<Sight> + Resume>(mut tracker: T, stage: impl Fn(u32) -> Stage) {
        let seen = || Sight::new(vec![0.1, 0.9], vec![4.0; 2], true);
        for frame in [0, 2] {
            let before = tracker.save();
            let refused = tracker.step(&Impossible, stage(frame));
            assert!(matches!(refused, Err(Error::Samplers(sinew_samplers::Error::AllWeightsZero { .. }))));
            assert_eq!(tracker.save(), before);
            tracker.step(&seen(), stage(frame + 1)).expect("continues");
            assert_ne!(tracker.save(), before);
        }
    }
    check(partitioned(100), stage);
    check(annealed(annealed_search::Config::default()), stage);
    check(coarse_to_fine(coarse_to_fine::Config::default()), stage);
    check(hppf(Truncation::KeepOnceRefill), stage);
}

/// Another dimension, or another number of parts.
#[test]
fn an_observation_of_another_shape_is_refused() {
    struct Wrong(usize);
    impl LogDensity for Wrong {
        fn dim(&self) -> usize {
            self.0
        }
        fn log_density(&self, _x: &[f64]) -> f64 {
            0.0
        }
    }
    impl PartLogDensity for Wrong {
        fn parts(&self) -> usize {
            3
        }
        fn log_density_parts_block(&self, _parts: &[usize], _x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
            out.fill(Block::ZERO);
        }
    }
    let refused = |mut tracker: Box<dyn Tracker<Wrong>>, observed: Wrong| {
        let error = tracker.step(&observed, Stage::new(1, "wrong")).expect_err("refused");
        matches!(error, Error::Dimension { found: 3, expected: 2, .. })
    };
    for dim in [2, 3] {
        assert!(refused(Box::new(partitioned(10)), Wrong(dim)));
        assert!(refused(Box::new(hppf(Truncation::KeepOnceRefill)), Wrong(dim)));
        assert!(refused(Box::new(coarse_to_fine(coarse_to_fine::Config::default())), Wrong(dim)));
    }
    assert!(refused(Box::new(annealed(annealed_search::Config::default())), Wrong(3)));
    assert!(annealed(Default::default()).with_validity(std::sync::Arc::new(Wrong(3))).is_err());
}

#[test]
fn without_observations_the_variance_grows_by_the_walk() {
    for between in [Between::Mixture, Between::Gaussian] {
        let mut tracker = filter(between);
        for frame in 0..100 {
            let info = tracker.step(&Nothing, Stage::new(3, "blind").at_frame(frame)).expect("continues");
            assert_eq!(info.log_evidence.map(|l| l.abs() < 1e-9), Some(true));
        }
        let variance = tracker.posterior().moments(Isa::best()).covariance[0];
        // 100 steps of 0.2²; the walk of the summary itself scatters, most with few chains.
        assert!((0.5..20.0).contains(&variance), "{between:?}: {variance} against 4");
    }
}

/// Shows nothing that can be.
struct Blinded;

impl Harness<Impossible> for Blinded {
    type Bound = Impossible;
    type Noted = ();
    type Error = Error;
    fn observe(&mut self, _frame: u32, _estimate: &[f64]) -> Result<Impossible, Error> {
        Ok(Impossible)
    }
    fn note(&mut self, _: u32, _: StepInfo) -> Result<(), Error> {
        Ok(())
    }
    fn record(&mut self, (): (), _: Posterior<'_>) -> Result<(), Error> {
        Ok(())
    }
}

#[test]
fn an_impossible_frame_is_an_error_and_can_be_passed_over() {
    let config = bootstrap::Config { particles: 100, ..bootstrap::Config::default() };
    let make = || Bootstrap::new(config.clone(), walk(Between::Mixture), vec![0.0, 1.0]).expect("valid");
    let mut tracker = make();
    let stage = |frame| Stage::new(1, "impossible").at_frame(frame);
    for first in [true, false] {
        let refused = tracker.step(&Impossible, stage(0));
        assert!(matches!(refused, Err(Error::Samplers(sinew_samplers::Error::AllWeightsZero { count: 100 }))));
        if first {
            tracker.step(&Nothing, stage(1)).expect("continues");
        }
    }
    let spread = tracker.posterior().moments(Isa::best()).covariance[0];
    assert!((0.02..0.07).contains(&spread), "one step of variance 0.04, not two: {spread}");
    let mut walked: Box<dyn Tracker<Impossible>> = Box::new(make());
    let result = run(walked.as_mut(), 5..9, stage, &mut Blinded);
    assert!(matches!(result, Err(Error::Frame { frame: 5, .. })));
}

#[test]
fn tuning_gives_settings_that_accept_as_asked() {
    let filter = filter(Between::Gaussian);
    let config = tuning::Config { jitter: 0.2, lengths: vec![1, 2, 5, 10], ..tuning::Config::default() };
    let observed = observation(0);
    let tuned = filter.tune(observed.as_ref(), &config, Stage::new(1, "tune")).expect("tunable");
    assert!((tuned.acceptance - 0.85).abs() <= 0.03 && tuned.leapfrog_steps <= 5, "{tuned:?}");
}

/// Chains that hardly move disagree, and only the patient filter continues, first to twice the updates; with steps that mix neither does.
#[test]
fn chains_that_disagree_continue() {
    let run = |patience, step_size, updates| {
        let config = hmc_filter::Config {
            chains: 16,
            updates,
            leapfrog_steps: 5,
            step_size,
            patience,
            ..hmc_filter::Config::default()
        };
        let mut tracker = HmcFilter::new(config, walk(Between::Gaussian), vec![0.0, 1.0], Isa::best()).expect("valid");
        let seen = Lanes { leaf: Quadratic { centre: vec![0.1, 0.9], precision: vec![4.0; 2] }, isa: Isa::best() };
        let info = tracker.step(&seen, Stage::new(5, "patience")).expect("step");
        (info.trajectories, tracker.posterior().weights.len(), info.gradient_evaluations)
    };
    assert_eq!(run(1, 0.01, 12), (16 * 12, 16 * 7, 16 * (1 + 5 * 12) + 64));
    assert_eq!(run(2, 0.01, 12), (16 * 24, 16 * 13, 16 * (2 + 5 * 24) + 64));
    assert_eq!(run(3, 0.01, 12), (16 * 36, 16 * 19, 16 * (3 + 5 * 36) + 64));
    assert_eq!(run(3, 0.3, 120).0, 16 * 120);
}

/// Chains that continue move by other random numbers than before: by as good as the same forces from other places, their later steps have nothing to do with the first.
#[test]
fn continued_chains_do_not_repeat_their_steps() {
    const CHAINS: usize = 16;
    let draws = |patience| {
        let config = hmc_filter::Config {
            chains: CHAINS,
            updates: 24,
            burn_in: 1,
            leapfrog_steps: 5,
            step_size: 0.001,
            patience,
            ..hmc_filter::Config::default()
        };
        let mut tracker = HmcFilter::new(config, walk(Between::Gaussian), vec![0.0, 1.0], Isa::best()).expect("valid");
        let seen = Lanes { leaf: Quadratic { centre: vec![0.1, 0.9], precision: vec![4.0; 2] }, isa: Isa::best() };
        tracker.step(&seen, Stage::new(8, "patience")).expect("step");
        let posterior = tracker.posterior();
        let state = |index: usize| {
            let mut state = [0.0; 2];
            posterior.state(index, &mut state);
            state
        };
        (0..posterior.weights.len()).map(state).collect::<Vec<_>>()
    };
    let steps = |draws: &[[f64; 2]], first: usize, count: usize| -> Vec<f64> {
        let step = |index: usize| [0, 1].map(|k| draws[index + CHAINS][k] - draws[index][k]);
        (first * CHAINS..(first + count) * CHAINS).flat_map(step).collect()
    };
    let [once, again] = [draws(1), draws(2)];
    assert!(again.len() > once.len());
    let correlation = |a: &[f64], b: &[f64]| {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        product(a, b) / (product(a, a) * product(b, b)).sqrt()
    };
    let count = 18;
    let first_steps = steps(&once, 1, count);
    // Two samples are discarded rather than one.
    assert_eq!(first_steps, steps(&again, 0, count));
    // The 25th update is the step from draw 22 on: whichever of the first is the same, none is repeated. Five standard errors.
    let bound = 5.0 / (first_steps.len() as f64).sqrt();
    for shift in 20..28 {
        let found = correlation(&first_steps, &steps(&again, shift, count));
        assert!(found.abs() < bound, "shift {shift}: {found}");
    }
}
