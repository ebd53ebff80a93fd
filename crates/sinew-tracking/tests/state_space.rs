//! The filter of any state-space model against the exact filter and smoother of a linear-Gaussian one.

use rayon::ThreadPoolBuilder;
use sinew_core::lanes::Block;
use sinew_core::transition::Moments;
use sinew_dynamics::kalman::{Filtered, Form, Kalman, Model};
use sinew_tracking::state_space::{Settings, StateSpace, TransitionDensity, filter, filter_with_history};
use sinew_tracking::{BlockRng, Error, Scheme};

/// A cart: place and speed, of which the place is seen with an error of 0.4.
struct Cart;

const SLOWED: f64 = 0.9;
const STEP: [f64; 2] = [0.2, 0.5];
const ERROR: f64 = 0.4;
/// None in one frame.
const SEEN: [Option<f64>; 12] = [
    Some(0.3),
    Some(0.9),
    Some(1.8),
    None,
    Some(2.2),
    Some(2.9),
    Some(2.4),
    Some(1.9),
    Some(0.4),
    Some(-0.6),
    Some(-0.8),
    Some(-0.1),
];

impl StateSpace for Cart {
    type Observation = Option<f64>;

    fn dim(&self) -> usize {
        2
    }
    fn draw_first(&self, state: &mut [f64], rng: &mut BlockRng) {
        (state[0], state[1]) = (rng.normal(), 1.0 + 0.5 * rng.normal());
    }
    fn draw_next(&self, _frame: usize, previous: &[f64], next: &mut [f64], rng: &mut BlockRng) {
        next[0] = previous[0] + previous[1] + STEP[0] * rng.normal();
        next[1] = SLOWED * previous[1] + STEP[1] * rng.normal();
    }
    fn log_density(&self, _frame: usize, observation: &Option<f64>, state: &[f64]) -> f64 {
        observation
            .map_or(0.0, |y| -0.5 * ((y - state[0]) / ERROR).powi(2) - ERROR.ln() - 0.5 * std::f64::consts::TAU.ln())
    }
}

impl TransitionDensity for Cart {
    fn log_transition(&self, _frame: usize, previous: &[f64], next: &[f64]) -> f64 {
        let errors = [next[0] - previous[0] - previous[1], next[1] - SLOWED * previous[1]];
        errors.iter().zip(STEP).map(|(e, sd)| -0.5 * (e / sd).powi(2)).sum()
    }
}

fn exact() -> (Vec<Filtered>, Vec<Moments>) {
    let model = Model {
        dim: 2,
        matrix: vec![1.0, 1.0, 0.0, SLOWED],
        noise: vec![STEP[0] * STEP[0], 0.0, 0.0, STEP[1] * STEP[1]],
        observation: vec![1.0, 0.0],
        error: vec![ERROR * ERROR],
    };
    let kalman = Kalman::new(model, Form::Joseph).expect("valid");
    let start = Moments { mean: vec![0.0, 1.0], covariance: vec![1.0, 0.0, 0.0, 0.25] };
    let frames = kalman.filter(&start, &SEEN.map(|y| vec![y])).expect("seen");
    let smoothed = kalman.smooth(&frames).expect("factors");
    (frames, smoothed)
}

const SCHEMES: [Scheme; 4] = [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic];

/// Mean of Ẑ / Z over 300 seeds, of each scheme, resampled always, where few are effective, and never: twelve means at |z| < 4.5, false alarm 1e-4.
#[test]
fn the_evidence_is_unbiased_with_every_scheme_and_threshold() {
    let log_z: f64 = exact().0.iter().map(|frame| frame.log_likelihood).sum();
    for scheme in SCHEMES {
        for resample_below in [1.0, 0.5, 0.0] {
            let ratio = |seed| {
                let settings = Settings { particles: 200, scheme, resample_below, seed };
                let found = filter(&Cart, &SEEN, settings).expect("weights");
                let resampled = found.frames.iter().filter(|frame| frame.resampled).count();
                assert!(match resample_below {
                    0.0 => resampled == 0,
                    1.0 => resampled == 11,
                    _ => (2..11).contains(&resampled),
                });
                (found.log_evidence - log_z).exp()
            };
            let ratios: Vec<f64> = (0..300).map(ratio).collect();
            let mean = ratios.iter().sum::<f64>() / 300.0;
            let variance = ratios.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>() / 299.0;
            let z = (mean - 1.0) / (variance / 300.0).sqrt();
            assert!(z.abs() < 4.5, "{scheme:?}, {resample_below}: {mean}, z = {z}");
        }
    }
}

/// With 20 000 particles and an effective number of some thousands: a tenth of a standard deviation is more than five standard errors.
#[test]
fn means_and_deviations_are_those_of_the_exact_filter() {
    let found = filter(&Cart, &SEEN, Settings { particles: 20_000, seed: 1, ..Settings::default() }).expect("weights");
    for (found, exact) in found.frames.iter().zip(exact().0) {
        assert!(found.ess > 2_500.0, "{found:?}");
        for j in 0..2 {
            let sd = exact.filtered.covariance[3 * j].sqrt();
            assert!((found.mean[j] - exact.filtered.mean[j]).abs() < 0.1 * sd, "{found:?}");
            assert!((found.sd[j] / sd - 1.0).abs() < 0.1, "{found:?}");
        }
        assert!((found.log_evidence - exact.log_likelihood).abs() < 0.1, "{found:?}");
    }
}

