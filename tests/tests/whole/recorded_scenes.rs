//! Simulated recordings of recorded motion: whoever moves stays in view of all cameras.

use sinew::observe::Camera;
use sinew_body::points::Trajectories;
use sinew_motion::retarget::retarget;
use sinew_simulate::detector::pixel;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::data::shared;
use sinew_tests::recorded_motion::recorded;

#[test]
fn walking_running_and_dancing_stay_in_view() {
    for (name, skeleton) in [("07_01", "07"), ("09_06", "09"), ("131_04", "131")] {
        let Some(folder) = shared("cmu_amc") else { return };
        let [motion, skeleton] = [format!("{name}.amc"), format!("{skeleton}.asf")].map(|file| folder.join(file));
        let recorded = recorded(&motion, &skeleton, 30.0).unwrap();
        let fitted = retarget(&recorded).unwrap();
        let film = |truth: &Trajectories| {
            let (body, states) = (fitted.body.clone(), fitted.states.clone());
            SyntheticRecording::from_motion(body, states, truth.clone(), &Script::default(), 1).unwrap()
        };
        for recording in [film(&recorded), film(&fitted.points)] {
            let inside = |camera: &Camera, point| {
                let [u, v] = pixel(camera, point).unwrap();
                (0.0..1280.0).contains(&u) && (0.0..960.0).contains(&v)
            };
            let mut points = recording.truth.frames.iter().flatten();
            assert!(points.all(|&point| recording.cameras.iter().all(|camera| inside(camera, point))), "{name}");
        }
    }
}
