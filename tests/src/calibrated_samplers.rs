//! Simulation-based calibration (J2) of the samplers on parts of CF28 seen by one camera. A search must fail it.

use crate::simulators::{PRIOR_SD, PartOfBody};
use crate::size::Size;
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::FramePrior;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::samplers::annealed_search::{self, search};
use sinew::samplers::chains::{self, Schedule};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::laplace::laplace;
use sinew::samplers::metric::Metric;
use sinew::samplers::particles::{self, Particles};
use sinew::samplers::population::Population;
use sinew::samplers::resample::multinomial;
use sinew::samplers::tempered_smc::{self, temper};
use sinew::tracking::Tracker;
use sinew::tracking::annealed::{self, Annealed};
use sinew_invariance::{RankCalibration, Ranks, Report, calibration};

/// A stage from a generator, for verbs that take one.
fn stage(rng: &mut BlockRng) -> Stage {
    Stage::new(rand_u64(rng), "posterior draws")
}

fn rand_u64(rng: &mut BlockRng) -> u64 {
    let mut two = [Block::ZERO];
    rng.fill_uniform(&mut two);
    (two[0].0[0] * 4_294_967_296.0) as u64 | ((two[0].0[1] * 4_294_967_296.0) as u64) << 32
}

fn check(
    seed: u64,
    data_sets: usize,
    body: &PartOfBody,
    posterior: impl FnMut(&[f64], usize, &mut BlockRng) -> Vec<Vec<f64>>,
) -> (Report, Ranks) {
    let config = RankCalibration { data_sets, seed, ..RankCalibration::default() };
    let simulate = |x: &[f64], rng: &mut BlockRng| body.simulate(x, rng);
    calibration(&config, |rng: &mut BlockRng| body.prior(rng), simulate, posterior, &body.functions())
}

/// Hamiltonian Monte Carlo on the lower body: eight chains from the prior, a Gauss–Newton metric at the mode, thinned by eight.
///
/// # Panics
/// When a chain cannot start, which would be a defect.
#[must_use]
pub fn hmc(seed: u64, size: Size) -> (Report, Ranks) {
    let body = PartOfBody::lower_body(0.01);
    let (d, prior) = (body.dim(), body.frame_prior());
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let target = body.posterior(y);
        let [to_find, to_start, to_run] = stage(rng).split(["mode", "start", "run"]);
        let metric = Metric::Dense(laplace(&target.0, &prior, 32, Isa::best(), to_find).expect("a mode").metric);
        let hmc = Hmc::with_metric(0.6, &metric, 4, 0.2, Isa::best()).expect("valid settings");
        let mut starts = vec![Block::ZERO; d];
        prior.sample_block(0, &mut starts, &mut to_start.block(0));
        let (burn_in, thin) = (60, 8);
        let updates = burn_in + n.div_ceil(LANES) * thin;
        let draws = chains::draw_trajectories(
            &target,
            &hmc,
            &starts,
            LANES,
            Schedule { updates, burn_in: burn_in + 1 },
            &to_run,
        );
        let states = draws.expect("starts of finite density").states;
        let state = |step: usize, lane: usize| states[step * d..][..d].iter().map(|b| b.0[lane]).collect::<Vec<f64>>();
        (0..n).map(|i| state(i / LANES * thin + thin - 1, i % LANES)).collect()
    };
    check(seed, size.pick(100, 2000), &body, posterior)
}

/// Tempered sequential Monte Carlo on the arm.
///
/// # Panics
/// When the run fails, which would be a defect.
#[must_use]
pub fn tempered(seed: u64, size: Size) -> (Report, Ranks) {
    let body = PartOfBody::arm(0.02);
    let prior = body.frame_prior();
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let likelihood = body.likelihood(y);
        let [to_find, to_run] = stage(rng).split(["mode", "run"]);
        let metric = Metric::Dense(laplace(&likelihood, &prior, 32, Isa::best(), to_find).expect("a mode").metric);
        let config = tempered_smc::Config { particles: 4 * n, updates: 8, ..tempered_smc::Config::default() };
        let sample = temper(&likelihood, &prior, &metric, &config, Isa::best(), to_run).expect("a posterior");
        let last = &sample.draws[config.updates - 1];
        (0..n).map(|i| last.state(4 * i)).collect()
    };
    check(seed, size.pick(100, 2000), &body, posterior)
}

/// One frame of the particle filter on the arm: particles from the prior, weighted, and as many as wanted chosen by weight.
///
/// # Panics
/// When all weights are zero, which would be a defect.
#[must_use]
pub fn particle_filter(seed: u64, size: Size) -> (Report, Ranks) {
    let body = PartOfBody::arm(0.02);
    let walk = RandomWalk::new(&vec![PRIOR_SD; body.dim()], 1.0, Between::Mixture, Isa::best()).expect("valid walk");
    let count = size.pick(5000, 20_000);
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let mut cloud = Particles::new(&body.centre(), count).expect("particles");
        particles::start(&mut cloud, &walk, &body.centre(), stage(rng));
        particles::reweight(&mut cloud, &body.likelihood(y)).expect("weights");
        let chosen = multinomial(cloud.weights(), n, rng);
        let state = |i: usize| {
            let block = &cloud.states()[i / LANES * body.dim()..][..body.dim()];
            block.iter().map(|b| b.0[i % LANES]).collect::<Vec<f64>>()
        };
        chosen.iter().map(|&i| state(i)).collect()
    };
    check(seed, size.pick(100, 2000), &body, posterior)
}

/// The annealed search on the arm, its last layer taken for a posterior: it is none.
///
/// # Panics
/// When all weights are zero.
#[must_use]
pub fn annealed(seed: u64, size: Size) -> (Report, Ranks) {
    let body = PartOfBody::arm(0.02);
    let prior = body.frame_prior();
    let sd = vec![PRIOR_SD; body.dim()];
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let [to_draw, to_search] = stage(rng).split(["draw", "search"]);
        let draw =
            |block: usize, states: &mut [Block]| prior.sample_block(block, states, &mut to_draw.block(block as u32));
        let start = Population::from_blocks(body.dim(), 4 * n, draw).expect("a population");
        let config = annealed_search::Config::default();
        let found = search(&body.posterior(y), &start, &sd, &config, Isa::best(), to_search).expect("weights");
        (0..n).map(|i| found.population.state(4 * i)).collect()
    };
    check(seed, size.pick(100, 500), &body, posterior)
}

/// One frame of the annealed filter on the arm, from the prior, its last layer taken for a posterior: it is none.
///
/// # Panics
/// When all weights are zero.
#[must_use]
pub fn annealed_filter(seed: u64, size: Size) -> (Report, Ranks) {
    let body = PartOfBody::arm(0.02);
    let sd = vec![PRIOR_SD; body.dim()];
    let walk = RandomWalk::new(&sd, 1.0, Between::Mixture, Isa::best()).expect("valid walk");
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let config = annealed::Config { particles: 4 * n, ..annealed::Config::default() };
        let tracker = Annealed::new(config, walk.clone(), sd.clone(), body.centre(), Isa::best());
        let mut tracker = tracker.expect("valid settings");
        tracker.step(&body.likelihood(y), stage(rng)).expect("weights");
        let particles = tracker.particles();
        multinomial(particles.weights(), n, rng).iter().map(|&i| particles.state(i)).collect()
    };
    check(seed, size.pick(100, 500), &body, posterior)
}
