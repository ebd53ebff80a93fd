//! The no-U-turn sampler on targets with exact draws.
//! It keeps the target, it reaches the target, its trees are as long as a half period.
//!
//! Biased choice within a half, halves that are kept although they turn, and a choice between halves that ignores their weights were each planted once: `a_start_from_the_target_stays_in_the_target` fails on all.

use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::diagnostics::{effective_sample_size, split_r_hat};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_samplers::Error;
use sinew_samplers::chains::{ChainStat, Schedule};
use sinew_samplers::metric::{Dense, Metric};
use sinew_samplers::nuts::{MAX_DEPTH, Nuts, TreeRun, draw_trees};

/// A target that is the image of a standard normal z.
trait Exact: GradLogDensity {
    fn image_of(&self, z: &[f64]) -> Vec<f64>;
}

/// x = C z with a lower triangular C.
struct Correlated(Vec<Vec<f64>>);

impl Correlated {
    /// Standard deviations from 1 to 10 and correlations of either sign.
    fn new(d: usize) -> Self {
        let entry = |i: usize, j: usize| if i == j { 1.0 } else { 0.6 * (1.3 * (i + 2 * j) as f64).cos() };
        let scale = |i: usize| 10.0_f64.powf(i as f64 / (d - 1) as f64);
        Self((0..d).map(|i| (0..=i).map(|j| scale(i) * entry(i, j)).collect()).collect())
    }

    fn covariance(&self) -> Vec<f64> {
        let d = self.0.len();
        let product = |i: usize, j: usize| self.0[i].iter().zip(&self.0[j]).map(|(a, b)| a * b).sum();
        (0..d * d).map(|e| product(e / d, e % d)).collect()
    }
}

impl LogDensity for Correlated {
    fn dim(&self) -> usize {
        self.0.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
}

impl GradLogDensity for Correlated {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let d = x.len();
        let mut z = vec![0.0; d];
        for i in 0..d {
            let sum: f64 = (0..i).map(|j| self.0[i][j] * z[j]).sum();
            z[i] = (x[i] - sum) / self.0[i][i];
        }
        for i in (0..d).rev() {
            let sum: f64 = (i + 1..d).map(|k| self.0[k][i] * grad[k]).sum();
            grad[i] = (-z[i] - sum) / self.0[i][i];
        }
        -0.5 * z.iter().map(|z| z * z).sum::<f64>()
    }
}

impl Exact for Correlated {
    fn image_of(&self, z: &[f64]) -> Vec<f64> {
        self.0.iter().map(|row| row.iter().zip(z).map(|(c, z)| c * z).sum()).collect()
    }
}

/// x₀ = 2 z₀, x₁ = z₁ + 0.4 (x₀² − 4).
struct Banana;

impl LogDensity for Banana {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 2])
    }
}

impl GradLogDensity for Banana {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let off = x[1] - 0.4 * (x[0] * x[0] - 4.0);
        grad[0] = -x[0] / 4.0 + 0.8 * x[0] * off;
        grad[1] = -off;
        -x[0] * x[0] / 8.0 - 0.5 * off * off
    }
}

impl Exact for Banana {
    fn image_of(&self, z: &[f64]) -> Vec<f64> {
        let x = 2.0 * z[0];
        vec![x, z[1] + 0.4 * (x * x - 4.0)]
    }
}

/// A standard normal left of a cliff, with a region of NaN far left.
struct Cliff;

impl LogDensity for Cliff {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0])
    }
}

impl GradLogDensity for Cliff {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = if x[0] < -2.0 { f64::NAN } else { -x[0] };
        if x[0] > 1.0 { f64::NEG_INFINITY } else { -0.5 * x[0] * x[0] }
    }
}

fn exact_starts(target: &impl Exact, blocks: usize, stage: Stage) -> Vec<Block> {
    let d = target.dim();
    let mut starts = vec![Block::ZERO; blocks * d];
    stage.whole().fill_normal(Isa::best(), &mut starts);
    for block in starts.chunks_exact_mut(d) {
        for lane in 0..LANES {
            let z: Vec<f64> = block.iter().map(|b| b.0[lane]).collect();
            for (b, x) in block.iter_mut().zip(target.image_of(&z)) {
                b.0[lane] = x;
            }
        }
    }
    starts
}

fn run(
    target: &impl GradLogDensity,
    nuts: &Nuts,
    starts: &[Block],
    updates: usize,
    burn_in: usize,
    stage: &Stage,
) -> TreeRun {
    let chains = starts.len() / target.dim() * LANES;
    draw_trees(target, nuts, starts, chains, Schedule { updates, burn_in }, stage).expect("finite starts")
}

fn nuts(eta: f64, metric: &Metric, jitter: f64) -> Nuts {
    Nuts::with_metric(eta, metric, MAX_DEPTH, jitter, Isa::best()).expect("valid")
}

