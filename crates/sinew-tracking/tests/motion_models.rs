//! Motion models that follow the estimates, in every tracker.
//! Each calls them alike, resumes them to the bit, and stores nothing for a model that remembers nothing.

mod common;

use common::Sight;
use core::ops::Range;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::{Cloud, MotionModel, PartTransition, Predict, Transition};
use sinew_dynamics::first_order::FirstOrder;
use sinew_dynamics::prior::Prior;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_tracking::annealed::{self, Annealed};
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::partitioned::{self, Partitioned};
use sinew_tracking::{Resume, StepInfo, Tracker};

const START: [f64; 2] = [0.0, 1.0];
const PARTICLES: usize = 203;
const CHAINS: usize = 10;

/// A target that circles ever faster.
fn seen(frame: u32) -> Sight {
    let angle = 0.01 * f64::from(frame * frame);
    Sight::new(vec![angle.sin(), angle.cos()], vec![50.0, 200.0], false)
}

fn stage(frame: u32) -> Stage {
    Stage::new(8, "motion models").at_frame(frame)
}

fn walk(sd: f64) -> RandomWalk {
    RandomWalk::new(&[sd; 2], 1.0, Between::Gaussian, Isa::best()).expect("valid")
}

fn first_order() -> FirstOrder<RandomWalk> {
    FirstOrder::new(walk(0.1), 0.7).expect("finite")
}

/// A slow and a fast walk: the fast one where the last three estimates moved far.
#[derive(Clone, Debug)]
struct Switch {
    walks: [RandomWalk; 2],
    moved: [f64; 3],
}

impl Switch {
    fn new() -> Self {
        Self { walks: [walk(0.05), walk(0.4)], moved: [0.0; 3] }
    }

    fn walk(&self) -> &RandomWalk {
        &self.walks[usize::from(self.moved.iter().sum::<f64>() > 0.15)]
    }
}

impl MotionModel for Switch {
    fn dim(&self) -> usize {
        2
    }
    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        let change = |before: &[f64]| before.iter().zip(estimate).map(|(from, to)| (to - from).abs()).sum();
        self.moved.rotate_left(1);
        self.moved[2] = before.map_or(0.0, change);
    }
    fn memory(&self) -> Vec<f64> {
        self.moved.to_vec()
    }
    fn recall(&mut self, memory: &[f64]) {
        self.moved.copy_from_slice(memory);
    }
}

impl Transition for Switch {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        self.walk().sample_block(previous, next, rng);
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        self.walk().log_density(previous, next)
    }
}

impl PartTransition for Switch {
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng) {
        self.walk().sample_part_block(part, next, rng);
    }
}

impl Predict for Switch {
    type Prior = Prior;
    type Error = sinew_dynamics::Error;
    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Self::Error> {
        self.walk().predict(cloud)
    }
    fn initial(&self, centre: &[f64]) -> Result<Prior, Self::Error> {
        self.walk().initial(centre)
    }
}

trait Steps: Tracker<Sight> + Resume {}
impl<T: Tracker<Sight> + Resume> Steps for T {}

/// Every tracker that takes a motion model, over one.
fn trackers<T>(model: T) -> Vec<(&'static str, Box<dyn Steps>)>
where
    T: PartTransition + Predict + Clone + Send + 'static,
{
    let start = START.to_vec();
    let parts = [0, 1].map(|j| Part::new(vec![j], 2).expect("valid")).to_vec();
    let tree = PartTree::new(Partition::new(parts, 2).expect("covers"), vec![None, None]).expect("parents first");
    let bootstrap = bootstrap::Config { particles: PARTICLES, ..Default::default() };
    let annealed = annealed::Config { particles: PARTICLES, ..annealed::Config::balan() };
    let partitioned = partitioned::Config { particles: PARTICLES, ..Default::default() };
    let hmc = hmc_filter::Config { chains: CHAINS, updates: 8, leapfrog_steps: 4, burn_in: 2, ..Default::default() };
    vec![
        ("bootstrap", Box::new(Bootstrap::new(bootstrap, model.clone(), start.clone()).expect("valid"))),
        (
            "annealed",
            Box::new(Annealed::new(annealed, model.clone(), vec![0.1; 2], start.clone(), Isa::best()).expect("valid")),
        ),
        ("partitioned", Box::new(Partitioned::new(partitioned, model.clone(), tree, start.clone()).expect("valid"))),
        ("hmc", Box::new(HmcFilter::new(hmc, model, start, Isa::best()).expect("valid"))),
    ]
}

/// The coarse-to-fine paper's CONDENSATION, by a filter that is made again for each frame with a walk that drifts by a constant, and by one that owns a first-order model.
#[test]
fn a_first_order_filter_is_one_made_again_in_every_frame() {
    struct Drifting {
        walk: RandomWalk,
        drift: [f64; 2],
    }
    impl MotionModel for Drifting {
        fn dim(&self) -> usize {
            2
        }
    }
    impl Transition for Drifting {
        fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
            self.walk.sample_block(previous, next, rng);
            for (next, drift) in next.iter_mut().zip(&self.drift) {
                next.0.iter_mut().for_each(|x| *x += drift);
            }
        }
        fn log_density(&self, _previous: &[f64], _next: &[f64]) -> f64 {
            unreachable!("a bootstrap filter samples only")
        }
    }
    let part = 0.2;
    let config = bootstrap::Config { particles: PARTICLES, ..Default::default() };
    let made = |drift| Bootstrap::new(config.clone(), Drifting { walk: walk(0.1), drift }, START.to_vec());
    let mut old = made([0.0; 2]).expect("valid");
    let model = FirstOrder::new(walk(0.1), part).expect("finite");
    let mut new = Bootstrap::new(config.clone(), model, START.to_vec()).expect("valid");
    let mut before: Option<Vec<f64>> = None;
    for frame in 0..20 {
        let expected = old.step(&seen(frame), stage(frame)).expect("weights");
        let found = new.step(&seen(frame), stage(frame)).expect("weights");
        assert_eq!(found, expected, "frame {frame}");
        assert_eq!(new.particles().states(), old.particles().states(), "frame {frame}");
        let change = |j: usize| before.as_ref().map_or(0.0, |before| part * (expected.mean[j] - before[j]));
        let saved = old.save();
        old = made([change(0), change(1)]).expect("valid");
        old.restore(&saved).expect("the same settings");
        before = Some(expected.mean);
    }
}

