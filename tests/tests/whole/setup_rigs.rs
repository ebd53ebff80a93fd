//! The set-up's posterior of what lasts: lengths that its prior does not expect, and lags of clocks.

use rayon::prelude::*;
use sinew::config::settings::Settings;
use sinew::input::source::FrameSource as _;
use sinew::setup::{SetupRequest, measure_lasting};
use sinew::track::{self, Doubt};
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::drawn_rig::{RATE_HZ, Rig, truth};
use sinew_tests::evaluation;
use sinew_tests::simulated_source::{set_up, source};

/// Rigs.
const RIGS: u64 = 10;

/// Lengths are right in the mean, and squared deviations over the variances of their draws about 1. Were the steps of poses to tell lengths, bodies would be 5 mm too long in these rigs.
#[test]
fn lengths_that_nobody_expects_are_held() {
    let found = |seed: u64| -> Vec<[f64; 2]> {
        let rig = Rig::drawn(seed).unwrap();
        let request = SetupRequest { fps: Some(RATE_HZ), any_size: true, ..SetupRequest::default() };
        let setup = set_up(&mut rig.source(), &request, RATE_HZ, seed).unwrap();
        let known = setup.lasting.as_ref().unwrap();
        let truth = truth(&rig, &setup, known);
        let one = |place: usize| {
            let known = known.known(place);
            let too_long = known.mean - truth[place];
            [too_long, (too_long / known.sd).powi(2)]
        };
        known.layout().lengths().map(one).collect()
    };
    let found: Vec<[f64; 2]> = (1..=RIGS).into_par_iter().flat_map_iter(found).collect();
    let [too_long, square] = [0, 1].map(|k: usize| found.iter().map(|row| row[k]).sum::<f64>() / found.len() as f64);
    assert!(too_long.abs() < 3e-3, "{:.1} mm too long", 1e3 * too_long);
    assert!((0.4..2.0).contains(&square), "{square:.2}");
}

/// Cameras before a walker whose clocks are off by as much as the prior expects: how much each is later than the mean of all is found, and known as well as it is found. What all share is not known.
#[test]
fn clocks_that_are_late_are_found() {
    const LAG_FRAMES: f64 = 0.15;
    let calibration = CalibrationError { lag_frames: LAG_FRAMES, ..CalibrationError::NONE };
    let script = Script { calibration, duration_s: 6.0, ..Script::default() };
    let found = |seed: u64| -> Vec<[f64; 2]> {
        let recording = SyntheticRecording::new(&script, seed).unwrap();
        let setup = set_up(&mut source(&recording), &SetupRequest::default(), script.rate_hz, seed).unwrap();
        let known = setup.lasting.as_ref().unwrap();
        let lags = known.layout().lags();
        let centred = |x: &[f64]| -> Vec<f64> {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter().map(|x| x - mean).collect()
        };
        let draw = |draw: usize| -> Vec<f64> {
            let late = |place: usize| known.number[place].value + known.number[place].draws[draw];
            lags.clone().map(|place| script.rate_hz * late(place)).collect()
        };
        let drawn: Vec<Vec<f64>> = (0..known.draws()).map(|k| centred(&draw(k))).collect();
        let true_lags = centred(&recording.lags_frames);
        let moments = |camera: usize| {
            let mean = drawn.iter().map(|lags| lags[camera]).sum::<f64>() / drawn.len() as f64;
            let variance = drawn.iter().map(|lags| (lags[camera] - mean).powi(2)).sum::<f64>() / drawn.len() as f64;
            let away = mean - true_lags[camera];
            [away, away * away / variance]
        };
        let together: f64 = lags.clone().map(|place| script.rate_hz * known.known(place).sd).sum();
        assert!(together > 0.2, "the common lag is known: {together}");
        (0..lags.len()).map(moments).collect()
    };
    let found: Vec<[f64; 2]> = (1..=6_u64).into_par_iter().flat_map_iter(found).collect();
    let count = found.len() as f64;
    let error = (found.iter().map(|[away, _]| away * away).sum::<f64>() / count).sqrt();
    let square = found.iter().map(|row| row[1]).sum::<f64>() / count;
    assert!(error < 0.3 * LAG_FRAMES, "{error:.3} frames");
    assert!((0.2..2.5).contains(&square), "{square:.2}");
}

/// Clocks that are off by some half of a frame, and good detections: what late cameras show is put on time before the pose is found, so that keypoints lie where the pose has them and none seem to scatter. With lags taken for 0 they do.
#[test]
fn late_cameras_are_corrected_while_tracking() {
    let calibration = CalibrationError { lag_frames: 0.5, ..CalibrationError::NONE };
    let script = Script { calibration, noise: DetectorNoise::stated_gaussian(2.0), ..Script::default() };
    let scatter = |seed: u64| {
        let mut source = source(&SyntheticRecording::new(&script, seed).unwrap());
        let settings = Settings { seed, fps: script.rate_hz, ..Settings::default() };
        let mut setup = set_up(&mut source, &SetupRequest::default(), script.rate_hz, seed).unwrap();
        let (tree, start) = (setup.tree(), setup.start_frame);
        track::tune(&mut setup, &tree, &mut source, start, &settings).unwrap();
        let mut as_seen = setup.clone();
        let known = as_seen.lasting.as_mut().unwrap();
        known.layout().lags().for_each(|place| known.number[place].value = 0.0);
        [setup, as_seen].map(|setup| {
            let frames = source.frames();
            let found = evaluation::filter(&mut source, &setup, frames, &settings).unwrap();
            let all = || found.estimates.iter().flat_map(|estimate| estimate.residual_px.iter().flatten());
            let scatters = found.doubts.iter().any(|doubt| matches!(doubt, Doubt::Scatter { .. }));
            (all().sum::<f64>() / all().count() as f64, scatters)
        })
    };
    let found: Vec<_> = (1..=3_u64).into_par_iter().map(scatter).collect();
    for [(on_time, seems_odd), (as_seen, is_odd)] in found {
        assert!(on_time < 0.9 * as_seen, "{on_time:.2} px on time, {as_seen:.2} px as seen");
        assert!(!seems_odd && is_odd, "scatter: {seems_odd} on time, {is_odd} as seen");
    }
}

/// One frame says nothing of how long errors last, and is enough for a set-up.
#[test]
fn one_frame_is_enough_for_a_set_up() {
    let rig = Rig::drawn(1).unwrap();
    let request = SetupRequest { fps: Some(RATE_HZ), any_size: true, ..SetupRequest::default() };
    let mut setup = set_up(&mut rig.source(), &request, RATE_HZ, 1).unwrap();
    measure_lasting(&mut setup, &mut rig.source(), 20..21, RATE_HZ, 1).unwrap();
    let known = setup.lasting.unwrap();
    assert_eq!((known.frames, known.worth, known.persistence_s), (1, 1.0, 0.0));
    assert!(known.number.iter().all(|number| number.draws.iter().all(|draw| draw.is_finite())));
}
