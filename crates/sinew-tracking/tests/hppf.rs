//! The hierarchical partitioned particle filter on targets that are known.

use sinew_core::density::{Global, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_dynamics::joint_ranges::JointRanges;
use sinew_dynamics::level_walk::LevelWalk;
use sinew_samplers::levels::Selection;
use sinew_samplers::resample::Truncation;
use sinew_tracking::hppf::{Config, Hppf};
use sinew_tracking::{Error, Resume as _, Tracker};

const DIM: usize = 12;

/// A trunk of two coordinates, five limbs on it, and on two of these another one: three levels.
fn tree() -> PartTree {
    let parts = [vec![0, 1], vec![2, 3], vec![4], vec![5], vec![6, 7], vec![8], vec![9, 10], vec![11]];
    let parts = parts.into_iter().map(|part| Part::new(part, DIM).expect("valid")).collect();
    let parents = [None, Some(0), Some(0), Some(0), Some(0), Some(0), Some(1), Some(2)];
    PartTree::new(Partition::new(parts, DIM).expect("covers"), parents.to_vec()).expect("parents first")
}

fn tracker(particles: usize, truncation: Truncation) -> Hppf<LevelWalk> {
    let walk = LevelWalk::new(tree(), vec![0.1; DIM], vec![0.1; DIM], Isa::best()).expect("valid");
    let config = Config { particles, selection: Selection { truncation, surviving: 0.8 }, ..Config::default() };
    Hppf::new(config, walk, &tree(), vec![0.0; DIM]).expect("valid")
}

/// A Gaussian about a target, the factor of each part about its own coordinates. Where the first coordinate is beyond `edge`, nothing is met, and the global likelihood is the largest.
struct Target {
    at: Vec<f64>,
    edge: f64,
}

impl Target {
    fn part(&self, part: usize, x: &[Block]) -> Block {
        let square = |lane: usize| {
            let indices = tree().partition().parts()[part].indices().to_vec();
            indices.iter().map(|&j| ((x[j].0[lane] - self.at[j]) / 0.1).powi(2)).sum::<f64>()
        };
        Block(core::array::from_fn(|lane| -0.5 * square(lane)))
    }
}

impl LogDensity for Target {
    fn dim(&self) -> usize {
        DIM
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.at).map(|(x, at)| -0.5 * ((x - at) / 0.1).powi(2)).sum()
    }
}

impl PartLogDensity for Target {
    fn parts(&self) -> usize {
        8
    }
    fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
        let likelihood = self.log_density_block(x, ws);
        let (mut log_likelihood, mut met) = (likelihood, Block::splat(1.0));
        for lane in 0..8 {
            if x[0].0[lane] > self.edge {
                (log_likelihood.0[lane], met.0[lane]) = (0.0, 0.0);
            }
        }
        Global { log_likelihood, met }
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        for (&part, out) in parts.iter().zip(out) {
            *out = self.part(part, x);
        }
    }
}

fn at(frame: u32) -> Vec<f64> {
    (0..DIM).map(|j| 0.8 * (0.05 * f64::from(frame) + 0.3 * j as f64).sin() - 0.8 * (0.3 * j as f64).sin()).collect()
}

/// A target that moves by 0.04 a frame is followed in all coordinates, with either reading of survival; counted are the parts of the levels: 1, 5 + 1 and 2 + 6.
#[test]
fn a_moving_target_is_followed() {
    for truncation in [Truncation::KeepOnceRefill, Truncation::TruncateThenSystematic] {
        let mut tracker = tracker(200, truncation);
        for frame in 0..60 {
            let stage = Stage::new(1, "follow").at_frame(frame);
            let target = Target { at: at(frame), edge: f64::INFINITY };
            let info = tracker.step(&target, stage).expect("weights");
            assert_eq!((info.likelihood_evaluations, info.part_evaluations), (200, 15 * 200));
            assert_eq!((info.survivors.len(), info.resampled), (1 + 6 + 3 + 1, Some(frame > 0)));
            assert_eq!(info.choices, vec![[(0, 1.0)]; 8], "a random walk moves all parts");
            assert!(info.survivors.iter().all(|d| (1.0..=200.0 + 1e-9).contains(d)), "{:?}", info.survivors);
            let worst = info.mean.iter().zip(&target.at).map(|(x, at)| (x - at).abs()).fold(0.0, f64::max);
            assert!(frame < 5 || worst < 0.25, "{truncation:?}, frame {frame}: {worst}");
            let found = tracker.found().expect("a frame");
            assert!(found.similar.contains(&found.mode) && found.mean == info.mean && found.astray == 0);
        }
    }
}

