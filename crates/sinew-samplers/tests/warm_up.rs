//! The warm-up from scattered starts: where chains arrive, what metric and step size they leave.

use rayon::ThreadPoolBuilder;
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_samplers::Error;
use sinew_samplers::chains::Schedule;
use sinew_samplers::metric::Metric;
use sinew_samplers::nuts::{self, Nuts};
use sinew_samplers::starts::uniform_starts;
use sinew_samplers::tuning::{self, StepSizeTrial};
use sinew_samplers::warm_up::{Config, WarmedUp, warm_up};

const CHAINS: usize = 2 * LANES;

/// Counts 3, 30 and 300 with the logarithms of their rates as coordinates: Σ k x − exp x.
struct Counts;
const SEEN: [f64; 3] = [3.0, 30.0, 300.0];
impl LogDensity for Counts {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        SEEN.iter().zip(x).map(|(k, x)| k * x - x.exp()).sum()
    }
}
impl GradLogDensity for Counts {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.iter_mut().zip(SEEN).zip(x).for_each(|((g, k), x)| *g = k - x.exp());
        self.log_density(x)
    }
}

/// Four of sixteen chains start where the log density is −10³⁹.
fn far_starts() -> Vec<Block> {
    let mut starts = uniform_starts(&Counts, 2.0, CHAINS, &Stage::new(1, "starts")).expect("finite");
    for lane in [1, 4] {
        (starts[0].0[lane], starts[5].0[lane]) = (90.0, 90.0);
    }
    starts
}

fn warmed(starts: &[Block]) -> WarmedUp {
    warm_up(&Counts, starts, CHAINS, &Config::default(), Isa::best(), &Stage::new(2, "warm up")).expect("warms up")
}

/// exp x is a gamma variable: the mean of x is digamma(k), near ln (k − ½), and its variance is near 1 / (k − ½).
#[test]
fn chains_from_far_tails_arrive_with_the_others() {
    let starts = far_starts();
    // One step size for all chains cannot accept 0.8 of the trajectories while a quarter of the chains accepts none.
    let metric = Metric::Diagonal(vec![1.0; 3]);
    let mut trial = StepSizeTrial { target: &Counts, metric: &metric, states: starts.clone(), isa: Isa::best() };
    let common = tuning::step_size(&mut trial, 3, &tuning::Config::default(), &Stage::new(3, "common"));
    assert!(matches!(common, Err(Error::StepSizeNotFound { .. })), "{common:?}");

    let WarmedUp { metric, states, step_size, .. } = warmed(&starts);
    let nuts = Nuts::with_metric(step_size, &metric, 10, 0.0, Isa::best()).expect("valid");
    let schedule = Schedule { updates: 400, burn_in: 1 };
    let run = nuts::draw_trees(&Counts, &nuts, &states, CHAINS, schedule, &Stage::new(4, "draw")).expect("finite");
    assert!((run.draws.acceptance - 0.8).abs() < 0.1, "{}", run.draws.acceptance);
    let quality = run.draws.quality(&SEEN.map(|k| (k - 0.5).ln()));
    assert!(quality.r_hat < 1.01 && run.draws.divergences == 0, "{quality:?}");
    for (j, k) in SEEN.into_iter().enumerate() {
        let all: Vec<f64> = run.draws.series(j).concat();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / all.len() as f64;
        let sd = (1.0 / (k - 0.5)).sqrt();
        assert!((mean - (k - 0.5).ln()).abs() < 0.15 * sd, "coordinate {j}: mean {mean}");
        assert!((variance.sqrt() / sd - 1.0).abs() < 0.15, "coordinate {j}: sd {}", variance.sqrt());
    }
}

#[test]
fn a_warm_up_is_the_same_for_every_number_of_threads() {
    let starts = far_starts();
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| warmed(&starts))
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn metric_and_step_size_on_a_gaussian_do_not_depend_on_the_units() {
    let step_size = |scale: f64| {
        let precision: Vec<f64> = (0..6).map(|j| 10.0_f64.powi(j - 3) / (scale * scale)).collect();
        let leaf = Quadratic { centre: vec![0.3; 6], precision };
        let target = Lanes { leaf, isa: Isa::best() };
        let starts = uniform_starts(&target, 2.0, CHAINS, &Stage::new(5, "starts")).expect("finite");
        let stage = Stage::new(6, "warm up");
        warm_up(&target, &starts, CHAINS, &Config::default(), Isa::best(), &stage).expect("warms up").step_size
    };
    let (narrow, wide) = (step_size(0.01), step_size(10.0));
    assert!((narrow / wide - 1.0).abs() < 0.2 && (0.4..1.5).contains(&narrow), "{narrow} {wide}");
}

/// A standard normal right of a wall.
struct Corner(f64);
impl LogDensity for Corner {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x[0] > self.0 { -0.5 * x[0] * x[0] } else { f64::NEG_INFINITY }
    }
}
impl GradLogDensity for Corner {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = -x[0];
        self.log_density(x)
    }
}

#[test]
fn starts_without_a_density_are_drawn_again() {
    let starts = uniform_starts(&Corner(1.5), 2.0, 11, &Stage::new(7, "corner")).expect("some have a density");
    assert_eq!(starts.len(), 2);
    assert!(starts.iter().flat_map(|b| b.0).all(|x| (1.5..2.0).contains(&x)), "{starts:?}");
    let none = uniform_starts(&Corner(2.5), 2.0, 11, &Stage::new(7, "nowhere"));
    assert!(matches!(none, Err(Error::BadStart { value: f64::NEG_INFINITY, .. })), "{none:?}");
    assert!(matches!(uniform_starts(&Corner(0.0), 2.0, 0, &Stage::new(7, "none")), Err(Error::Empty { .. })));
    let spread = uniform_starts(&Corner(-9.0), 3.0, 800, &Stage::new(8, "spread")).expect("finite");
    let square = spread.iter().flat_map(|b| b.0).map(|x| x * x).sum::<f64>() / 800.0;
    assert!((square - 3.0).abs() < 0.5, "{square}");
}