/// Means of monomials up to the fourth degree after some transitions against the same states before them. At most 25 statistics a call at |z| < 4.5.
fn stays(name: &str, target: &impl Exact, nuts: &Nuts, transitions: usize) {
    let d = target.dim();
    let starts = exact_starts(target, 2500, Stage::new(3, "exact"));
    let ends = run(target, nuts, &starts, transitions, transitions, &Stage::new(3, name)).draws.states;
    let mut powers: Vec<Vec<(usize, u8)>> = Vec::new();
    for i in 0..d {
        powers.extend((1..=4).map(|power| vec![(i, power)]));
        powers.extend((0..i).flat_map(|j| [vec![(i, 1), (j, 1)], vec![(i, 1), (j, 2)]]));
    }
    powers.truncate(25);
    for monomial in powers {
        let of = |states: &[Block], k: usize| -> f64 {
            let state = &states[k / LANES * d..];
            monomial.iter().map(|&(j, power)| state[j].0[k % LANES].powi(power.into())).product()
        };
        let change: Vec<f64> = (0..2500 * LANES).map(|k| of(&ends, k) - of(&starts, k)).collect();
        let n = change.len() as f64;
        let mean = change.iter().sum::<f64>() / n;
        let variance = change.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / n;
        let z = mean / (variance / n).sqrt();
        assert!(variance > 0.0 && z.abs() < 4.5, "{name}: {monomial:?} changed by {mean}, z = {z}, bound 4.5, seed 3");
    }
}

/// 87 statistics: false alarm 6e-4.
#[test]
fn a_start_from_the_target_stays_in_the_target() {
    let gaussian = Correlated::new(4);
    stays("gaussian, diagonal", &gaussian, &nuts(0.7, &Metric::Diagonal(vec![1.0, 0.5, 0.2, 0.1]), 0.0), 2);
    let rough: Vec<f64> = (0..16).map(|e| if e % 5 == 0 { 0.6 } else { 0.1 }).collect();
    let rough = Metric::Dense(Dense::new(&rough, 4).expect("positive definite"));
    stays("gaussian, dense", &gaussian, &nuts(0.7, &rough, 0.3), 2);
    let unit = Metric::Diagonal(vec![1.0; 2]);
    stays("banana, small steps", &Banana, &nuts(0.25, &unit, 0.0), 1);
    // At this step size a third of the states of a trajectory differ much in weight.
    stays("banana, large steps", &Banana, &nuts(0.8, &unit, 0.2), 3);
    let shallow = Nuts::with_metric(0.2, &unit, 3, 0.0, Isa::best()).expect("valid");
    stays("banana, shallow trees", &Banana, &shallow, 2);
}

/// 30 statistics at |z| < 4.5 a metric: false alarm 4e-4.
#[test]
fn a_start_far_away_reaches_the_moments_of_the_target() {
    let (d, isa) = (5, Isa::best());
    let target = Correlated::new(d);
    let covariance = target.covariance();
    let dense = Dense::new(&(0..25).map(|e| if e % 6 == 0 { 1.2 } else { 0.2 }).collect::<Vec<_>>(), d);
    for metric in [Metric::Diagonal(vec![1.0; d]), Metric::Dense(dense.expect("positive definite"))] {
        let nuts = Nuts::with_metric(0.4, &metric, MAX_DEPTH, 0.2, isa).expect("valid");
        let starts: Vec<Block> = (0..2 * d).map(|k| Block::splat(if k % 2 == 0 { 60.0 } else { -60.0 })).collect();
        let draws = run(&target, &nuts, &starts, 4000, 200, &Stage::new(8, "far")).draws;
        assert!(draws.acceptance > 0.6 && draws.acceptance < 0.99, "acceptance {}", draws.acceptance);
        let series: Vec<Vec<Vec<f64>>> = (0..d).map(|j| draws.series(j)).collect();
        let check = |name: String, values: Vec<Vec<f64>>, exact: f64| {
            let n = values.iter().map(Vec::len).sum::<usize>() as f64;
            let mean = values.iter().flatten().sum::<f64>() / n;
            let variance = values.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
            let z = (mean - exact) / (variance / effective_sample_size(&values)).sqrt();
            assert!(z.abs() < 4.5, "{name}: {mean} against {exact}, z = {z}, bound 4.5, seed 8");
            assert!(split_r_hat(&values) < 1.01, "{name}");
        };
        for i in 0..d {
            check(format!("mean {i}"), series[i].clone(), 0.0);
            for j in 0..=i {
                let product = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a * b).collect();
                let values = series[i].iter().zip(&series[j]).map(product).collect();
                check(format!("covariance {i}, {j}"), values, covariance[i * d + j]);
            }
        }
    }
}

