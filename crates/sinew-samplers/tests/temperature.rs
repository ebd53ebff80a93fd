//! The survival diagnostic, the exponent that is solved from it, and the sign of the log weights.
//! These are the laws A2 to A5.

use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::FramePrior;
use sinew_samplers::metric::Metric;
use sinew_samplers::temperature::{MOST, exponent};
use sinew_samplers::tempered_smc::{Config, Temperature, temper};
use sinew_samplers::weights::{effective_number, normalise};

/// Log weights of a Gaussian in ten dimensions: χ² halves.
fn log_weights(seed: u64, count: usize) -> Vec<f64> {
    let mut rng = Stage::new(seed, "log weights").whole();
    let mut normals = [Block::ZERO; 10];
    let draw = |_| {
        rng.fill_normal(Isa::best(), &mut normals);
        -3.0 * normals.iter().map(|b| b.0[0] * b.0[0]).sum::<f64>()
    };
    (0..count).map(draw).collect()
}

fn weights(log_weights: &[f64], beta: f64) -> Vec<f64> {
    let mut weights = vec![];
    normalise(&log_weights.iter().map(|l| beta * l).collect::<Vec<_>>(), &mut weights).expect("weights");
    weights
}

fn survivors(log_weights: &[f64], beta: f64) -> f64 {
    effective_number(&weights(log_weights, beta))
}

/// The exponent that is solved for (A2).
#[test]
fn the_solved_exponent_leaves_the_wanted_part() {
    for seed in 0..20 {
        for survival in [0.05, 0.3, 0.5, 0.9, 0.99] {
            let l = log_weights(seed, 200);
            let beta = exponent(&l, survival, MOST).expect("weights");
            assert!((survivors(&l, beta) / 200.0 - survival).abs() < 1e-6, "seed {seed}, {survival}: {beta}");
        }
    }
}

/// Monotone survival (A3): D falls, and as d log D / dβ = 2 (E_β[l] − E_2β[l]) says.
#[test]
fn fewer_survive_a_larger_exponent() {
    for seed in 0..5 {
        let l = log_weights(seed, 200);
        let mean = |beta: f64| -> f64 { weights(&l, beta).iter().zip(&l).map(|(w, l)| w * l).sum() };
        let mut before = survivors(&l, 0.0);
        assert!((before - 200.0).abs() < 1e-9);
        for step in 1..200 {
            let beta = 0.01 * f64::from(step);
            let now = survivors(&l, beta);
            assert!(now <= before + 1e-12, "seed {seed}, β = {beta}: {now} after {before}");
            before = now;
            let numeric = (survivors(&l, beta + 1e-6).ln() - survivors(&l, beta - 1e-6).ln()) / 2e-6;
            let formula = 2.0 * (mean(beta) - mean(2.0 * beta));
            assert!((numeric - formula).abs() < 1e-6 * formula.abs().max(1.0), "seed {seed}: {numeric} for {formula}");
        }
    }
}

/// Invariance of the exponent (A4).
#[test]
fn the_exponent_does_not_know_the_zero_of_the_log_weights_and_scales_with_their_unit() {
    for seed in 0..20 {
        let l = log_weights(seed, 200);
        let beta = exponent(&l, 0.5, MOST).expect("weights");
        for constant in [-1e3, 0.1, 77.0] {
            let moved: Vec<f64> = l.iter().map(|l| l + constant).collect();
            let found = exponent(&moved, 0.5, MOST).expect("weights");
            assert!((found / beta - 1.0).abs() < 1e-9, "seed {seed}, + {constant}: {found} for {beta}");
        }
        for factor in [1e-3, 0.3, 7.0, 1e4] {
            let scaled: Vec<f64> = l.iter().map(|l| factor * l).collect();
            let found = exponent(&scaled, 0.5, MOST).expect("weights");
            assert!((found * factor / beta - 1.0).abs() < 1e-9, "seed {seed}, × {factor}: {found} for {beta}");
        }
    }
}

/// Degenerate weights (A5).
#[test]
fn equal_weights_are_flat_and_one_state_is_one() {
    let flat = [-7.3; 12];
    assert_eq!(exponent(&flat, 0.5, MOST), Ok(MOST));
    assert_eq!(weights(&flat, MOST), [1.0 / 12.0; 12]);
    let mut one = [f64::NEG_INFINITY; 12];
    one[4] = -7.3;
    let beta = exponent(&one, 0.5, MOST).expect("one state");
    assert_eq!(beta, MOST);
    assert_eq!(survivors(&one, beta), 1.0);
    assert!(weights(&one, beta).iter().all(|w| !w.is_nan()));
}

