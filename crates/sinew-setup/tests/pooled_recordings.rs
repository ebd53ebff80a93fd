//! One set-up of several recordings of a person.

use sinew_input::in_memory::InMemory;
use sinew_input::one_after_another::OneAfterAnother;
use sinew_input::source::FrameSource as _;
use sinew_setup::{
    MeasuredErrors, Setup, SetupError, SetupRequest, measure_lasting, measure_lasting_with, measure_motion, set_up,
};
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};

const RATE_HZ: f64 = 30.0;
/// Frames of a recording.
const FRAMES: usize = 45;

/// A walker before a detector with constant biases, whose other errors last some frames.
fn walker(frames: usize) -> InMemory {
    let noise = DetectorNoise { bias_px: 4.0, persistence: 0.8, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script { noise, duration_s: frames as f64 / RATE_HZ, rate_hz: RATE_HZ, ..Script::default() };
    let SyntheticRecording { cameras, layout, keypoints, .. } = SyntheticRecording::new(&script, 3).unwrap();
    InMemory { cameras, layout, keypoints }
}

/// Recordings that follow each other, with their set-up before what lasts is measured.
fn prepared(recordings: Vec<InMemory>) -> (Setup, OneAfterAnother<InMemory>) {
    let mut source = OneAfterAnother::new(recordings, (0.5 * RATE_HZ) as u64).unwrap();
    let (cameras, layout, frames) = (source.cameras().to_vec(), source.layout().clone(), source.frames());
    let people: Vec<_> =
        frames.clone().map(|number| Ok::<_, SetupError>((number, source.people(number).unwrap()))).collect();
    let request = SetupRequest { fps: Some(RATE_HZ), ..SetupRequest::default() };
    let (mut setup, _) = set_up(&cameras, &layout, &request, people).unwrap();
    let tree = setup.tree();
    setup.motion_sd = Some(measure_motion(&setup, &tree, &mut source, frames, RATE_HZ).unwrap());
    (setup, source)
}

/// What lasts, by the set-up of recordings that follow each other.
fn pooled(recordings: Vec<InMemory>) -> MeasuredErrors {
    let (mut setup, mut source) = prepared(recordings);
    let frames = source.frames();
    measure_lasting(&mut setup, &mut source, frames, RATE_HZ, 1).unwrap();
    setup.lasting.unwrap()
}

/// It may be stopped before each of its three rounds and before the draws; then nothing is in the set-up.
#[test]
fn measuring_lasting_errors_can_be_stopped() {
    let (before, mut source) = prepared(vec![walker(FRAMES)]);
    let frames = source.frames();
    let mut stopped_after = |parts: usize| {
        let (mut setup, mut asked) = (before.clone(), 0);
        let mut proceed = || {
            asked += 1;
            if asked > parts { Err(sinew_setup::Error::from(SetupError::NoPose)) } else { Ok(()) }
        };
        let ended = measure_lasting_with(&mut setup, &mut source, frames.clone(), (RATE_HZ, 1), None, &mut proceed);
        (ended.is_ok(), setup == before, asked)
    };
    assert_eq!(
        (0..=4).map(&mut stopped_after).collect::<Vec<_>>(),
        [(false, true, 1), (false, true, 2), (false, true, 3), (false, true, 4), (true, false, 4)]
    );
}

/// A recording that is shown four times says what it says once. Were copies taken for new frames they would be worth four times as much, and lengths would drift with their number to where the errors pull them that all of them share.
#[test]
fn copies_of_a_recording_say_no_more_than_one() {
    let [once, four_times] = [1, 4].map(|count| pooled(vec![walker(FRAMES); count]));
    assert!(four_times.worth < 1.7 * once.worth, "{} independent frames for {}", four_times.worth, once.worth);
    for place in once.layout().lengths() {
        let [one, four] = [&once, &four_times].map(|known| known.known(place));
        assert!((four.mean - one.mean).abs() < 2.0 * one.sd && four.sd > 0.7 * one.sd, "{one:?} {four:?}");
    }
}

/// The parts of a recording have the same constant biases and errors of their own beside: each tells something new.
#[test]
fn recordings_with_the_same_biases_say_more_than_one() {
    let whole = walker(4 * FRAMES);
    let part = |first: usize| {
        let keypoints = whole.keypoints.iter().map(|frames| frames[first..first + FRAMES].to_vec()).collect();
        InMemory { keypoints, ..whole.clone() }
    };
    let four = pooled((0..4).map(|k| part(k * FRAMES)).collect());
    let together = pooled(vec![whole.clone()]);
    assert!(four.worth > 0.7 * together.worth, "{} independent frames for {}", four.worth, together.worth);
}