/// Where only whole bodies are compared, the weights of one frame decide in the next who moves on: the particles drift to the target.
#[test]
fn whole_particles_are_resampled_by_the_last_frame() {
    struct Whole(Target);
    impl LogDensity for Whole {
        fn dim(&self) -> usize {
            DIM
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            self.0.log_density(x)
        }
    }
    impl PartLogDensity for Whole {
        fn parts(&self) -> usize {
            8
        }
        fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
            self.0.global_block(x, ws)
        }
        fn log_density_parts_block(&self, _: &[usize], _: &[Block], out: &mut [Block], _: &mut [Block]) {
            out.fill(Block::ZERO);
        }
    }
    let (mut tracker, mut at) = (tracker(400, Truncation::KeepOnceRefill), vec![0.0; DIM]);
    at[0] = 1.0;
    let target = Whole(Target { at, edge: f64::INFINITY });
    for frame in 0..40 {
        tracker.step(&target, Stage::new(5, "whole").at_frame(frame)).expect("weights");
    }
    let particles = tracker.particles();
    let mean = (0..400).map(|i| particles.state(i)[0]).sum::<f64>() / 400.0;
    assert!((mean - 1.0).abs() < 0.3, "{mean} for 1");
}

/// The trap of the global likelihood: particles that meet nothing are the heaviest, and are never the mode.
#[test]
fn particles_that_meet_nothing_are_not_the_mode() {
    let mut tracker = tracker(200, Truncation::KeepOnceRefill);
    let mut strayed = 0;
    for frame in 0..20 {
        let target = Target { at: vec![0.0; DIM], edge: 0.15 };
        let info = tracker.step(&target, Stage::new(2, "trap").at_frame(frame)).expect("weights");
        let found = tracker.found().expect("a frame");
        strayed += found.astray;
        assert!(tracker.particles().state(found.mode)[0] <= 0.15 && info.mean[0] < 0.45, "{:?}", info.mean);
    }
    assert!(strayed > 20, "{strayed} met nothing");
}

/// What ψ finds implausible is left out: the target lies beyond the range of a coordinate.
#[test]
fn ranges_hold_the_estimate() {
    let mut ranges = vec![None; DIM];
    ranges[4] = Some([-0.1, 0.1]);
    let walk = LevelWalk::new(tree(), vec![0.1; DIM], vec![0.1; DIM], Isa::best()).expect("valid");
    let held = walk.with_ranges(JointRanges::new(ranges).expect("valid")).expect("of its size");
    let config = Config { particles: 500, ..Config::default() };
    let mut held = Hppf::new(config, held, &tree(), vec![0.0; DIM]).expect("valid");
    let mut free = tracker(500, Truncation::KeepOnceRefill);
    let mut target = Target { at: vec![0.0; DIM], edge: f64::INFINITY };
    target.at[4] = 0.35;
    let mut last = [0.0; 2];
    for frame in 0..20 {
        let stage = || Stage::new(3, "ranges").at_frame(frame);
        last = [held.step(&target, stage()), free.step(&target, stage())].map(|info| info.expect("weights").mean[4]);
    }
    // 1 / 0.1 a radian against the Gaussian's (0.35 − x) / 0.01: balance at 0.25.
    assert!(last[0] < 0.32 && last[1] > 0.25 && last[0] < last[1], "{last:?}");
}

/// A resumed tracker continues to the same bits; so does its motion's memory.
#[test]
fn it_resumes_bit_for_bit() {
    let step = |tracker: &mut Hppf<LevelWalk>, frame| {
        let target = Target { at: at(frame), edge: f64::INFINITY };
        tracker.step(&target, Stage::new(4, "resume").at_frame(frame)).expect("weights")
    };
    let mut whole = tracker(61, Truncation::KeepOnceRefill);
    for frame in 0..7 {
        step(&mut whole, frame);
    }
    let mut other = tracker(61, Truncation::KeepOnceRefill);
    other.restore(&whole.save()).expect("of the same settings");
    for frame in 7..12 {
        assert_eq!(step(&mut whole, frame), step(&mut other, frame));
        assert_eq!(whole.particles().states(), other.particles().states());
    }
}

#[test]
fn settings_are_checked() {
    let make = |surviving: f64, particles: usize, dim: usize| {
        let walk = LevelWalk::new(tree(), vec![0.1; DIM], vec![0.1; DIM], Isa::best()).expect("valid");
        let config = Config { particles, selection: Selection { surviving, ..Selection::default() }, width: 3.0 };
        Hppf::new(config, walk, &tree(), vec![0.0; dim]).err()
    };
    assert!(make(0.8, 10, DIM).is_none());
    for surviving in [0.0, 1.1, f64::NAN] {
        assert!(matches!(make(surviving, 10, DIM), Some(Error::Config { .. })));
    }
    assert!(matches!(make(0.8, 10, DIM + 1), Some(Error::Dimension { .. })));
    assert!(matches!(make(0.8, 0, DIM), Some(Error::Samplers(_))));
}