/// Steps up to a frame, and what came out from another one on.
fn record(tracker: &mut dyn Steps, frames: Range<u32>) -> Vec<(StepInfo, Vec<Block>)> {
    let step = |frame| {
        let info = tracker.step(&seen(frame), stage(frame)).expect("a posterior");
        (info, tracker.posterior().states.to_vec())
    };
    frames.map(step).collect()
}

/// Every tracker, stopped after each frame, continues to the same bits with the memory of its model, and to others without.
#[test]
fn what_a_model_remembers_is_resumed() {
    fn check<T: PartTransition + Predict + Clone + Send + 'static>(model: &T, memory: usize) {
        for (i, (name, mut whole)) in trackers(model.clone()).into_iter().enumerate() {
            let frames = 12;
            let mut differs = false;
            let mut rest = record(&mut *whole, 0..frames);
            let (_, mut stopped) = trackers(model.clone()).swap_remove(i);
            for frame in 0..frames {
                let mut other = trackers(model.clone()).swap_remove(i).1;
                let saved = stopped.save();
                other.restore(&saved).expect("the same settings");
                assert_eq!(other.save(), saved, "{name}, frame {frame}");
                assert_eq!(record(&mut *other, frame..frames), rest, "{name} stopped before frame {frame}");
                let mut forgetful = saved;
                let length = forgetful.len();
                forgetful[length - memory..].fill(0.0);
                other.restore(&forgetful).expect("the same settings");
                differs |= record(&mut *other, frame..frames) != rest;
                record(&mut *stopped, frame..frame + 1);
                rest.remove(0);
            }
            assert!(differs, "{name}: the memory matters");
        }
    }
    check(&first_order(), 2);
    check(&Switch::new(), 3);
}

/// The numbers of checkpoints that exist: whether begun, estimate, log weights, weights, states; of chains the estimate, moments and last states.
#[test]
fn a_model_without_memory_adds_nothing_to_what_is_saved() {
    let blocks = PARTICLES.div_ceil(LANES) * 2 * LANES;
    for ((name, mut plain), (_, mut drifting)) in trackers(walk(0.1)).into_iter().zip(trackers(first_order())) {
        let (start, lengths) = match name {
            "hmc" => (0, [2, 2 + 2 + 4 + 1 + CHAINS.div_ceil(LANES) * 2 * LANES]),
            _ => (1, [1 + 2 + 2 * PARTICLES + blocks; 2]),
        };
        for (frame, length) in (0..).zip(lengths) {
            let saved = plain.save();
            assert_eq!(saved.len(), length, "{name}");
            assert_eq!(drifting.save().len(), length + 2, "{name}");
            assert_eq!(&saved[start..start + 2], plain.estimate(), "{name}");
            if name != "hmc" {
                assert_eq!(saved[0], f64::from(frame), "{name}");
                let posterior = plain.posterior();
                let [logs, weights] = [3, 3 + PARTICLES].map(|first| &saved[first..first + PARTICLES]);
                assert_eq!(weights, posterior.weights);
                assert!(logs.iter().zip(weights).all(|(log, weight)| (log.exp() - weight).abs() < 1e-14));
                let states = saved[3 + 2 * PARTICLES..].chunks(LANES);
                assert!(states.eq(posterior.states.iter().map(|block| &block.0[..])), "{name}");
            }
            record(&mut *plain, frame..frame + 1);
            record(&mut *drifting, frame..frame + 1);
        }
    }
}