/// Half a period of a unit oscillator is π / η steps: a trajectory has between half and about twice as many states.
#[test]
fn trees_are_as_long_as_half_a_period() {
    let d = 10;
    let target = Correlated((0..d).map(|i| (0..=i).map(|j| f64::from(u8::from(i == j))).collect()).collect());
    let starts = exact_starts(&target, 2, Stage::new(5, "start"));
    for (eta, depth) in [(0.4, 3.0), (0.2, 4.0), (0.1, 5.0)] {
        let run =
            run(&target, &nuts(eta, &Metric::Diagonal(vec![1.0; d]), 0.0), &starts, 500, 0, &Stage::new(5, "run"));
        let steps = run.leapfrog_steps as f64 / 8000.0;
        assert_eq!(run.depths.iter().sum::<usize>(), 8000);
        assert!((run.mean_depth() - depth).abs() < 0.5, "{} at {eta}", run.mean_depth());
        let half_period = std::f64::consts::PI / eta;
        assert!(steps > 0.5 * half_period && steps < 2.0 * half_period, "{steps} steps at {eta}");
        let called = (run.block_gradients * LANES) as f64 / run.leapfrog_steps as f64;
        assert!((1.0..1.1).contains(&called), "{called} gradients for one: lanes wait for each other");
        assert!(run.draws.acceptance > 0.95 && run.draws.divergences == 0);
        let ess = effective_sample_size(&run.draws.series(0));
        assert!(ess > 7000.0, "{ess} of 8016 draws");
    }
}

#[test]
fn divergences_are_counted_and_no_chain_ends_on_one() {
    let nuts = nuts(0.5, &Metric::Diagonal(vec![1.0]), 0.2);
    let run =
        draw_trees(&Cliff, &nuts, &[Block::ZERO], 5, Schedule { updates: 2000, burn_in: 0 }, &Stage::new(3, "cliff"))
            .expect("finite start");
    let counted = run.draws.stats.iter().filter(|stat| stat.divergent).count();
    assert!(run.draws.divergences == counted && counted > 1000, "{counted}");
    for chain in run.draws.series(0) {
        assert!(chain.len() == 2001 && chain.iter().all(|&x| x <= 1.0));
    }
    let fits = |s: &ChainStat| s.energy >= -s.log_density && s.energy.is_finite() && s.acceptance <= 1.0;
    assert!(run.draws.stats.iter().all(|s| s.log_density.is_finite() && fits(s)));
}

#[test]
fn draws_are_the_chains_states_and_depend_on_nothing_else() {
    let target = Correlated::new(3);
    let nuts = nuts(0.5, &Metric::Diagonal(vec![1.0; 3]), 0.2);
    let starts = exact_starts(&target, 2, Stage::new(6, "start"));
    let both = run(&target, &nuts, &starts, 50, 10, &Stage::new(6, "run"));
    assert_eq!(both, run(&target, &nuts, &starts, 50, 10, &Stage::new(6, "run")));
    let first = run(&target, &nuts, &starts[..3], 50, 10, &Stage::new(6, "run"));
    for j in 0..3 {
        assert_eq!(both.draws.series(j)[..LANES], first.draws.series(j)[..]);
    }
    let (series, stats) = (first.draws.series(1), &first.draws.stats);
    assert_eq!((series.len(), series[0].len(), stats.len()), (8, 41, 8 * 41));
    for (index, stat) in stats.iter().enumerate() {
        let state: Vec<f64> = (0..3).map(|j| first.draws.series(j)[index % 8][index / 8]).collect();
        assert!((target.log_density(&state) - stat.log_density).abs() < 1e-10);
        assert!(stat.energy >= -stat.log_density && (stat.step_factor - 1.0).abs() <= 0.2);
    }
}

/// Weights far beyond the largest number: a start 200 standard deviations away.
#[test]
fn a_start_in_the_far_tail_comes_back() {
    let target = Correlated::new(2);
    let starts = vec![Block::splat(200.0); 2];
    let run = run(&target, &nuts(0.5, &Metric::Diagonal(vec![1.0; 2]), 0.0), &starts, 300, 300, &Stage::new(1, "tail"));
    assert!(run.draws.stats.iter().all(|stat| stat.log_density > -20.0), "{:?}", run.draws.stats);
}

#[test]
fn bad_settings_and_starts_are_refused() {
    let isa = Isa::best();
    for (eta, h, depth, jitter) in
        [(0.0, 1.0, 5, 0.0), (1.0, f64::NAN, 5, 0.0), (1.0, 1.0, 0, 0.0), (1.0, 1.0, 31, 0.0), (1.0, 1.0, 5, 1.0)]
    {
        let refused = Nuts::with_metric(eta, &Metric::Diagonal(vec![h]), depth, jitter, isa);
        assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{refused:?}");
    }
    let nuts = nuts(0.5, &Metric::Diagonal(vec![1.0]), 0.0);
    let start = |x: f64, updates: usize, burn_in: usize, chains: usize| {
        draw_trees(&Cliff, &nuts, &[Block::splat(x)], chains, Schedule { updates, burn_in }, &Stage::new(1, "refused"))
    };
    assert!(matches!(start(3.0, 5, 0, 8), Err(Error::BadStart { lane: 0, .. })));
    assert!(matches!(start(0.0, 5, 6, 8), Err(Error::OutOfRange { name: "burn-in", .. })));
    assert!(matches!(start(0.0, 5, 0, 9), Err(Error::Empty { count: 9, dim: 1 })));
    assert_eq!(start(0.0, 0, 0, 8).expect("no update, one draw").draws.stats.len(), 8);
}