/// Means and standard deviations of drawn trajectories, and the covariance of neighbouring places, which filtered states drawn one by one have not: within 5 standard errors of the number of independent draws that are sure to be there.
#[test]
fn trajectories_are_those_of_the_exact_smoother() {
    let (_, smoothed) = exact();
    let settings = Settings { particles: 4000, seed: 2, ..Settings::default() };
    let (_, history) = filter_with_history(&Cart, &SEEN, settings).expect("weights");
    let backward = history.backward_samples(&Cart, 400, 3).expect("steps");
    let genealogies = history.genealogies(4000, 3);
    for (name, draws, independent) in [("backward", backward, 300.0_f64), ("genealogies", genealogies, 60.0)] {
        for (t, exact) in smoothed.iter().enumerate() {
            for j in 0..2 {
                let values: Vec<f64> = draws.iter().map(|draw| draw[2 * t + j]).collect();
                let (mean, sd) = moments(&values);
                let exact_sd = exact.covariance[3 * j].sqrt();
                assert!((mean - exact.mean[j]).abs() < 5.0 * exact_sd / independent.sqrt(), "{name} {t} {j}: {mean}");
                assert!((sd / exact_sd - 1.0).abs() < 5.0 / (2.0 * independent).sqrt(), "{name} {t} {j}: {sd}");
            }
        }
        // A step of the place is the speed before it, but for noise of 0.2.
        let steps: Vec<f64> = draws.iter().map(|draw| draw[14] - draw[12] - draw[13]).collect();
        assert!(moments(&steps).1 < 1.3 * STEP[0], "{name}: {}", moments(&steps).1);
        assert!(draws.iter().all(|draw| draw.len() == 2 * SEEN.len()));
    }
}

fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n).sqrt())
}

#[test]
fn threads_change_no_bit() {
    let run = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let settings = Settings { particles: 1003, seed: 5, ..Settings::default() };
            let (found, history) = filter_with_history(&Cart, &SEEN, settings).expect("weights");
            let backward = history.backward_samples(&Cart, 9, 1).expect("steps");
            (found, history.genealogies(9, 1), backward)
        })
    };
    let one = run(1);
    assert!([2, 7].into_iter().all(|threads| run(threads) == one));
    let alone = filter(&Cart, &SEEN, Settings { particles: 1003, seed: 5, ..Settings::default() }).expect("weights");
    assert_eq!(alone, one.0, "a history changes nothing");
}

/// Blocks that a model writes itself are used, and say the same where they compute the same.
#[test]
fn a_model_may_write_its_blocks() {
    struct Blocks;
    impl StateSpace for Blocks {
        type Observation = Option<f64>;
        fn dim(&self) -> usize {
            2
        }
        fn draw_first(&self, state: &mut [f64], rng: &mut BlockRng) {
            Cart.draw_first(state, rng);
        }
        fn draw_next(&self, _frame: usize, _: &[f64], _: &mut [f64], _: &mut BlockRng) {
            unreachable!("blocks are drawn");
        }
        fn log_density(&self, _frame: usize, _: &Option<f64>, _: &[f64]) -> f64 {
            unreachable!("blocks are evaluated");
        }
        fn draw_next_block(&self, frame: usize, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
            Cart.draw_next_block(frame, previous, next, rng);
        }
        fn log_density_block(&self, frame: usize, observation: &Option<f64>, states: &[Block]) -> Block {
            Cart.log_density_block(frame, observation, states)
        }
    }
    let settings = Settings { particles: 99, ..Settings::default() };
    let found = filter(&Blocks, &SEEN, settings.clone()).expect("weights");
    assert_eq!(found, filter(&Cart, &SEEN, settings).expect("weights"));
}

/// Frame and reason are named.
#[test]
fn models_that_cannot_be_filtered_are_refused() {
    let with = |change: &dyn Fn(&mut Settings)| {
        let mut settings = Settings::default();
        change(&mut settings);
        filter(&Cart, &SEEN, settings)
    };
    assert!(matches!(with(&|s| s.particles = 0), Err(Error::Samplers(_))));
    assert!(matches!(with(&|s| s.resample_below = f64::NAN), Err(Error::Config { name: "resample_below", .. })));
    let unseen = [Some(0.0), Some(1e200), Some(0.0)];
    assert!(matches!(filter(&Cart, &unseen, Settings::default()), Err(Error::Frame { frame: 1, .. })));
    let nothing = filter(&Cart, &[], Settings::default()).expect("no frames");
    assert!(nothing.frames.is_empty() && nothing.log_evidence == 0.0);
    let (_, history) = filter_with_history(&Cart, &[], Settings::default()).expect("no frames");
    assert_eq!(history.genealogies(2, 1), [vec![], vec![]] as [Vec<f64>; 2]);
}
