//! What action primitives learn from signals that are known.

use sinew_core::random::Stage;
use sinew_dynamics::Error;
use sinew_dynamics::primitives::learning::{Config, TrainingMotion, learn, noise_sd};
use sinew_dynamics::primitives::model::FeatureVector;
use sinew_dynamics::primitives::summary::prediction_errors;

/// Prediction of a periodic signal (M4): a signal at the pace of a walk (1.05 Hz at 20 frames a second), without noise; three feature vectors an action primitive, twenty clusters. The mean of model (6) misses the next value by less than a tenth of the amplitude, root mean square.
///
/// A signal of 0.7 Hz needs more than 95 % of the variance: the direction in which one coordinate moves is then in a component with 3 % of it, and which way the signal moves is lost.
#[test]
fn what_follows_in_a_periodic_signal_is_predicted() {
    for (pace, share) in [(0.33, 0.95), (0.217, 0.99)] {
        let signal = |first: f64, frames: usize| -> Vec<f64> {
            let phase = |t: usize| first + pace * t as f64;
            (0..frames).flat_map(|t| [phase(t).sin(), 0.5 * phase(t).cos()]).collect()
        };
        let training = [signal(0.0, 400), signal(1.0, 300)];
        let motion = TrainingMotion { state: "sine", dim: 2, frame_rate: 20.0, sequences: &training, horizontal: &[] };
        let mut config = Config::default();
        config.mixture.components = 20;
        config.keep.share = share;
        assert_eq!(config.length, 3);
        for seed in 0..4 {
            for (coordinates, amplitude) in [(&[0][..], 1.0), (&[1], 0.5)] {
                let feature = FeatureVector { name: "sine".into(), coordinates: coordinates.to_vec() };
                let stage = Stage::new(seed, "M4");
                let model = learn(&motion, &[feature], &config, stage, &mut |_| {}).expect("valid");
                let held_out = [signal(0.5, 500)];
                let errors = prediction_errors(&model.primitives[0], &held_out, 2).expect("valid").expect("steps");
                assert_eq!(errors.steps, 497);
                let missed = errors.next / amplitude;
                assert!(
                    missed < 0.1,
                    "pace {pace}, seed {seed}, {coordinates:?}: {missed} of the amplitude, bound 0.1"
                );
            }
        }
    }
}

/// A walk along one axis: both horizontal coordinates get the root of the mean of their squares, so that it could have gone anywhere; the height keeps its own.
#[test]
fn horizontal_steps_have_no_direction() {
    let sequences = [(0..40).flat_map(|k| [0.0, 0.06 * f64::from(k), 0.01 * f64::from(k % 2)]).collect::<Vec<f64>>()];
    let motion = |horizontal: &'static [usize]| TrainingMotion {
        state: "walk",
        dim: 3,
        frame_rate: 20.0,
        sequences: &sequences,
        horizontal,
    };
    let config = Config { noise_factor: 1.5, noise_floor: 1e-9, ..Config::default() };
    let sd = noise_sd(&motion(&[0, 1]), &config).expect("valid");
    let expected = 1.5 * 0.06 / 2.0_f64.sqrt();
    assert!((sd[0] - expected).abs() < 1e-12 && sd[0] == sd[1], "{sd:?}");
    assert!((sd[2] - 0.015).abs() < 1e-12, "{sd:?}");
    assert!((noise_sd(&motion(&[]), &config).expect("valid")[1] - 0.09).abs() < 1e-12);
    assert!(matches!(noise_sd(&motion(&[3]), &config), Err(Error::Shape { .. })));
}
