//! Clocks of cameras, from each of several people whose ways cross.

use sinew::formats::Layout;
use sinew::formats::openpose::Keypoint;
use sinew::input::roll::Roll;
use sinew::input::source::FrameSource;
use sinew::observe::association::{Config, Person};
use sinew::observe::cameras::offsets::{self, Sighted};
use sinew::observe::clocks::lag_estimate::{LagSearch, camera_clocks};
use sinew::observe::{Camera, Detection};
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording, FoundPeople};
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::ring::Ring;
use std::ops::Range;

struct InMemory(CrowdRecording);

impl FrameSource for InMemory {
    fn cameras(&self) -> &[Camera] {
        &self.0.cameras
    }
    fn layout(&self) -> &Layout {
        &self.0.layout
    }
    fn frames(&self) -> Range<u64> {
        0..self.0.keypoints[0].len() as u64
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, sinew_input::Error> {
        let detection = |k: Keypoint| Detection::new([k.x, k.y], k.confidence);
        let person = |found: &Vec<Option<Keypoint>>| found.iter().map(|k| k.map(detection)).collect();
        let view = |camera: &Vec<FoundPeople>| camera[number as usize].iter().map(person).collect();
        Ok(self.0.keypoints.iter().map(view).collect())
    }
}

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
    let mut source = InMemory(CrowdRecording::new(&crowd, 3).unwrap());
    let (frames, cameras) = (source.frames(), source.0.cameras.clone());
    let never = |_| Ok::<(), sinew_input::Error>(());
    let roll = Roll::call(&mut source, frames.clone(), crowd.rate_hz, &Config::default(), never).unwrap();
    assert_eq!(roll.people.len(), crowd.people);
    let search = LagSearch { fps: crowd.rate_hz, offsets: offsets::Config::default(), drifts: false };
    for person in 0..crowd.people {
        let shown = |number: u64| {
            let [own, _] = roll.parted(number, person, source.people(number).unwrap());
            (number, own.into_iter().map(|view| view.into_iter().next().unwrap_or_default()).collect())
        };
        let run: Vec<(u64, Sighted)> = frames.clone().map(shown).collect();
        let clocks = camera_clocks((&cameras, &[0.0; 4]), &[&run], &search).unwrap();
        assert!(clocks.iter().all(|clock| !clock.lag.is_off()), "{clocks:?}");
    }
}