/// For l = −E, E ~ Exp(1), D(β) / N = (1 + 2 β) / (1 + β)², which is 0.9 at β = (√0.4 + 0.2) / 1.8; for l = E it is (1 − 2 β) / (1 − β)², 0.9 at (√0.4 − 0.2) / 1.8. Of log weights that lie symmetrically either sign has the same exponent, so that these
/// cannot show whether the sign is right.
#[test]
fn the_sign_of_skewed_log_weights_matters() {
    let count = 100_000;
    let places = (0..count).map(|i| (f64::from(i) + 0.5) / f64::from(count));
    let skewed: Vec<f64> = places.clone().map(f64::ln).collect();
    let symmetric: Vec<f64> = places.map(|u| 6.0 * u - 3.0).collect();
    let turned = |l: &[f64]| exponent(&l.iter().map(|l| -l).collect::<Vec<_>>(), 0.9, MOST).expect("weights");
    let root = 0.4_f64.sqrt();
    let found = exponent(&skewed, 0.9, MOST).expect("weights");
    assert!((found - (root + 0.2) / 1.8).abs() < 1e-4, "{found}");
    assert!((turned(&skewed) - (root - 0.2) / 1.8).abs() < 1e-2, "{}", turned(&skewed));
    let found = exponent(&symmetric, 0.9, MOST).expect("weights");
    assert!((found / turned(&symmetric) - 1.0).abs() < 1e-9, "{found}");
}

/// N(0, 1), of which draws come in pairs x and −x, so that a sample is exactly symmetric.
struct Standard;
impl LogDensity for Standard {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -0.5 * x[0] * x[0]
    }
}
impl GradLogDensity for Standard {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = -x[0];
        self.log_density(x)
    }
}
impl FramePrior for Standard {
    fn sample_block(&self, _block: usize, out: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::baseline(), out);
        for x in out {
            for lane in 0..LANES / 2 {
                x.0[LANES / 2 + lane] = -x.0[lane];
            }
        }
    }
    fn precision_diagonal(&self) -> &[f64] {
        &[1.0]
    }
}

/// A likelihood of one coordinate.
struct Likelihood {
    value: fn(f64) -> f64,
    slope: fn(f64) -> f64,
}
impl LogDensity for Likelihood {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        (self.value)(x[0])
    }
}
impl GradLogDensity for Likelihood {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = (self.slope)(x[0]);
        self.log_density(x)
    }
}

/// Temperatures before the last one, and the mean of the draws.
fn tempered(likelihood: &Likelihood, precision: f64) -> (Vec<Temperature>, f64) {
    let config = Config { particles: 1000, ..Config::default() };
    let metric = Metric::Diagonal(vec![precision]);
    let mut run = temper(likelihood, &Standard, &metric, &config, Isa::best(), Stage::new(1, "sign")).expect("runs");
    run.temperatures.pop();
    let mean = run.mean()[0];
    (run.temperatures, mean)
}

/// The likelihood exp(6 x) has symmetric log weights: half of the particles stay effective at the first temperature whichever sign the solver sees, and the posterior is N(6, 1) with any temperatures.
#[test]
fn half_survives_the_first_temperature_of_a_symmetric_likelihood() {
    let (temperatures, mean) = tempered(&Likelihood { value: |x| 6.0 * x, slope: |_| 6.0 }, 1.0);
    assert!((temperatures[0].effective / 1000.0 - 0.5).abs() < 1e-6, "{temperatures:?}");
    assert!((mean - 6.0).abs() < 0.1, "{mean}");
}

/// The likelihood exp(−300 eˣ) has log weights with a long tail downwards: a solver that sees the other sign takes that tail for the best states, and its temperatures are far too many (BlackJAX's issue 914).
#[test]
fn half_survives_each_temperature_of_a_skewed_likelihood() {
    let (temperatures, _) = tempered(&Likelihood { value: |x| -300.0 * x.exp(), slope: |x| -300.0 * x.exp() }, 5.0);
    assert!(temperatures.len() > 3, "{}", temperatures.len());
    for t in temperatures {
        assert!((t.effective / 1000.0 - 0.5).abs() < 1e-6, "{t:?}");
    }
}
