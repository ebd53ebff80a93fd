//! Clocks of cameras, from each of several people whose ways cross.

use sinew::formats::openpose::Keypoint;
use sinew::input::limbs::limbs;
use sinew::observe::Detection;
use sinew::observe::association::{Config, Person};
use sinew::observe::camera_lag::{LagSearch, camera_clocks};
use sinew::observe::identities::Identities;
use sinew::observe::offsets::{self, Sighted};
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording, FoundPeople};
use sinew_simulate::detector::DetectorNoise;

use sinew_simulate::ring::Ring;

/// In the images of small people, merged and with exchanged limbs, one leg at half a stride looks like the other.
#[test]
fn no_camera_in_step_is_said_to_be_late() {
    let size = [1280.0, 960.0];
    let keypoints = DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE.in_rows(size[1]) };
    let crowd = Crowd {
        people: 3,
        duration_s: 8.0,
        rate_hz: 30.0,
        ring: Ring { image_size_px: size, ..Ring::default() },
        calibration: CalibrationError::NONE,
        noise: CrowdNoise { keypoints, ..CrowdNoise::DETECTOR_LIKE },
    };
    let recording = CrowdRecording::new(&crowd, 3).unwrap();
    let mut identities =
        Identities::new(&recording.cameras, limbs(&recording.layout), recording.rate_hz, Config::default());
    let mut runs: Vec<Vec<(u64, Sighted)>> = vec![vec![]; crowd.people];
    for number in 0..recording.keypoints[0].len() {
        let person =
            |found: &[Option<Keypoint>]| found.iter().map(|k| k.map(|k| Detection::new([k.x, k.y], k.confidence)));
        let view = |found: &FoundPeople| found.iter().map(|found| person(found).collect()).collect();
        let people: Vec<Vec<Person>> = recording.keypoints.iter().map(|camera| view(&camera[number])).collect();
        let named = identities.name(&people);
        for (person, run) in runs.iter_mut().enumerate() {
            let own = |(view, names): (&Vec<Person>, &Vec<Option<usize>>)| {
                names.iter().position(|name| *name == Some(person)).map(|i| view[i].clone()).unwrap_or_default()
            };
            run.push((number as u64, people.iter().zip(&named).map(own).collect()));
        }
    }
    let search = LagSearch { fps: recording.rate_hz, offsets: offsets::Config::default(), drifts: false };
    for run in &runs {
        let clocks = camera_clocks((&recording.cameras, &[0.0; 4]), &[run], &search).unwrap();
        assert!(clocks.iter().all(|clock| !clock.lag.is_off()), "{clocks:?}");
    }
}
