//! Hamiltonian Monte Carlo that starts from exact draws leaves draws of the same target.
//! So in every number of updates, with every metric. No burn-in, and no autocorrelation to estimate.
//!
//! Statistics are paired: the mean over chains of h(x') − h(x) against its own standard error, |z| < 4.5 for each (a false alarm in 1.5e5), fixed seeds.

use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::kernel::MarkovKernel;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_samplers::chains::{ChainDraws, Schedule, draw_trajectories};
use sinew_samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew_samplers::metric::{Dense, Metric};
use sinew_samplers::one_chain::OneChain;

/// Test functions of a state.
type OfOne = fn(f64) -> f64;
type OfTwo = fn(f64, f64) -> f64;

/// x₀ = 4 + 1.5 z₀, x₁ = z₁ + 0.5 (z₀² − 1): skewed, bent, and beyond π in its first coordinate.
struct Bent;

impl LogDensity for Bent {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 2])
    }
}

impl GradLogDensity for Bent {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let z = (x[0] - 4.0) / 1.5;
        let off = x[1] - 0.5 * (z * z - 1.0);
        grad[0] = (off * z - z) / 1.5;
        grad[1] = -off;
        -0.5 * (z * z + off * off)
    }
}

fn normals(blocks: usize, stage: Stage) -> Vec<Block> {
    let mut noise = vec![Block::ZERO; blocks];
    stage.whole().fill_normal(Isa::baseline(), &mut noise);
    noise
}

fn bent_draws(blocks: usize, stage: Stage) -> Vec<Block> {
    let mut states = normals(2 * blocks, stage);
    for state in states.chunks_exact_mut(2) {
        for lane in 0..LANES {
            let z = state[0].0[lane];
            state[0].0[lane] = 4.0 + 1.5 * z;
            state[1].0[lane] += 0.5 * (z * z - 1.0);
        }
    }
    states
}

/// One coordinate of every state.
fn coordinate(states: &[Block], dim: usize, j: usize) -> Vec<f64> {
    states.iter().skip(j).step_by(dim).flat_map(|b| b.0).collect()
}

fn check_paired(what: &str, before: &[f64], after: &[f64]) {
    let n = before.len() as f64;
    let change: Vec<f64> = before.iter().zip(after).map(|(b, a)| a - b).collect();
    let mean = change.iter().sum::<f64>() / n;
    let variance = change.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / n;
    let z = mean / (variance / n).sqrt();
    assert!(variance > 0.0 && z.abs() < 4.5, "{what}: changed by {mean}, z = {z}, bound 4.5");
}

/// Means, squares, product, third powers and the indicator of the middle of a target in the plane: 8 statistics.
fn check_moments(what: &str, before: &[Block], after: &[Block], centre: [f64; 2]) {
    let columns =
        |states: &[Block]| [0, 1].map(|j| coordinate(states, 2, j).iter().map(|x| x - centre[j]).collect::<Vec<_>>());
    let ([a, b], [c, d]) = (columns(before), columns(after));
    let of: [(&str, OfTwo); 8] = [
        ("x", |x, _| x),
        ("y", |_, y| y),
        ("x²", |x, _| x * x),
        ("y²", |_, y| y * y),
        ("xy", |x, y| x * y),
        ("x²y", |x, y| x * x * y),
        ("y³", |_, y| y * y * y),
        ("middle", |x, y| f64::from(u8::from(x * x + y * y < 1.0))),
    ];
    for (name, of) in of {
        let values = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| of(*x, *y)).collect::<Vec<_>>();
        check_paired(&format!("{what}, {name}"), &values(&a, &b), &values(&c, &d));
    }
}

fn ends(target: &impl GradLogDensity, hmc: &Hmc, starts: &[Block], updates: usize, stage: &Stage) -> ChainDraws {
    let chains = starts.len() / target.dim() * LANES;
    draw_trajectories(target, hmc, starts, chains, Schedule { updates, burn_in: updates }, stage)
        .expect("finite starts")
}

/// 4 × 8 statistics: false alarm 2e-4. Seeds 1 and 2.
#[test]
fn a_bent_target_is_kept_by_both_metrics() {
    let starts = bent_draws(5000, Stage::new(1, "bent"));
    let dense = Metric::Dense(Dense::new(&[0.6, 0.2, 0.2, 1.1], 2).expect("positive definite"));
    for (name, metric) in [("diagonal", Metric::Diagonal(vec![0.5, 1.2])), ("dense", dense)] {
        for (updates, jitter) in [(1, 0.0), (4, 0.3)] {
            let hmc = Hmc::with_metric(0.9, &metric, 3, jitter, Isa::best()).expect("valid");
            let draws = ends(&Bent, &hmc, &starts, updates, &Stage::new(2, name));
            assert!(draws.acceptance > 0.5 && draws.acceptance < 0.9, "{name}: acceptance {}", draws.acceptance);
            check_moments(&format!("{name}, {updates} updates"), &starts, &draws.states, [4.0, 0.0]);
        }
    }
}

/// One harmonic coordinate pair at a tiny energy error, so that nothing but the momenta decides: pooled squares see a variance that is 1 % off. 2 statistics, seeds 3 and 4.
#[test]
fn a_gaussian_keeps_its_width() {
    let target = Lanes { leaf: Quadratic { centre: vec![0.0; 2], precision: vec![1.0; 2] }, isa: Isa::best() };
    let starts = normals(2 * 12_500, Stage::new(3, "width"));
    let hmc = Hmc::new(0.3, &[1.0; 2], 5, 0.0, Isa::best()).expect("valid");
    for updates in [1, 3] {
        let draws = ends(&target, &hmc, &starts, updates, &Stage::new(4, "width"));
        let squares = |states: &[Block]| states.iter().flat_map(|b| b.0).map(|x| x * x).collect::<Vec<_>>();
        check_paired(&format!("{updates} updates, x²"), &squares(&starts), &squares(&draws.states));
    }
}

