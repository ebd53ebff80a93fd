//! The guided particle filter against the Kalman filter, and what it refuses.

use sinew_core::density::Lanes;
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_core::transition::{Moments, Transition};
use sinew_dynamics::kalman::{Filtered, Form, Kalman, Model};
use sinew_dynamics::linear_gaussian::LinearGaussian;
use sinew_samplers::importance::Tails;
use sinew_tracking::guided::{Config, Guided};
use sinew_tracking::{Error, Inferred, Tracker};

const TURN: [f64; 4] = [0.95, 0.2, -0.2, 0.95];
const NOISE: [f64; 4] = [0.3, 0.1, 0.1, 0.2];
const START: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const PRECISION: [f64; 2] = [4.0, 25.0];
const FRAMES: usize = 12;

fn motion() -> LinearGaussian {
    LinearGaussian::new(2, TURN.to_vec(), NOISE.to_vec(), START.to_vec(), Isa::best()).expect("valid")
}

/// A simulated series, with what the exact filter makes of it.
fn series() -> (Vec<Vec<f64>>, Vec<Filtered>) {
    let (motion, mut rng) = (motion(), Stage::new(5, "turning").whole());
    let (mut state, mut next, mut noise) = ([Block::ZERO; 2], [Block::ZERO; 2], [Block::ZERO; 2]);
    let mut seen = vec![];
    for frame in 0..FRAMES {
        match frame {
            0 => motion.sample_initial_block(&[0.0, 0.0], &mut next, &mut rng),
            _ => motion.sample_block(&state, &mut next, &mut rng),
        }
        state = next;
        rng.fill_normal(Isa::best(), &mut noise);
        seen.push((0..2).map(|j| state[j].0[0] + noise[j].0[0] / PRECISION[j].sqrt()).collect::<Vec<f64>>());
    }
    let model = Model {
        dim: 2,
        matrix: TURN.to_vec(),
        noise: NOISE.to_vec(),
        observation: vec![1.0, 0.0, 0.0, 1.0],
        error: vec![1.0 / PRECISION[0], 0.0, 0.0, 1.0 / PRECISION[1]],
    };
    let start = Moments { mean: vec![0.0; 2], covariance: START.to_vec() };
    let values: Vec<Vec<Option<f64>>> = seen.iter().map(|z| z.iter().copied().map(Some).collect()).collect();
    let exact = Kalman::new(model, Form::Joseph).expect("valid").filter(&start, &values).expect("positive definite");
    (seen, exact)
}

/// Over runs, root mean squares of: the error of the mean in exact standard deviations, of the variance as a share, of the log evidence of a frame; and the mean of Ẑ / Z over frames.
fn errors(config: &Config, runs: usize) -> [f64; 4] {
    let (seen, exact) = series();
    let mut sums = [0.0; 4];
    for run in 0..runs {
        let mut filter = Guided::new(config.clone(), motion(), vec![0.0; 2], Isa::best()).expect("valid");
        let stage = Stage::new(9, "guided").round(run);
        for (frame, (seen, exact)) in seen.iter().zip(&exact).enumerate() {
            let leaf = Quadratic { centre: seen.clone(), precision: PRECISION.to_vec() };
            let info = filter.step(&Lanes { leaf, isa: Isa::best() }, stage.round(frame)).expect("posterior");
            let found = filter.posterior().moments(Isa::best());
            // The density of the observation has no constants.
            let constant: f64 = PRECISION.iter().map(|p| 0.5 * (p / std::f64::consts::TAU).ln()).sum();
            let evidence = info.log_evidence.expect("estimated") + constant - exact.log_likelihood;
            let Moments { mean, covariance } = &exact.filtered;
            for j in [0, 1] {
                sums[0] += (found.mean[j] - mean[j]).powi(2) / covariance[3 * j] / 2.0;
                sums[1] += (found.covariance[3 * j] / covariance[3 * j] - 1.0).powi(2) / 2.0;
            }
            sums[2] += evidence * evidence;
            sums[3] += evidence.exp();
        }
    }
    let [mean, variance, evidence, ratio] = sums.map(|sum| sum / (runs * FRAMES) as f64);
    [mean.sqrt(), variance.sqrt(), evidence.sqrt(), ratio]
}

/// Means, variances and evidence with 4000 particles to a few times 1/√4000; the errors of 250 are four times as large.
#[test]
fn it_converges_to_the_exact_filter() {
    for tails in [Tails::Gaussian, Tails::StudentT { degrees: 5 }] {
        let config = |particles| Config { particles, tails, ..Config::default() };
        let (few, many) = (errors(&config(250), 32), errors(&config(4000), 8));
        let bounds = [0.04, 0.06, 0.04];
        for k in 0..3 {
            assert!(many[k] < bounds[k], "{tails:?}: {many:?}");
            assert!((2.5..6.5).contains(&(few[k] / many[k])), "{tails:?}: {few:?} and {many:?}");
        }
        assert!((few[3] - 1.0).abs() < 0.03 && (many[3] - 1.0).abs() < 0.02, "{few:?} and {many:?}");
    }
}

/// Resampled in every frame or nearly never, it is the same filter.
#[test]
fn resampling_is_a_choice() {
    for resample_below in [1.0, 0.05] {
        let found = errors(&Config { particles: 4000, resample_below, ..Config::default() }, 4);
        assert!(found[0] < 0.08 && found[1] < 0.12 && (found[3] - 1.0).abs() < 0.05, "{resample_below}: {found:?}");
    }
}

#[test]
fn bad_settings_are_refused() {
    let new = |config, centre: &[f64]| Guided::new(config, motion(), centre.to_vec(), Isa::best()).map(|_| ());
    let usual = Config::default;
    assert!(matches!(new(usual(), &[0.0; 3]), Err(Error::Dimension { found: 3, expected: 2, .. })));
    let below = new(Config { resample_below: f64::NAN, ..usual() }, &[0.0; 2]).expect_err("no number");
    assert_eq!(below.to_string(), "resample_below is NaN; must be between 0 and 1");
    assert!(new(Config { tails: Tails::StudentT { degrees: 0 }, ..usual() }, &[0.0; 2]).is_err());
    assert!(new(Config { particles: 0, ..usual() }, &[0.0; 2]).is_err());
}
