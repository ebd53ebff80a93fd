//! Recordings in which detectors exchange left and right, through set-up and tracking.

use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::settings::Settings;
use sinew::setup::SetupRequest;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{Track, filter, mean_distance, positions};
use sinew_tests::simulated_source::{set_up, source};

/// Frames in which the walker walks.
const WALKED: std::ops::Range<u64> = 40..100;

/// Two cameras a right angle apart, whose detectors exchange limbs in this share of the frames: the shares that the set-up finds, the mean error of tracking, metres, and the frames in which it began again.
fn tracked(swapped: f64, seed: u64) -> (Vec<f64>, f64, usize) {
    let noise = DetectorNoise { swapped, ..DetectorNoise::stated_gaussian(3.0) };
    let mut film = SyntheticRecording::new(&Script { noise, ..Script::default() }, seed).unwrap();
    film.cameras.truncate(2);
    film.keypoints.truncate(2);
    let request = SetupRequest { fps: Some(film.rate_hz), ..SetupRequest::default() };
    let setup = set_up(&mut source(&film), &request, film.rate_hz, seed).unwrap();
    let settings = Settings { seed, fps: film.rate_hz, ..Settings::default() };
    let found = filter(&mut source(&film), &setup, WALKED, &settings).unwrap();
    let truth: Track = film.truth.select(&EVALUATION_JOINTS).frames[40..100]
        .iter()
        .map(|frame| frame.iter().map(|&point| Some(point)).collect())
        .collect();
    let track = positions(&found.tree, &found.estimates, &EVALUATION_JOINTS);
    let shares = setup.camera.iter().map(|camera| camera.exchanged).collect();
    let restarts = found.estimates.iter().filter(|estimate| estimate.restarted).count();
    (shares, mean_distance(&track, &truth, 0..60), restarts)
}

/// The share of exchanged limbs is found, and what is exchanged costs next to nothing, though two cameras cannot outvote one of them.
#[test]
fn exchanged_limbs_are_found_and_cost_little() {
    let (none, plain, usual) = tracked(0.0, 3);
    assert!(none.iter().all(|share| *share < 0.01), "{none:?}");
    let (found, exchanged, restarts) = tracked(0.1, 3);
    assert!(found.iter().all(|share| (0.05..0.15).contains(share)), "{found:?}");
    assert!(exchanged < 1.05 * plain, "{exchanged} m, without exchanges {plain} m");
    assert_eq!(restarts, usual, "frames in which tracking began again");
}