/// e^(−x) on x > 0: trajectories that cross the edge are refused, and the old state must count again.
struct HalfLine;

impl LogDensity for HalfLine {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x[0] > 0.0 { -x[0] } else { f64::NEG_INFINITY }
    }
}

impl GradLogDensity for HalfLine {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = -1.0;
        self.log_density(x)
    }
}

/// Rejected proposals count (H10), with one chain and with many. 2 × 3 statistics, seeds 5 and 6.
#[test]
fn a_half_line_is_kept_where_half_the_trajectories_are_refused() {
    let starts: Vec<Block> = {
        let mut uniform = vec![Block::ZERO; 2500];
        Stage::new(5, "half line").whole().fill_uniform(&mut uniform);
        uniform.iter().map(|b| Block(b.0.map(|u| -u.ln()))).collect()
    };
    let hmc = Hmc::new(1.0, &[1.0], 2, 0.0, Isa::best()).expect("valid");
    let many = ends(&HalfLine, &hmc, &starts, 2, &Stage::new(6, "many"));
    assert!(many.acceptance > 0.3 && many.acceptance < 0.7, "{}", many.acceptance);
    let mut kernel = OneChain::new(HalfLine, hmc);
    let mut rng = Stage::new(6, "one").whole();
    let one = |x: f64| {
        let mut state = [x];
        (0..2).for_each(|_| kernel.step(&mut state, &mut rng));
        state[0]
    };
    let before: Vec<f64> = coordinate(&starts, 1, 0);
    let one: Vec<f64> = before.iter().copied().map(one).collect();
    for (name, after) in [("many", coordinate(&many.states, 1, 0)), ("one", one)] {
        let of: [(&str, OfOne); 3] = [("x", |x| x), ("x²", |x| x * x), ("x < ½", |x| f64::from(u8::from(x < 0.5)))];
        for (what, of) in of {
            let values = |x: &[f64]| x.iter().map(|x| of(*x)).collect::<Vec<_>>();
            check_paired(&format!("{name} chains, {what}"), &values(&before), &values(&after));
        }
    }
    assert!(kernel.divergences() > 1000, "{}", kernel.divergences());
    // Where the density vanishes nothing moves, and that counts.
    let (mut outside, before) = ([-1.0], kernel.divergences());
    kernel.step(&mut outside, &mut rng);
    assert_eq!((outside, kernel.divergences()), ([-1.0], before + 1));
}

/// Chains from one state part at once, and no two go the same way.
#[test]
fn every_chain_has_randomness_of_its_own() {
    let hmc = Hmc::new(0.5, &[0.5, 1.0], 3, 0.2, Isa::best()).expect("valid");
    let starts = [Block::splat(4.0), Block::ZERO].repeat(8);
    let last = ends(&Bent, &hmc, &starts, 2, &Stage::new(7, "own")).last;
    let mut x = coordinate(&last, 2, 0);
    x.sort_by(f64::total_cmp);
    let still = x.iter().filter(|x| **x == 4.0).count();
    x.dedup();
    assert_eq!(x.len(), 64 - still.saturating_sub(1), "chains that moved stand apart");
    assert!(still < 20, "{still}");
}

/// One thread, and each of three as the one that begins.
#[test]
fn chains_are_the_same_for_every_number_of_threads() {
    let hmc = Hmc::new(0.5, &[0.5, 1.0], 3, 0.2, Isa::best()).expect("valid");
    let starts = bent_draws(40, Stage::new(8, "threads"));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.broadcast(|_| ends(&Bent, &hmc, &starts, 5, &Stage::new(8, "threads")))
    };
    let alone = on(1).remove(0);
    for found in on(3) {
        assert_eq!(alone, found);
    }
}

/// What an update reports is what happened: acceptance from the energies, the old state where it was refused.
#[test]
fn an_update_reports_what_it_did() {
    let hmc = Hmc::new(1.1, &[0.5, 1.2], 3, 0.4, Isa::best()).expect("valid");
    let mut chains = Chains::new(&Bent, bent_draws(1, Stage::new(9, "report"))).expect("finite");
    let (mut ws, mut rng) = (Workspace::new(&Bent), Stage::new(9, "update").whole());
    let (mut refused, mut factors) = (0, vec![]);
    for _ in 0..300 {
        let before = chains.clone();
        let info = update(&Bent, &hmc, &mut chains, &mut ws, &mut rng);
        for lane in 0..LANES {
            let stayed = (0..2).all(|j| chains.position[j].0[lane] == before.position[j].0[lane]);
            assert_eq!(info.accepted[lane], !stayed);
            assert!((0.0..=1.0).contains(&info.acceptance.0[lane]));
            assert!(info.energy.0[lane] >= -chains.log_density.0[lane], "kinetic energy is not negative");
            factors.push(info.factor.0[lane]);
            refused += usize::from(stayed);
        }
    }
    assert!((300..1500).contains(&refused), "{refused} of 2400 refused");
    let (low, high) = factors.iter().fold((f64::MAX, f64::MIN), |(l, h), f| (l.min(*f), h.max(*f)));
    assert!((0.6..0.61).contains(&low) && (1.39..1.4).contains(&high), "jitter from {low} to {high}");
    let mean = factors.iter().sum::<f64>() / factors.len() as f64;
    assert!((mean - 1.0).abs() < 4.5 * 0.4 / (3.0 * factors.len() as f64).sqrt(), "{mean}");
}
